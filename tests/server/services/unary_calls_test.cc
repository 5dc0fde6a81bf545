// Calls with one answer, over a channel of this process: what the store refuses is what they end
// with, and the limits of what they take.
#include <functional>

#include "proto/bridge/sha256.h"
#include "proto/recording/recording.h"
#include "server/base/names.h"
#include "tests/server/services/unary_calls_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;

TEST_F(UnaryCalls, OfMachinesHandOnWhatTheStoreSays) {
  using Stub = v1::MachineService::Stub;
  const std::string schedule = "name: 'machines/laser/laserSchedules/5'";
  EXPECT_EQ(InSpiteOfAll(machines, &Stub::CreateMachine,
                         "machine_id: 'laser' machine { family: 'optimo' title: 'Laser' }")
                .title(),
            "Laser");
  EXPECT_EQ(InSpiteOfAll(machines, &Stub::GetMachine, "name: 'machines/laser'").status().state(),
            v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(InSpiteOfAll(machines, &Stub::ListMachines, "").machines_size(), 3);
  EXPECT_EQ(InSpiteOfAll(machines, &Stub::UpdateMachine,
                         "machine { name: 'machines/laser' title: 'Other' } update_mask { paths: "
                         "'title' }")
                .title(),
            "Other");
  InSpiteOfAll(machines, &Stub::PutLaserSchedule,
               "laser_schedule { " + schedule + " mode: LASER_MODE_CW power_percent: 40 }");
  EXPECT_EQ(InSpiteOfAll(machines, &Stub::GetLaserSchedule, schedule).power_percent(), 40.0);
  EXPECT_EQ(InSpiteOfAll(machines, &Stub::ListLaserSchedules, "parent: 'machines/laser'")
                .laser_schedules_size(),
            1);
  InSpiteOfAll(machines, &Stub::DeleteLaserSchedule, schedule);
  InSpiteOfAll(machines, &Stub::DeleteMachine, "name: 'machines/laser'");
}

TEST_F(UnaryCalls, OfProgramsHandOnWhatTheStoreSays) {
  using Stub = v1::ProgramService::Stub;
  const std::string name = "name: 'machines/optimo-1/programs/45' ";
  EXPECT_EQ(InSpiteOfAll(programs, &Stub::PutProgram,
                         name + "program { file_name: 'a.S' content: 'SPEED 20\\n' }")
                .file_name(),
            "a.S");
  EXPECT_EQ(InSpiteOfAll(programs, &Stub::GetProgram, name).etag(), "1");
  EXPECT_EQ(InSpiteOfAll(programs, &Stub::GetProgramContent, name).content(), "SPEED 20\n");
  EXPECT_EQ(
      InSpiteOfAll(programs, &Stub::ListPrograms, "parent: 'machines/optimo-1'").programs_size(),
      1);
  EXPECT_TRUE(InSpiteOfAll(programs, &Stub::CheckProgram,
                           "machine: 'machines/optimo-1' program { file_name: 'b.S' content: "
                           "'CALL 45\\n' }")
                  .findings()
                  .ok());
  InSpiteOfAll(programs, &Stub::ListStaleExecutables, "parent: 'machines/optimo-1'");
  InSpiteOfAll(programs, &Stub::DeleteProgram, name);
}

TEST_F(UnaryCalls, OfProjectsHandOnWhatTheStoreSays) {
  using Stub = v1::ProjectService::Stub;
  InSpiteOfAll(projects, &Stub::CreateProject, "project_id: 'lid' project { title: 'Lid' }");
  EXPECT_EQ(InSpiteOfAll(projects, &Stub::GetProject, "name: 'projects/lid'").title(), "Lid");
  EXPECT_EQ(InSpiteOfAll(projects, &Stub::ListProjects, "").projects_size(), 1);
  EXPECT_EQ(InSpiteOfAll(projects, &Stub::UpdateProject,
                         "project { name: 'projects/lid' title: 'Box' } update_mask { paths: "
                         "'title' }")
                .title(),
            "Box");
  InSpiteOfAll(projects, &Stub::DeleteProject, "name: 'projects/lid'");
}

TEST_F(UnaryCalls, OfJobsHandOnWhatTheStoreSays) {
  using Stub = v1::JobService::Stub;
  v1::RunReport report;
  report.set_family("optimo");
  const std::int64_t ended = EndedJob({{.name = "report", .bytes = report.SerializeAsString()},
                                       {.name = "picture.svg", .bytes = "<svg/>"}});
  const std::string name = "name: '" + JobName(ended) + "' ";
  EXPECT_EQ(InSpiteOfAll(jobs, &Stub::ListJobs, "").jobs_size(), 1);
  EXPECT_EQ(InSpiteOfAll(jobs, &Stub::GetJobReport, name).family(), "optimo");
  InSpiteOfAll(jobs, &Stub::ListJobFindings, name);
  EXPECT_EQ(InSpiteOfAll(jobs, &Stub::GetJobPicture, name).content(), "<svg/>");
  EXPECT_EQ(InSpiteOfAll(jobs, &Stub::GetJobArtifact, name + "artifact: 'picture.svg'").content(),
            "<svg/>");
  InSpiteOfAll(jobs, &Stub::DeleteJob, name);
}

// 0 to 100 percent, both of them.
TEST_F(UnaryCalls, ThePowerOfAScheduleIsAShare) {
  const auto put = [&](const std::string& percent) {
    Call(machines, &v1::MachineService::Stub::PutLaserSchedule,
         "laser_schedule { name: 'machines/optimo-1/laserSchedules/5' mode: LASER_MODE_CW "
         "power_percent: " +
             percent + " }");
  };
  for (const char* good : {"0", "100"}) {
    put(good);
    EXPECT_TRUE(status.ok()) << good;
  }
  for (const char* bad : {"-0.001", "100.001", "nan"}) {
    put(bad);
    ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "power_percent: allowed are 0 to 100");
  }
}

TEST_F(UnaryCalls, MachinesComeInPages) {
  std::string names;
  std::string token;
  do {
    const auto page = Call(machines, &v1::MachineService::Stub::ListMachines,
                           "page_size: 1 page_token: '" + token + "'");
    ASSERT_EQ(page.machines_size(), 1);
    names += page.machines(0).name() + " ";
    token = page.next_page_token();
  } while (!token.empty());
  EXPECT_EQ(names, "machines/mill-1 machines/optimo-1 ");
}

// One answer has 3 MiB; a byte more goes by a stream.
TEST_F(UnaryCalls, AnAnswerHasSoManyBytes) {
  constexpr std::size_t kMost = std::size_t{3} << 20;
  PutObject(1, kMost);
  PutObject(2, kMost + 1);
  const auto content = [&](int slot) {
    return Call(programs, &v1::ProgramService::Stub::GetProgramContent,
                "name: 'machines/mill-1/programs/" + std::to_string(slot) +
                    "' form: PROGRAM_FORM_OBJECT")
        .content()
        .size();
  };
  EXPECT_EQ(content(1), kMost);
  content(2);
  ExpectRefused(grpc::StatusCode::RESOURCE_EXHAUSTED, "3145729 bytes: use DownloadProgram");
  const std::int64_t job = EndedJob({{.name = "most", .bytes = std::string(kMost, 'x')},
                                     {.name = "more", .bytes = std::string(kMost + 1, 'x')}});
  const auto artifact = [&](const std::string& name) {
    return Call(jobs, &v1::JobService::Stub::GetJobArtifact,
                "name: '" + JobName(job) + "' artifact: '" + name + "'")
        .content()
        .size();
  };
  EXPECT_EQ(artifact("most"), kMost);
  artifact("more");
  ExpectRefused(grpc::StatusCode::RESOURCE_EXHAUSTED, "more has 3145729 bytes");
}

TEST_F(UnaryCalls, ErrorsAreExplained) {
  using Stub = v1::ProgramService::Stub;
  EXPECT_EQ(Call(programs, &Stub::ExplainError, "").errors_size(),
            static_cast<int>(Catalogue().size()));
  const auto one = Call(programs, &Stub::ExplainError, "code: 'OPT-E348'");
  ASSERT_EQ(one.errors_size(), 1);
  EXPECT_EQ(one.errors(0).code(), "OPT-E348");
  EXPECT_EQ(one.language(), "en");
  Call(programs, &Stub::ExplainError, "code: 'none'");
  ExpectRefused(grpc::StatusCode::NOT_FOUND, "no error 'none'");
  Call(programs, &Stub::ExplainError, "code: '" + std::string(81, 'x') + "'");
  ExpectRefused(grpc::StatusCode::NOT_FOUND, "no error '" + std::string(80, 'x') + "'");
}

// LIVE-3.03: who gives a machine away says why, and to whom. Here no machine lives.
TEST_F(UnaryCalls, WhoTakesAMachineSaysWhy) {
  const auto take = [&](std::size_t reason, const std::string& computer) {
    Call(machines, &v1::MachineService::Stub::TakeMachine,
         "machine: 'machines/mill-1' request_id: 'r' reason: '" + std::string(reason, 'x') +
             "' computer: '" + computer + "'");
  };
  for (const std::size_t reason : {0U, 201U}) {
    take(reason, "pc");
    ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "reason: why, in 1 to 200 characters");
  }
  for (const std::string& computer : {std::string(), std::string(254, 'p'), std::string("a/b")}) {
    take(1, computer);
    ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "computer: its name");
  }
  for (const std::size_t reason : {1U, 200U}) {
    take(reason, std::string(253, 'p'));
    ExpectRefused(grpc::StatusCode::UNAVAILABLE, "no machine lives here");
  }
}

// docs/api.md: a content says how large it is, and has a byte at least.
TEST_F(UnaryCalls, AContentSaysItsSize) {
  const auto upload = [&](const std::string& header, const std::string& bytes) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    v1::UploadContentResponse response;
    const auto writer = programs->UploadContent(&context, &response);
    writer->Write(FromText<v1::UploadContentRequest>("header { " + header + " }"));
    v1::UploadContentRequest chunk;
    chunk.set_chunk(bytes);
    writer->Write(chunk);
    writer->WritesDone();
    status = writer->Finish();
    return response;
  };
  const std::string sha256 = "sha256: '" + bridge::Sha256Hex("x") + "' ";
  upload("size: 0 " + sha256, "");
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "header.size is missing");
  upload("size: 1", "x");
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "header.sha256 is missing");
  upload("size: 1 " + sha256, "x");
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(Must(store_.ReadBlob(bridge::Sha256Hex("x"))), "x");
}

v1::JournalEntry Mark(std::int64_t sequence, std::int64_t time_ns) {
  v1::JournalEntry entry;
  entry.set_fence(7);
  entry.set_sequence(sequence);
  entry.set_virtual_time_ns(time_ns);
  entry.mutable_mark()->set_state("state");
  return entry;
}

// machine.proto ExportJournal: of a job what was kept with it, from a time on, of a fence; else
// what the host of the machine has.
TEST_F(UnaryCalls, AJournalGoesOut) {
  const recording::Recording all{.head = FromText<v1::MachineRecording>("fence: 7"),
                                 .entries = {Mark(1, 0), Mark(2, 10)}};
  const std::string file = recording::FileOf(all);
  const std::int64_t job = EndedJob({{.name = "recording", .bytes = file}});
  const std::int64_t bare = EndedJob({});
  const auto exported = [&](const std::string& request) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    const auto reader =
        machines->ExportJournal(&context, FromText<v1::ExportJournalRequest>(request));
    std::string bytes;
    for (v1::ExportJournalResponse part; reader->Read(&part);) {
      EXPECT_FALSE(part.chunk().empty());
      bytes += part.chunk();
    }
    status = reader->Finish();
    return bytes;
  };
  const std::string of_job = "machine: 'machines/optimo-1' job: '" + JobName(job) + "' ";
  EXPECT_EQ(exported(of_job), file);
  EXPECT_TRUE(status.ok());
  EXPECT_EQ(exported(of_job + "fence: 7"), file);
  EXPECT_EQ(exported(of_job + "from_virtual_time_ns: 9"), file);
  EXPECT_EQ(exported(of_job + "fence: 7 from_virtual_time_ns: 10"),
            recording::FileOf({.head = all.head, .entries = {Mark(2, 10)}}));
  // From the beginning it is as it was kept, also where it began twice.
  const std::string twice =
      recording::FileOf({.head = all.head, .entries = {Mark(1, 0), Mark(2, 0)}});
  const std::string begun = JobName(EndedJob({{.name = "recording", .bytes = twice}}));
  EXPECT_EQ(exported("machine: 'machines/optimo-1' fence: 7 job: '" + begun + "'"), twice);
  exported(of_job + "fence: 8");
  ExpectRefused(grpc::StatusCode::NOT_FOUND, "what is recorded is of fence 7");
  exported("machine: 'machines/mill-1' job: '" + JobName(job) + "'");
  ExpectRefused(grpc::StatusCode::NOT_FOUND, JobName(job) + " is of another machine");
  exported("machine: 'machines/optimo-1' job: 'jobs/99'");
  ExpectRefused(grpc::StatusCode::NOT_FOUND, "job 99");
  exported("machine: 'machines/optimo-1' job: 'x'");
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
  exported("machine: 'machines/none'");
  ExpectRefused(grpc::StatusCode::NOT_FOUND, "CELL-E9009");
  exported("machine: 'x'");
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
  for (const std::string& unkept : {std::string(), " job: '" + JobName(bare) + "'"}) {
    exported("machine: 'machines/optimo-1'" + unkept);
    ExpectRefused(grpc::StatusCode::UNAVAILABLE, "the machine has no host: enable it");
  }
  const std::int64_t damaged = EndedJob({{.name = "recording", .bytes = "no recording"}});
  exported("machine: 'machines/optimo-1' fence: 7 job: '" + JobName(damaged) + "'");
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "it does not begin as one");
}

// What the book refuses is what the import ends with.
TEST_F(UnaryCalls, AnArchiveIsImportedOnce) {
  const std::string archive = *WriteProjectArchive(FromText<v1::Project>("title: 'Lid'"));
  v1::Project response;
  for (int time = 0; time < 2; ++time) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    const auto writer = projects->ImportProject(&context, &response);
    writer->Write(FromText<v1::ImportProjectRequest>("project_id: 'lid'"));
    v1::ImportProjectRequest chunk;
    chunk.set_chunk(archive);
    writer->Write(chunk);
    writer->WritesDone();
    status = writer->Finish();
    EXPECT_EQ(status.ok(), time == 0) << status.error_message();
  }
  EXPECT_EQ(response.name(), "projects/lid");
  EXPECT_EQ(response.title(), "Lid");
  ExpectRefused(grpc::StatusCode::ALREADY_EXISTS, "lid");
}

// An archive of so many bytes is looked at, a byte more is not taken.
TEST_F(UnaryCalls, AnArchiveHasSoManyBytes) {
  const auto import = [&](std::size_t last_bytes) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    v1::Project response;
    const auto writer = projects->ImportProject(&context, &response);
    writer->Write(FromText<v1::ImportProjectRequest>("project_id: 'lid'"));
    v1::ImportProjectRequest chunk;
    chunk.set_chunk(std::string(kProjectBytesMax / 2, 'x'));
    writer->Write(chunk);
    chunk.set_chunk(std::string(last_bytes, 'x'));
    writer->Write(chunk);
    writer->WritesDone();
    status = writer->Finish();
  };
  import(kProjectBytesMax / 2 + 1);
  ExpectRefused(grpc::StatusCode::RESOURCE_EXHAUSTED, "an archive has at most 67108864 bytes");
  import(kProjectBytesMax / 2);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << status.error_message();
}

// Of a server that starts no hosts.
TEST_F(UnaryCalls, WhereNoMachineLives) {
  using Stub = v1::MachineService::Stub;
  Call(machines, &Stub::EnableMachine, "machine: 'machines/mill-1' request_id: 'a'");
  ExpectRefused(grpc::StatusCode::UNAVAILABLE, "this server starts no hosts");
  Call(machines, &Stub::StartMachine, "machine: 'machines/mill-1' request_id: 'b' job: 'jobs/1'");
  ExpectRefused(grpc::StatusCode::UNAVAILABLE, "no machine lives here");
  // It is as if it were disabled.
  EXPECT_EQ(
      Call(machines, &Stub::DisableMachine, "machine: 'machines/mill-1' request_id: 'c'").state(),
      v1::MACHINE_STATE_IDLE);
  EXPECT_TRUE(status.ok()) << status.error_message();
  Call(machines, &Stub::DisableMachine, "machine: 'machines/none' request_id: 'd'");
  ExpectRefused(grpc::StatusCode::NOT_FOUND, "CELL-E9009");
  Call(machines, &Stub::DisableMachine, "machine: 'none' request_id: 'e'");
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
  Call(machines, &Stub::TakeMachine,
       "machine: 'machines/none' request_id: 'f' reason: 'why' computer: 'pc'");
  ExpectRefused(grpc::StatusCode::NOT_FOUND, "CELL-E9009");
}

// machine.proto connection: devices are for a later version, by their kind or by their name.
TEST_F(UnaryCalls, ADeviceIsForLater) {
  using Stub = v1::MachineService::Stub;
  const std::string text = "machine.connection: a device";
  for (const char* device : {"kind: KIND_DEVICE", "device: 'tcp:a:1'"}) {
    const std::string connection = std::string(" connection { ") + device + " } }";
    Call(machines, &Stub::CreateMachine, "machine_id: 'm' machine { family: 'optimo'" + connection);
    ExpectRefused(grpc::StatusCode::UNIMPLEMENTED, text);
    Call(machines, &Stub::UpdateMachine,
         "update_mask { paths: 'title' } machine { name: 'machines/mill-1'" + connection);
    ExpectRefused(grpc::StatusCode::UNIMPLEMENTED, text);
  }
  Call(machines, &Stub::CreateMachine,
       "machine_id: 'm' machine { family: 'optimo' connection { kind: KIND_VIRTUAL } }");
  EXPECT_TRUE(status.ok()) << status.error_message();
}

// Schedules are of a family that is known.
TEST_F(UnaryCalls, SchedulesOfAnUnknownFamily) {
  using Stub = v1::MachineService::Stub;
  Must(store_.PutMachine({.id = "lathe-1", .family = "lathe"}, 0, {}));
  const std::string name = "name: 'machines/lathe-1/laserSchedules/5'";
  Call(machines, &Stub::PutLaserSchedule, "laser_schedule { " + name + " mode: LASER_MODE_CW }");
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9008");
  Call(machines, &Stub::DeleteLaserSchedule, name);
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9008");
}

// Who does not say how many gets a hundred.
TEST_F(UnaryCalls, APageHasAHundredMachines) {
  for (int i = 0; i < 99; ++i)
    Must(store_.PutMachine({.id = "n" + std::to_string(100 + i), .family = "rml1"}, 0, {}));
  const auto page = Call(machines, &v1::MachineService::Stub::ListMachines, "");
  EXPECT_EQ(page.machines_size(), 100);
  const auto rest = Call(machines, &v1::MachineService::Stub::ListMachines,
                         "page_token: '" + page.next_page_token() + "'");
  EXPECT_EQ(rest.machines_size(), 1);
  EXPECT_EQ(rest.next_page_token(), "");
}

// project.proto ExportProject: the archive in parts of a megabyte.
TEST_F(UnaryCalls, AnArchiveGoesOut) {
  v1::CreateProjectRequest request;
  request.set_project_id("lid");
  v1::ProjectProgram& program = *request.mutable_project()->add_programs();
  program.set_slot(5);
  program.mutable_source()->set_file_name("a.rml");
  program.mutable_source()->set_content(storage::Noise(1'500'000, 1));  // it packs badly
  {
    grpc::ClientContext context;
    v1::Project made;
    status = projects->CreateProject(&context, request, &made);
    ASSERT_TRUE(status.ok()) << status.error_message();
  }
  std::vector<std::size_t> sizes;
  const auto exported = [&](const std::string& name) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    const auto reader = projects->ExportProject(
        &context, FromText<v1::ExportProjectRequest>("name: '" + name + "'"));
    std::string bytes;
    for (v1::ExportProjectResponse part; reader->Read(&part);) {
      sizes.push_back(part.chunk().size());
      bytes += part.chunk();
    }
    status = reader->Finish();
    return bytes;
  };
  const std::string archive = exported("projects/lid");
  EXPECT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(sizes.size(), 2U);
  EXPECT_EQ(sizes[0], std::size_t{1} << 20);
  const v1::Project back = Must(ReadProjectArchive(archive));
  ASSERT_EQ(back.programs_size(), 1);
  EXPECT_TRUE(back.programs(0).source().content() == program.source().content());
  EXPECT_EQ(exported("projects/none"), "");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND) << status.error_message();
}

// What goes out in parts is read from the store once, however many they are.
TEST_F(UnaryCalls, WhatGoesOutInPartsIsReadOnce) {
  // Calls to the store until all of it has come.
  const auto reads = [&](const std::function<grpc::Status()>& fetch) {
    for (int call = 1;; ++call) {
      store_.FailAt(call);
      const grpc::Status end = fetch();
      const bool failed = store_.failed();
      EXPECT_NE(end.ok(), failed) << "call " << call << ": " << end.error_message();
      store_.FailAt(0);
      if (!failed) return call - 1;
    }
  };
  const auto project = [&](const std::string& id, std::size_t bytes) {
    v1::CreateProjectRequest request;
    request.set_project_id(id);
    v1::ProjectProgram& program = *request.mutable_project()->add_programs();
    program.set_slot(5);
    program.mutable_source()->set_file_name("a.rml");
    program.mutable_source()->set_content(storage::Noise(bytes, 1));
    grpc::ClientContext context;
    v1::Project made;
    EXPECT_TRUE(projects->CreateProject(&context, request, &made).ok());
    return reads([&] {
      grpc::ClientContext export_context;
      export_context.set_deadline(std::chrono::system_clock::now() + kPatience);
      const auto reader = projects->ExportProject(
          &export_context, FromText<v1::ExportProjectRequest>("name: 'projects/" + id + "'"));
      for (v1::ExportProjectResponse part; reader->Read(&part);) {
      }
      return reader->Finish();
    });
  };
  EXPECT_EQ(project("large", 1'500'000), project("small", 1000));
  const auto journal = [&](std::size_t bytes) {
    const std::string job =
        JobName(EndedJob({{.name = "recording", .bytes = std::string(bytes, 'x')}}));
    return reads([&] {
      grpc::ClientContext context;
      context.set_deadline(std::chrono::system_clock::now() + kPatience);
      const auto reader = machines->ExportJournal(
          &context,
          FromText<v1::ExportJournalRequest>("machine: 'machines/optimo-1' job: '" + job + "'"));
      for (v1::ExportJournalResponse part; reader->Read(&part);) {
      }
      return reader->Finish();
    });
  };
  EXPECT_EQ(journal(600'000), journal(10));
}

// project.proto ImportProject: its name first, once, then its bytes.
TEST_F(UnaryCalls, AnArchiveSaysWhatItBecomes) {
  const auto refused = [&](const std::vector<std::string>& messages, const std::string& text) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    v1::Project response;
    const auto writer = projects->ImportProject(&context, &response);
    for (const std::string& one : messages) writer->Write(FromText<v1::ImportProjectRequest>(one));
    writer->WritesDone();
    status = writer->Finish();
    ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, text);
  };
  refused({}, "project_id is missing");
  refused({"project_id: ''"}, "project_id is missing");
  refused({"chunk: 'x'"}, "the first message must be the project_id");
  refused({"project_id: 'lid'", "project_id: 'box'"}, "a second project_id");
  refused({"project_id: 'lid'", "chunk: 'no archive'"}, "CELL-E9003");
}

}  // namespace
}  // namespace rmlcell::server
