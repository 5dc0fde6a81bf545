// A worker's side of a job, against a server that says what the test wants and notes what it hears.
#include "server/worker/job_runner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "server/base/version.h"
#include "tests/server/worker/runner_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;

// Runs for as long as it is let, in no virtual time.
constexpr const char* kEndless = "10 VI[2] = VI[3]\nGOTO 10\n";

TEST_F(JobRunnerTest, JoinsWithItsNameAndWhatItCanDo) {
  server.lease_ms = 1234;
  server.window = 77;
  EXPECT_TRUE(Work(Assignment(v1::JOB_KIND_CHECK, "STOP\n")));
  EXPECT_EQ(line_->lease_ms(), 1234);
  EXPECT_EQ(line_->events_window(), 77);
  const v1::WorkerHello& hello = heard_.front().hello();
  EXPECT_EQ(hello.join_token(), "secret");
  EXPECT_EQ(hello.worker(), "w");
  EXPECT_EQ(hello.version(), kVersion);
  EXPECT_THAT(hello.kinds(), ElementsAre(v1::JOB_KIND_CHECK, v1::JOB_KIND_SIMULATE));
  EXPECT_GT(hello.process_id(), 0);
}

// worker.proto: from its first beat on an attempt counts, which waits for no third of a lease.
TEST_F(JobRunnerTest, ItsHeartBeatsAtOnce) {
  Work(Assignment(v1::JOB_KIND_CHECK, "STOP\n"));
  ASSERT_GT(heard_.size(), 2U);
  EXPECT_TRUE(heard_[1].has_heartbeat());
  EXPECT_FALSE(heard_[1].heartbeat().has_progress());
  EXPECT_EQ(heard_[1].heartbeat().lease().SerializeAsString(), Lease().SerializeAsString());
}

// Nobody holds the lease of a job that is over: its heart rests.
TEST_F(JobRunnerTest, NoHeartBeatsBehindAJob) {
  server.lease_ms = 3;
  line_ = Joined();
  JobRunner runner(*line_, stopping, processor_time);
  EXPECT_TRUE(runner.Work(Assignment(v1::JOB_KIND_CHECK, "STOP\n")));
  v1::WorkRequest behind;
  *behind.mutable_hand_back()->mutable_lease() = Lease(9);  // of no job that there is
  ASSERT_TRUE(line_->Send(behind));
  line_->Receive(std::chrono::milliseconds(60));  // as long as some beats, and nothing comes
  line_->Close();
  while (!line_->gone()) line_->Receive(std::chrono::seconds(60));
  const std::vector<v1::WorkRequest> heard = server.requests();
  const auto from = std::ranges::find_if(heard, &v1::WorkRequest::has_hand_back);
  ASSERT_NE(from, heard.end());
  EXPECT_TRUE(std::none_of(from, heard.end(),
                           [](const v1::WorkRequest& one) { return one.has_heartbeat(); }));
}

TEST_F(JobRunnerTest, SaysOfWhichPoolItIs) {
  line_ = Joined("paced");
  EXPECT_EQ(server.requests().front().hello().pool(), "paced");
}

// server/worker/server_line.h: the reason of the server has a code of its own.
TEST_F(JobRunnerTest, IsToldWhyItMayNotJoin) {
  const std::vector<std::pair<grpc::StatusCode, ErrorCode>> rows = {
      {grpc::StatusCode::UNAUTHENTICATED, ErrorCode::kCellJoinRefused},
      {grpc::StatusCode::FAILED_PRECONDITION, ErrorCode::kCellVersionMismatch},
      {grpc::StatusCode::INTERNAL, ErrorCode::kCellUnavailable}};
  for (const auto& [status, code] : rows) {
    server.refusal = grpc::Status(status, "because");
    const auto joined =
        ServerLine::Join({.server = server.address(), .join_token = "", .name = "w"});
    ASSERT_FALSE(joined);
    EXPECT_EQ(joined.error().code, code);
    EXPECT_EQ(joined.error().detail, "because");
  }
}

// Who is answered and not welcome has not joined.
TEST_F(JobRunnerTest, WhoIsNotWelcomeHasNotJoined) {
  server.welcomes = false;
  const auto joined =
      ServerLine::Join({.server = server.address(), .join_token = "secret", .name = "w"});
  ASSERT_FALSE(joined);
  EXPECT_EQ(joined.error().code, ErrorCode::kCellUnavailable);
}

// Where nobody listens: that is no refusal of a server.
TEST_F(JobRunnerTest, WhereNobodyListensNobodyIsJoined) {
  const std::string address = "unix:" + testing::TempDir() + "/no-server-listens";
  const auto joined = ServerLine::Join({.server = address, .join_token = "", .name = "w"});
  ASSERT_FALSE(joined);
  EXPECT_EQ(joined.error().code, ErrorCode::kCellUnavailable);
  EXPECT_EQ(joined.error().detail, "no server answers at " + address);
}

TEST_F(JobRunnerTest, ACheckLeavesAReport) {
  EXPECT_TRUE(Work(Assignment(v1::JOB_KIND_CHECK, "STOP\n")));
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_THAT(Names(), ElementsAre("report"));
  EXPECT_EQ(Report().outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_EQ(Report().family(), "optimo");
  EXPECT_FALSE(HandedBack());
}

// The first error ends the job; each finding is in the report and in the log. OPT-2.35: SPEED is 0
// to 100.
TEST_F(JobRunnerTest, ACheckOfAProgramWithErrorsFails) {
  Work(Assignment(v1::JOB_KIND_CHECK, "STOP\nSPEED 101\nSPEED 102\n"));
  const v1::Outcome outcome = Outcome();
  EXPECT_EQ(outcome.kind(), v1::Outcome::KIND_FAILED);
  EXPECT_EQ(outcome.code(), "OPT-E7004");
  EXPECT_EQ(outcome.place().program(), 45);
  EXPECT_EQ(outcome.place().line(), 2);
  EXPECT_EQ(Report().diagnostics_size(), 2);
  EXPECT_EQ(Report().outcome().SerializeAsString(), outcome.SerializeAsString());
  EXPECT_EQ(Events().size(), 2U);
}

TEST_F(JobRunnerTest, ASimulationThatCannotBeTranslatedFailsWithItsFindings) {
  Work(Assignment(v1::JOB_KIND_SIMULATE, "STOP\nSPEED 101\n"));
  EXPECT_EQ(Outcome().code(), "OPT-E7004");
  EXPECT_THAT(Names(), ElementsAre("report"));
  EXPECT_EQ(Report().diagnostics_size(), 1);
}

// 10 mm in the work: the products of a run.
TEST_F(JobRunnerTest, ASimulationLeavesItsProducts) {
  Work(Assignment(v1::JOB_KIND_SIMULATE,
                  "PA;PA;VS8;!MC1;PU1000,1000;Z1000,1000,-50;Z2000,1000,-50;PU0,0;", "rml1"));
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_THAT(Names(), ElementsAre("picture.svg", "report", "toolpath"));
  EXPECT_NE(Artifacts()["picture.svg"].find("<svg"), std::string::npos);
  EXPECT_NEAR(Report().total().cut_length_mm() - Report().total().plunge_length_mm(), 10.0, 1e-3);
}

// With a pace somebody looks on: the first position comes at once.
TEST_F(JobRunnerTest, APacedSimulationTellsItsPosition) {
  v1::WorkerAssignment assignment =
      Assignment(v1::JOB_KIND_SIMULATE, "PA;PA;VS8;!MC1;PU1000,1000;Z1000,1000,-50;PU0,0;", "rml1");
  assignment.mutable_job()->mutable_simulation()->set_pace(1000.0);
  Work(assignment);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_TRUE(std::ranges::any_of(heard_, IsPosition));
}

TEST_F(JobRunnerTest, ATraceComesWhenItIsWanted) {
  v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, "OL[20]=ON\nDELAY 1.5\n");
  assignment.mutable_job()->mutable_simulation()->set_trace(true);
  assignment.mutable_job()->mutable_simulation()->add_variables("VI[3]");
  Work(assignment);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_THAT(Names(), ElementsAre("picture.svg", "report", "steps", "toolpath", "trace"));
  EXPECT_NEAR(Report().total().times().dwell_s(), 1.5, 1e-9);
  EXPECT_EQ(Finished()->executables_size(), 1);  // OPT-1.11: the first run makes it
  EXPECT_EQ(Finished()->executables(0).slot(), 45);
  EXPECT_EQ(Finished()->executables(0).object_revision(), 3);
  EXPECT_NE(Finished()->executables(0).content(), "");
  EXPECT_EQ(std::ranges::count_if(Events(), [](const v1::JobEvent& e) { return e.has_signal(); }),
            1);
}

// Large programs follow in parts; parts of other programs are not taken for them.
TEST_F(JobRunnerTest, TakesAProgramInParts) {
  v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, "");
  assignment.mutable_programs(0)->set_size(10);
  const auto part = [](int slot, const std::string& bytes) {
    v1::WorkResponse message;
    message.mutable_blob()->set_slot(slot);
    message.mutable_blob()->set_chunk(bytes);
    return message;
  };
  Work(assignment, {part(45, "DELAY "), part(44, "junk"), Release(4), part(45, "2.5\n")});
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_NEAR(Report().total().times().dwell_s(), 2.5, 1e-9);
}

TEST_F(JobRunnerTest, ALeaseThatIsLostBeforeAllPartsCameIsGone) {
  v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, "");
  assignment.mutable_programs(0)->set_size(10);
  EXPECT_TRUE(Work(assignment, {Release()}));
  EXPECT_FALSE(Finished());
  EXPECT_FALSE(HandedBack());
}

TEST_F(JobRunnerTest, IsCancelled) {
  for (const v1::JobKind kind : {v1::JOB_KIND_CHECK, v1::JOB_KIND_SIMULATE}) {
    v1::WorkerAssignment assignment = Assignment(kind, "");
    const std::string source = kind == v1::JOB_KIND_CHECK ? "STOP\n" : kEndless;
    assignment.mutable_programs(0)->set_size(static_cast<std::int64_t>(source.size()));
    v1::WorkResponse program;
    program.mutable_blob()->set_slot(45);
    program.mutable_blob()->set_chunk(source);
    // An order of another attempt is not for this one; the order is there before the run begins.
    Work(assignment,
         {Order(v1::WorkerControl::KIND_STOP, 4), Order(v1::WorkerControl::KIND_CANCEL), program});
    EXPECT_EQ(heard_.back().finish().outcome().kind(), v1::Outcome::KIND_CANCELLED);
    EXPECT_EQ(heard_.back().finish().outcome().code(), "CELL-E9307");
  }
}

TEST_F(JobRunnerTest, IsCancelledWhileItRuns) {
  bool ordered = false;
  server.heard = [&](const v1::WorkRequest& message) {
    if (IsPosition(message) && !std::exchange(ordered, true))
      server.Send(Order(v1::WorkerControl::KIND_CANCEL));
  };
  Work(Assignment(v1::JOB_KIND_SIMULATE, kEndless));
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_CANCELLED);
}

// Who follows the toolpath gets each frame once, in order, while the run goes on, and the block
// that is not full yet besides; what is stored at the end begins with the same.
TEST_F(JobRunnerTest, TheToolpathIsSentAsItIsMade) {
  bool ordered = false;
  std::string frames;
  int open_blocks = 0;
  server.heard = [&](const v1::WorkRequest& message) {
    if (IsPosition(message) && !std::exchange(ordered, true))
      server.Send(Order(v1::WorkerControl::KIND_FOLLOW_TOOLPATH));
    if (!message.has_toolpath()) return;
    frames += message.toolpath().frames();
    if (!message.toolpath().open_block().empty()) ++open_blocks;
    // One block that is full, and one that is not.
    if (!frames.empty() && open_blocks > 1) server.Send(Order(v1::WorkerControl::KIND_CANCEL));
  };
  std::string source = "PA;PA;VS8;!MC1;";
  for (int i = 0; i < 200'000; ++i)
    source += "Z" + std::to_string(i % 2 * 1000) + "," + std::to_string(i % 7 * 100) + ",-50;";
  v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, source, "rml1");
  assignment.mutable_job()->mutable_simulation()->set_pace(20'000.0);
  Work(assignment);
  EXPECT_FALSE(frames.empty());
  EXPECT_GT(open_blocks, 1);
  const std::string stored = Artifacts()["toolpath"];
  EXPECT_GE(stored.size(), frames.size());
  EXPECT_TRUE(stored.starts_with(frames));
  // It is no order of a client: the log tells of nothing but the cancel.
  for (const v1::JobEvent& event : Events()) {
    EXPECT_TRUE(!event.has_input_applied() || event.input_applied().input().has_abort());
  }
}

// How long a paced program takes is worked out beside its run, a little at a time, and told once it
// is known: of 50,000 moves not at first. The run itself would last some four minutes.
TEST_F(JobRunnerTest, TheTimeOfALongProgramIsToldWhenItIsKnown) {
  std::int64_t planned_ns = 0;
  server.heard = [&](const v1::WorkRequest& message) {
    if (!IsPosition(message) || planned_ns > 0) return;
    planned_ns = message.heartbeat().progress().planned_time_ns();
    if (planned_ns > 0) server.Send(Order(v1::WorkerControl::KIND_CANCEL));
  };
  std::string source = "PA;PA;VS8;!MC1;";
  for (int i = 0; i < 50'000; ++i)
    source += "Z" + std::to_string(i % 2 * 1000) + "," + std::to_string(i % 7 * 100) + ",-50;";
  v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, source, "rml1");
  assignment.mutable_job()->mutable_simulation()->set_pace(1'000.0);
  Work(assignment);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_CANCELLED);
  // Each is 10 mm or a little more long, at 2 mm/s and more slowly at its ends.
  EXPECT_GT(planned_ns, std::int64_t{50'000} * 5'000'000'000);
}

TEST_F(JobRunnerTest, AToolpathThatNobodyFollowsIsSentAtItsEnd) {
  Work(Assignment(v1::JOB_KIND_SIMULATE, "PA;PA;VS8;!MC1;PU1000,1000;PU0,0;", "rml1"));
  EXPECT_TRUE(std::ranges::none_of(heard_, [](const auto& m) { return m.has_toolpath(); }));
}

// A job that is held is where it was: that is told once, whatever passes.
TEST_F(JobRunnerTest, AJobThatStandsTellsItsPlaceOnce) {
  server.lease_ms = 150;
  std::set<std::string> places;
  int positions = 0;
  int beats = 0;
  server.heard = [&](const v1::WorkRequest& message) {
    if (IsPosition(message)) {
      places.insert(message.heartbeat().progress().SerializeAsString());
      if (++positions == 1) server.Send(Order(v1::WorkerControl::KIND_HOLD));
    } else if (message.has_heartbeat() && positions > 0 && ++beats == 12) {
      server.Send(Order(v1::WorkerControl::KIND_CANCEL));
    }
  };
  Work(Assignment(v1::JOB_KIND_SIMULATE, kEndless));
  EXPECT_GE(positions, 1);
  EXPECT_EQ(places.size(), static_cast<std::size_t>(positions));
}

// HOLD halts it and RESUME lets it go on; what is ordered is told at once.
TEST_F(JobRunnerTest, IsHeldAndGoesOn) {
  for (const auto kind : {v1::WorkerControl::KIND_HOLD, v1::WorkerControl::KIND_STOP}) {
    std::vector<std::string> told;
    bool ordered = false;
    server.heard = [&](const v1::WorkRequest& message) {
      if (IsPosition(message) && !std::exchange(ordered, true)) server.Send(Order(kind));
      for (const v1::JobEvent& event : message.events().events()) {
        if (event.has_halted()) {
          told.emplace_back("halted");
          server.Send(Order(v1::WorkerControl::KIND_RESUME));
        } else if (event.has_resumed()) {
          told.emplace_back("resumed");
          server.Send(Order(v1::WorkerControl::KIND_CANCEL));
        }
      }
    };
    Work(Assignment(v1::JOB_KIND_SIMULATE, kEndless));
    EXPECT_EQ(heard_.back().finish().outcome().kind(), v1::Outcome::KIND_CANCELLED);
    EXPECT_THAT(told, ElementsAre("halted", "resumed"));
  }
}

// A program that halts by itself waits for a key that nobody presses; one that a client holds waits
// for him.
TEST_F(JobRunnerTest, AHaltThatNobodyEndsEndsTheRun) {
  v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, kEndless);
  assignment.mutable_job()->mutable_simulation()->add_breakpoints()->mutable_step()->set_step(2);
  Work(assignment);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_STOPPED);
  EXPECT_EQ(Outcome().code(), "CELL-E9308");
}

TEST_F(JobRunnerTest, ALeaseThatIsLostEndsTheWorkWithoutAWord) {
  bool sent = false;
  server.heard = [&](const v1::WorkRequest& message) {
    if (!IsPosition(message) || std::exchange(sent, true)) return;
    server.Send(Release(4));  // another one
    server.Send(Release());
  };
  EXPECT_TRUE(Work(Assignment(v1::JOB_KIND_SIMULATE, kEndless)));
  EXPECT_FALSE(Finished());
  EXPECT_FALSE(HandedBack());
}

TEST_F(JobRunnerTest, ALineThatIsGoneEndsTheWork) {
  bool sent = false;
  server.heard = [&](const v1::WorkRequest& message) {
    if (IsPosition(message) && !std::exchange(sent, true)) server.HangUp();
  };
  EXPECT_TRUE(Work(Assignment(v1::JOB_KIND_SIMULATE, kEndless)));
  EXPECT_FALSE(Finished());
}

// A server that stops gets its job back, and the worker ends; so it does when its process is to
// end.
TEST_F(JobRunnerTest, HandsAJobBack) {
  v1::WorkResponse stop;
  stop.mutable_stop();
  EXPECT_FALSE(Work(Assignment(v1::JOB_KIND_SIMULATE, kEndless), {stop}));
  EXPECT_TRUE(HandedBack());
  EXPECT_FALSE(Finished());
  stopping = true;
  EXPECT_TRUE(Work(Assignment(v1::JOB_KIND_SIMULATE, kEndless)));
  EXPECT_TRUE(HandedBack());
  EXPECT_FALSE(Finished());
}

TEST_F(JobRunnerTest, EachBudgetEndsTheJobWithItsCode) {
  const auto ended = [&](const std::string& source, const std::function<void(v1::Budget&)>& change,
                         v1::JobKind kind = v1::JOB_KIND_SIMULATE) {
    v1::WorkerAssignment assignment = Assignment(kind, source);
    change(*assignment.mutable_budget());
    Work(assignment);
    const v1::Outcome outcome = heard_.back().finish().outcome();
    EXPECT_EQ(outcome.kind(), v1::Outcome::KIND_BUDGET_EXCEEDED);
    return outcome.code();
  };
  EXPECT_EQ(ended(kEndless, [](v1::Budget& b) { b.set_processor_ns(50'000'000); }), "CELL-E9303");
  EXPECT_EQ(ended(
                "STOP\n", [](v1::Budget& b) { b.set_processor_ns(1); }, v1::JOB_KIND_CHECK),
            "CELL-E9303");
  EXPECT_EQ(ended("STOP\n", [](v1::Budget& b) { b.set_output_bytes(1); }), "CELL-E9306");
  EXPECT_EQ(ended(
                "STOP\n", [](v1::Budget& b) { b.set_output_bytes(1); }, v1::JOB_KIND_CHECK),
            "CELL-E9306");
  EXPECT_EQ(ended("STOP\n", [](v1::Budget& b) { b.set_memory_bytes(1000); }), "CELL-E9302");
}

// A parameter that the machine has not: refused before anything runs.
TEST_F(JobRunnerTest, RefusesWhatCannotBeSetUp) {
  for (const v1::JobKind kind : {v1::JOB_KIND_CHECK, v1::JOB_KIND_SIMULATE}) {
    v1::WorkerAssignment assignment = Assignment(kind, "STOP\n");
    (*assignment.mutable_parameters())["NONE"] = "1";
    Work(assignment);
    EXPECT_EQ(heard_.back().finish().outcome().kind(), v1::Outcome::KIND_FAILED);
    EXPECT_FALSE(heard_.back().finish().outcome().code().empty());
    EXPECT_THAT(Names(), ElementsAre());
  }
}

// A store that is slow slows the run: beyond the window nothing is sent until events are stored.
TEST_F(JobRunnerTest, SendsNoMoreThanAWindowOfEvents) {
  server.lease_ms = 30;
  server.window = 63;  // a batch of 64 events is one more
  server.stores = false;
  int beats = 0;
  int events = 0;
  std::vector<int> sent_when_stored;
  server.heard = [&](const v1::WorkRequest& message) {
    events += message.events().events_size();
    // Some beats of the heart in which nothing else comes.
    beats = message.has_heartbeat() && !message.heartbeat().has_progress() ? beats + 1 : 0;
    if (beats < 5 || events == 0) return;
    beats = 0;
    sent_when_stored.push_back(events);
    v1::WorkResponse stored;
    *stored.mutable_events_stored()->mutable_lease() = Lease();
    stored.mutable_events_stored()->set_count(events);
    server.Send(stored);
  };
  std::string source;
  for (int i = 0; i < 100; ++i) source += "OL[20]=ON\nOL[20]=OFF\n";
  Work(Assignment(v1::JOB_KIND_SIMULATE, source));
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_EQ(std::ranges::count_if(Events(),
                                  [](const v1::JobEvent& e) { return e.signal().index() == 20; }),
            200);
  ASSERT_FALSE(sent_when_stored.empty());
  // One batch of 64 more than the window, which may be exceeded once, and never more under way.
  int before = 0;
  for (const int sent : sent_when_stored) {
    EXPECT_LE(sent - before, 63 + 64);
    before = sent;
  }
}

// An order is looked at while the store makes the run wait.
TEST_F(JobRunnerTest, IsStoppedWhileItsEventsAreNotStored) {
  server.window = 1;
  server.stores = false;
  server.heard = [&](const v1::WorkRequest& message) {
    if (message.has_events()) server.Send(Order(v1::WorkerControl::KIND_CANCEL));
  };
  Work(Assignment(v1::JOB_KIND_SIMULATE, "10 OL[20]=ON\nOL[20]=OFF\nDELAY 0.1\nGOTO 10\n"));
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_CANCELLED);
}

// While it translates and runs its heart beats three times in a lease.
TEST_F(JobRunnerTest, BeatsThreeTimesInALease) {
  server.lease_ms = 60;
  int beats = 0;
  server.heard = [&](const v1::WorkRequest& message) {
    if (!message.has_heartbeat() || message.heartbeat().has_progress()) return;
    EXPECT_EQ(message.heartbeat().lease().SerializeAsString(), Lease().SerializeAsString());
    if (++beats == 3) server.Send(Order(v1::WorkerControl::KIND_CANCEL));
  };
  Work(Assignment(v1::JOB_KIND_SIMULATE, kEndless));
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_CANCELLED);
  EXPECT_GE(beats, 3);
}

}  // namespace
}  // namespace rmlcell::server
