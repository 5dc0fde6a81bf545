#include <gtest/gtest.h>

#include <random>

#include "tests/engine/optimo/control/run_text.h"

// Random programs of valid statements, with random inputs and keys: always an outcome, and the same
// one however time is divided and whether or not the run is saved and restored on the way.
namespace rmlcell::optimo::testing {
namespace {

constexpr int kPrograms = 300;
constexpr int kCalled = 2;  // slots 2 and 3: CALL and FUNCTION

class Generator {
 public:
  explicit Generator(unsigned seed) : random_(seed) {}

  std::string Program(bool main) {
    std::string text =
        "COORD ABSOL\nPATH LIN\nWORKDEF 1,0 (8.,75.,.2,50.)\nWORKDEF 2,0 (11)\nERR 900\n";
    const int lines = 5 + Below(25);
    for (int n = 0; n < lines; ++n) {
      if (n % 4 == 0) text += std::to_string(10 * (n / 4 + 1)) + " ";
      text += Statement(main, lines) + "\n";
    }
    return text +
           "WORK 0,0/OFF\nWORK 1,0/OFF\nENDTASK\n800 VI[7]=VI[7]+1\nRETURN\n900 VI[8]=VI[8]+1\n" +
           (Below(2) == 0 ? "ERR 900\n" : "") + "DELAY .1\n";
  }

  machine::InputScript Inputs() {
    using machine::InputKind;
    machine::InputScript script;
    for (int at_ms = 300; at_ms < 14'000; at_ms += 1 + Below(900)) {
      machine::InputChange change{.at = std::chrono::milliseconds(at_ms)};
      switch (Below(9)) {
        case 0:
          change.kind = InputKind::kHold;
          break;
        case 1:
          change.kind = InputKind::kStop;
          break;
        case 2:
          change = {change.at, InputKind::kOverride, 0, 10.0 + Below(140)};
          break;
        case 3:
          change = {change.at, InputKind::kDoor, 0, static_cast<double>(Below(8) == 0)};
          break;
        case 4:
        case 5:
          change = {change.at, InputKind::kLogical, 20 + Below(3), static_cast<double>(Below(2))};
          break;
        default:
          change.kind = InputKind::kStart;
          break;
      }
      script.push_back(change);
    }
    return script;
  }

  int Below(int limit) { return static_cast<int>(random_() % static_cast<unsigned>(limit)); }

 private:
  std::string Number(int low, int high) { return std::to_string(low + Below(high - low)) + "."; }
  std::string Point() {
    return "(" + Number(900, 1100) + "," + Number(900, 1100) + "," + Number(-450, -400) + "," +
           (Below(4) == 0 ? "0.3,0.2)" : "0.,0.)");
  }
  std::string Condition() {
    switch (Below(5)) {
      case 0:
        return "IL[" + std::to_string(20 + Below(3)) + "]";
      case 1:
        return "NOT IL[95]";
      case 2:
        return "VI[7] > " + std::to_string(Below(4));
      case 3:
        return "VL[1] XOR IL[87]";
      default:
        return "VR[1] / VR[" + std::to_string(1 + Below(3)) + "] < 2.";
    }
  }
  std::string Label(int lines) { return std::to_string(10 * (1 + Below(lines / 4 + 2))); }

  std::string Move() {
    std::string move = "MOVE " + Point();
    if (Below(6) == 0) move += "/VIA " + Point();
    if (Below(2) == 0) move += "/FLY";
    if (Below(8) == 0) move += "/START (" + Condition() + ")";
    if (Below(8) == 0) move += "/END (" + Condition() + ")";
    if (Below(8) == 0) move += "/TIME (." + std::to_string(1 + Below(9)) + ",800)";
    if (Below(8) == 0) move += "/NEXT";
    return move;
  }
  std::string Work() {
    std::string work = "WORK " + std::to_string(Below(3)) + ",0/" + (Below(2) == 0 ? "ON" : "OFF");
    if (Below(4) == 0) work += "/START (" + Condition() + ")";
    if (Below(4) == 0) work += "/END (" + Condition() + ")";
    if (Below(3) == 0) work += "/NEXT";
    return work;
  }
  std::string Statement(bool main, int lines) {
    switch (Below(26)) {
      case 0:
      case 1:
      case 2:
      case 3:
      case 4:
      case 5:
      case 6:
        return Move();
      case 7:
      case 8:
        return Work();
      case 9:
        return "SPEED " + std::to_string(Below(60));
      case 10:
        return "OVERSH " + std::to_string(Below(101));
      case 11:
        return "PATH " + std::string(Below(3) == 0 ? "CIR" : Below(2) == 0 ? "HOLE (8.)" : "LIN");
      case 12:
        return "PATH " + std::string(Below(2) == 0 ? "PTP" : "LIN");
      case 13:
        return "COORD " + std::string(Below(8) == 0 ? "ROBOT" : "ABSOL");
      case 14:
        return "DELAY ." + std::to_string(Below(6));
      case 15:
        return "VR[1]=VR[2]+" + Number(0, 9);
      case 16:
        return "VI[7]=VI[7]+1";
      case 17:
        return "OL[16]=" + std::string(Below(2) == 0 ? "ON" : "NOT OL[16]");
      case 18:
        return "IF " + Condition() + " THEN " + Label(lines);
      case 19:
        return "GOSUB 800";
      case 20:
        return "VR[2]=IA[" + std::to_string(Below(5)) + "]";
      case 21:
        return "TIMER (." + std::to_string(1 + Below(9)) + ",800)" + (Below(2) == 0 ? "/AUTO" : "");
      case 22:
        return main ? "FUNCTION " + std::to_string(2 + Below(kCalled)) : "VL[1]=NOT VL[1]";
      case 23:
        return main ? "CALL " + std::to_string(2 + Below(kCalled))
                    : "UPDATE OL /" + std::string(Below(2) == 0 ? "ON" : "OFF");
      case 24:
        return Below(3) == 0 ? "STOP" : "SYSDEF (" + Number(0, 50) + ",0,0,.1,0,0)";
      default:
        return Below(6) == 0 ? "GOTO " + Label(lines) : "WAIT " + Condition();
    }
  }

  std::mt19937 random_;  // the same numbers everywhere; distributions are not
};

void ExpectSame(const Ran& a, const Ran& b, const std::string& how) {
  ASSERT_EQ(a.told, b.told) << how;
  for (std::size_t n = 0; n < a.events.size(); ++n) {
    ASSERT_EQ(a.events[n].at_s, b.events[n].at_s) << how << ": " << a.events[n].what;
  }
  EXPECT_EQ(a.outcome.kind, b.outcome.kind) << how;
  EXPECT_EQ(a.outcome.code, b.outcome.code) << how;
  EXPECT_EQ(a.outcome.place, b.outcome.place) << how;
  EXPECT_EQ(a.steps, b.steps) << how;
  EXPECT_EQ(a.machine_state, b.machine_state) << how;
  ASSERT_EQ(a.parts.size(), b.parts.size()) << how;
  for (std::size_t n = 0; n < a.parts.size(); ++n) {
    ASSERT_EQ(a.parts[n].done.start, b.parts[n].done.start) << how;
    ASSERT_EQ(a.parts[n].done.travelled, b.parts[n].done.travelled) << how;
  }
}

TEST(Hostile, RandomProgramsHaveOneOutcome) {
  int completed = 0;
  int failed = 0;
  for (unsigned seed = 1; seed <= kPrograms; ++seed) {
    Generator generator(seed);
    const std::string main = generator.Program(true);
    RunOptions options;
    for (int slot = 2; slot < 2 + kCalled; ++slot)
      options.programs[slot] = generator.Program(false);
    if (generator.Below(2) == 0) options.inputs = generator.Inputs();
    options.mode = generator.Below(5) == 0 ? machine::Mode::kRepeat : machine::Mode::kCycle;
    options.budget = {.steps = 1000, .virtual_time = std::chrono::seconds(15)};
    SCOPED_TRACE("seed " + std::to_string(seed) + "\n" + main);

    const Ran whole = RunText(main, options);
    completed += whole.outcome.kind == machine::OutcomeKind::kCompleted ? 1 : 0;
    failed += whole.outcome.code.has_value() ? 1 : 0;
    EXPECT_LE(whole.end.time, options.budget.virtual_time);
    SimTime told_until{0};
    for (const Ran::Part& part : whole.parts) {  // motions never overlap, and time never runs back
      EXPECT_GE(part.done.start, told_until);
      told_until = part.done.end;
    }
    for (const int slice_ms : {1, 10}) {
      RunOptions sliced = options;
      sliced.slice = std::chrono::milliseconds(slice_ms);
      ExpectSame(whole, RunText(main, sliced), std::to_string(slice_ms) + " ms");
    }
    RunOptions restored = options;
    restored.restore_at = FromSeconds(whole.time_s * generator.Below(10) / 10.0);
    ExpectSame(whole, RunText(main, restored), "restored");
    if (HasFailure()) return;  // the first one tells enough
  }
  // The programs are neither all good nor all bad.
  EXPECT_GT(completed, kPrograms / 10);
  EXPECT_GT(failed, kPrograms / 10);
}

}  // namespace
}  // namespace rmlcell::optimo::testing
