#include "tests/engine/optimo/control/run_text.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/core/number_text.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/language/compiler.h"

namespace rmlcell::optimo::testing {
namespace {

class Listener final : public machine::RunObserver {
 public:
  explicit Listener(Ran& ran) : ran_(ran) {}
  void OnMove(const machine::MoveDone& move) override { ran_.moves.push_back(move); }
  void OnSignal(const machine::SignalChange& change) override {
    using machine::Signal;
    const std::string value = TrimmedText(change.value, 3);
    switch (change.signal) {
      case Signal::kBeam:
        Tell(change.value != 0.0 ? "beam on " + TrimmedText(change.detail, 3) : "beam off");
        break;
      case Signal::kShutter: Tell(change.value != 0.0 ? "shutter open" : "shutter closed"); break;
      case Signal::kSchedule: Tell("schedule " + std::to_string(static_cast<int>(change.value))); break;
      case Signal::kOutput: Tell("OL[" + std::to_string(change.index) + "] " + std::to_string(static_cast<int>(change.value))); break;
      case Signal::kGas: Tell("gas " + std::to_string(static_cast<int>(change.value))); break;
      case Signal::kRotaryTable: Tell("table " + value); break;
      default: break;
    }
  }
  void OnWait(const machine::Wait& wait) override {
    const char* kinds[] = {"dwell", "pierce", "spin-up", "condition", "operator", "load"};
    Tell(std::string("wait ") + kinds[static_cast<int>(wait.kind)] + " " + TrimmedText(ToSeconds(wait.end - wait.start), 3));
  }
  void OnHalt(const machine::Halt& halt) override { Tell("halt " + std::string(halt.why)); }
  void OnProgram(SimTime, const machine::Place&, std::string_view what, int program) override {
    Tell(std::string(what) + " " + std::to_string(program));
  }
  void OnMessage(SimTime, const machine::Place&, std::string_view text) override { Tell(std::string(text)); }
  void OnDiagnostic(SimTime, const Diagnostic& diagnostic) override {
    Tell("E" + std::to_string(Lookup(diagnostic.code).number));
  }

 private:
  void Tell(std::string what) { ran_.told.push_back(std::move(what)); }
  Ran& ran_;
};

machine::Bytes ObjectOf(const std::string& text) {
  Compilation compiled = Compile(text, "test.S", {});
  for (const Diagnostic& diagnostic : compiled.diagnostics) {
    EXPECT_FALSE(IsError(diagnostic.severity)) << FormatDiagnostic(diagnostic, text);
  }
  return std::make_shared<const std::string>(std::move(compiled.object));
}

}  // namespace

bool Ran::Told(const std::string& what) const { return Count(what) > 0; }
int Ran::Count(const std::string& what) const { return static_cast<int>(std::ranges::count(told, what)); }

Ran RunText(const std::string& main, const RunOptions& options) {
  Ran ran;
  Listener listener(ran);
  const machine::MachineFamily& family = OptimoFamily();
  machine::Parameters parameters(family.parameters());
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
  Result<std::unique_ptr<machine::Run>> run = family.NewRun(std::move(setup), listener);
  if (!run) {
    ADD_FAILURE() << run.error().detail;
    return ran;
  }
  for (int n = 0; n < 100'000; ++n) {
    const machine::RunPhase phase = (*run)->Advance((*run)->state().time + options.slice);
    if (phase == machine::RunPhase::kFinished) break;
    if (phase == machine::RunPhase::kHalted &&
        (options.inputs.empty() || options.inputs.back().at <= (*run)->state().time)) {
      break;
    }
  }
  ran.outcome = (*run)->outcome();
  ran.end = (*run)->state();
  ran.time_s = ToSeconds(ran.end.time);
  ran.steps = (*run)->steps_executed();
  for (const std::string& name : options.variables) {
    ran.variables[name] = (*run)->ReadVariable(name).value_or("?");
  }
  return ran;
}

}  // namespace rmlcell::optimo::testing
