#include "engine/simulation/trace.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/engine/simulation/fake_run.h"

namespace rmlcell::simulation {
namespace {

using machine::Signal;
using machine::WaitKind;

std::vector<std::string> LinesOf(const Script& script) {
  std::vector<std::string> lines;
  TraceRecorder recorder([&](const TraceRecord& record) {
    EXPECT_EQ(record.number, lines.size() + 1);
    lines.push_back(TraceText(record));
    return true;
  });
  FakeRun run(script, recorder);
  run.Advance(kForever);
  recorder.End(run.state().time, run.outcome());
  return lines;
}

// Issue 2, `--trace`: moves with end point and feed, outputs, beam, dwell, pauses, errors with
// their place, in order.
TEST(Trace, RecordsEverythingObservableInOrder) {
  Script script;
  script.Step(45, 1).Signal(Signal::kOutput, 1, 0, 16).Program("CALL", 2);
  script.Step(2, 3, 8).Signal(Signal::kShutter, 1).Signal(Signal::kBeam, 1, 50);
  script.Wait(WaitKind::kPierce, 1.2, true, 50);
  script.Move({1, -2, 0.5}, 40.0, "LIN").Message("load \"part\"\n");
  script.Find(ErrorCode::kHoleRadiusZero, "radius is 0");
  script.Ends(machine::OutcomeKind::kFailed, ErrorCode::kHoleRadiusZero, "radius is 0");
  const std::vector<std::string> expected = {
      "0.000000 45/1 signal output[16] 1.0",
      "0.000000 45/1 program CALL 2",
      "0.000000 2/3 signal shutter 1.0",
      "0.000000 2/3 signal beam 1.0 power 50.0",
      "1.200000 2/3 wait pierce 1.2",
      "1.200000 2/3 move LIN tip 1.0 -2.0 0.5 A 0.0 B 0.0 point 1.0 -2.0 0.5 feed 40.0",
      "1.200000 2/3 message \"load \\\"part\\\"\\x0a\"",
      "1.200000 2/3 finding program error OPT-E348 \"radius is 0\"",
      "1.200000 2/3 end failed OPT-E348 \"radius is 0\"",
  };
  EXPECT_EQ(LinesOf(script), expected);
}

TEST(Trace, HaltAndResume) {
  Script script;
  script.Step(1, 4).Halt("STOP").Signal(Signal::kSpindle, 1, 4500);
  std::vector<std::string> lines;
  TraceRecorder recorder([&](const TraceRecord& record) {
    lines.push_back(TraceText(record));
    return true;
  });
  FakeRun run(script, recorder, {{FromSeconds(2.0), machine::InputKind::kStart, 0, 1.0}});
  run.Advance(kForever);
  recorder.End(run.state().time, run.outcome());
  const std::vector<std::string> expected = {"0.000000 1/4 halt \"STOP\"", "2.000000 1/4 resume",
                                             "2.000000 1/4 signal spindle 1.0 rpm 4500.0",
                                             "2.000000 0/0 end completed"};
  EXPECT_EQ(lines, expected);
}

// A budget on the number of records; how the run ended is told all the same.
TEST(Trace, IsCutOffAtItsBudget) {
  std::vector<TraceKind> kinds;
  TraceRecorder recorder(
      [&](const TraceRecord& record) {
        kinds.push_back(record.kind);
        return true;
      },
      3);
  Script script;
  for (int k = 0; k < 5; ++k) script.Move({1.0 * k, 0, 0}, 1.0, "LIN");
  FakeRun run(script, recorder);
  run.Advance(kForever);
  recorder.End(run.state().time, run.outcome());
  ASSERT_EQ(kinds.size(), 4u);
  EXPECT_EQ(kinds.back(), TraceKind::kEnd);
  EXPECT_EQ(recorder.dropped(), 2u);
  EXPECT_EQ(recorder.records(), 4u);
}

// A sink that wants no more gets no more.
TEST(Trace, SinkCanClose) {
  int taken = 0;
  TraceRecorder recorder([&](const TraceRecord&) { return ++taken < 2; });
  Script script;
  for (int k = 0; k < 5; ++k) script.Move({}, 1.0, "LIN");
  FakeRun run(script, recorder);
  run.Advance(kForever);
  recorder.End(run.state().time, run.outcome());
  EXPECT_EQ(taken, 2);
  EXPECT_EQ(recorder.dropped(), 3u);
}

}  // namespace
}  // namespace rmlcell::simulation
