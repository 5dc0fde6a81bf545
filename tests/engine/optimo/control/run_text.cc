#include "tests/engine/optimo/control/run_text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/core/number_text.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/language/compiler.h"

namespace rmlcell::optimo::testing {
namespace {

class Listener final : public machine::RunObserver {
 public:
  explicit Listener(Ran& ran) : ran_(ran) {}
  void OnStep(SimTime, const machine::Place& place, std::string_view) override {
    ran_.steps_begun.push_back(place.step);
  }
  void OnMotion(const machine::MotionDone& done) override {
    ran_.parts.push_back({.motion = *done.motion, .done = done});
    ran_.parts.back().done.motion = nullptr;
  }
  void OnMove(const machine::MoveDone& move) override { ran_.moves.push_back(move); }
  void OnSignal(const machine::SignalChange& change) override {
    using machine::Signal;
    const std::string value = TrimmedText(change.value, 3);
    const auto Tell = [&](std::string what) {
      this->Tell(std::move(what), change.at, change.place);
    };
    // What there is but one of has no number, and is on or off where it is no quantity.
    if (change.signal != Signal::kOutput && change.signal != Signal::kAnalogue) {
      EXPECT_EQ(change.index, 0) << static_cast<int>(change.signal);
    }
    if (change.signal == Signal::kBeam || change.signal == Signal::kShutter ||
        change.signal == Signal::kOutput || change.signal == Signal::kSensor) {
      EXPECT_TRUE(change.value == 0.0 || change.value == 1.0) << change.value;
    }
    switch (change.signal) {
      case Signal::kBeam:
        Tell(change.value != 0.0 ? "beam on " + TrimmedText(change.detail, 3) : "beam off");
        break;
      case Signal::kShutter:
        Tell(change.value != 0.0 ? "shutter open" : "shutter closed");
        break;
      case Signal::kSchedule:
        Tell("schedule " + std::to_string(static_cast<int>(change.value)));
        break;
      case Signal::kOutput:
        Tell("OL[" + std::to_string(change.index) + "] " +
             std::to_string(static_cast<int>(change.value)));
        break;
      case Signal::kGas:
        Tell("gas " + std::to_string(static_cast<int>(change.value)));
        break;
      case Signal::kRotaryTable:
        Tell("table " + value);
        break;
      case Signal::kAnalogue:
        Tell("OA[" + std::to_string(change.index) + "] " + value);
        break;
      case Signal::kSensor:
        Tell(change.value != 0.0 ? "sensor on" : "sensor off");
        break;
      default:
        break;
    }
  }
  void OnWait(const machine::Wait& wait) override {
    ran_.waits.push_back(wait);
    const char* kinds[] = {"dwell", "pierce", "spin-up", "condition", "operator", "load"};
    Tell(std::string("wait ") + kinds[static_cast<int>(wait.kind)] + " " +
             TrimmedText(ToSeconds(wait.end - wait.start), 3),
         wait.end, wait.place);
  }
  void OnHalt(const machine::Halt& halt) override {
    Tell("halt " + std::string(halt.why), halt.at, halt.place);
  }
  void OnProgram(SimTime at, const machine::Place& place, std::string_view what,
                 int program) override {
    Tell(std::string(what) + " " + std::to_string(program), at, place);
  }
  void OnMessage(SimTime at, const machine::Place& place, std::string_view text) override {
    Tell(std::string(text), at, place);
  }
  void OnViolation(const machine::TravelViolation& violation) override {
    ran_.violations.push_back(violation);
  }
  void OnDiagnostic(SimTime at, const Diagnostic& diagnostic) override {
    EXPECT_FALSE(diagnostic.detail.starts_with("OPT-")) << diagnostic.detail;
    EXPECT_TRUE(diagnostic.rule.empty() || diagnostic.rule.starts_with("OPT-")) << diagnostic.rule;
    ran_.findings.push_back(diagnostic);
    Tell("E" + std::to_string(Lookup(diagnostic.code).number), at,
         {.program = diagnostic.program, .step = diagnostic.step});
  }

 private:
  void Tell(std::string what, SimTime at, const machine::Place& place) {
    ran_.events.push_back(
        {.what = what, .at_s = ToSeconds(at), .program = place.program, .step = place.step});
    ran_.told.push_back(std::move(what));
  }
  Ran& ran_;
};

machine::Bytes ObjectOf(const std::string& text) {
  Compilation compiled = Compile(text, "test.S", {});
  for (const Diagnostic& diagnostic : compiled.diagnostics) {
    EXPECT_FALSE(IsError(diagnostic.severity)) << FormatDiagnostic(diagnostic, text);
  }
  return machine::Bytes::Of(std::move(compiled.object));
}

}  // namespace

bool Ran::Told(const std::string& what) const { return Count(what) > 0; }
int Ran::Count(const std::string& what) const {
  return static_cast<int>(std::ranges::count(told, what));
}

double Ran::Part::SpeedAt(double t_s) const {
  return motion.speed.At(done.profile_start_s + t_s).speed;
}

double Ran::Part::PowerAt(double t_s) const {
  if (!done.beam_on) return 0.0;
  const double power = done.power.constant_percent + done.power.percent_per_mm_s * SpeedAt(t_s);
  return std::clamp(power, 0.0, 100.0);
}

const Ran::Event& Ran::First(const std::string& what) const {
  const auto found = std::ranges::find(events, what, &Event::what);
  if (found != events.end()) return *found;
  ADD_FAILURE() << "never told: " << what;
  static const Event none;
  return none;
}

const Diagnostic& Ran::Finding(int code) const {
  const auto found = std::ranges::find_if(
      findings, [&](const Diagnostic& one) { return Lookup(one.code).number == code; });
  if (found != findings.end()) return *found;
  ADD_FAILURE() << "never told: " << code;
  static const Diagnostic none{.code = ErrorCode::kLabelNotFound, .severity = Severity::kAdvice};
  return none;
}

double Ran::DistanceTo(const motion::MachinePoint& point) const {
  constexpr int kSamples = 512;  // of a part; the best of them is refined by thirds
  constexpr int kThirds = 80;
  double best = HUGE_VAL;
  for (const Part& part : parts) {
    const auto distance = [&](double s) {
      const motion::PathPiece& path = part.motion.path;
      return (motion::TipOn(path, part.motion.head, path.At(s)).tip - point).norm();
    };
    const double from = part.done.from;
    const double step = (part.done.travelled - from) / kSamples;
    double at = from;
    for (int n = 0; n <= kSamples; ++n) {
      if (distance(from + n * step) < distance(at)) at = from + n * step;
    }
    double low = std::max(from, at - step);
    double high = std::min(part.done.travelled, at + step);
    for (int n = 0; n < kThirds; ++n) {
      const double third = (high - low) / 3.0;
      if (distance(low + third) < distance(high - third)) {
        high -= third;
      } else {
        low += third;
      }
    }
    best = std::min({best, distance(low), distance(at)});
  }
  return best;
}

double Ran::BeamOnLength() const {
  double length = 0.0;
  for (const Part& part : parts) {
    if (part.done.beam_on) length += part.done.travelled - part.done.from;
  }
  return length;
}

machine::RunSetup SetupOf(const std::string& main, const RunOptions& options) {
  const machine::MachineFamily& family = OptimoFamily();
  machine::Parameters parameters(family.parameters());
  for (const machine::MachineProfile& profile : family.profiles()) {
    if (profile.id == options.profile) {
      EXPECT_TRUE(parameters.Apply(profile).ok());
    }
  }
  for (const auto& [name, value] : options.parameters) {
    EXPECT_TRUE(parameters.Set(name, std::string_view(value)).ok()) << name;
  }
  machine::RunSetup setup(parameters);
  setup.programs[1] = {.name = "main", .object = ObjectOf(main), .executable = nullptr};
  for (const auto& [slot, text] : options.programs) {
    setup.programs[slot] = {.name = "further", .object = ObjectOf(text), .executable = nullptr};
  }
  setup.main_program = 1;
  setup.mode = options.mode;
  setup.inputs = options.inputs;
  setup.breakpoint = options.breakpoint;
  setup.simul = options.simul;
  setup.override_percent = options.override_percent;
  setup.budget = options.budget;
  setup.forecast = options.forecast;
  setup.machine_state = options.machine_state;
  setup.schedules = options.schedules;
  for (const auto& [slot, bytes] : options.executables) {
    setup.programs[slot].executable = machine::Bytes::Of(bytes);
  }
  return setup;
}

std::unique_ptr<machine::Run> RunOfText(const std::string& main, const RunOptions& options) {
  static machine::RunObserver nobody;
  Result<std::unique_ptr<machine::Run>> run = OptimoFamily().NewRun(SetupOf(main, options), nobody);
  EXPECT_TRUE(bool(run));
  return *std::move(run);
}

Ran RunText(const std::string& main, const RunOptions& options) {
  Ran ran;
  Listener listener(ran);
  const machine::MachineFamily& family = OptimoFamily();
  machine::RunSetup setup = SetupOf(main, options);
  Result<std::unique_ptr<machine::Run>> run = family.NewRun(std::move(setup), listener);
  if (!run) {
    ADD_FAILURE() << run.error().detail;
    return ran;
  }
  const auto go_on = [&](SimTime until) {
    for (int n = 0; n < 100'000 && (*run)->state().time < until; ++n) {
      const SimTime to = std::min(until, (*run)->state().time + options.slice);
      const machine::RunPhase phase = (*run)->Advance(to);
      if (phase == machine::RunPhase::kFinished) break;
      if (phase == machine::RunPhase::kHalted &&
          (options.inputs.empty() || options.inputs.back().at <= (*run)->state().time)) {
        break;
      }
    }
  };
  if (options.restore_at) {
    go_on(*options.restore_at);
    const std::unique_ptr<machine::RunSnapshot> saved = (*run)->Save();
    const Ran told_before = ran;
    go_on(kForever);
    (*run)->Restore(*saved);
    ran = told_before;
  }
  go_on(kForever);
  ran.outcome = (*run)->outcome();
  ran.end = (*run)->state();
  ran.time_s = ToSeconds(ran.end.time);
  ran.steps = (*run)->steps_executed();
  ran.machine_state = (*run)->SaveMachine();
  ran.executables = (*run)->made_executables();
  for (const std::string& name : options.variables) {
    ran.variables[name] =
        (*run)->ReadVariable(name).value_or(machine::VariableValue{.text = "?"}).text;
  }
  return ran;
}

std::string Value(const std::string& text, const std::string& variable, RunOptions options) {
  options.variables = {variable};
  return RunText(text, options).variables[variable];
}

void ExpectValues(const std::vector<ValueRow>& rows, const RunOptions& options) {
  for (const ValueRow& row : rows) {
    EXPECT_EQ(Value(row.text, row.variable, options), row.wanted) << row.text;
  }
}

int CodeOf(const Ran& ran) { return ran.outcome.code ? Lookup(*ran.outcome.code).number : 0; }

SimTime At(double seconds) { return FromSeconds(seconds); }

}  // namespace rmlcell::optimo::testing
