// Calls for a tool, a picture, a comparison: what is made is the answer, and what cannot be made is
// what the call ends with.
#include <atomic>

#include "proto/bridge/framing.h"
#include "server/base/names.h"
#include "tests/server/services/unary_calls_bed.h"

namespace rmlcell::server {
namespace {

class ToolsInCalls : public UnaryCalls {
 protected:
  template <class Stub, class Request, class Response>
  void ExpectCode(const std::unique_ptr<Stub>& stub,
                  grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                  const std::string& request, ErrorCode code) {
    SCOPED_TRACE(Request::descriptor()->name());
    Call(stub, method, request);
    EXPECT_FALSE(status.ok());
    EXPECT_THAT(status.error_message(), testing::HasSubstr(CodeText(code)));
  }
  void Put(int slot, const std::string& source) {
    v1::PutProgramRequest request;
    request.set_name(Name(slot));
    request.mutable_program()->set_file_name("a.S");
    request.mutable_program()->set_content(source);
    grpc::ClientContext context;
    v1::Program stored;
    const grpc::Status put = programs->PutProgram(&context, request, &stored);
    ASSERT_TRUE(put.ok()) << put.error_message();
  }
  static std::string Name(int slot) { return "machines/optimo-1/programs/" + std::to_string(slot); }
};

constexpr const char* kTwoStraightMoves =
    "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (1000.,900.,-500.,0.,0.)\n"
    "MOVE (1010.,900.,-500.,0.,0.)\n";

TEST_F(ToolsInCalls, AnEmptyTextIsRefused) {
  using Stub = v1::ProgramService::Stub;
  const ErrorCode empty = ErrorCode::kCellEmptyProgram;
  const std::string program = "program { file_name: 'a.S' }";
  ExpectCode(programs, &Stub::CompileProgram, program, empty);
  ExpectCode(programs, &Stub::FormatProgram, program, empty);
  ExpectCode(programs, &Stub::FixProgram, program, empty);
  ExpectCode(programs, &Stub::ConvertProgram, program, empty);
  ExpectCode(programs, &Stub::CompensateProgram, program, empty);
  ExpectCode(programs, &Stub::TransformProgram, program, empty);
  ExpectCode(programs, &Stub::ShiftProgram, program, empty);
  ExpectCode(programs, &Stub::MakeListing, program, empty);
  ExpectCode(programs, &Stub::DecompileProgram, "", empty);
  ExpectCode(programs, &Stub::LinkProgram, "slot: 32 programs { slot: 32 " + program + " }", empty);
  ExpectCode(programs, &Stub::DiffPrograms,
             "before { text { file_name: 'a.S' } } after { text { file_name: 'b.S' } }", empty);
  const std::string text = "text { " + program + " }";
  ExpectCode(programs, &Stub::Hover, text, empty);
  ExpectCode(programs, &Stub::Complete, text, empty);
  ExpectCode(programs, &Stub::FindDefinition, text, empty);
  ExpectCode(programs, &Stub::FindReferences, text, empty);
  ExpectCode(programs, &Stub::Rename, text, empty);
  ExpectCode(programs, &Stub::Outline, text, empty);
}

TEST_F(ToolsInCalls, WhatIsNotThereIsRefused) {
  using Programs = v1::ProgramService::Stub;
  ExpectCode(programs, &Programs::GetLanguage, "family: 'lathe'", ErrorCode::kCellUnknownFamily);
  ExpectCode(programs, &Programs::GetProgramPicture, "name: 'x'", ErrorCode::kCellInvalidArgument);
  ExpectCode(programs, &Programs::StoreSpecialPrograms, "parent: 'machines/none'",
             ErrorCode::kCellUnknownMachine);
  ExpectCode(projects, &v1::ProjectService::Stub::TransferProjectFromMachine,
             "machine: 'machines/none' project_id: 'lid'", ErrorCode::kCellUnknownMachine);
  using Jobs = v1::JobService::Stub;
  const ErrorCode no_name = ErrorCode::kCellInvalidArgument;
  ExpectCode(jobs, &Jobs::GetJobSeries, "name: 'x'", no_name);
  ExpectCode(jobs, &Jobs::CompareJobs, "before: 'x' after: 'y'", no_name);
  ExpectCode(jobs, &Jobs::GetStepMap, "name: 'x'", no_name);
  ExpectCode(jobs, &Jobs::CancelJobs, "jobs { names { names: 'x' } }", no_name);
  ExpectCode(jobs, &Jobs::HoldJobs, "jobs { names { names: 'x' } }", no_name);
}

TEST_F(ToolsInCalls, WhatIsMadeIsTheAnswer) {
  using Stub = v1::ProgramService::Stub;
  const auto special =
      Call(programs, &Stub::StoreSpecialPrograms, "parent: 'machines/optimo-1' slots: 90");
  ASSERT_EQ(special.programs_size(), 1) << status.error_message();
  EXPECT_EQ(special.programs(0).title(), "TCP");
  EXPECT_EQ(special.programs(0).name(), Name(90));
  Put(45, kTwoStraightMoves);
  EXPECT_EQ(Call(programs, &Stub::DecompileProgram, "name: '" + Name(45) + "'").content(),
            kTwoStraightMoves);
  const auto picture = Call(programs, &Stub::GetProgramPicture, "name: '" + Name(45) + "'");
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_THAT(picture.content(), testing::HasSubstr("<svg"));
  EXPECT_EQ(picture.media_type(), "image/svg+xml");
}

// program.proto StreamProgramToolpath: the header, then its blocks, one in each message.
TEST_F(ToolsInCalls, ThePathOfAProgramGoesOut) {
  Put(45, kTwoStraightMoves);
  const auto streamed = [&](const std::string& request) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    const auto reader = programs->StreamProgramToolpath(
        &context, FromText<v1::StreamProgramToolpathRequest>(request));
    std::vector<v1::StreamProgramToolpathResponse> parts;
    for (v1::StreamProgramToolpathResponse part; reader->Read(&part);) parts.push_back(part);
    status = reader->Finish();
    return parts;
  };
  const auto parts = streamed("name: '" + Name(45) + "'");
  EXPECT_TRUE(status.ok()) << status.error_message();
  ASSERT_GE(parts.size(), 2U);
  ASSERT_TRUE(parts[0].has_header());
  EXPECT_TRUE(parts[0].header().complete());
  EXPECT_GT(parts[0].header().points(), 0);
  std::string frames;
  for (std::size_t i = 1; i < parts.size(); ++i) {
    EXPECT_TRUE(parts[i].has_block());
    EXPECT_FALSE(parts[i].block().empty());
    bridge::AddFrame(parts[i].block(), frames);
  }
  EXPECT_EQ(parts[0].header().bytes(), static_cast<std::int64_t>(frames.size()));
  EXPECT_TRUE(streamed("name: '" + Name(46) + "'").empty());
  EXPECT_FALSE(status.ok());
  EXPECT_TRUE(streamed("name: '" + Name(45) + "' level: -1").empty());
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
}

// A path of more points than a block has comes in several, none of which is left out.
TEST_F(ToolsInCalls, EachBlockOfALongPathIsAMessage) {
  std::string arcs;
  for (int i = 0; i < 40; ++i) {
    arcs +=
        "MOVE (1200.,900.,-500.,0.,0.)/VIA (1100.,1000.,-500.,0.,0.)\n"
        "MOVE (1000.,900.,-500.,0.,0.)/VIA (1100.,1000.,-500.,0.,0.)\n";
  }
  Put(45, "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (1000.,900.,-500.,0.,0.)\nPATH CIR\n" + arcs);
  v1::StreamProgramToolpathRequest request;
  request.set_name(Name(45));
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kPatience);
  const auto reader = programs->StreamProgramToolpath(&context, request);
  v1::StreamProgramToolpathResponse part;
  ASSERT_TRUE(reader->Read(&part));
  const v1::ToolpathHeader header = part.header();
  EXPECT_GT(header.points(), 4096);  // of a block, at most
  std::string frames;
  int blocks = 0;
  for (; reader->Read(&part); ++blocks) bridge::AddFrame(part.block(), frames);
  EXPECT_TRUE(reader->Finish().ok());
  EXPECT_GE(blocks, 2);
  EXPECT_EQ(header.bytes(), static_cast<std::int64_t>(frames.size()));
}

// LIVE-3.20: who stores something in the memory of a machine has it told before the answer.
TEST_F(ToolsInCalls, SpecialProgramsAreToldWhenTheyAreStored) {
  std::atomic<int> told = 0;
  program_book_.OnStored([&told] { ++told; });
  const auto store = [&](const std::string& machine) {
    Call(programs, &v1::ProgramService::Stub::StoreSpecialPrograms,
         "parent: 'machines/" + machine + "' slots: 90");
  };
  store("none");
  EXPECT_FALSE(status.ok());
  EXPECT_EQ(told, 0);
  store("optimo-1");
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(told, 1);
}

// What the project becomes is told without the texts, and by whom.
TEST_F(ToolsInCalls, AProjectIsMadeOfAMachine) {
  Put(45, "SPEED 20\n");
  const auto made = InSpiteOfAll(projects, &v1::ProjectService::Stub::TransferProjectFromMachine,
                                 "machine: 'machines/optimo-1' project_id: 'lid'");
  EXPECT_EQ(made.name(), "projects/lid");
  EXPECT_EQ(made.title(), "Laser");
  ASSERT_EQ(made.programs_size(), 1);
  EXPECT_EQ(made.programs(0).slot(), 45);
  EXPECT_EQ(made.programs(0).source().content(), "");
  const v1::Project kept =
      Call(projects, &v1::ProjectService::Stub::GetProject, "name: 'projects/lid'");
  ASSERT_EQ(kept.programs_size(), 1);
  EXPECT_EQ(kept.programs(0).source().content(), "SPEED 20\n");
  const auto events = Must(store_.AllEvents(0, 100));
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events.back().resource, "projects/lid");
  EXPECT_EQ(events.back().caller, "local");
}

TEST_F(ToolsInCalls, WhatJobsHaveMadeIsTheAnswer) {
  using Stub = v1::JobService::Stub;
  const std::int64_t one = EndedJob(
      {{.name = "series",
        .bytes =
            FromText<v1::SeriesTable>("part_ns: 10 end_ns: 20 parts: 0 parts: 1 columns { signal: "
                                      "'speed' unit: 'mm/s' low: 1 low: 2 high: 3 high: 5 last: 2 "
                                      "last: 4 }")
                .SerializeAsString()},
       {.name = "steps",
        .bytes = FromText<v1::GetStepMapResponse>("programs { program: 12 lines: 3 lines: 7 }")
                     .SerializeAsString()},
       {.name = "report",
        .bytes =
            FromText<v1::RunReport>("family: 'optimo' total { pierces: 2 }").SerializeAsString()}});
  const std::int64_t other = EndedJob(
      {{.name = "report",
        .bytes =
            FromText<v1::RunReport>("family: 'optimo' total { pierces: 3 }").SerializeAsString()}});
  const std::string name = "name: '" + JobName(one) + "' ";
  const auto series = InSpiteOfAll(jobs, &Stub::GetJobSeries, name + "signals: 'speed' buckets: 1");
  ASSERT_EQ(series.series_size(), 1);
  ASSERT_EQ(series.series(0).high_size(), 1);
  EXPECT_EQ(series.series(0).low(0), 1.0);
  EXPECT_EQ(series.series(0).high(0), 5.0);
  const auto map = InSpiteOfAll(jobs, &Stub::GetStepMap, name);
  ASSERT_EQ(map.programs_size(), 1);
  EXPECT_THAT(map.programs(0).lines(), testing::ElementsAre(3, 7));
  const auto compared = Call(jobs, &Stub::CompareJobs,
                             "before: '" + JobName(one) + "' after: '" + JobName(other) + "'");
  EXPECT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(compared.figures_size(), 1);
  EXPECT_EQ(compared.figures(0).before(), 2.0);
  EXPECT_EQ(compared.figures(0).after(), 3.0);
}

// Of many jobs as of one: what the store says.
TEST_F(ToolsInCalls, ActsOnManyHandOnWhatTheStoreSays) {
  using Stub = v1::JobService::Stub;
  for (int i = 0; i < 2; ++i)
    Must(store_.SubmitAndWait({.machine = "optimo-1", .family = "optimo", .kind = "CHECK"}));
  EXPECT_EQ(InSpiteOfAll(jobs, &Stub::HoldJobs, "jobs { all: true }").jobs(), 2);
  EXPECT_EQ(InSpiteOfAll(jobs, &Stub::HoldJobs, "jobs { all: true } release: true").jobs(), 2);
  EXPECT_EQ(InSpiteOfAll(jobs, &Stub::CancelJobs, "jobs { all: true }").jobs(), 2);
}

}  // namespace
}  // namespace rmlcell::server
