// A run that is held: keys, HOME and ZERO move the machine while it stays open, and it goes on.
// LIVE-5.06
#include <cmath>
#include <string>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/number_text.h"
#include "engine/machine/hand_program.h"
#include "engine/machine/machine.h"
#include "engine/machine/machine_states.h"
#include "engine/machine/refusal.h"

namespace rmlcell::machine {
namespace {

// Nobody brings a machine back to where it was by hand more closely, and no status is nearer.
// LIVE-3.17
constexpr double kBack_mm = 0.01;
constexpr double kBack_rad = 0.0001;

// "X by 12.500 mm, B by -0.1000 rad"; empty: it stands where it was.
Detail DisplacementOf(const motion::AxisPose& from, const motion::AxisPose& to) {
  Detail text;
  const auto tell = [&text](const std::string& axis, double by, const std::string& unit,
                            int decimals) {
    if (!text.empty()) text += ", ";
    text += axis + " by " + Told(axis, by, unit, FixedText(by, decimals) + " " + unit);
  };
  const auto moved = [&tell](const std::string& axis, double by) {
    if (std::abs(by) > kBack_mm) tell(axis, by, "mm", 3);
  };
  const auto turned = [&tell](const std::string& axis, double by) {
    if (std::abs(by) > kBack_rad) tell(axis, by, "rad", 4);
  };
  const motion::MachineVector way = to.column - from.column;
  moved("X", way.x());
  moved("Y", way.y());
  moved("Z", way.z());
  turned("A", to.a_rad - from.a_rad);
  turned("B", to.b_rad - from.b_rad);
  return text;
}

}  // namespace

// Of the open run, as it stands now.
std::unique_ptr<Standing> Machine::StandingOfRun() const {
  Result<std::unique_ptr<Standing>> now = family_.NewStanding(parameters_, run_->SaveMachine());
  RMLCELL_CHECK(now);
  return *std::move(now);
}

std::optional<HandMotion> Machine::ByHand(bool fast) const {
  if (run_ == nullptr) return standing_->ByHand(override_percent_, fast);
  return StandingOfRun()->ByHand(override_percent_, fast);
}

void Machine::MoveTo(const motion::AxisPose& axes) {
  if (run_ == nullptr) {
    standing_->MoveTo(axes);
  } else {
    if (!held_at_) held_at_ = run_->state().axes;
    run_->MoveTo(axes);
  }
  if (viewed_from_ && !jog_.asks() && DisplacementOf(*viewed_from_, axes).empty())
    viewed_from_.reset();
}

// HOME and ZERO beside the open run, which has BREAK and SIMUL for itself. OPT-4.49
Status Machine::SendByHand(const RunByHand& asked) {
  Translation made = family_.Translate({.bytes = asked.text}, parameters_, {.advice = false});
  RMLCELL_CHECK(made.ok);
  RunSetup setup(parameters_);
  setup.main_program = kNoProgram;
  setup.programs[kNoProgram] = {.name = "HANDBOX", .object = Bytes::Of(std::move(made.object))};
  setup.machine_state = run_->SaveMachine();
  setup.override_percent = OverrideOf(asked.what);
  setup.breakpoint = setup.simul = ProgramStep{};
  setup.budget = kLiveBudget;
  Result<std::unique_ptr<HandProgram>> way =
      HandProgram::Make(family_, std::move(setup), asked.what, now_);
  if (!way) return way.error();
  jog_.Send(*std::move(way));
  AdvanceJog(now_);
  return {};
}

// Who presses START at the machine sees where it stands; but what cannot go on from there does not.
Status Machine::MayGoOn(const ResumeRun& input) const {
  if (jog_.moves()) return NotNow(state(), kReleaseKeys);
  if (CoverStops()) return Error{ErrorCode::kCellDoorOpen, "the cover is open", {}};
  // The key at the machine is the control's own; who is elsewhere loses no part by it.
  if (input.source != StartSource::kPanel) {
    if (const Status may = run_->MayGoOn(); !may) return may.error();
    if (stopping_ && run_->state().door_open)
      return Error{ErrorCode::kCellDoorOpen, "it comes to rest for the door", {}};
  }
  if (!held_at_) return {};
  const bool asked = !input.accept_displaced && input.source != StartSource::kPanel;
  if (!asked && run_->may_be_moved()) return {};
  Detail moved = DisplacementOf(*held_at_, run_->state().axes);
  if (moved.empty()) return {};
  return Error{ErrorCode::kCellDisplaced, "it was moved in " + std::move(moved), {}};
}

Status Machine::Act(const ResumeRun& input) {
  const Transition next = Next(state(), MachineEvent::kResume, guards());
  if (next.code) return Refusal(*next.code);
  if (next.kind == Transition::Kind::kStays && !next.Does(StateAct::kTakeBack)) return {};
  if (const Status source = MaySource(input.source); !source && !Pauses()) return source.error();
  if (abort_behind_) return NotNow(state(), "the run ends as soon as it stands");
  if (const Status may = MayGoOn(input); !may) return may.error();
  if (stopping_ && !family_.info().start_takes_back) {
    resume_behind_ = true;
    return {};
  }
  stopping_ = false;
  // Whoever simulates it knows nothing of that, nor of a spindle that is started anew.
  if (held_at_ || input.restore_process) base_.reset();
  held_at_.reset();
  ToRun(InputKind::kStart, 0, input.restore_process ? 1.0 : 0.0);
  return {};
}

}  // namespace rmlcell::machine
