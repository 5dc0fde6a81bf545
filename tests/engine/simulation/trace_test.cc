#include "engine/simulation/report/trace.h"

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

// Each signal and each kind of wait has its word; only an output and an analogue value have an
// index, only a beam and a spindle that are on their power and speed.
TEST(Trace, SignalsAndWaitsHaveWords) {
  Script script;
  script.Step(1, 2)
      .Signal(Signal::kAnalogue, 3.5, 9, 5)
      .Signal(Signal::kShutter, 1, 9, 5)
      .Signal(Signal::kBeam, 0, 9)
      .Signal(Signal::kSchedule, 11, 9)
      .Signal(Signal::kGas, 2, 9)
      .Signal(Signal::kSensor, 1, 9)
      .Signal(Signal::kSpindle, 0, 9)
      .Signal(Signal::kSpindleSpeed, 4500, 9)
      .Signal(Signal::kRotaryTable, 90, 9);
  for (const WaitKind kind : {WaitKind::kDwell, WaitKind::kPierce, WaitKind::kSpinUp,
                              WaitKind::kCondition, WaitKind::kOperator, WaitKind::kLoad}) {
    script.Wait(kind, 1.0);
  }
  const std::vector<std::string> expected = {"0.000000 1/2 signal analogue[5] 3.5",
                                             "0.000000 1/2 signal shutter 1.0",
                                             "0.000000 1/2 signal beam 0.0",
                                             "0.000000 1/2 signal schedule 11.0",
                                             "0.000000 1/2 signal gas 2.0",
                                             "0.000000 1/2 signal sensor 1.0",
                                             "0.000000 1/2 signal spindle 0.0",
                                             "0.000000 1/2 signal spindle_speed 4500.0",
                                             "0.000000 1/2 signal rotary_table 90.0",
                                             "1.000000 1/2 wait dwell 1.0",
                                             "2.000000 1/2 wait pierce 1.0",
                                             "3.000000 1/2 wait spin_up 1.0",
                                             "4.000000 1/2 wait condition 1.0",
                                             "5.000000 1/2 wait operator 1.0",
                                             "6.000000 1/2 wait load 1.0",
                                             "6.000000 0/0 end completed"};
  EXPECT_EQ(LinesOf(script), expected);
}

// What a record holds: of a move all that was told of it, of a finding its code, severity and
// place.
TEST(Trace, RecordsHoldWhatWasTold) {
  std::vector<TraceRecord> records;
  TraceRecorder recorder([&](const TraceRecord& record) {
    records.push_back(record);
    return true;
  });
  recorder.OnMove({.at = SimTime(5),
                   .place = {.program = 1, .step = 2, .line = 3, .byte_offset = 4},
                   .tip = {{1, 2, 3}, 0.25, 0.5},
                   .axes = {{4, 5, 6}, 0.25, 0.5},
                   .program_point = {7, 8, 9},
                   .rotary_a = 0.75,
                   .feed_mm_s = 40.0,
                   .path = "LIN"});
  recorder.OnDiagnostic(SimTime(6), {.code = ErrorCode::kSpeedLimited,
                                     .severity = Severity::kWarning,
                                     .detail = "120 %",
                                     .where = {.line = 8, .byte_offset = 9},
                                     .program = 45,
                                     .step = 7});
  recorder.OnWait({.start = SimTime(6), .end = SimTime(10), .kind = WaitKind::kDwell});
  recorder.End(SimTime(11), {.kind = machine::OutcomeKind::kFailed,
                             .code = ErrorCode::kHoleRadiusZero,
                             .detail = "radius",
                             .place = {.program = 3, .step = 4}});
  ASSERT_EQ(records.size(), 4u);
  EXPECT_EQ(records[0].at, SimTime(5));
  EXPECT_EQ(records[0].place.byte_offset, 4);
  EXPECT_EQ(records[0].axes.column, (motion::MachineVector{4, 5, 6}));
  EXPECT_EQ(records[0].program_a, 0.75);
  EXPECT_EQ(records[0].program_b, 0.5);
  EXPECT_EQ(records[1].place.program, 45);
  EXPECT_EQ(records[1].place.step, 7);
  EXPECT_EQ(records[1].place.line, 8);
  EXPECT_EQ(records[1].place.byte_offset, 9);
  EXPECT_EQ(records[1].code, ErrorCode::kSpeedLimited);
  EXPECT_EQ(records[1].severity, Severity::kWarning);
  EXPECT_EQ(records[2].at, SimTime(10));
  EXPECT_EQ(records[2].duration, SimTime(4));
  EXPECT_FALSE(records[2].code.has_value());
  EXPECT_EQ(records[3].severity, Lookup(ErrorCode::kHoleRadiusZero).severity);
  EXPECT_EQ(records[3].place.step, 4);
  EXPECT_EQ(records[3].number, 4u);
}

// A backslash and what is no text are written so that they can be read back.
TEST(Trace, WordsAreQuoted) {
  Script script;
  script.Message(std::string("a\\b\x1f\x7f~ ") + '\x01');
  EXPECT_EQ(LinesOf(script)[0], "0.000000 0/0 message \"a\\\\b\\x1f\\x7f~ \\x01\"");
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

// The end is the last record.
TEST(Trace, NothingComesBehindTheEnd) {
  std::vector<TraceKind> kinds;
  TraceRecorder recorder([&](const TraceRecord& record) {
    kinds.push_back(record.kind);
    return true;
  });
  recorder.OnMessage(SimTime(5), {}, "in time");
  recorder.End(SimTime(6), {});
  recorder.OnMessage(SimTime(7), {}, "late");
  recorder.End(SimTime(8), {});
  EXPECT_EQ(kinds, (std::vector<TraceKind>{TraceKind::kMessage, TraceKind::kEnd}));
  EXPECT_EQ(recorder.records(), 2u);
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
