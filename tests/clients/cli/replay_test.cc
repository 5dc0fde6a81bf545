// `rmlcell replay`: where a recording comes from, and what is said of it.
#include "clients/cli/replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "clients/cli/terminal.h"
#include "clients/cli/version.h"
#include "engine/core/hex.h"
#include "engine/families/families.h"
#include "engine/machine/machine.h"
#include "proto/bridge/encoding.h"
#include "proto/bridge/machine_inputs.h"
#include "proto/bridge/sha256.h"
#include "proto/recording/recording.h"
#include "rmlcell/v1/job.grpc.pb.h"
#include "rmlcell/v1/machine.grpc.pb.h"
#include "tests/clients/cli/fake_services.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

// A mill that stands: its state at 0 s, and at 2 s.
recording::Recording StandingMill() {
  recording::Recording made;
  made.head.set_engine_version(std::string(kVersion));
  made.head.set_machine("machines/m");
  made.head.set_family("rml1");
  made.head.set_profile("srm-20");
  const machine::MachineFamily& family = *families::FindFamily("rml1");
  machine::RunObserver nobody;
  auto machine = machine::Machine::Make(family, *machine::MakeParameters(family, "srm-20", {}), {},
                                        {}, nobody);
  EXPECT_TRUE(machine);
  for (const int second : {0, 2}) {
    const SimTime time = std::chrono::seconds(second);
    while (time > (*machine)->time() && (*machine)->Advance(time) == machine::Progress::kMoreWork) {
    }
    v1::JournalEntry& entry = made.entries.emplace_back();
    entry.set_sequence(static_cast<std::int64_t>(made.entries.size()));
    entry.set_virtual_time_ns(time.count());
    const std::string state = (*machine)->Save();
    entry.mutable_mark()->set_clean(true);
    entry.mutable_mark()->set_state(state);
    for (std::size_t at = 0; at < 64; at += 2)
      entry.mutable_mark()->mutable_state_sha256()->push_back(
          static_cast<char>(std::stoi(bridge::Sha256Hex(state).substr(at, 2), nullptr, 16)));
  }
  return made;
}

// A laser whose program waits for 99 s in each of two steps. It is started at 1 s.
recording::Recording WaitingLaser() {
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  const machine::Parameters parameters = *machine::MakeParameters(family, "", {});
  machine::Translation program = family.Translate(
      {.name = "4.S", .bytes = "DELAY 99.\nDELAY 99.\n"}, parameters, {.advice = false});
  EXPECT_TRUE(program.ok);
  machine::MachineMemory memory;
  memory.programs[4] = {.name = "4.S", .object = machine::Bytes::Of(std::move(program.object))};
  recording::Recording made;
  made.head.set_engine_version(std::string(kVersion));
  made.head.set_machine("machines/l");
  made.head.set_family("optimo");
  recording::SetMemory(memory, made.head);
  machine::RunObserver nobody;
  const auto laser = machine::Machine::Make(family, parameters, std::move(memory), "", nobody);
  EXPECT_TRUE(laser);
  const std::string state = (*laser)->Save();
  const auto add = [&made](int second) -> v1::JournalEntry& {
    v1::JournalEntry& entry = made.entries.emplace_back();
    entry.set_sequence(static_cast<std::int64_t>(made.entries.size()));
    entry.set_virtual_time_ns(std::int64_t{1'000'000'000} * second);
    return entry;
  };
  v1::MachineMark& mark = *add(0).mutable_mark();
  mark.set_clean(true);
  mark.set_state(state);
  mark.set_state_sha256(*BytesOfHex(bridge::Sha256Hex(state)));
  *add(1).mutable_applied()->mutable_input() = bridge::AppliedOf(machine::StartRun{.program = 4});
  // How it stands is known as far as there are entries.
  *add(190).mutable_applied()->mutable_input() = bridge::AppliedOf(machine::StopRun{});
  return made;
}

struct FakeExport final : v1::MachineService::Service {
  grpc::Status ExportJournal(grpc::ServerContext*, const v1::ExportJournalRequest* request,
                             grpc::ServerWriter<v1::ExportJournalResponse>* writer) override {
    asked = *request;
    v1::ExportJournalResponse part;
    for (std::size_t at = 0; at < file.size(); at += 100) {
      part.set_chunk(file.substr(at, 100));
      writer->Write(part);
    }
    return refusal;
  }
  std::string file{};
  v1::ExportJournalRequest asked{};
  grpc::Status refusal{};
};

struct FakeJobOf final : v1::JobService::Service {
  grpc::Status GetJob(grpc::ServerContext*, const v1::GetJobRequest* request,
                      v1::Job* response) override {
    response->set_name(request->name());
    response->set_machine("machines/m");
    return refusal;
  }
  grpc::Status refusal{};
};

class ReplayTest : public testing::Test {
 protected:
  ReplayTest() { export_.file = FileOf(StandingMill()); }
  Told Play(const std::string& what, std::optional<std::int64_t> from = {},
            std::optional<std::int64_t> to = {}, const std::string& output = {}) {
    return Hear([&] { return Replay(server_.remote(), {what, from, to, output}); });
  }

  CliFolder folder_;
  FakeExport export_;
  FakeJobOf job_;
  FakeServer server_{folder_, {&export_, &job_}};
  const std::string same_ =
      "machines/m: played again, 0 inputs, 0 events and 2 marks are the same, until 2.000 s of the "
      "machine\n";
};

TEST_F(ReplayTest, AFileIsPlayedAgain) {
  Told told = Play(folder_.Put("a.rmlj", export_.file));
  EXPECT_EQ(told.exit_code, kGood) << told.errors;
  EXPECT_EQ(told.output, same_);
  EXPECT_EQ(told.errors, "");
  recording::Recording of_job = StandingMill();
  of_job.head.set_job("jobs/17");
  told = Play(folder_.Put("a.rmlj", FileOf(of_job)));
  EXPECT_THAT(told.output, StartsWith("machines/m, jobs/17: played again, "));
}

// It may come out otherwise: then that is why.
TEST_F(ReplayTest, AnotherVersionIsNamed) {
  recording::Recording other = StandingMill();
  other.head.set_engine_version("0.0.1");
  const Told told = Play(folder_.Put("a.rmlj", FileOf(other)));
  EXPECT_EQ(told.exit_code, kGood);
  EXPECT_EQ(told.errors, "rmlcell: it was recorded by version 0.0.1, and this is " +
                             std::string(kVersion) + "\n");
}

TEST_F(ReplayTest, TheFirstDifferenceIsTold) {
  recording::Recording other = StandingMill();
  other.entries[1].mutable_mark()->set_state_sha256(std::string(32, '\0'));
  const Told told = Play(folder_.Put("a.rmlj", FileOf(other)));
  EXPECT_EQ(told.exit_code, kProgramErrors);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, HasSubstr("entry 2 at 2000000000 ns, mark.state_sha256\n  recorded " +
                                     std::string(64, '0') + "\n  played   "));
}

TEST_F(ReplayTest, FromAMarkAndUpToATime) {
  const std::string file = folder_.Put("a.rmlj", export_.file);
  Told told = Play(file, 2'000'000'000);
  EXPECT_EQ(told.exit_code, kGood) << told.errors;
  EXPECT_THAT(told.output, HasSubstr(" and 1 marks are the same, until 2.000 s"));
  told = Play(file, {}, 1'500'000'000);
  EXPECT_EQ(told.exit_code, kGood) << told.errors;
  EXPECT_THAT(told.output, StartsWith("at 1.500 s of the machine: "));
  EXPECT_THAT(told.output, HasSubstr("  X 0.000 mm  Y 0.000 mm"));
  EXPECT_THAT(told.output, HasSubstr(" and 1 marks are the same, until 1.500 s"));
}

// In which step it is, as long as a run is open.
TEST_F(ReplayTest, WhereAnOpenRunStandsIsTold) {
  const std::string file = folder_.Put("a.rmlj", FileOf(WaitingLaser()));
  const auto told = [&](std::int64_t ns) {
    const std::string output = Play(file, {}, ns).output;
    return output.substr(0, output.find('\n'));
  };
  EXPECT_THAT(told(500'000'000), StartsWith("at 0.500 s of the machine: "));
  EXPECT_THAT(told(500'000'000), Not(HasSubstr(" at ")));
  // It is open, and has come to no step yet.
  EXPECT_THAT(told(1'000'000'000), StartsWith("at 1.000 s of the machine: "));
  EXPECT_THAT(told(1'000'000'000), Not(HasSubstr(" at ")));
  EXPECT_THAT(told(51'000'000'000), StartsWith("at 51.000 s of the machine: RUNNING at 4/1  "));
  EXPECT_THAT(told(151'000'000'000),
              StartsWith("at 2 min 31.000 s of the machine: RUNNING at 4/2  "));
}

// By its name, or that of a job, as long as there is no file of that name.
TEST_F(ReplayTest, AServerHasRecordings) {
  for (const char* name : {"m", "machines/m"}) {
    EXPECT_EQ(Play(name).output, same_) << name;
    EXPECT_EQ(export_.asked.ShortDebugString(), "machine: \"machines/m\"");
  }
  for (const char* name : {"17", "jobs/17"}) {
    EXPECT_EQ(Play(name).output, same_) << name;
    EXPECT_EQ(export_.asked.ShortDebugString(), "machine: \"machines/m\" job: \"jobs/17\"");
  }
  const Told told = Play("m", {}, {}, folder_.File("kept.rmlj"));
  EXPECT_EQ(told.exit_code, kGood);
  EXPECT_EQ(folder_.Read("kept.rmlj"), export_.file);
}

TEST_F(ReplayTest, WhatThereIsNotIsRefused) {
  for (const char* name : {"none.rmlj", "folder/none", "./m"}) {
    const Told told = Play(name);
    EXPECT_EQ(told.exit_code, kUsage) << name;
    EXPECT_THAT(told.errors, HasSubstr(std::string(name) + ": no such file"));
  }
  EXPECT_EQ(Play(folder_.Put("a.rmlj", "no recording")).exit_code, kUsage);
  EXPECT_EQ(Play("m", {}, {}, folder_.File("none/a")).exit_code, kUsage);
  export_.refusal = {grpc::StatusCode::NOT_FOUND, "none"};
  Told told = Play("m");
  EXPECT_EQ(told.exit_code, kConnection);
  EXPECT_EQ(told.errors, "rmlcell: none\n");
  job_.refusal = {grpc::StatusCode::NOT_FOUND, "no job"};
  told = Play("17");
  EXPECT_EQ(told.exit_code, kConnection);
  EXPECT_EQ(told.errors, "rmlcell: no job\n");
}

// A folder is there, and no recording.
TEST_F(ReplayTest, AFolderIsRefused) {
  const Told told = Play(folder_.path());
  EXPECT_EQ(told.exit_code, kUsage);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, StartsWith("rmlcell: CELL-E9022: "));
  EXPECT_THAT(told.errors, HasSubstr(folder_.path() + " is a directory"));
}

// A file that is not there is another error than a recording that comes out otherwise.
TEST_F(ReplayTest, EachRefusalHasItsCode) {
  EXPECT_THAT(Play("none.rmlj").errors, StartsWith("rmlcell: CELL-E9022: "));
  recording::Recording other = StandingMill();
  other.entries[1].mutable_mark()->set_state_sha256(std::string(32, '\0'));
  EXPECT_THAT(Play(folder_.Put("a.rmlj", FileOf(other))).errors,
              StartsWith("rmlcell: CELL-E9436: "));
}

}  // namespace
}  // namespace rmlcell::cli
