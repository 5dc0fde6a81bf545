// What a recorder passes on and says of its products, and in which order time that nobody told
// about is counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/simulation/report/time_ledger.h"
#include "engine/simulation/run/recorder.h"
#include "engine/simulation/verdict/verdict.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/laser_shape.h"
#include "tests/engine/simulation/verdict_text.h"

namespace rmlcell::simulation {
namespace {

std::string WhenAndWhere(SimTime at, const machine::Place& place) {
  return std::to_string(at.count()) + '@' + std::to_string(place.program) + '/' +
         std::to_string(place.step) + ' ';
}

// Writes down what it is told with everything that belongs to it.
class WholeListener final : public machine::RunObserver {
 public:
  std::vector<std::string> heard;

  void OnStep(SimTime at, const machine::Place& place, std::string_view instruction) override {
    heard.push_back("step " + WhenAndWhere(at, place) + std::string(instruction));
  }
  void OnResume(SimTime at, const machine::Place& place) override {
    heard.push_back("resume " + WhenAndWhere(at, place));
  }
  void OnEntered(SimTime at) override { heard.push_back("entered " + WhenAndWhere(at, {})); }
  void OnProgram(SimTime at, const machine::Place& place, std::string_view what,
                 int program) override {
    heard.push_back("program " + WhenAndWhere(at, place) + std::string(what) +
                    std::to_string(program));
  }
  void OnMessage(SimTime at, const machine::Place& place, std::string_view text) override {
    heard.push_back("message " + WhenAndWhere(at, place) + std::string(text));
  }
  void OnViolation(const machine::TravelViolation& violation) override {
    heard.push_back("violation " + WhenAndWhere(violation.at, violation.place));
  }
  void OnLost(const machine::LostWay& way) override {
    heard.push_back("lost " + WhenAndWhere(way.at, way.place));
  }
  void OnDiagnostic(SimTime at, const Diagnostic& found) override {
    heard.push_back("found " + WhenAndWhere(at, {.step = found.step}));
  }
  void OnCounted(SimTime at, const Diagnostic& found) override {
    heard.push_back("counted " + WhenAndWhere(at, {.step = found.step}));
  }
  void OnAssumed(const machine::Assumed& assumed) override {
    heard.push_back("assumed " + std::string(assumed.group) + std::to_string(assumed.index));
  }
};

TEST(RunProducts, WhatIsToldIsPassedOnWhole) {
  WholeListener listener;
  Recorder recorder({}, {}, {.also = &listener});
  const machine::Place place{.program = 7, .step = 3};
  recorder.OnStep(SimTime(11), place, "MOVE");
  recorder.OnResume(SimTime(12), place);
  recorder.OnEntered(SimTime(13));
  recorder.OnProgram(SimTime(14), place, "CALL", 44);
  recorder.OnMessage(SimTime(15), place, "hello");
  recorder.OnViolation({.at = SimTime(16), .place = place});
  recorder.OnLost({.at = SimTime(17), .place = place});
  Diagnostic found{.code = ErrorCode::kShortFly, .severity = Severity::kWarning};
  found.step = 5;
  recorder.OnDiagnostic(SimTime(18), found);
  found.step = 6;
  recorder.OnCounted(SimTime(19), found);
  recorder.OnAssumed({.group = "VR", .index = 9});
  EXPECT_EQ(listener.heard,
            (std::vector<std::string>{"step 11@7/3 MOVE", "resume 12@7/3 ", "entered 13@0/0 ",
                                      "program 14@7/3 CALL44", "message 15@7/3 hello",
                                      "violation 16@7/3 ", "lost 17@7/3 ", "found 18@0/5 ",
                                      "counted 19@0/6 ", "assumed VR9"}));
}

Script LinesOfThreeSteps() {
  Script script;
  script.Step(1, 1).Line({}, {1, 0, 0}).Step(1, 2).Line({1, 0, 0}, {1, 2, 0});
  script.Step(1, 3).Line({1, 2, 0}, {4, 2, 0}).Move({4, 2, 0}, 50, "LIN");
  return script;
}

TEST(RunProducts, AreSaidToBeMadeAndComplete) {
  int records = 0, samples = 0;
  std::uint64_t bytes = 0;
  Products products;
  products.trace = [&](const TraceRecord&) { return ++records > 0; };
  products.toolpath = [&](std::string_view block) { return (bytes += block.size()) > 0; };
  products.samples = [&](std::string_view) { return ++samples > 0; };
  products.picture = products.plot = true;
  Recorder recorder(Laser(), {}, std::move(products));
  FakeRun run(LinesOfThreeSteps(), recorder);
  recorder.Begin(run);
  run.Advance(kForever);
  EXPECT_EQ(bytes, 0U);
  EXPECT_NE(recorder.OpenToolpathBlock(), "");
  recorder.Finish(run);
  EXPECT_EQ(recorder.OpenToolpathBlock(), "");
  const RunReport report = recorder.Report(run);
  EXPECT_EQ(report.trace, (ProductState{.made = true, .complete = true, .records = 2}));
  EXPECT_EQ(report.toolpath,
            (ProductState{.made = true, .complete = true, .records = 4, .bytes = bytes}));
  EXPECT_GT(bytes, 0U);
  EXPECT_EQ(report.picture, (ProductState{.made = true, .complete = true, .records = 3}));
  EXPECT_EQ(records, 2);  // the move and the end
  EXPECT_GT(samples, 0);
  EXPECT_FALSE(recorder.cut_off());
  ASSERT_NE(recorder.Values(run.state().time), nullptr);
  EXPECT_NE(recorder.PlotSvg(report, {}).find("<svg"), std::string::npos);
  EXPECT_EQ(recorder.milling(), nullptr);
}

// A toolpath that is refused, or that has no room, is cut off.
TEST(RunProducts, AToolpathWithoutRoomIsCutOff) {
  for (const bool refused : {false, true}) {
    Products products;
    products.toolpath = [&](std::string_view) { return !refused; };
    if (!refused) products.toolpath_options.bytes_max = 10;
    Recorder recorder(Laser(), {}, std::move(products));
    FakeRun run(LinesOfThreeSteps(), recorder);
    run.Advance(kForever);
    EXPECT_FALSE(recorder.cut_off());
    EXPECT_TRUE(recorder.Report(run).toolpath.complete);
    recorder.Finish(run);
    EXPECT_TRUE(recorder.cut_off()) << refused;
    EXPECT_FALSE(recorder.Report(run).toolpath.complete) << refused;
    EXPECT_EQ(recorder.Report(run).toolpath.bytes, 0U);
    EXPECT_FALSE(recorder.Report(run).trace.made);
    EXPECT_EQ(recorder.Values(run.state().time), nullptr);
    EXPECT_EQ(recorder.PlotSvg(recorder.Report(run), {}), "");
  }
}

// Sixteen gaps stay open: with each further one the oldest is counted, so that they come in the
// order of time, whole and at their own place.
TEST(RunProducts, GapsAreCountedInTheOrderOfTime) {
  std::vector<TimeLedger::Gap> counted;
  TimeLedger ledger([&](const TimeLedger::Gap& gap) { counted.push_back(gap); });
  for (int k = 0; k < 40; ++k) {
    EXPECT_EQ(counted.size(), k > 16 ? k - 16U : 0U) << k;
    TimeLedger::Gap now;
    now.place.step = k + 1;
    ledger.Claim(SimTime(100 * k + 30 + k), SimTime(100 * k + 100), now);
  }
  ledger.Close();
  ASSERT_EQ(counted.size(), 40U);
  for (int k = 0; k < 40; ++k) {
    const TimeLedger::Gap& gap = counted[static_cast<std::size_t>(k)];
    EXPECT_EQ(gap.place.step, k + 1);
    EXPECT_EQ(gap.start, SimTime(100 * k)) << k;
    EXPECT_EQ(gap.end, SimTime(100 * k + 30 + k)) << k;
  }
  EXPECT_EQ(ledger.counted(), SimTime(4000));
  ledger.Close();  // nothing is left
  EXPECT_EQ(counted.size(), 40U);
}

// Each product is told of the motions as if it watched alone.
TEST(RunProducts, EachIsAsIfItWatchedAlone) {
  std::string together, alone;
  const auto into = [](std::string& text) {
    return [&text](std::string_view lines) {
      text += lines;
      return true;
    };
  };
  Products products;
  products.plot = true;
  products.samples = into(together);
  products.samples_hz = 10.0;
  Recorder recorder(Laser(), {}, std::move(products));
  FakeRun run(LinesOfThreeSteps(), recorder);
  recorder.Begin(run);
  SampleRecorder samples(Laser(), 10.0, into(alone));
  FakeRun sampled(LinesOfThreeSteps(), samples);
  samples.StandsAt(sampled.state().tip, sampled.state().axes);
  PlotRecorder plot(Laser());
  FakeRun plotted(LinesOfThreeSteps(), plot);
  for (FakeRun* each : {&run, &sampled, &plotted}) each->Advance(kForever);
  recorder.Finish(run);
  samples.Finish(sampled.state().time);
  EXPECT_GT(samples.lines(), 3U);
  EXPECT_EQ(together, alone);
  const RunReport report = recorder.Report(run);
  EXPECT_EQ(recorder.PlotSvg(report, {}), plot.Svg(report, {}));
}

// A run that goes on is not judged yet; at its end it is, and what is not told singly is marked as
// other findings are.
TEST(RunProducts, OnTheWayNothingIsJudged) {
  constexpr ErrorCode kFault = ErrorCode::kHoleRadiusZero;
  Script script;
  script.Step(1, 1).Nothing(2.0).Ends(machine::OutcomeKind::kFailed, kFault, "radius is 0");
  Recorder recorder({}, {}, {});
  FakeRun run(script, recorder);
  recorder.Begin(run);
  run.Advance(FromSeconds(1.0));
  recorder.OnViolation({.place = {.program = 1, .step = 1}, .axis = 0, .excess = 2.0});
  recorder.OnCounted(SimTime(0), {.code = kFault, .severity = Lookup(kFault).severity});
  const auto marked = [&](const RunReport& report) {
    return report.findings_dropped.kinds().at(kFault).judged;
  };
  const RunReport before = recorder.Report(run);
  EXPECT_EQ(before.judgement, machine::Judgement{});
  EXPECT_EQ(marked(before), Judged::kNo);
  run.Advance(kForever);
  recorder.Finish(run);
  const RunReport after = recorder.Report(run);
  EXPECT_EQ(after.judgement.verdict, machine::Verdict::kBad);
  EXPECT_EQ(std::ranges::count(after.judgement.reasons, ErrorCode::kCellTravelLeft,
                               &machine::Reason::code),
            1);
  EXPECT_EQ(marked(after), Judged::kBad);
}

// A run that somebody ended, with a word alone, is one that waits: of no part is known more.
TEST(RunProducts, AnEndWithoutACodeIsAWait) {
  const auto said = [](machine::OutcomeKind kind) {
    return TextOf(JudgeOutcome(
        {.kind = kind, .detail = "emergency stop", .place = {.program = 1, .step = 7}}));
  };
  const std::string reason = "; " + CodeText(ErrorCode::kCellWaitsForever) + " emergency stop @7";
  EXPECT_EQ(said(machine::OutcomeKind::kStopped), "DOUBTFUL" + reason);
  EXPECT_EQ(said(machine::OutcomeKind::kFailed), "BAD" + reason);
}

}  // namespace
}  // namespace rmlcell::simulation
