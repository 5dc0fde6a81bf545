// The verbs that ask a server for machines, programs and projects: what they ask for, and what they
// show of the answer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "clients/cli/remote.h"
#include "clients/cli/verbs.h"
#include "engine/core/result.h"
#include "proto/bridge/files.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/sha256.h"
#include "rmlcell/v1/machine.grpc.pb.h"
#include "rmlcell/v1/program.grpc.pb.h"
#include "rmlcell/v1/project.grpc.pb.h"
#include "tests/clients/cli/fake_services.h"

namespace rmlcell::cli {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::StartsWith;

struct FakeMachines final : v1::MachineService::Service {
  grpc::Status ListMachines(grpc::ServerContext*, const v1::ListMachinesRequest*,
                            v1::ListMachinesResponse* response) override {
    *response = list;
    return {};
  }
  v1::ListMachinesResponse list;
};

struct FakePrograms final : v1::ProgramService::Service {
  grpc::Status PutProgram(grpc::ServerContext*, const v1::PutProgramRequest* request,
                          v1::Program* response) override {
    put = *request;
    *response = stored;
    return refusal;
  }
  grpc::Status StoreSpecialPrograms(grpc::ServerContext*,
                                    const v1::StoreSpecialProgramsRequest* request,
                                    v1::StoreSpecialProgramsResponse* response) override {
    special = *request;
    *response->add_programs() = stored;
    return refusal;
  }
  grpc::Status UploadProgram(grpc::ServerContext*,
                             grpc::ServerReader<v1::UploadProgramRequest>* reader,
                             v1::Program* response) override {
    v1::UploadProgramRequest part;
    while (reader->Read(&part)) {
      if (part.has_header()) header = part.header();
      if (part.has_chunk()) chunks.push_back(part.chunk());
    }
    *response = stored;
    return refusal;
  }
  grpc::Status DownloadProgram(grpc::ServerContext*, const v1::DownloadProgramRequest* request,
                               grpc::ServerWriter<v1::DownloadProgramResponse>* writer) override {
    download = *request;
    v1::DownloadProgramResponse part;
    part.mutable_header()->set_form(request->form());
    writer->Write(part);
    for (const char* chunk : {"SPEED 5\n", "STOP\n"}) {
      part.set_chunk(chunk);
      writer->Write(part);
    }
    return refusal;
  }
  grpc::Status ListPrograms(grpc::ServerContext*, const v1::ListProgramsRequest* request,
                            v1::ListProgramsResponse* response) override {
    parent = request->parent();
    *response = list;
    return refusal;
  }
  grpc::Status DeleteProgram(grpc::ServerContext*, const v1::DeleteProgramRequest* request,
                             google::protobuf::Empty*) override {
    deleted = request->name();
    return refusal;
  }
  grpc::Status ListStaleExecutables(grpc::ServerContext*,
                                    const v1::ListStaleExecutablesRequest* request,
                                    v1::ListStaleExecutablesResponse* response) override {
    parent = request->parent();
    *response = stale;
    return refusal;
  }

  grpc::Status refusal;
  v1::Program stored;
  v1::ListProgramsResponse list;
  v1::ListStaleExecutablesResponse stale;
  v1::PutProgramRequest put;
  v1::StoreSpecialProgramsRequest special;
  v1::UploadProgramRequest::Header header;
  std::vector<std::string> chunks;
  v1::DownloadProgramRequest download;
  std::string parent, deleted;
};

struct FakeProjects final : v1::ProjectService::Service {
  grpc::Status ListProjects(grpc::ServerContext*, const v1::ListProjectsRequest* request,
                            v1::ListProjectsResponse* response) override {
    tokens.push_back(request->page_token());
    v1::Project& one = *response->add_projects();
    one.set_name("projects/p" + std::to_string(tokens.size()));
    one.set_title("title");
    one.add_programs();
    one.add_programs();
    one.add_laser_schedules();
    one.add_processes();
    one.add_processes();
    one.add_processes();
    if (tokens.size() == 1) response->set_next_page_token("more");
    return refusal;
  }
  grpc::Status GetProject(grpc::ServerContext*, const v1::GetProjectRequest* request,
                          v1::Project* response) override {
    asked = request->name();
    *response = project;
    return refusal;
  }
  grpc::Status DeleteProject(grpc::ServerContext*, const v1::DeleteProjectRequest* request,
                             google::protobuf::Empty*) override {
    asked = request->name();
    return refusal;
  }
  grpc::Status TransferProject(grpc::ServerContext*, const v1::TransferProjectRequest* request,
                               v1::TransferProjectResponse* response) override {
    transfer = *request;
    v1::TransferItem& program = *response->add_items();
    program.set_name("machines/m/programs/12");
    program.set_change(v1::TRANSFER_CHANGE_REPLACE);
    program.mutable_program_before()->set_object_bytes(30);
    program.mutable_program_after()->set_title("twelve");
    program.mutable_program_after()->set_object_bytes(33);
    v1::TransferItem& schedule = *response->add_items();
    schedule.set_name("machines/m/laserSchedules/3");
    schedule.set_change(v1::TRANSFER_CHANGE_ADD);
    schedule.mutable_laser_schedule_after()->set_mode(v1::LASER_MODE_PULSE);
    schedule.mutable_laser_schedule_after()->set_power_percent(40.0);
    response->mutable_findings()->set_diagnostics_dropped(2);
    return refusal;
  }

  grpc::Status TransferProjectFromMachine(grpc::ServerContext*,
                                          const v1::TransferProjectFromMachineRequest* request,
                                          v1::Project* response) override {
    taken = *request;
    response->set_name("projects/" + request->project_id());
    return refusal;
  }
  grpc::Status ExportProject(grpc::ServerContext*, const v1::ExportProjectRequest* request,
                             grpc::ServerWriter<v1::ExportProjectResponse>* writer) override {
    asked = request->name();
    if (!refusal.ok()) return refusal;
    v1::ExportProjectResponse part;
    for (const char* chunk : {"PK", "bytes"}) {
      part.set_chunk(chunk);
      writer->Write(part);
    }
    return refusal;
  }
  grpc::Status ImportProject(grpc::ServerContext*,
                             grpc::ServerReader<v1::ImportProjectRequest>* reader,
                             v1::Project* response) override {
    v1::ImportProjectRequest part;
    archive.clear();
    while (reader->Read(&part)) {
      if (part.has_chunk()) archive += part.chunk();
      if (!part.project_id().empty()) response->set_name("projects/" + part.project_id());
    }
    return refusal;
  }

  grpc::Status refusal;
  v1::Project project;
  v1::TransferProjectRequest transfer;
  v1::TransferProjectFromMachineRequest taken;
  std::string archive;
  std::vector<std::string> tokens;
  std::string asked;
};

class RemoteVerbs : public testing::Test {
 protected:
  Told Put(const std::string& bytes, const PutOptions& options = {}, bool as_json = false) {
    const std::string file = folder.Put("12.S", bytes);
    return Hear([&] { return PutProgram(server.remote(as_json), "m", 12, file, options); });
  }

  CliFolder folder;
  FakeMachines machines;
  FakePrograms programs;
  FakeProjects projects;
  FakeServer server{folder, {&machines, &programs, &projects}};
};

TEST_F(RemoteVerbs, MachinesAreATable) {
  v1::Machine& machine = *machines.list.add_machines();
  machine.set_name("machines/mill-1");
  machine.set_family("rml1");
  machine.set_title("the small one");
  Told told = Hear([&] { return Machines(server.remote()); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_THAT(told.output, MatchesRegex("MACHINE +FAMILY +PROFILE +TITLE *\n"
                                        "mill-1 +rml1 +- +the small one *\n"));
  told = Hear([&] { return Machines(server.remote(true)); });
  EXPECT_THAT(told.output, HasSubstr("\"machines/mill-1\""));
}

TEST_F(RemoteVerbs, ProgramsAreATable) {
  v1::Program& source = *programs.list.add_programs();
  source.set_name("machines/m/programs/12");
  source.set_title("bracket");
  source.set_file_name("12.S");
  source.set_object_bytes(99);
  source.set_executable_bytes(0);
  source.set_etag("3");
  v1::Program& object = *programs.list.add_programs();
  object.set_name("machines/m/programs/44");
  object.set_object_bytes(7);
  Told told = Hear([&] { return Programs(server.remote(), "m"); });
  EXPECT_EQ(programs.parent, "machines/m");
  EXPECT_THAT(told.output, MatchesRegex("SLOT +TITLE +SOURCE +OBJECT +EXECUTABLE +ETAG *\n"
                                        "12 +bracket +12.S +99 B +0 B +3 *\n"
                                        "44 +- +7 B +- *\n"));
  told = Hear([&] { return Programs(server.remote(true), "machines/m"); });
  EXPECT_EQ(programs.parent, "machines/m");
  EXPECT_THAT(told.output, AllOf(HasSubstr("programs/12\""), HasSubstr("programs/44\"")));
}

TEST_F(RemoteVerbs, ASmallProgramGoesInOneMessage) {
  programs.stored.set_name("machines/m/programs/12");
  programs.stored.set_title("twelve");
  programs.stored.set_object_bytes(33);
  programs.stored.mutable_findings()->set_diagnostics_dropped(1);
  Told told = Put("SPEED 5\n", {.etag = "7", .check_only = false, .force = true});
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output,
            "and 1 more finding\nmachines/m/programs/12 stored: twelve, object 33 B\n");
  EXPECT_EQ(programs.put.name(), "machines/m/programs/12");
  EXPECT_EQ(programs.put.program().file_name(), "12.S");
  EXPECT_EQ(programs.put.program().content(), "SPEED 5\n");
  EXPECT_EQ(programs.put.etag(), "7");
  EXPECT_FALSE(programs.put.validate_only());
  EXPECT_TRUE(programs.put.force());
  programs.stored.clear_findings();
  told = Put("SPEED 5\n", {.etag = {}, .check_only = true, .force = false});
  EXPECT_EQ(told.output, "machines/m/programs/12 would be stored: twelve, object 33 B\n");
  EXPECT_TRUE(programs.put.validate_only());
  EXPECT_FALSE(programs.put.force());
  EXPECT_THAT(Put("SPEED 5\n", {}, true).output, StartsWith("{"));
}

// OPT-1.11: the executable of slot n has the number n + 100.
TEST_F(RemoteVerbs, AnExecutableIsToldAsOne) {
  programs.stored.set_title("t");
  programs.stored.set_object_bytes(5);
  programs.stored.set_executable_bytes(6);
  programs.stored.set_name("machines/m/programs/100");
  EXPECT_THAT(Put("x").output, HasSubstr(", object 5 B\n"));
  programs.stored.set_name("machines/m/programs/101");
  EXPECT_THAT(Put("x").output, HasSubstr(", executable 6 B\n"));
}

// 3 MiB are one message; a byte more is uploaded, 512 KiB at a time.
TEST_F(RemoteVerbs, ALargeProgramIsUploadedInParts) {
  constexpr std::size_t kMessage = std::size_t{3} << 20;
  EXPECT_EQ(Put(std::string(kMessage, ';')).exit_code, 0);
  EXPECT_EQ(programs.put.program().content().size(), kMessage);
  EXPECT_TRUE(programs.chunks.empty());
  const std::string large = std::string(kMessage, ';') + "\n";
  EXPECT_EQ(Put(large, {.etag = "7", .check_only = true, .force = true}).exit_code, 0);
  ASSERT_EQ(programs.chunks.size(), 7U);
  EXPECT_EQ(programs.chunks.front().size(), std::size_t{512} << 10);
  EXPECT_EQ(programs.chunks.back(), "\n");
  EXPECT_EQ(programs.header.name(), "machines/m/programs/12");
  EXPECT_EQ(programs.header.file_name(), "12.S");
  EXPECT_EQ(programs.header.etag(), "7");
  EXPECT_EQ(programs.header.size(), static_cast<std::int64_t>(large.size()));
  EXPECT_EQ(programs.header.sha256(), bridge::Sha256Hex(large));
  EXPECT_TRUE(programs.header.validate_only());
  EXPECT_TRUE(programs.header.force());
}

TEST_F(RemoteVerbs, AProgramComesInTheFormThatIsAskedFor) {
  const auto get = [&](const std::string& form, const std::string& output) {
    return Hear([&] { return GetProgram(server.remote(), "m", 12, form, output); });
  };
  EXPECT_EQ(get("", "").output, "SPEED 5\nSTOP\n");
  EXPECT_EQ(programs.download.name(), "machines/m/programs/12");
  EXPECT_EQ(programs.download.form(), v1::PROGRAM_FORM_SOURCE);
  EXPECT_EQ(get("", "-").output, "SPEED 5\nSTOP\n");
  EXPECT_EQ(get("object", "").output, "SPEED 5\nSTOP\n");  // no terminal
  EXPECT_EQ(programs.download.form(), v1::PROGRAM_FORM_OBJECT);
  get("executable", "");
  EXPECT_EQ(programs.download.form(), v1::PROGRAM_FORM_EXECUTABLE);
  get("listing", "");
  EXPECT_EQ(programs.download.form(), v1::PROGRAM_FORM_LISTING);
  EXPECT_EQ(get("", folder.File("a.O")).output, "");
  EXPECT_EQ(programs.download.form(), v1::PROGRAM_FORM_OBJECT);  // by the name of the file
  EXPECT_EQ(folder.Read("a.O"), "SPEED 5\nSTOP\n");
  get("source", folder.File("b.O"));
  EXPECT_EQ(programs.download.form(), v1::PROGRAM_FORM_SOURCE);
  const Told told = get("", folder.File("none/a.S"));
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, HasSubstr("CELL-E9023"));
}

TEST_F(RemoteVerbs, SpecialProgramsAreStored) {
  programs.stored.set_name("machines/m/programs/2");
  programs.stored.set_title("Z-UP");
  const auto special = [&](const std::string& words, bool as_json = false) {
    Remote remote = server.remote(as_json);
    int exit_code = -1;
    CLI::App app;
    AddSpecialVerb(app, remote, exit_code);
    return Hear([&] {
      app.parse("special " + words);
      return exit_code;
    });
  };
  Told told = special("m");
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, "machines/m/programs/2 stored: Z-UP\n");
  EXPECT_EQ(programs.special.parent(), "machines/m");
  EXPECT_EQ(programs.special.slots_size(), 0);
  EXPECT_FALSE(programs.special.replace());
  told = special("machines/m 2 90 --replace", true);
  EXPECT_THAT(told.output, AllOf(StartsWith("{"), HasSubstr("\"Z-UP\"")));
  EXPECT_EQ(programs.special.parent(), "machines/m");
  EXPECT_THAT(programs.special.slots(), ElementsAre(2, 90));
  EXPECT_TRUE(programs.special.replace());
  programs.refusal = {grpc::StatusCode::ALREADY_EXISTS, "2 is there"};
  told = special("m");
  EXPECT_NE(told.exit_code, 0);
  EXPECT_THAT(told.errors, HasSubstr("2 is there"));
}

TEST_F(RemoteVerbs, StaleExecutablesHaveTheirReasons) {
  Told told = Hear([&] { return StaleExecutables(server.remote(), "m"); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, "every executable is what a new link would give\n");
  EXPECT_EQ(programs.parent, "machines/m");
  v1::StaleExecutable& stale = *programs.stale.add_executables();
  stale.set_name("machines/m/programs/112");
  stale.add_parts()->set_program("machines/m/programs/44");
  stale.mutable_parts(0)->set_text("was changed");
  told = Hear([&] { return StaleExecutables(server.remote(), "m"); });
  EXPECT_THAT(told.output, MatchesRegex("EXECUTABLE +BECAUSE OF +WHY *\n112 +44 +was changed *\n"));
  told = Hear([&] { return StaleExecutables(server.remote(true), "m"); });
  EXPECT_THAT(told.output, AllOf(StartsWith("{"), HasSubstr("programs/112\"")));
}

TEST_F(RemoteVerbs, ProjectsAreReadToTheLastPage) {
  Told told = Hear([&] { return Projects(server.remote()); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_THAT(projects.tokens, ElementsAre("", "more"));
  EXPECT_THAT(told.output, MatchesRegex("PROJECT +TITLE +PROGRAMS +SCHEDULES +PROCESSES *\n"
                                        "p1 +title +2 +1 +3 *\np2 +title +2 +1 +3 *\n"));
  projects.tokens.clear();
  told = Hear([&] { return Projects(server.remote(true)); });
  EXPECT_THAT(told.output, AllOf(StartsWith("{"), HasSubstr("\"projects/p2\"")));
  EXPECT_EQ(told.output.find("PROJECT "), std::string::npos);
}

TEST_F(RemoteVerbs, AProjectIsShownWithWhatIsInIt) {
  projects.project.set_name("projects/p");
  projects.project.set_title("title");
  const auto get = [&] { return Hear([&] { return GetProject(server.remote(), "p"); }); };
  EXPECT_EQ(get().output, "projects/p  title\n");  // no empty tables
  EXPECT_EQ(projects.asked, "projects/p");
  projects.project.set_notes("of steel");
  v1::ProjectProgram& program = *projects.project.add_programs();
  program.set_slot(12);
  program.set_title("main");
  program.set_units(v1::UNITS_INCH);
  program.mutable_source()->set_file_name("12.SI");
  program.mutable_source()->set_content("SPEED 5\n");
  v1::ProjectLaserSchedule& schedule = *projects.project.add_laser_schedules();
  schedule.set_number(11);
  schedule.set_title("fine");
  schedule.set_power_percent(12.5);
  v1::ProjectProcess& process = *projects.project.add_processes();
  process.set_kind(1);
  process.set_process(5);
  process.add_values(8);
  process.add_values(0.5);
  process.set_note("thin");
  EXPECT_THAT(get().output,
              MatchesRegex("projects/p  title\nof steel\n\n"
                           "SLOT +TITLE +FILE +UNITS +SIZE *\n12 +main +12.SI +inch +8 B *\n\n"
                           "SCHEDULE +TITLE +MODE +POWER % *\n11 +fine +CW +12.5 *\n\n"
                           "WORKDEF +VALUES +NOTE *\n1,5 +8, 0.5 +thin *\n"));
  const Told told = Hear([&] { return GetProject(server.remote(true), "projects/p"); });
  EXPECT_EQ(projects.asked, "projects/p");
  EXPECT_THAT(told.output, StartsWith("{"));
}

TEST_F(RemoteVerbs, ATransferSaysWhatItStored) {
  Told told = Hear([&] { return TransferProject(server.remote(), "p", "m", true, false); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(projects.transfer.name(), "projects/p");
  EXPECT_EQ(projects.transfer.machine(), "machines/m");
  EXPECT_TRUE(projects.transfer.insert_missing_definitions());
  EXPECT_FALSE(projects.transfer.validate_only());
  EXPECT_EQ(told.output,
            "and 2 more findings\nmachines/m/programs/12 replaced: twelve, object 33 B, was 30 B\n"
            "machines/m/laserSchedules/3 new: PULSE 40 %\nall of it is stored\n");
  told = Hear([&] { return TransferProject(server.remote(), "p", "m", false, true); });
  EXPECT_FALSE(projects.transfer.insert_missing_definitions());
  EXPECT_TRUE(projects.transfer.validate_only());
  EXPECT_THAT(told.output, EndsWith("\nnothing was stored: --check-only\n"));
  told = Hear([&] { return TransferProject(server.remote(true), "p", "m", false, true); });
  EXPECT_THAT(told.output, StartsWith("{"));
}

TEST_F(RemoteVerbs, AProjectGoesOutAndInAsOneFile) {
  const std::string file = folder.File("door.zip");
  Told told = Hear([&] { return ExportProject(server.remote(), "door", file); });
  EXPECT_EQ(told.output, "projects/door is in " + file + "\n");
  EXPECT_EQ(projects.asked, "projects/door");
  EXPECT_EQ(*bridge::ReadFile(file, 100), "PKbytes");
  EXPECT_EQ(Hear([&] { return ExportProject(server.remote(), "door", "-"); }).output, "PKbytes");
  told = Hear([&] { return ImportProject(server.remote(), "door-2", file); });
  EXPECT_EQ(told.output, "projects/door-2 made\n");
  EXPECT_EQ(projects.archive, "PKbytes");
  EXPECT_NE(
      Hear([&] { return ImportProject(server.remote(), "d", folder.File("none")); }).exit_code, 0);
}

TEST_F(RemoteVerbs, AProjectIsMadeOfWhatAMachineHolds) {
  const Told told = Hear([&] { return TakeProject(server.remote(), "door", "m", {12, 44}, true); });
  EXPECT_EQ(told.output, "projects/door made of what m holds\n");
  EXPECT_EQ(projects.taken.machine(), "machines/m");
  EXPECT_THAT(projects.taken.slots(), testing::ElementsAre(12, 44));
  EXPECT_EQ(projects.taken.units(), v1::UNITS_INCH);
  Hear([&] { return TakeProject(server.remote(), "door", "m", {}, false); });
  EXPECT_EQ(projects.taken.units(), v1::UNITS_UNSPECIFIED);
}

TEST_F(RemoteVerbs, WhatIsDeletedIsNamed) {
  EXPECT_EQ(Hear([&] { return DeleteProgram(server.remote(), "m", 112); }).exit_code, 0);
  EXPECT_EQ(programs.deleted, "machines/m/programs/112");
  EXPECT_EQ(Hear([&] { return DeleteProject(server.remote(), "p"); }).exit_code, 0);
  EXPECT_EQ(projects.asked, "projects/p");
}

TEST_F(RemoteVerbs, ARefusalIsToldByEach) {
  programs.refusal = projects.refusal = {grpc::StatusCode::NOT_FOUND, "there is none"};
  const Remote remote = server.remote();
  const std::string file = folder.Put("12.S", "SPEED 5\n");
  for (const auto& verb : std::vector<std::function<int()>>{
           [&] { return Programs(remote, "m"); },
           [&] { return PutProgram(remote, "m", 12, file, {}); },
           [&] { return GetProgram(remote, "m", 12, "", folder.File("out")); },
           [&] { return DeleteProgram(remote, "m", 12); },
           [&] { return StaleExecutables(remote, "m"); }, [&] { return Projects(remote); },
           [&] { return GetProject(remote, "p"); }, [&] { return DeleteProject(remote, "p"); },
           [&] { return TransferProject(remote, "p", "m", false, false); },
           [&] { return TakeProject(remote, "p", "m", {}, false); },
           [&] { return ExportProject(remote, "p", folder.File("out")); },
           [&] { return ImportProject(remote, "p", file); }}) {
    const Told told = Hear(verb);
    EXPECT_EQ(told.exit_code, 3);
    EXPECT_EQ(told.output, "");
    EXPECT_THAT(told.errors, HasSubstr("there is none"));
  }
  EXPECT_EQ(folder.Read("out"), "");
  const Told none = Hear([&] { return PutProgram(remote, "m", 12, folder.File("no.S"), {}); });
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.errors, HasSubstr("CELL-E9022"));
}

TEST_F(RemoteVerbs, ATerminalGetsTextsOnly) {
  const auto on_terminal = [&](const std::string& form, const std::string& output) {
    termios raw{};
    ::cfmakeraw(&raw);
    int outside = -1;
    int inside = -1;
    EXPECT_EQ(::openpty(&outside, &inside, nullptr, &raw, nullptr), 0);
    std::fflush(stdout);
    const int kept = ::dup(STDOUT_FILENO);
    ::dup2(inside, STDOUT_FILENO);
    testing::internal::CaptureStderr();
    Told told;
    told.exit_code = GetProgram(server.remote(), "m", 12, form, output);
    std::fflush(stdout);
    told.errors = testing::internal::GetCapturedStderr();
    ::dup2(kept, STDOUT_FILENO);
    ::close(kept);
    ::close(inside);
    char room[4096];
    for (ssize_t size = 0; (size = ::read(outside, room, sizeof room)) > 0;)
      told.output.append(room, static_cast<std::size_t>(size));
    ::close(outside);
    return told;
  };
  for (const char* form : {"object", "executable"}) {
    const Told refused = on_terminal(form, "");
    EXPECT_EQ(refused.exit_code, 2) << form;
    EXPECT_EQ(refused.output, "") << form;
    EXPECT_THAT(refused.errors, AllOf(HasSubstr("CELL-E9026"), HasSubstr("give -o FILE")));
    EXPECT_EQ(on_terminal(form, "-").output, "SPEED 5\nSTOP\n") << form;
  }
  for (const char* form : {"", "source", "listing"}) {
    const Told shown = on_terminal(form, "");
    EXPECT_EQ(shown.exit_code, 0) << form;
    EXPECT_EQ(shown.output, "SPEED 5\nSTOP\n") << form;
  }
}

// Without a title the slot names it; what it was judged stands before.
TEST_F(RemoteVerbs, AProgramThatWasStoredIsToldWithItsVerdict) {
  programs.stored.set_name("machines/m/programs/12");
  programs.stored.set_object_bytes(33);
  EXPECT_EQ(Put("SPEED 5\n").output, "machines/m/programs/12 stored: slot 12, object 33 B\n");
  v1::Findings& findings = *programs.stored.mutable_findings();
  findings.set_verdict(v1::VERDICT_BAD);
  v1::VerdictReason& reason = *findings.add_reasons();
  reason.set_message("too deep");
  reason.set_code("RML1-E8002");
  EXPECT_EQ(Put("SPEED 5\n").output,
            "verdict: BAD\n  too deep (RML1-E8002)\n"
            "machines/m/programs/12 stored: slot 12, object 33 B\n");
}

// Without a name it is the project's, where the command was given.
TEST_F(RemoteVerbs, AnArchiveHasTheNameOfItsProject) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const Told told = Hear([&] { return ExportProject(server.remote(), "projects/door", ""); });
  const Told as_json = Hear([&] { return ExportProject(server.remote(true), "window", ""); });
  std::filesystem::current_path(before);
  EXPECT_EQ(told.output, "projects/door is in door.zip\n");
  EXPECT_EQ(folder.Read("door.zip"), "PKbytes");
  EXPECT_EQ(as_json.exit_code, 0);
  EXPECT_EQ(as_json.output, "");
  EXPECT_EQ(folder.Read("window.zip"), "PKbytes");
}

}  // namespace
}  // namespace rmlcell::cli
