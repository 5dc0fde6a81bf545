#include "server/worker/job_events.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "engine/core/units.h"

namespace rmlcell::server {
namespace {

using machine::Place;
using machine::Signal;
using std::chrono::milliseconds;
using testing::ElementsAre;

class JobEventsTest : public testing::Test {
 protected:
  std::vector<v1::JobEvent> Sent() {
    std::vector<v1::JobEvent> all;
    for (const v1::WorkerEvents& batch : batches_) {
      all.insert(all.end(), batch.events().begin(), batch.events().end());
    }
    return all;
  }
  void Message(int count) {
    for (int i = 0; i < count; ++i) events_.OnMessage(SimTime(0), {}, "text");
  }

  std::vector<v1::WorkerEvents> batches_;
  JobEvents events_{[this](const v1::WorkerEvents& events) { batches_.push_back(events); }};
};

// server/worker/job_events.h: what people would look for; analogue outputs and sensors change all
// the time.
TEST_F(JobEventsTest, KeepsTheSignalsThatPeopleLookFor) {
  std::set<Signal> kept;
  for (const Signal signal : {Signal::kOutput, Signal::kAnalogue, Signal::kShutter, Signal::kBeam,
                              Signal::kSchedule, Signal::kGas, Signal::kSensor, Signal::kSpindle,
                              Signal::kSpindleSpeed, Signal::kRotaryTable}) {
    batches_.clear();
    events_.OnSignal({.signal = signal});
    events_.Flush();
    if (!batches_.empty()) kept.insert(signal);
  }
  EXPECT_EQ(kept, (std::set{Signal::kOutput, Signal::kShutter, Signal::kBeam, Signal::kSchedule,
                            Signal::kGas, Signal::kSpindle, Signal::kSpindleSpeed,
                            Signal::kRotaryTable}));
}

TEST_F(JobEventsTest, TellsAllOfASignal) {
  events_.OnSignal({.at = milliseconds(1500),
                    .place = {.program = 45, .step = 7},
                    .signal = Signal::kBeam,
                    .index = 3,
                    .value = 1.0,
                    .detail = 80.0});
  events_.Flush();
  ASSERT_EQ(Sent().size(), 1U);
  const v1::JobEvent event = Sent().front();
  EXPECT_EQ(event.virtual_time_ns(), 1'500'000'000);
  EXPECT_EQ(event.signal().kind(), v1::SIGNAL_KIND_BEAM);
  EXPECT_EQ(event.signal().place().program(), 45);
  EXPECT_EQ(event.signal().place().step(), 7);
  EXPECT_EQ(event.signal().name(), "beam");
  EXPECT_EQ(event.signal().index(), 3);
  EXPECT_EQ(event.signal().value(), 1.0);
  EXPECT_EQ(event.signal().detail(), 80.0);
}

TEST_F(JobEventsTest, TellsOfEachKind) {
  events_.OnHalt({.at = milliseconds(1),
                  .place = {.program = 45, .step = 6},
                  .reason = machine::HaltReason::kStop,
                  .why = "STOP"});
  events_.OnResume(milliseconds(2), {.program = 45, .step = 7});
  events_.OnProgram(milliseconds(3), {}, "call", 44);
  events_.OnMessage(milliseconds(4), {.program = 45, .step = 8}, "hello");
  events_.OnDiagnostic(milliseconds(5),
                       {.code = ErrorCode::kHoleRadiusZero, .detail = "radius is 0"});
  events_.OnProgram(milliseconds(6), {}, machine::kCompiling, 45);
  events_.Flush();
  const std::vector<v1::JobEvent> sent = Sent();
  ASSERT_EQ(sent.size(), 6U);
  EXPECT_EQ(sent[0].halted().reason(), v1::HOLD_REASON_STOP);
  EXPECT_EQ(sent[0].halted().message(), "STOP");
  EXPECT_EQ(sent[0].halted().place().step(), 6);
  EXPECT_EQ(sent[1].resumed().place().step(), 7);
  EXPECT_EQ(sent[2].program_loaded().program(), 44);
  EXPECT_EQ(sent[3].message().text(), "hello");
  EXPECT_EQ(sent[3].message().place().step(), 8);
  EXPECT_EQ(sent[4].diagnostic().code(), "OPT-E348");
  EXPECT_EQ(sent[5].executable_made().program(), 45);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(sent[static_cast<std::size_t>(i)].virtual_time_ns(), (i + 1) * 1'000'000);
  }
}

TEST_F(JobEventsTest, TellsWhyARunHalts) {
  const auto told = [&](machine::HaltReason reason) {
    events_.OnHalt({.reason = reason});
    return Sent().back().halted().reason();
  };
  EXPECT_EQ(told(machine::HaltReason::kHold), v1::HOLD_REASON_HOLD);
  EXPECT_EQ(told(machine::HaltReason::kStop), v1::HOLD_REASON_STOP);
  EXPECT_EQ(told(machine::HaltReason::kProgram), v1::HOLD_REASON_PROGRAM);
  EXPECT_EQ(told(machine::HaltReason::kBreakpoint), v1::HOLD_REASON_BREAKPOINT);
  EXPECT_EQ(told(machine::HaltReason::kSingle), v1::HOLD_REASON_SINGLE);
}

TEST_F(JobEventsTest, TellsWhatASignalIsOf) {
  const auto told = [&](Signal signal) {
    events_.OnSignal({.signal = signal});
    events_.Flush();
    return Sent().back().signal().kind();
  };
  EXPECT_EQ(told(Signal::kOutput), v1::SIGNAL_KIND_LOGICAL_OUTPUT);
  EXPECT_EQ(told(Signal::kShutter), v1::SIGNAL_KIND_SHUTTER);
  EXPECT_EQ(told(Signal::kBeam), v1::SIGNAL_KIND_BEAM);
  EXPECT_EQ(told(Signal::kSchedule), v1::SIGNAL_KIND_SCHEDULE);
  EXPECT_EQ(told(Signal::kGas), v1::SIGNAL_KIND_GAS);
  EXPECT_EQ(told(Signal::kSpindle), v1::SIGNAL_KIND_SPINDLE);
  EXPECT_EQ(told(Signal::kSpindleSpeed), v1::SIGNAL_KIND_SPINDLE);
  EXPECT_EQ(told(Signal::kRotaryTable), v1::SIGNAL_KIND_OTHER);
}

// Whoever watches a halted job sees that at once; the rest goes in company.
TEST_F(JobEventsTest, SendsInBatchesAndHaltsAtOnce) {
  Message(JobEvents::kBatch - 1);
  EXPECT_TRUE(batches_.empty());
  Message(1);
  ASSERT_EQ(batches_.size(), 1U);
  EXPECT_EQ(batches_[0].events_size(), 64);
  Message(2);
  EXPECT_EQ(batches_.size(), 1U);
  events_.OnHalt({.why = "HOLD"});
  ASSERT_EQ(batches_.size(), 2U);
  EXPECT_EQ(batches_[1].events_size(), 3);
  events_.OnResume(SimTime(0), {});
  EXPECT_EQ(batches_.size(), 3U);
  events_.Flush();
  EXPECT_EQ(batches_.size(), 3U);  // nothing is left
}

// At most 10,000, then one that says so; what somebody ordered is told nevertheless.
TEST_F(JobEventsTest, CutsALongLogAndSaysSo) {
  Message(10'000);
  events_.Flush();
  EXPECT_EQ(Sent().size(), 10'000U);
  EXPECT_EQ(Sent().back().message().text(), "text");
  Message(100);
  events_.OnHalt({.why = "HOLD"});
  events_.OnResume(SimTime(0), {});
  Message(100);
  events_.Flush();
  const std::vector<v1::JobEvent> sent = Sent();
  ASSERT_EQ(sent.size(), 10'003U);
  EXPECT_EQ(sent[10'000].message().text().substr(0, 13), "more happened");
  EXPECT_EQ(sent[10'001].halted().message(), "HOLD");
  EXPECT_TRUE(sent[10'002].has_resumed());
}

// A finding is told once for each place that it is about: five places of a code at once, the others
// in one event at the end.
TEST_F(JobEventsTest, GathersFindingsOfOneKind) {
  const Diagnostic first{.code = ErrorCode::kHoleRadiusZero,
                         .where = {.line = 3, .column = 4},
                         .program = 1,
                         .step = 2};
  const auto changed = [&](auto change) {
    Diagnostic other = first;
    change(other);
    return other;
  };
  const std::vector<Diagnostic> different = {
      first,
      changed([](Diagnostic& d) { d.code = ErrorCode::kLiteralRange; }),
      changed([](Diagnostic& d) { d.program = 2; }),
      changed([](Diagnostic& d) { d.step = 3; }),
      changed([](Diagnostic& d) { d.where.line = 4; }),
      changed([](Diagnostic& d) { d.where.column = 5; })};
  for (int twice = 0; twice < 2; ++twice) {
    for (const Diagnostic& finding : different) events_.OnDiagnostic(SimTime(0), finding);
  }
  events_.OnDiagnostic(milliseconds(9), changed([](Diagnostic& d) { d.detail = "again"; }));
  events_.Flush();
  EXPECT_EQ(Sent().size(), different.size());
  for (int step = 10; step < 210; ++step) {
    events_.OnDiagnostic(milliseconds(step), changed([&](Diagnostic& d) {
                           d.step = step;
                           d.where.line = step;
                         }));
  }
  events_.Flush();
  EXPECT_EQ(Sent().size(), different.size());  // five of this code were told
  // Another kind is not held back by the first one.
  events_.OnDiagnostic(milliseconds(300), {.code = ErrorCode::kCellWaitsForever, .step = 1});
  events_.TellRest();
  events_.Flush();
  std::vector<v1::JobEvent> sent = Sent();
  ASSERT_EQ(sent.size(), different.size() + 2);
  EXPECT_EQ(sent[different.size()].diagnostic().code(), "CELL-E9308");
  const v1::JobEvent rest = sent.back();
  EXPECT_EQ(rest.virtual_time_ns(), 209'000'000);  // when the last of them was made
  EXPECT_EQ(rest.gathered().code(), "OPT-E348");
  EXPECT_EQ(rest.gathered().count(), 200);
  EXPECT_EQ(rest.gathered().first().line(), 10);
  EXPECT_EQ(rest.gathered().last().line(), 209);
  EXPECT_FALSE(rest.gathered().advice().empty());
  events_.TellRest();  // once
  events_.Flush();
  EXPECT_EQ(Sent().size(), different.size() + 2);
}

// Five are no crowd.
TEST_F(JobEventsTest, FewFindingsAreToldEach) {
  for (int step = 1; step <= 5; ++step)
    events_.OnDiagnostic(SimTime(0), {.code = ErrorCode::kHoleRadiusZero, .step = step});
  events_.TellRest();
  events_.Flush();
  ASSERT_EQ(Sent().size(), 5U);
  EXPECT_TRUE(Sent().back().has_diagnostic());
}

}  // namespace
}  // namespace rmlcell::server
