// What is made of a run when it is over, by a process that plays its recording (live.md 3.41).
#include "server/runs/run_products.h"

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "server/base/config.h"
#include "server/base/executor.h"
#include "server/base/log.h"
#include "server/base/names.h"
#include "server/events/event_feed.h"
#include "server/jobs/job_book.h"
#include "server/machines/hosts.h"
#include "server/machines/recordings.h"
#include "server/records/job_messages.h"
#include "tests/server/server_bed.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::server {
namespace {

// A shell script in place of the worker: it notes its recording, and answers to "bad" with 1.
class RunProductsTest : public testing::Test {
 protected:
  RunProductsTest() {
    SetReport(v1::Outcome::KIND_COMPLETED, v1::VERDICT_GOOD);
    SetScript("cp $2 $4/picture.svg; echo path > $4/toolpath");
  }
  ~RunProductsTest() override { hosts_.CloseAll(); }
  void SetScript(const std::string& what) {
    std::ofstream(program_) << "#!/bin/sh\ncat $2 >> " << folder_.File("played")
                            << "\ngrep -q bad $2 && exit 1\ncp " << folder_.File("report")
                            << " $4/report\n"
                            << what << "\n";
    ::chmod(program_.c_str(), 0700);
  }
  void SetReport(v1::Outcome::Kind kind, v1::Verdict verdict) {
    v1::RunReport report;
    report.mutable_outcome()->set_kind(kind);
    report.mutable_outcome()->set_verdict(verdict);
    report.mutable_outcome()->add_reasons()->set_code("CELL-E1");
    std::ofstream(folder_.File("report"), std::ios::binary) << report.SerializeAsString();
  }
  // A run that is over, with this recording.
  std::int64_t Run(const std::string& recording) {
    v1::SubmitJobRequest request;
    v1::Job& job = *request.mutable_job();
    job.set_kind(v1::JOB_KIND_RUN);
    job.set_machine("machines/mill-1");
    job.mutable_inline_program()->set_file_name("a.rml");
    job.mutable_inline_program()->set_content("PA;PU100,0;");
    job.set_inline_slot(7);
    std::int64_t id = 0;
    book_.Submit(request, "anna", [&](const Result<v1::Job>& made) {
      if (made) id = *ParseJobName(made->name());
    });
    EXPECT_TRUE(Eventually([&] { return id != 0; }));
    const storage::Lease lease = bed_.Lease("RUN");
    EXPECT_EQ(lease.job, id);
    Must(bed_.store().Finish(lease, {.outcome = {.state = storage::JobState::kSucceeded}}));
    Must(bed_.store().AddProducts(id, {.artifacts = {{.name = std::string(kRecording),
                                                      .media_type = "application/octet-stream",
                                                      .bytes = recording}}}));
    return id;
  }
  std::unique_ptr<RunProducts> Start(std::chrono::seconds patience = std::chrono::seconds(600)) {
    return std::make_unique<RunProducts>(RunProducts::Needs{.store = bed_.store(),
                                                            .hosts = hosts_,
                                                            .program = program_,
                                                            .folder = folder_.File("runs"),
                                                            .log_level = "info",
                                                            .log_format = "text",
                                                            .patience = patience});
  }
  bool HasReport(std::int64_t job) {
    return static_cast<bool>(bed_.store().GetArtifact(job, "report"));
  }
  bool IsOver(std::int64_t job) {
    return !std::filesystem::exists(folder_.File("runs") + "/" + std::to_string(job));
  }
  // What was played, in order.
  std::string Played() {
    std::ifstream file(folder_.File("played"));
    return {std::istreambuf_iterator<char>(file), {}};
  }
  // A run that is good is made of, and nothing of those before it that were given up.
  void ExpectGivenUp(RunProducts& products, std::int64_t job, const std::string& recording) {
    products.Look("mill-1");
    ASSERT_TRUE(Eventually([&] { return Played() == recording && IsOver(job); }));
    SetReport(v1::Outcome::KIND_COMPLETED, v1::VERDICT_GOOD);
    SetScript("");
    const std::int64_t next = Run("good");
    products.Look("mill-1");
    EXPECT_TRUE(Eventually([&] { return HasReport(next); }));
    EXPECT_FALSE(HasReport(job));
    EXPECT_EQ(Played(), recording + "good");
    EXPECT_TRUE(Eventually([&] { return std::filesystem::is_empty(folder_.File("runs")); }));
  }

  ServerBed bed_;
  Config config_;
  JobBook book_{bed_.store(), config_};
  EventFeed feed_{bed_.store()};
  TestSteadyClock clock_;
  Executor executor_{2};
  Hosts hosts_{{.store = bed_.store(),
                .feed = feed_,
                .executor = executor_,
                .server = "this server",
                .join_token = "secret",
                .clock = clock_.clock()}};
  storage::TestDirectory folder_;
  const std::string program_ = folder_.File("worker");
};

TEST_F(RunProductsTest, AreMadeOfItsRecording) {
  const std::int64_t job = Run("recorded");
  std::filesystem::create_directories(folder_.File("runs") + "/left");
  const auto products = Start();
  products->Look("mill-1");
  ASSERT_TRUE(Eventually([&] { return HasReport(job); }));
  EXPECT_EQ(Must(bed_.store().ReadArtifact(job, "picture.svg")), "recorded");
  EXPECT_EQ(Must(bed_.store().ReadArtifact(job, "toolpath")), "path\n");
  EXPECT_FALSE(bed_.store().GetArtifact(job, "steps"));
  EXPECT_EQ(Must(bed_.store().GetArtifact(job, "report")).media_type, "application/x-protobuf");
  EXPECT_EQ(Must(bed_.store().GetArtifact(job, "picture.svg")).media_type, "image/svg+xml");
  const v1::Job told = ToProto(Must(bed_.store().GetJob(job)));
  EXPECT_EQ(told.outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_EQ(told.outcome().verdict(), v1::VERDICT_GOOD);
  EXPECT_EQ(told.outcome().reasons(0).code(), "CELL-E1");
  EXPECT_TRUE(Eventually([&] { return std::filesystem::is_empty(folder_.File("runs")); }));
}

TEST_F(RunProductsTest, OneThatCannotBePlayedIsGivenUp) {
  const std::int64_t job = Run("bad");
  const auto products = Start();
  ExpectGivenUp(*products, job, "bad");
}

// A part is not made by a run that did not come to its end.
TEST_F(RunProductsTest, OneThatEndsOtherwiseThanItsJobIsGivenUp) {
  SetReport(v1::Outcome::KIND_STOPPED, v1::VERDICT_BAD);
  const std::int64_t job = Run("other");
  const auto products = Start();
  ExpectGivenUp(*products, job, "other");
}

TEST_F(RunProductsTest, OneWithoutAReportIsGivenUp) {
  SetScript("rm $4/report");
  const std::int64_t job = Run("none");
  const auto products = Start();
  ExpectGivenUp(*products, job, "none");
}

// What plays it too long is killed.
TEST_F(RunProductsTest, OneThatTakesTooLongIsGivenUp) {
  SetScript("exec sleep 600");
  const std::int64_t job = Run("long");
  {
    const auto products = Start(std::chrono::seconds(1));
    // Else it would be over before it is looked at.
    std::filesystem::create_directories(folder_.File("runs") + "/" + std::to_string(job));
    products->Look("mill-1");
    ASSERT_TRUE(Eventually([&] { return IsOver(job); }));
  }
  EXPECT_FALSE(HasReport(job));
  // Nor is a dead process left that nobody asked how it ended.
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
}

// What became of each is in the log, by its own code: whoever misses a report reads there why.
TEST_F(RunProductsTest, TheLogSaysWhyThereIsNone) {
  const std::shared_ptr<spdlog::logger> before = spdlog::default_logger();
  const std::string log = folder_.File("log");
  EXPECT_TRUE(StartLog("products-that-fail", "warn", "text", log));
  const auto told = [&log] {
    std::ifstream file(log);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const auto tells = [&told](std::int64_t job, ErrorCode code) {
    return Eventually([&] {
      const std::string text = told();
      const std::size_t line = text.find("no report of " + JobName(job) + ": ");
      return line != std::string::npos && text.find(CodeText(code), line) != std::string::npos;
    });
  };
  {
    SetScript("exec sleep 600");
    const std::int64_t slow = Run("slow");
    const auto products = Start(std::chrono::seconds(1));
    products->Look("mill-1");
    EXPECT_TRUE(tells(slow, ErrorCode::kCellProcessorBudget)) << told();
  }
  {
    SetScript("");
    const std::int64_t bad = Run("bad");
    const auto products = Start();
    products->Look("mill-1");
    EXPECT_TRUE(tells(bad, ErrorCode::kCellReplayDiffers)) << told();
  }
  spdlog::drop("products-that-fail");
  spdlog::set_default_logger(before);
}

// A host has the recordings of its newest runs alone.
TEST_F(RunProductsTest, FourRunsAreLookedAt) {
  std::vector<std::int64_t> jobs;
  for (int run = 0; run < 5; ++run) jobs.push_back(Run(std::to_string(run)));
  const auto products = Start();
  products->Look("mill-1");
  for (int run = 4; run >= 1; --run)
    EXPECT_TRUE(Eventually([&] { return HasReport(jobs[static_cast<std::size_t>(run)]); })) << run;
  const std::int64_t next = Run("5");
  products->Look("mill-1");
  EXPECT_TRUE(Eventually([&] { return HasReport(next); }));
  EXPECT_FALSE(HasReport(jobs[0]));
  std::string played = Played();
  std::ranges::sort(played);
  EXPECT_EQ(played, "12345");
}

}  // namespace
}  // namespace rmlcell::server
