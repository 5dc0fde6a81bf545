// Runs of which nothing can be made yet, and what is told when something was (live.md 3.41).
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include "proto/recording/recording.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "server/machines/hosts.h"
#include "server/machines/recordings.h"
#include "server/records/job_messages.h"
#include "server/runs/run_products.h"
#include "tests/server/fake_link.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using storage::JobState;

// Notes whose jobs are asked for: one machine is looked at behind the other. Fails where it is told
// so.
class NotingStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  std::atomic<bool> fails = false;
  std::atomic<bool> lists_fail = false;   // of jobs of the mill
  std::atomic<bool> lists_throw = false;  // likewise
  std::atomic<int> looks_at_optimo = 0;

  Result<std::vector<storage::JobRecord>> ListJobs(const storage::JobQuery& query) override {
    if (query.machine == "optimo-1") ++looks_at_optimo;
    if (lists_throw && query.machine == "mill-1") throw std::runtime_error("no memory");
    if (lists_fail && query.machine == "mill-1")
      return Error{ErrorCode::kCellStoreFailed, "the line broke", {}};
    return store_.ListJobs(query);
  }
  Result<storage::JobRecord> AddProducts(std::int64_t job,
                                         const storage::LateProducts& products) override {
    if (fails) return Error{ErrorCode::kCellStoreFailed, "the disk is full", {}};
    return store_.AddProducts(job, products);
  }
};

class ProductsOfLater : public testing::Test {
 protected:
  ProductsOfLater() {
    v1::RunReport report;
    report.mutable_outcome()->set_kind(v1::Outcome::KIND_COMPLETED);
    report.mutable_outcome()->set_verdict(v1::VERDICT_DOUBTFUL);
    std::ofstream(folder_.File("report"), std::ios::binary) << report.SerializeAsString();
    std::ofstream(program_) << "#!/bin/sh\necho \"$@\" > " << folder_.File("said") << "\ncp "
                            << folder_.File("report") << " $4/report\necho s > $4/steps\n";
    ::chmod(program_.c_str(), 0700);
  }
  ~ProductsOfLater() override {
    products_.reset();
    hosts_.CloseAll();
    executor_.reset();  // what was posted is done
  }
  // A run that is over; of one that never began there is no recording.
  std::int64_t Over(bool began = true, JobState how = JobState::kSucceeded) {
    v1::Job asked;
    asked.set_kind(v1::JOB_KIND_RUN);
    const std::int64_t job =
        Must(bed_.store().SubmitAndWait({.machine = "mill-1",
                                         .kind = "RUN",
                                         .specification = asked.SerializeAsString(),
                                         .attempts_max = 1}))
            .job.id;
    if (began) {
      Must(bed_.store().Finish(bed_.Lease("RUN"), {.outcome = {.state = how}}));
    } else {
      Must(bed_.store().RequestCancel(job, {}));
    }
    return job;
  }
  void Record(std::int64_t job) {
    Must(bed_.store().AddProducts(job, {.artifacts = {{.name = std::string(kRecording),
                                                       .media_type = "application/octet-stream",
                                                       .bytes = "recorded"}}}));
  }
  RunProducts& products() {
    if (products_ == nullptr)
      products_ =
          std::make_unique<RunProducts>(RunProducts::Needs{.store = store_,
                                                           .hosts = hosts_,
                                                           .program = program_,
                                                           .folder = runs_,
                                                           .log_level = "warning",
                                                           .log_format = "json",
                                                           .looked_at_again_after = again_after_});
    return *products_;
  }
  // The host of the mill.
  std::shared_ptr<FakeLink> Joined() {
    auto link = std::make_shared<FakeLink>();
    v1::HostHello hello;
    hello.set_join_token("secret");
    hello.set_machine("machines/mill-1");
    hello.set_host("hall/1");
    hello.set_protocol(1);
    EXPECT_TRUE(hosts_.Join(link, hello));
    return link;
  }
  // Answers the newest of so many questions for a recording with this.
  void Send(const FakeLink& link, std::size_t count, const std::string& bytes) {
    std::vector<v1::HostOrder> orders;
    ASSERT_TRUE(Eventually([&] {
      orders.clear();
      for (const v1::HostResponse& message : link.All()) {
        if (message.has_order()) orders.push_back(message.order());
      }
      return orders.size() >= count;
    }));
    v1::HostRequest answer;
    answer.mutable_answer()->set_number(orders.back().number());
    v1::HostRecordingPart& part = *answer.mutable_answer()->mutable_recording();
    part.set_chunk(bytes);
    part.set_total(static_cast<std::int64_t>(bytes.size()));
    hosts_.Receive(link, std::move(answer));
  }
  // Until the thread is done with it.
  void LookAtMill() {
    products().Look("mill-1");
    AwaitMill();
  }
  void AwaitMill() {
    const int before = store_.looks_at_optimo;
    products().Look("optimo-1");
    ASSERT_TRUE(Eventually([&] { return store_.looks_at_optimo > before; }));
  }
  bool HasReport(std::int64_t job) {
    return static_cast<bool>(bed_.store().GetArtifact(job, "report"));
  }

  std::chrono::milliseconds again_after_ = std::chrono::hours(1);
  ServerBed bed_;
  NotingStore store_{bed_.store()};
  EventFeed feed_{bed_.store()};
  std::unique_ptr<Executor> executor_ = std::make_unique<Executor>(2);
  Hosts hosts_{{.store = bed_.store(),
                .feed = feed_,
                .executor = *executor_,
                .server = "this server",
                .join_token = "secret"}};
  storage::TestDirectory folder_;
  const std::string program_ = folder_.File("worker");
  const std::string runs_ = folder_.File("runs");
  std::unique_ptr<RunProducts> products_;
};

// While its host is not heard of nothing is given up: it may have the recording.
TEST_F(ProductsOfLater, ARunWhoseHostIsNotHeardOfIsLookedAtAgain) {
  const std::int64_t job = Over();
  LookAtMill();
  EXPECT_FALSE(HasReport(job));
  Record(job);
  LookAtMill();
  EXPECT_TRUE(HasReport(job));
}

// A host that is silent for a moment keeps its line: nobody says when it answers again.
TEST_F(ProductsOfLater, ARunWhoseHostIsSilentIsLookedAtAgain) {
  again_after_ = std::chrono::milliseconds(1);
  const std::int64_t job = Over();
  const auto link = Joined();
  v1::HostRequest silent;
  silent.mutable_status()->set_machine("machines/mill-1");
  silent.mutable_status()->set_state(v1::MACHINE_STATE_LOST);
  hosts_.Receive(*link, std::move(silent));
  LookAtMill();
  EXPECT_FALSE(HasReport(job));
  Record(job);
  EXPECT_TRUE(Eventually([&] { return HasReport(job); }));
}

// Nor where there is no room to play it, or to keep what was made.
TEST_F(ProductsOfLater, TroubleOfADiskIsNotTheFaultOfARecording) {
  const std::int64_t job = Over();
  Record(job);
  products();
  std::ofstream(runs_) << "no folder";
  LookAtMill();
  EXPECT_FALSE(HasReport(job));
  std::filesystem::remove(runs_);
  store_.fails = true;
  LookAtMill();
  EXPECT_FALSE(HasReport(job));
  store_.fails = false;
  LookAtMill();
  EXPECT_TRUE(HasReport(job));
}

// Nor where there was no room for what is played: its folder lies by then where nothing can be
// written.
TEST_F(ProductsOfLater, WhatHadNoRoomIsPlayedAgain) {
  const std::int64_t job = Over();
  Record(job);
  std::ofstream(program_) << "#!/bin/sh\nrm -r \"$4\"\nln -s /proc \"$4\"\nexit 1\n";
  LookAtMill();
  EXPECT_FALSE(HasReport(job));
  std::filesystem::remove(runs_ + "/" + std::to_string(job));
  std::ofstream(program_) << "#!/bin/sh\ncp " << folder_.File("report") << " $4/report\n";
  LookAtMill();
  EXPECT_TRUE(HasReport(job));
}

// Where all was made, or there was nothing to make, it is not looked at again by itself: whoever is
// looked at behind it would come behind that.
TEST_F(ProductsOfLater, WhatIsDoneIsNotLookedAtAgain) {
  again_after_ = std::chrono::milliseconds(0);
  products().Look("optimo-1");
  ASSERT_TRUE(Eventually([&] { return store_.looks_at_optimo > 0; }));
  for (int run = 0; run < 2; ++run) {
    const std::int64_t job = Over();
    Record(job);
    products().Look("mill-1");
    ASSERT_TRUE(Eventually([&] { return HasReport(job); }));
  }
  EXPECT_EQ(store_.looks_at_optimo.load(), 1);
}

// Nor where the store does not say which runs there are.
TEST_F(ProductsOfLater, RunsThatCannotBeListedAreLookedAtAgain) {
  const std::int64_t job = Over();
  Record(job);
  store_.lists_fail = true;
  LookAtMill();
  EXPECT_FALSE(HasReport(job));
  store_.lists_fail = false;
  LookAtMill();
  EXPECT_TRUE(HasReport(job));
}

// Nor is what could not be written to its end: the part of it that is there would be played.
TEST_F(ProductsOfLater, ARecordingThatIsNotWholeIsNotPlayed) {
  const std::int64_t job = Over();
  Record(job);
  products();
  const std::string folder = runs_ + "/" + std::to_string(job);
  std::filesystem::create_directories(folder);
  std::filesystem::create_symlink("/dev/full", folder + "/" + std::string(kRecording));
  LookAtMill();
  EXPECT_FALSE(HasReport(job));
  EXPECT_FALSE(std::filesystem::exists(folder_.File("said")));
  LookAtMill();
  EXPECT_TRUE(HasReport(job));
}

// Where the store could not say it, or not keep it, nobody has to ask again: it is looked at a
// while later.
TEST_F(ProductsOfLater, WhatCouldNotBeMadeIsMadeLater) {
  again_after_ = std::chrono::milliseconds(50);
  for (std::atomic<bool> NotingStore::*trouble :
       {&NotingStore::lists_fail, &NotingStore::lists_throw, &NotingStore::fails}) {
    const std::int64_t job = Over();
    Record(job);
    store_.*trouble = true;
    LookAtMill();
    EXPECT_FALSE(HasReport(job));
    store_.*trouble = false;
    EXPECT_TRUE(Eventually([&] { return HasReport(job); }));
  }
}

// What is under way when the server stops is made later, and nothing more is begun.
TEST_F(ProductsOfLater, AServerThatStopsAsksForNoFurtherRecording) {
  const auto link = Joined();
  Over();  // its host has the recording
  Record(Over());
  const std::string played = folder_.File("plays");
  std::ofstream(program_) << "#!/bin/sh\necho > " << played << "\nexec sleep 600\n";
  products().Look("mill-1");
  ASSERT_TRUE(Eventually([&] { return std::filesystem::exists(played); }));
  products_.reset();
  const std::vector<v1::HostResponse> all = link->All();
  EXPECT_EQ(std::ranges::count_if(all, &v1::HostResponse::has_order), 0);
}

// What its host sends and is no recording is not kept, and not asked for again.
TEST_F(ProductsOfLater, WhatIsNoRecordingIsNotKept) {
  const auto link = Joined();
  const std::int64_t job = Over();
  products().Look("mill-1");
  Send(*link, 1, "a letter");
  LookAtMill();
  EXPECT_FALSE(HasReport(job));
  EXPECT_FALSE(bed_.store().GetArtifact(job, kRecording));
  const std::vector<v1::HostResponse> all = link->All();
  EXPECT_EQ(std::ranges::count_if(all, &v1::HostResponse::has_order), 1);
}

// What cannot be kept is not played, and asked for again.
TEST_F(ProductsOfLater, ARecordingIsKeptBeforeItIsPlayed) {
  recording::Recording recorded;
  recorded.head.set_machine("machines/mill-1");
  recorded.entries.emplace_back().mutable_mark()->set_state("where it stood");
  const std::string bytes = recording::FileOf(recorded);
  const auto link = Joined();
  const std::int64_t job = Over();
  store_.fails = true;
  products().Look("mill-1");
  Send(*link, 1, bytes);
  AwaitMill();
  EXPECT_FALSE(HasReport(job));
  EXPECT_FALSE(std::filesystem::exists(folder_.File("said")));
  store_.fails = false;
  products().Look("mill-1");
  Send(*link, 2, bytes);
  EXPECT_TRUE(Eventually([&] { return HasReport(job); }));
  EXPECT_EQ(Must(bed_.store().ReadArtifact(job, kRecording)), bytes);
}

// Without the program that plays it there is no report, and nothing is left of the trial.
TEST_F(ProductsOfLater, WithoutAPlayerThereIsNoReport) {
  const std::int64_t job = Over();
  Record(job);
  std::filesystem::remove(program_);
  LookAtMill();
  EXPECT_FALSE(HasReport(job));
  EXPECT_FALSE(std::filesystem::exists(runs_ + "/" + std::to_string(job)));
}

// What was cancelled before it began has nothing that could be played, and holds nothing up.
TEST_F(ProductsOfLater, WhatNeverBeganIsPassedOver) {
  const std::int64_t job = Over();
  Record(job);
  Over(false);
  LookAtMill();
  EXPECT_TRUE(HasReport(job));
}

// Of its host it is asked for by the name of the job; what that has not is given up.
TEST_F(ProductsOfLater, TheRecordingIsThatOfTheJob) {
  const auto link = std::make_shared<FakeLink>();
  v1::HostHello hello;
  hello.set_join_token("secret");
  hello.set_machine("machines/mill-1");
  hello.set_host("hall/1");
  hello.set_protocol(1);
  ASSERT_TRUE(hosts_.Join(link, hello));
  const std::int64_t job = Over();
  products().Look("mill-1");
  const auto order = link->Newest(v1::HostResponse::kOrder);
  ASSERT_TRUE(order);
  EXPECT_EQ(order->order().recording().job(), JobName(job));
  v1::HostRequest answer;
  answer.mutable_answer()->set_number(order->order().number());
  answer.mutable_answer()->mutable_refusal()->set_code(CodeText(ErrorCode::kCellNotFound));
  hosts_.Receive(*link, std::move(answer));
  LookAtMill();
  const std::vector<v1::HostResponse> all = link->All();
  EXPECT_EQ(std::ranges::count_if(all, &v1::HostResponse::has_order), 1);
  EXPECT_FALSE(HasReport(job));
}

// What cannot be played, leaves no report or ends otherwise than its job is played once.
TEST_F(ProductsOfLater, WhatIsNoGoodIsPlayedOnce) {
  v1::RunReport stopped;
  stopped.mutable_outcome()->set_kind(v1::Outcome::KIND_STOPPED);
  std::ofstream(folder_.File("stopped"), std::ios::binary) << stopped.SerializeAsString();
  const std::vector<std::string> worthless = {
      "exit 1", "exit 0", "cp " + folder_.File("stopped") + " $4/report\necho s > $4/steps",
      "echo no report > $4/report"};
  for (const std::string& what : worthless) {
    std::ofstream(program_) << "#!/bin/sh\necho played >> " << folder_.File("plays") << "\n"
                            << what << "\n";
    std::filesystem::remove(folder_.File("plays"));
    const std::int64_t job = Over();
    Record(job);
    LookAtMill();
    LookAtMill();
    EXPECT_FALSE(HasReport(job)) << what;
    std::ifstream plays(folder_.File("plays"));
    EXPECT_EQ(std::count(std::istreambuf_iterator<char>(plays), {}, '\n'), 1) << what;
  }
}

// Nor is anything told of a run that failed and left no report.
TEST_F(ProductsOfLater, WithoutAReportNothingIsTold) {
  std::ofstream(program_) << "#!/bin/sh\necho path > $4/toolpath\n";
  const std::int64_t job = Over(true, JobState::kFailed);
  Record(job);
  LookAtMill();
  EXPECT_FALSE(bed_.store().GetArtifact(job, "toolpath"));
  for (const storage::EventRecord& event : Must(bed_.store().JobEvents(job, 0, 100)))
    EXPECT_FALSE(ToProto(event).has_products_made());
}

// The log of the job tells that it has more now, and how the part is; the worker is told where to
// put it and how to log.
TEST_F(ProductsOfLater, WhatWasMadeIsTold) {
  const std::int64_t job = Over();
  Record(job);
  LookAtMill();
  ASSERT_TRUE(HasReport(job));
  const v1::JobEvent told = ToProto(Must(bed_.store().JobEvents(job, 0, 100)).back());
  ASSERT_TRUE(told.has_products_made());
  EXPECT_EQ(told.products_made().verdict(), v1::VERDICT_DOUBTFUL);
  EXPECT_EQ(Must(bed_.store().GetJob(job)).outcome->verdict, "DOUBTFUL");
  EXPECT_EQ(Must(bed_.store().GetArtifact(job, "steps")).media_type, "application/x-protobuf");
  std::ifstream file(folder_.File("said"));
  std::string said;
  std::getline(file, said);
  const std::string into = runs_ + "/" + std::to_string(job);
  EXPECT_EQ(said, "--products " + into + "/" + std::string(kRecording) + " --into " + into +
                      " --log-level warning --log-format json");
  EXPECT_FALSE(std::filesystem::exists(into));
}

}  // namespace
}  // namespace rmlcell::server
