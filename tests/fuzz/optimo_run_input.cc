#include "tests/fuzz/optimo_run_input.h"

#include <cmath>
#include <memory>
#include <optional>

#include "engine/families/families.h"
#include "engine/machine/parameters.h"
#include "engine/machine/run.h"
#include "engine/optimo/language/byte_stream.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/linker.h"
#include "tests/fuzz/told.h"

namespace rmlcell::optimo {
namespace {

using namespace std::chrono_literals;

constexpr machine::RunBudget kBudget = {
    .steps = 5'000, .virtual_time = std::chrono::hours(1), .steps_at_one_instant = 2'000};
constexpr int kStartsMax = 12;
constexpr int kCallsMax = 5'000;  // of Advance: each computes something, or lets time pass

// How a run is carried out.
struct Way {
  SimTime piece{0};        // of time; 0: all at once
  bool goes_back = false;  // to what was saved of it, again and again
};

// What it told, and how it ended; or what is wrong.
struct Carried {
  std::string told{};
  std::string wrong{};
};

std::string OutcomeOf(const machine::Run& run) {
  const machine::Outcome& outcome = run.outcome();
  return "ended " + std::to_string(static_cast<int>(outcome.kind)) + " " +
         (outcome.code ? CodeText(*outcome.code) : "well") + " at " +
         std::to_string(run.state().time.count()) + " behind " +
         std::to_string(run.steps_executed()) + "\n" + run.SaveMachine();
}

Carried Carry(const machine::MachineFamily& family, machine::RunSetup setup, const Way& way) {
  machine::Teller teller;
  Result<std::unique_ptr<machine::Run>> made = family.NewRun(std::move(setup), teller);
  if (!made) return {.told = "refused with " + CodeText(made.error().code)};
  machine::Run& run = **made;
  int starts = 0;
  SimTime until{0};
  for (int calls = 0; calls < kCallsMax; ++calls) {
    until = way.piece == SimTime(0) ? SimTime(2h) : until + way.piece;
    const machine::RunPhase phase = run.Advance(until);
    const machine::RunState state = run.state();
    if (!state.axes.column.allFinite() || !std::isfinite(state.axes.a_rad) ||
        !std::isfinite(state.axes.b_rad) || !std::isfinite(state.tip_speed_mm_s))
      return {.wrong = "the machine is nowhere"};
    if (run.steps_executed() > kBudget.steps + 1) return {.wrong = "more steps than its budget"};
    if (phase == machine::RunPhase::kFinished) return {.told = teller.told + OutcomeOf(run)};
    if (phase == machine::RunPhase::kHalted && starts < kStartsMax) {
      ++starts;
      run.Apply({.kind = machine::InputKind::kStart});
    } else if (phase == machine::RunPhase::kHalted) {
      run.End(machine::OutcomeKind::kCancelled, ErrorCode::kCellCancelled);
      if (run.state().phase != machine::RunPhase::kFinished) return {.wrong = "it does not end"};
      return {.told = teller.told + OutcomeOf(run)};
    } else if (way.goes_back && calls % 3 == 0) {
      run.Restore(*run.Save());
    }
  }
  // In small pieces an hour takes longer than anybody waits: all at once it must end.
  if (way.piece == SimTime(0)) return {.wrong = "it does not end"};
  run.End(machine::OutcomeKind::kCancelled, ErrorCode::kCellCancelled);
  return {};
}

std::string TryRun(const machine::StoredProgram& program) {
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  static const machine::Parameters kParameters =
      *machine::MakeParameters(family, std::string(family.info().default_profile), {});
  machine::RunSetup setup(kParameters);
  setup.programs[1] = setup.programs[2] = program;  // what it calls is one like it
  setup.main_program = 1;
  setup.budget = kBudget;
  const machine::Bytes& bytes = program.object != nullptr ? program.object : program.executable;
  setup.forecast = bytes->size() % 2 == 0;
  const Carried whole = Carry(family, setup, {});
  if (!whole.wrong.empty()) return whole.wrong;
  for (const Way& way : {Way{.piece = 731ms}, Way{.piece = 3s, .goes_back = true}}) {
    const Carried divided = Carry(family, setup, way);
    if (!divided.wrong.empty()) return divided.wrong + ", time divided";
    if (!divided.told.empty() && divided.told != whole.told)
      return "another telling when time is divided" + machine::Apart(divided.told, whole.told);
  }
  return {};
}

std::string Framed(std::string_view magic, std::string_view bytes) {
  ByteWriter framed;
  framed.Raw(magic);
  framed.Raw(bytes);
  framed.Fixed32(Checksum(framed.bytes()));
  return std::string(framed.bytes());
}

std::string TryAs(std::string_view bytes) {
  const auto kept = machine::Bytes::Of(std::string(bytes));
  if (DecodeObject(bytes)) return TryRun({.name = "a", .object = kept});
  if (DecodeExecutable(bytes)) return TryRun({.name = "a", .executable = kept});
  return {};
}

}  // namespace

std::string TryObjectRun(std::string_view bytes) {
  if (std::string wrong = TryAs(bytes); !wrong.empty()) return wrong;
  if (std::string wrong = TryAs(Framed({"LMR\x01", 4}, bytes)); !wrong.empty()) return wrong;
  return TryAs(Framed({"LMX\x01", 4}, bytes));
}

}  // namespace rmlcell::optimo
