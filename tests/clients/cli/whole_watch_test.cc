// A watch goes on until its job has ended; a check says how far it came, whatever it reads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>

#include "clients/cli/local.h"
#include "clients/cli/remote.h"
#include "engine/families/families.h"
#include "tests/clients/cli/fake_jobs.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;

v1::WatchJobResponse SnapshotAt(std::int64_t last, bool ended) {
  v1::WatchJobResponse message;
  v1::Job& job = *message.mutable_snapshot();
  job.set_last_sequence(last);
  if (ended) job.mutable_end_time()->set_seconds(1);
  job.mutable_outcome()->set_kind(v1::Outcome::KIND_COMPLETED);
  job.mutable_outcome()->set_verdict(v1::VERDICT_GOOD);
  return message;
}

// All of it was told, and it has ended: one alone is not the end.
TEST(WholeWatch, EndsWithTheJobAndNotBefore) {
  const CliFolder folder;
  FakeJobs jobs;
  const FakeServer server(folder, {&jobs});
  const grpc::Status away(grpc::StatusCode::UNAVAILABLE, "away");
  jobs.connections = {
      {{SnapshotAt(7, false)}, away}, {{SnapshotAt(8, true)}, away}, {{SnapshotAt(7, true)}, away}};
  EXPECT_EQ(Hear([&] { return WatchJob(server.remote(), "17", 7, true); }).exit_code, 0);
  EXPECT_EQ(jobs.watches.size(), 3U);
}

// docs/files.md, "Machine file": what may be added to it is shown where it goes.
TEST(WholeWatch, AMachineFileHasRoomForItsName) {
  for (const char* family : {"optimo", "rml1"}) {
    const Told told = Hear([&] { return ListParameters(family, "", false); });
    EXPECT_THAT(told.output, HasSubstr("\n# name = \"My machine\"   # what reports call it; "
                                       "[sources] says where figures are from\n\n[parameters]\n"));
  }
}

// Where each figure of a profile is from, as a script reads it.
TEST(WholeWatch, EachFigureHasTheSourceOfItsProfile) {
  std::size_t with_source = 0;
  for (const machine::MachineFamily* family : families::Families()) {
    for (const machine::MachineProfile& profile : family->profiles()) {
      std::map<std::string, std::string> wanted, told;
      for (const machine::ParameterValue& value : profile.values)
        if (!value.source.empty()) wanted[std::string(value.name)] = value.source;
      with_source += wanted.size();
      const Told listed = Hear([&] {
        return ListParameters(std::string(family->info().id), std::string(profile.id), true);
      });
      const nlohmann::json all = nlohmann::json::parse(listed.output);
      for (const nlohmann::json& one : all.at("parameters"))
        if (one.contains("source")) told[one.at("name")] = one.at("source");
      EXPECT_EQ(told, wanted) << profile.id;
    }
  }
  EXPECT_GT(with_source, 1U);
}

// By its own number, or by the one that it was given.
TEST(WholeWatch, ACheckSaysHowFarItCame) {
  const CliFolder folder;
  const std::string text =
      "COORD ROBOT\nMOVE (9000.,0.,0.,0.,0.)\nWAIT (IL[16])\nMOVE (9000.,0.,0.,0.,0.)\n";
  CheckOptions options;
  options.files = {folder.Put("6.S", text), folder.Put("x.S", text)};
  options.json = true;
  std::istringstream lines(Hear([&] { return Check(options); }).output);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    const std::string came = nlohmann::json::parse(line).at("motionCheck");
    EXPECT_THAT(came, HasSubstr("only up to step 3, line 3")) << count;
  }
  EXPECT_EQ(count, 2);
}

// What can be read only once is: a pipe in place of a file.
TEST(WholeWatch, ACheckReadsAStreamOnce) {
  const CliFolder folder;
  const std::string pipe = folder.File("a.rml");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::thread writer([&] { std::ofstream(pipe) << "PA;!PZ-10,10;PU0,0;PD500,0;PU;"; });
  CheckOptions options;
  options.files = {pipe};
  const Told told = Hear([&] { return Check(options); });
  writer.join();
  EXPECT_EQ(told.exit_code, 0) << told.errors;
  EXPECT_THAT(told.output, HasSubstr("\ncommands      5\n"));
}

}  // namespace
}  // namespace rmlcell::cli
