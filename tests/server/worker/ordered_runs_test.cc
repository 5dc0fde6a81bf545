// What people order of a job while it runs, and what a worker tells of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "server/worker/job_lease.h"
#include "tests/server/worker/runner_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;

class OrderedRuns : public JobRunnerTest {
 protected:
  static v1::WorkResponse OrderOf(v1::WorkerControl::Kind kind, const std::string& request,
                                  double value = 0.0) {
    v1::WorkResponse order = Order(kind, 5, value);
    order.mutable_control()->set_caller("anna");
    order.mutable_control()->set_request_id(request);
    return order;
  }
  static v1::WorkerAssignment Paced(const std::string& source, double pace,
                                    const std::string& family = "optimo") {
    v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, source, family);
    assignment.mutable_job()->mutable_simulation()->set_pace(pace);
    return assignment;
  }
  // The program comes behind what is ordered, which is there before the run begins.
  double CycleTime_s(std::vector<v1::WorkResponse> before) {
    const std::string source = "PA;PA;VS8;!MC1;PU1000,1000;PU3000,3000;PU0,0;";
    v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, "", "rml1");
    assignment.mutable_programs(0)->set_size(static_cast<std::int64_t>(source.size()));
    v1::WorkResponse& program = before.emplace_back();
    program.mutable_blob()->set_slot(45);
    program.mutable_blob()->set_chunk(source);
    Work(assignment, before);
    EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
    return Report().total().times().cycle_s();
  }
  std::vector<int> LinkedSlots(std::int64_t revision) {
    v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, "DELAY 1\n");
    assignment.mutable_programs(0)->set_object_revision(revision);
    Work(assignment);
    std::vector<int> slots;
    const std::optional<v1::WorkerFinish> finish = Finished();
    for (const v1::LinkedExecutable& one : finish->executables()) slots.push_back(one.slot());
    return slots;
  }
};

// Who asked for what, and when by the time of the run.
TEST_F(OrderedRuns, EachOrderStandsInTheLogAsItWas) {
  using Input = v1::AppliedInput;
  server.heard = [&](const v1::WorkRequest& message) {
    for (const v1::JobEvent& event : message.events().events()) {
      if (event.has_halted()) server.Send(OrderOf(v1::WorkerControl::KIND_RESUME, "go on", 20.0));
      if (!event.has_resumed()) continue;
      server.Send(OrderOf(v1::WorkerControl::KIND_OVERRIDE, "slower", 55.0));
      server.Send(OrderOf(v1::WorkerControl::KIND_CANCEL, "end"));
    }
  };
  for (const auto& [kind, input] : {std::pair{v1::WorkerControl::KIND_HOLD, Input::kHold},
                                    std::pair{v1::WorkerControl::KIND_STOP, Input::kStop}}) {
    Work(Paced("10 DELAY 1\nGOTO 10\n", 10.0), {OrderOf(kind, "hold it")});
    EXPECT_EQ(heard_.back().finish().outcome().kind(), v1::Outcome::KIND_CANCELLED);
    std::vector<Input::InputCase> inputs;
    std::vector<std::string> requests;
    for (const v1::JobEvent& event : Events()) {
      if (!event.has_input_applied()) continue;
      const v1::InputApplied& applied = event.input_applied();
      inputs.push_back(applied.input().input_case());
      requests.push_back(applied.request_id());
      EXPECT_EQ(applied.caller(), "anna");
      EXPECT_EQ(applied.fence(), 5);
      EXPECT_EQ(applied.source(), v1::START_SOURCE_CONSOLE);
      EXPECT_EQ(applied.virtual_time_ns(), event.virtual_time_ns());
      if (applied.input().has_override_percent()) {
        EXPECT_EQ(applied.input().override_percent(), 55.0);
      }
      if (applied.input().has_resume()) {
        EXPECT_EQ(applied.input().resume().source(), v1::START_SOURCE_CONSOLE);
      }
    }
    EXPECT_THAT(inputs, ElementsAre(input, Input::kResume, Input::kOverridePercent, Input::kAbort));
    EXPECT_THAT(requests, ElementsAre("hold it", "go on", "slower", "end"));
  }
}

// An order does what it says and nothing of what another one does.
TEST_F(OrderedRuns, HoldAndResumeChangeNoOverride) {
  const double plain_s = CycleTime_s({});
  EXPECT_NEAR(CycleTime_s({OrderOf(v1::WorkerControl::KIND_HOLD, "", 10.0),
                           OrderOf(v1::WorkerControl::KIND_RESUME, "", 10.0)}),
              plain_s, 1e-6);
  EXPECT_GT(CycleTime_s({OrderOf(v1::WorkerControl::KIND_OVERRIDE, "", 10.0)}), 1.5 * plain_s);
}

// STOP halts in the middle of a wait, and what is halted so waits.
TEST_F(OrderedRuns, AStopHaltsUntilSomebodyLetsItGoOn) {
  int halts = 0;
  server.heard = [&](const v1::WorkRequest& message) {
    for (const v1::JobEvent& event : message.events().events()) {
      if (!event.has_halted()) continue;
      ++halts;
      EXPECT_LT(event.virtual_time_ns(), 1'000'000'000);
      server.Send(Order(v1::WorkerControl::KIND_RESUME));
    }
  };
  WorkBehind(Paced("DELAY 1\n", 20.0), {Order(v1::WorkerControl::KIND_STOP)});
  EXPECT_EQ(halts, 1);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
}

// A mill has both keys: each halts as itself.
TEST_F(OrderedRuns, AHoldIsNoStop) {
  for (const auto& [order, reason] :
       {std::pair{v1::WorkerControl::KIND_HOLD, v1::HOLD_REASON_HOLD},
        std::pair{v1::WorkerControl::KIND_STOP, v1::HOLD_REASON_STOP}}) {
    std::vector<v1::HoldReason> reasons;
    server.heard = [&](const v1::WorkRequest& message) {
      for (const v1::JobEvent& event : message.events().events()) {
        if (!event.has_halted()) continue;
        reasons.push_back(event.halted().reason());
        server.Send(Order(v1::WorkerControl::KIND_CANCEL));
      }
    };
    WorkBehind(Paced("PA;PA;VS8;!MC1;PU1000,1000;PU3000,3000;PU0,0;", 20.0, "rml1"),
               {Order(order)});
    EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_CANCELLED);
    EXPECT_THAT(reasons, ElementsAre(reason));
  }
}

// What a STOP has halted does not go on by itself.
TEST_F(OrderedRuns, AStopLetsNothingGoOn) {
  server.heard = [&](const v1::WorkRequest& message) {
    for (const v1::JobEvent& event : message.events().events()) {
      if (event.has_halted()) server.Send(Order(v1::WorkerControl::KIND_CANCEL));
    }
  };
  WorkBehind(Paced("DELAY 1\n", 20.0), {Order(v1::WorkerControl::KIND_STOP)});
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_CANCELLED);
  for (const v1::JobEvent& event : Events()) EXPECT_FALSE(event.has_resumed());
}

// A worker that is to end hands back the run that it has under way, whatever is ordered then.
TEST_F(OrderedRuns, AWorkerThatIsToEndHandsItsRunBack) {
  server.heard = [&](const v1::WorkRequest& message) {
    for (const v1::JobEvent& event : message.events().events()) {
      if (!event.has_halted()) continue;
      v1::WorkResponse stop;
      stop.mutable_stop();
      server.Send(stop);
      server.Send(Order(v1::WorkerControl::KIND_RESUME));
    }
  };
  WorkBehind(Paced("DELAY 1\n", 20.0), {Order(v1::WorkerControl::KIND_STOP)});
  EXPECT_TRUE(HandedBack());
  EXPECT_FALSE(Finished());
}

// Whoever let it go on does not hold it any more: where it halts by itself nobody is waited for.
TEST_F(OrderedRuns, AHaltBehindAResumeEndsTheRun) {
  server.heard = [&](const v1::WorkRequest& message) {
    for (const v1::JobEvent& event : message.events().events()) {
      if (event.has_halted() && event.virtual_time_ns() < 4'000'000'000)
        server.Send(Order(v1::WorkerControl::KIND_RESUME));
    }
  };
  v1::WorkerAssignment assignment = Paced("DELAY 1\nDELAY 5\nDELAY 1\n", 20.0);
  assignment.mutable_job()->mutable_simulation()->add_breakpoints()->mutable_step()->set_step(2);
  Work(assignment, {Order(v1::WorkerControl::KIND_HOLD)});
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_STOPPED);
  EXPECT_EQ(Outcome().code(), "CELL-E9308");
}

// Who follows the heights is told what is new, and nothing where nothing is. The first look at them
// is over before the block is touched: the way there takes longer than a run catches up at once.
TEST_F(OrderedRuns, NoHeightsWithoutNews) {
  int messages = 0;
  int empty = 0;
  server.heard = [&](const v1::WorkRequest& message) {
    if (!message.has_heights()) return;
    ++messages;
    if (!message.heights().has_grid() && message.heights().tiles().empty()) ++empty;
  };
  v1::WorkerAssignment assignment = Mill(
      "PA;VS50;!VZ50;!PZ-100,200;!MC1;PU4010,0;PU0,0;PU4010,0;PU0,0;PU4010,0;PU0,0;"
      "PU2010,1510;PD4010,1510;PU0,0;PU4010,0;PU0,0;");
  assignment.mutable_job()->mutable_simulation()->set_pace(5.0);
  WorkBehind(assignment, {Order(v1::WorkerControl::KIND_FOLLOW_HEIGHTS)});
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_GT(messages, 1);
  EXPECT_EQ(empty, 0);
}

// Whoever watches sees what happens on the way, and not when a batch is full or the run is over.
TEST_F(OrderedRuns, WhatHappensIsToldOnTheWay) {
  bool ordered = false;
  server.heard = [&](const v1::WorkRequest& message) {
    for (const v1::JobEvent& event : message.events().events()) {
      if (event.has_signal() && !std::exchange(ordered, true))
        server.Send(Order(v1::WorkerControl::KIND_CANCEL));
    }
  };
  Work(Paced("OL[20]=ON\nDELAY 100\n", 1.0));
  EXPECT_TRUE(ordered);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_CANCELLED);
}

// Budget.output_bytes: what is told counts as it is told. A run that tells too much ends then: some
// 400 of the 20,000 changes of its output fit.
TEST_F(OrderedRuns, ARunThatTellsTooMuchEnds) {
  v1::WorkerAssignment assignment = Paced("10 OL[20]=ON\nOL[20]=OFF\nDELAY 0.1\nGOTO 10\n", 100.0);
  assignment.mutable_budget()->set_output_bytes(20'000);
  assignment.mutable_budget()->set_virtual_time_ns(1'000'000'000'000);
  Work(assignment);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_BUDGET_EXCEEDED);
  EXPECT_EQ(Outcome().code(), "CELL-E9306");
  EXPECT_LT(Events().size(), 5'000U);
}

// A window of events may be under way: the one beyond it waits.
TEST_F(OrderedRuns, AWindowOfEventsIsUsedToItsEnd) {
  server.window = 5;
  server.stores = false;
  line_ = Joined();
  const v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, "STOP\n");
  JobLease lease(*line_, assignment, stopping, processor_time);
  // Whoever waits for the store takes in what comes, and an order ends that; nobody else does.
  const auto sent_at_once = [&](int count) {
    v1::WorkerEvents events;
    for (int i = 0; i < count; ++i) events.add_events();
    server.Send(Order(v1::WorkerControl::KIND_HOLD));
    lease.SendEvents(events);
    const bool at_once = !lease.has_orders();
    if (at_once) lease.Listen(std::chrono::minutes(1));
    EXPECT_EQ(lease.TakeOrders().size(), 1U);
    return at_once;
  };
  EXPECT_TRUE(sent_at_once(3));
  EXPECT_TRUE(sent_at_once(2));
  EXPECT_FALSE(sent_at_once(1));
}

// worker.proto, LinkedExecutable: of what is stored, from its first revision on.
TEST_F(OrderedRuns, ExecutablesAreOfWhatIsStored) {
  EXPECT_THAT(LinkedSlots(1), ElementsAre(45));
  EXPECT_THAT(LinkedSlots(0), ElementsAre());
}

// A finding of the text has no time of its own.
TEST_F(OrderedRuns, AFindingOfTheTextIsToldAtTheBegin) {
  Work(Assignment(v1::JOB_KIND_SIMULATE, "STOP\nSPEED 101\n"));
  ASSERT_EQ(Events().size(), 1U);
  EXPECT_EQ(Events()[0].virtual_time_ns(), 0);
}

// Whoever has lost a job says nothing of it, whatever else is wrong with that.
TEST_F(OrderedRuns, AJobThatIsLostIsNotEvenRefused) {
  v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, "");
  assignment.mutable_programs(0)->set_size(10);
  for (int i = 0; i < 1'001; ++i)  // one more than a job may ask for
    assignment.mutable_job()->mutable_simulation()->add_variables("VI[" + std::to_string(i) + "]");
  EXPECT_TRUE(Work(assignment, {Release()}));
  EXPECT_FALSE(Finished());
  assignment.mutable_programs(0)->set_content("STOP\n");
  assignment.mutable_programs(0)->set_size(5);
  EXPECT_TRUE(WorkBehind(assignment, {Release()}));  // nor when the rest of it comes
  EXPECT_FALSE(Finished());
}

// job_lease.h: what is said of another attempt changes nothing, that its events are stored among
// it.
TEST_F(OrderedRuns, StoredEventsOfAnotherAttemptMakeNoRoom) {
  server.window = 5;
  server.stores = false;
  line_ = Joined();
  const v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, "STOP\n");
  JobLease lease(*line_, assignment, stopping, processor_time);
  // Whoever waits for room takes in what comes, up to an order.
  const auto tell = [&](int count, std::int64_t stored_of_fence) {
    v1::WorkResponse stored;
    *stored.mutable_events_stored()->mutable_lease() = Lease(stored_of_fence);
    stored.mutable_events_stored()->set_count(6);
    server.Send(stored);
    server.Send(Order(v1::WorkerControl::KIND_HOLD));
    v1::WorkerEvents events;
    for (int i = 0; i < count; ++i) events.add_events();
    lease.SendEvents(events);
  };
  tell(6, 4);
  EXPECT_EQ(lease.TakeOrders().size(), 1U);
  tell(5, 5);
  EXPECT_FALSE(lease.has_orders());  // the first six are stored: there was room
}

}  // namespace
}  // namespace rmlcell::server
