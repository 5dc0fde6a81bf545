#include "tests/conformance/optimo_machine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "engine/core/number_text.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/machine/machine_state.h"

namespace rmlcell::optimo::testing {
namespace {

constexpr int kPosesOfMotion = 64;  // of each motion that is looked at

std::string SignalText(const machine::SignalChange& change) {
  using machine::Signal;
  const bool on = change.value != 0.0;
  const std::string whole = std::to_string(static_cast<int>(change.value));
  switch (change.signal) {
    case Signal::kBeam:
      return on ? "beam on " + TrimmedText(change.detail, 3) : "beam off";
    case Signal::kShutter:
      return on ? "shutter open" : "shutter closed";
    case Signal::kSchedule:
      return "schedule " + whole;
    case Signal::kOutput:
      return "OL[" + std::to_string(change.index) + "] " + whole;
    case Signal::kGas:
      return "gas " + whole;
    case Signal::kSensor:
      return "sensor " + whole;
    case Signal::kRotaryTable:
      return "table " + TrimmedText(change.value, 3);
    default:
      return "signal";
  }
}

std::string WaitText(machine::WaitKind kind) {
  switch (kind) {
    case machine::WaitKind::kDwell:
      return "dwell";
    case machine::WaitKind::kPierce:
      return "pierce";
    case machine::WaitKind::kCondition:
      return "condition";
    case machine::WaitKind::kOperator:
      return "operator";
    default:
      return "load";
  }
}

}  // namespace

class Ran::Listener final : public machine::RunObserver {
 public:
  void OnStep(SimTime at, const machine::Place& place, std::string_view instruction) override {
    Tell(at, place, "step " + std::string(instruction));
  }
  void OnMove(const machine::MoveDone& move) override { moves.push_back(move); }
  void OnMotion(const machine::MotionDone& done) override {
    Ran::Motion motion{ToSeconds(done.start),
                       ToSeconds(done.end),
                       0.0,
                       done.beam_on,
                       done.power,
                       done.programmed_mm_s,
                       done.place.step,
                       done.motion->corner,
                       done.motion->speed.At(done.motion->speed.duration_s()).speed,
                       {}};
    const motion::PathPiece& path = done.motion->path;
    if (!path.by_sigma()) motion.length_mm = done.travelled - done.from;
    for (int n = 0; n <= kPosesOfMotion; ++n) {
      const double s = done.from + (done.travelled - done.from) * n / kPosesOfMotion;
      motion.poses.push_back(motion::TipOn(path, done.motion->head, path.At(s)));
    }
    motions.push_back(std::move(motion));
  }
  void OnSignal(const machine::SignalChange& change) override {
    Tell(change.at, change.place, SignalText(change));
  }
  void OnWait(const machine::Wait& wait) override {
    Tell(wait.start, wait.place,
         "wait " + WaitText(wait.kind) + " " + TrimmedText(ToSeconds(wait.end - wait.start), 3));
  }
  void OnHalt(const machine::Halt& halt) override {
    Tell(halt.at, halt.place, "halt " + std::string(halt.why));
  }
  void OnProgram(SimTime at, const machine::Place& place, std::string_view what,
                 int program) override {
    Tell(at, place, std::string(what) + " " + std::to_string(program));
  }
  void OnMessage(SimTime at, const machine::Place& place, std::string_view text) override {
    Tell(at, place, std::string(text));
  }
  void OnDiagnostic(SimTime at, const Diagnostic& diagnostic) override {
    Tell(at, {.program = diagnostic.program, .step = diagnostic.step},
         "E" + std::to_string(Lookup(diagnostic.code).number));
  }

  std::vector<Told> told;
  std::vector<machine::MoveDone> moves;
  std::vector<Ran::Motion> motions;

 private:
  void Tell(SimTime at, const machine::Place& place, std::string what) {
    told.push_back({ToSeconds(at), place.program, place.step, std::move(what)});
  }
};

Ran::Ran() : listener_(std::make_unique<Listener>()) {}
Ran::~Ran() = default;
Ran::Ran(Ran&&) noexcept = default;

int Ran::code() const {
  const machine::Outcome& outcome = run_->outcome();
  return outcome.code ? Lookup(*outcome.code).number : 0;
}
bool Ran::completed() const {
  return run_->state().phase == machine::RunPhase::kFinished &&
         run_->outcome().kind == machine::OutcomeKind::kCompleted;
}
double Ran::time_s() const { return ToSeconds(run_->state().time); }
std::string Ran::Var(const std::string& name) const {
  return run_->ReadVariable(name).value_or(machine::VariableValue{.text = "?"}).text;
}
double Ran::Number(const std::string& name) const { return ParseDouble(Var(name)).value_or(NAN); }

std::vector<std::string> Ran::Events() const {
  std::vector<std::string> events;
  for (const Told& t : told) {
    if (!t.what.starts_with("step ") && !t.what.starts_with("compiling ")) events.push_back(t.what);
  }
  return events;
}
int Ran::Count(const std::string& what) const {
  return static_cast<int>(std::ranges::count(told, what, &Told::what));
}
std::optional<Told> Ran::Find(const std::string& what) const {
  const auto found = std::ranges::find(told, what, &Told::what);
  return found == told.end() ? std::nullopt : std::optional<Told>(*found);
}
double Ran::BeamLength() const {
  double length = 0.0;
  for (const Motion& motion : motions) length += motion.beam ? motion.length_mm : 0.0;
  return length;
}
double Ran::NearestTo(const motion::MachinePoint& point) const {
  double nearest = HUGE_VAL;
  for (const Motion& motion : motions) {
    for (std::size_t n = 0; n + 1 < motion.poses.size(); ++n) {
      // Between two poses the path is nearly straight.
      const motion::MachineVector a = motion.poses[n].tip, d = motion.poses[n + 1].tip - a;
      const double square = d.dot(d);
      const double share = square > 0.0 ? std::clamp((point - a).dot(d) / square, 0.0, 1.0) : 0.0;
      nearest = std::fmin(nearest, (point - (a + d * share)).norm());
    }
  }
  return nearest;
}

OptimoMachine::OptimoMachine() : parameters_(OptimoFamily().parameters()) {}

OptimoMachine& OptimoMachine::Set(const std::string& parameter, const std::string& value) {
  EXPECT_TRUE(parameters_.Set(parameter, std::string_view(value)).ok()) << parameter;
  return *this;
}
OptimoMachine& OptimoMachine::Profile(const std::string& id) {
  for (const machine::MachineProfile& profile : OptimoFamily().profiles()) {
    if (profile.id != id) continue;
    EXPECT_TRUE(parameters_.Apply(profile).ok());
    return *this;
  }
  ADD_FAILURE() << "no profile " << id;
  return *this;
}
OptimoMachine& OptimoMachine::Store(int slot, const std::string& source) {
  Compilation compiled = Compile(source, "program", {.advice = false});
  for (const Diagnostic& d : compiled.diagnostics)
    EXPECT_FALSE(IsError(d.severity)) << FormatDiagnostic(d, source);
  deleted_.erase(slot);
  programs_[slot] = {.name = "program",
                     .object = machine::Bytes::Of(std::move(compiled.object)),
                     .executable = nullptr};
  return *this;
}
OptimoMachine& OptimoMachine::StoreExecutable(int slot, const std::string& bytes) {
  programs_.at(slot).executable = machine::Bytes::Of(bytes);
  return *this;
}
OptimoMachine& OptimoMachine::Delete(int slot) {
  if (programs_.erase(slot) > 0) deleted_.insert(slot);
  return *this;
}
OptimoMachine& OptimoMachine::Schedules(std::vector<machine::LaserSchedule> stored) {
  schedules_ = std::move(stored);
  return *this;
}
OptimoMachine& OptimoMachine::LoseZero() {
  MachineState state = NewMachine(Resolve(parameters_));
  state.zeroed = false;
  state_ = EncodeMachineState(state);
  return *this;
}
std::string OptimoMachine::Executable(int slot) const {
  return std::string(*programs_.at(slot).executable);
}
bool OptimoMachine::HasExecutable(int slot) const {
  const auto found = programs_.find(slot);
  return found != programs_.end() && found->second.executable != nullptr;
}

Ran OptimoMachine::Run(int slot, const Options& options) {
  Ran ran;
  machine::RunSetup setup(parameters_);
  setup.programs = programs_;
  setup.deleted_programs = deleted_;
  setup.main_program = slot;
  setup.schedules = schedules_;
  setup.machine_state = state_;
  setup.mode = options.mode;
  setup.override_percent = options.override_percent;
  setup.breakpoint = options.breakpoint;
  setup.simul = options.simul;
  setup.inputs = options.inputs;
  setup.budget = options.budget;
  Result<std::unique_ptr<machine::Run>> run =
      OptimoFamily().NewRun(std::move(setup), *ran.listener_);
  if (!run) {
    ADD_FAILURE() << run.error().detail;
    std::abort();
  }
  ran.run_ = std::move(*run);
  constexpr int kCallsMax = 100'000;
  for (int n = 0; n < kCallsMax; ++n) {
    const SimTime now = ran.run_->state().time;
    const machine::RunPhase phase = ran.run_->Advance(now + std::chrono::seconds(1000));
    if (phase == machine::RunPhase::kFinished) break;
    if (phase == machine::RunPhase::kHalted &&
        (options.inputs.empty() || options.inputs.back().at <= ran.run_->state().time)) {
      break;
    }
  }
  state_ = ran.run_->SaveMachine();
  for (const auto& [made, bytes] : ran.run_->made_executables()) {
    if (programs_.contains(made)) StoreExecutable(made, bytes);
  }
  ran.told = ran.listener_->told;
  ran.moves = ran.listener_->moves;
  ran.motions = ran.listener_->motions;
  return ran;
}

Ran OptimoMachine::Run(const std::string& source, const Options& options) {
  Store(1, source);
  return Run(1, options);
}

SimTime At(double seconds) { return FromSeconds(seconds); }

std::string CorpusProgram(const std::string& name) {
  const std::filesystem::path path =
      std::filesystem::path(RMLCELL_SHARED_DIR) / "corpus/optimo" / name;
  if (!std::filesystem::exists(path)) return {};
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace rmlcell::optimo::testing
