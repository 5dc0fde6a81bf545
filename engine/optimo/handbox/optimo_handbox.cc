#include "engine/optimo/handbox/optimo_handbox.h"

#include <algorithm>
#include <utility>

#include "engine/optimo/handbox/display.h"
#include "engine/optimo/handbox/modal_text.h"
#include "engine/optimo/handbox/override_steps.h"

// Modes, runs and axes: what acts while nothing is entered.
namespace rmlcell::optimo {
namespace {

using machine::JogReference;
using machine::MachineState;
using machine::MachineView;
using machine::Mode;
using machine::RunPhase;

// In the order of their lamps, and no way round the ends. OPT-4.22
constexpr std::array kModeSwitch = {Mode::kManual, Mode::kRepeat, Mode::kCycle, Mode::kSingle,
                                    Mode::kRemote};

constexpr double kFunctionShare = 0.4;  // of the override, OPT-9.36
constexpr double kPercent = 100.0;

bool MovesByHand(const MachineView& view) { return view.status.by_hand.has_value(); }
bool IsByHand(const MachineView& view, machine::HandRun what) {
  return view.status.by_hand == what;
}

// A run that is open, or HOME or ZERO; these two do not halt without being over.
bool RunGoesOn(const MachineView& view) {
  if (!view.status.open) return false;
  return view.status.run.phase != RunPhase::kHalted || IsByHand(view, machine::HandRun::kHome) ||
         IsByHand(view, machine::HandRun::kZero);
}

std::string_view LampOf(JogReference reference) {
  switch (reference) {
    case JogReference::kAbsolute:
      return "ABS";
    case JogReference::kTool:
      return "TCP";
    case JogReference::kRobot:
      break;
  }
  return "ROB";
}

// What the control says to what the cell refuses.
ErrorCode AtHandbox(ErrorCode code) {
  const bool not_now = code == ErrorCode::kCellMode || code == ErrorCode::kCellMachineState;
  return not_now ? ErrorCode::kKeyNotEnabled : code;
}

}  // namespace

void OptimoHandbox::Drop() {
  form_.reset();
  question_.reset();
  ready_.reset();
  asks_.clear();
}

Result<machine::HandboxAnswer> OptimoHandbox::Press(std::string_view key, machine::KeyAction action,
                                                    const MachineView& view) {
  const std::optional<KnownKey> known = FindKey(key);
  if (!known)
    return Error{ErrorCode::kCellInvalidArgument,
                 "there is no key " + Told("key", std::string(key)) + " on the handbox",
                 {}};
  Turn turn{.view = view, .key = *known};
  if (action != machine::KeyAction::kRelease) {
    if (view.status.state == MachineState::kOff && known->key != Key::kEmergencyStop)
      return Error{ErrorCode::kCellNotLive, "the machine is OFF", {}};
    told_.reset();
    if (modes_.beeps) turn.answer.beeps = 1;  // OPT-4.10
    if (!ActsAlways(turn)) {
      if (view.status.mode == Mode::kRemote) {
        Refuse(turn);  // OPT-4.11
      } else if (!ActsOutsideRemote(turn)) {
        InManual(turn);
      }
    }
    told_ = turn.answer.message;
  }
  // LIVE-7.03: of a TAP no motion is left.
  if (action != machine::KeyAction::kPress) Release(turn);
  if (action == machine::KeyAction::kTap && known->key == Key::kHome) turn.answer.run.reset();
  return std::move(turn.answer);
}

std::optional<ErrorCode> OptimoHandbox::Done(const Status& done) {
  std::optional<Ready> ready = std::exchange(ready_when_done_, std::nullopt);
  if (!done) return told_ = AtHandbox(done.error().code);
  if (ready) ready_ = std::move(ready);
  return std::nullopt;
}

void OptimoHandbox::Release(Turn& turn) {
  if (turn.key.key == Key::kJog) turn.Ask(machine::ReleaseJog{turn.key.jog});
  if (turn.key.key == Key::kEmergencyStop) turn.Ask(machine::EmergencyStop{false});
  if (turn.key.key == Key::kHome && IsByHand(turn.view, machine::HandRun::kHome))
    turn.Ask(machine::StopRun{});
}

// In every mode. OPT-4.11, OPT-4.14, OPT-4.29, OPT-4.37
bool OptimoHandbox::ActsAlways(Turn& turn) {
  switch (turn.key.key) {
    case Key::kErr:
      ClearError(turn);
      return true;
    case Key::kModeLeft:
      ChangeMode(turn, -1);
      return true;
    case Key::kModeRight:
      ChangeMode(turn, 1);
      return true;
    case Key::kOverridePlus:
      ChangeOverride(turn, true);
      return true;
    case Key::kOverrideMinus:
      ChangeOverride(turn, false);
      return true;
    case Key::kEmergencyStop:
      Drop();
      turn.Ask(machine::EmergencyStop{true});
      return true;
    default:
      return false;
  }
}

void OptimoHandbox::ClearError(Turn& turn) {
  if (form_ || question_) {
    form_.reset();
    question_.reset();
    asks_.clear();
    return;
  }
  if (turn.view.status.message) turn.Ask(machine::ClearMessage{});
}

void OptimoHandbox::ChangeMode(Turn& turn, int by) {
  if (IsByHand(turn.view, machine::HandRun::kHome)) turn.Ask(machine::StopRun{});
  if (MovesByHand(turn.view)) return Refuse(turn);
  const auto at = std::ranges::find(kModeSwitch, turn.view.status.mode) - kModeSwitch.begin();
  const auto to = std::clamp<std::ptrdiff_t>(at + by, 0, std::ptrdiff_t{kModeSwitch.size()} - 1);
  if (to == at) return;
  Drop();
  // A jog key that is down stops first.
  if (turn.view.status.state == MachineState::kJogging) turn.Ask(machine::StopRun{});
  turn.Ask(machine::ChangeMode{kModeSwitch[static_cast<std::size_t>(to)]});
}

void OptimoHandbox::ChangeOverride(Turn& turn, bool up) {
  if (IsByHand(turn.view, machine::HandRun::kZero)) return Refuse(turn);
  const double now = turn.view.status.override_percent;
  const double next = NextOverride(now, up);
  if (next != now) turn.Ask(machine::ChangeOverride{next});
}

double OptimoHandbox::OverrideOf(machine::HandRun run, double override_percent) const {
  return run == machine::HandRun::kHome ? JogShareOf(override_percent) * kPercent
                                        : override_percent * kFunctionShare;
}

bool OptimoHandbox::ActsOutsideRemote(Turn& turn) {
  const bool manual = turn.view.status.mode == Mode::kManual;
  switch (turn.key.key) {
    case Key::kShift:
      shift_ = !shift_;
      return true;
    case Key::kNote:
      modes_.beeps = !modes_.beeps;
      return true;
    case Key::kJogReference:
      ChooseReference(turn);
      return true;
    case Key::kStart:
      if (manual && !IsByHand(turn.view, machine::HandRun::kFunction)) return false;
      Start(turn);
      return true;
    case Key::kHold:
    case Key::kStop:
      if (manual && !turn.view.status.open) {
        Refuse(turn);
      } else if (turn.key.key == Key::kHold) {
        turn.Ask(machine::HoldRun{});
      } else if (std::exchange(shift_, false) && turn.view.status.open &&
                 turn.view.status.open->source == machine::StartSource::kPanel) {
        turn.Ask(machine::AbortRun{});
      } else {
        turn.Ask(machine::StopRun{});
      }
      return true;
    default:
      break;
  }
  if (manual) return false;
  // What is left of a handbox that starts programs: which one. OPT-4.32, OPT-4.42
  const bool steps = turn.key.key == Key::kPrev || turn.key.key == Key::kNext;
  if (RunGoesOn(turn.view)) {
    Refuse(turn);
  } else if (turn.key.key == Key::kJob) {
    OpenJob(turn);
  } else if (steps && shift_) {
    SelectNeighbour(turn, turn.key.key == Key::kNext);
  } else if (form_) {
    InForm(turn);
  } else {
    Refuse(turn);
  }
  return true;
}

// OPT-4.19, OPT-4.61, OPT-6.31
void OptimoHandbox::Start(Turn& turn) {
  const machine::MachineStatus& status = turn.view.status;
  if (status.open) {
    // A job of the queue goes on in REMOTE. LIVE-2.11
    if (status.open->source != machine::StartSource::kPanel) return Refuse(turn);
    if (status.run.phase == RunPhase::kHalted || status.state == MachineState::kStopping)
      turn.Ask(machine::ResumeRun{.source = machine::StartSource::kPanel});
    return;
  }
  if (turn.program() == 0) return Refuse(turn, ErrorCode::kNoProgramSelected);
  Drop();
  turn.Ask(machine::StartRun{.program = turn.program(), .source = machine::StartSource::kPanel});
}

// LIVE-7.06: keys that are down stop, and must be released first.
void OptimoHandbox::ChooseReference(Turn& turn) {
  if (modes_.reference == turn.key.reference) return;
  if (turn.view.status.state == MachineState::kJogging) turn.Ask(machine::StopRun{});
  modes_.reference = turn.key.reference;
}

// OPT-4.15, OPT-4.74: while the key is down.
void OptimoHandbox::GoHome(Turn& turn) {
  Drop();
  if (!turn.view.status.run.zeroed) return Refuse(turn, ErrorCode::kNotZeroed);
  const auto axis = [this](std::string_view name) { return parameters_.Number(name); };
  turn.answer.run = {.what = machine::HandRun::kHome,
                     .text = "COORD ROBOT\nPATH PTP\nSPEED 100\n" +
                             WithList("MOVE", {axis("HOME_X"), axis("HOME_Y"), axis("HOME_Z"),
                                               axis("HOME_A"), axis("HOME_B")}) +
                             "\n"};
}

void OptimoHandbox::InManual(Turn& turn) {
  if (RunGoesOn(turn.view) || edit_) return Refuse(turn);
  if (OpensForm(turn)) return;
  switch (turn.key.key) {
    case Key::kJob:
      return OpenJob(turn);
    case Key::kJog:
      return Jog(turn);
    case Key::kHome:
      return GoHome(turn);
    case Key::kZero:
      Drop();
      question_ = Question::kZero;
      return;
    case Key::kRec:
      return Record(turn);
    case Key::kPrev:
    case Key::kNext:
      if (shift_ && !ready_) return SelectNeighbour(turn, turn.key.key == Key::kNext);
      break;
    case Key::kDel:
      if (shift_) return Delete(turn);
      break;
    default:
      break;
  }
  if (question_) return Answer(turn);
  if (form_) return InForm(turn);
  if (ready_) return Refuse(turn);
  if (turn.key.key == Key::kDel) return Delete(turn);
  if (turn.key.key == Key::kPrev || turn.key.key == Key::kNext)
    return ShowNeighbour(turn, turn.key.key == Key::kNext);
  Refuse(turn);  // OPT-4.12, 4.13, 4.27, 4.45
}

// OPT-4.20, OPT-5.15, OPT-5.49; the C keys do nothing.
void OptimoHandbox::Jog(Turn& turn) {
  Drop();
  turn.Ask(machine::PressJog{.key = turn.key.jog, .reference = modes_.reference});
  if (turn.program() == 0 || turn.key.jog.axis == machine::JogAxis::kC) return;
  const bool centre = modes_.path == PathType::kHole && !first_point_;
  ready_when_done_ = centre ? Ready{.as = Ready::As::kCentre, .name = "ENTER CENTER NORMAL"}
                            : Ready{.as = Ready::As::kPoint, .name = "MOVE"};
}

machine::Panel OptimoHandbox::panel(const MachineView& view) const {
  const machine::MachineStatus& status = view.status;
  machine::Panel panel{.display = OnDisplay("")};
  if (status.state == MachineState::kOff) return panel;
  panel.lamps = {machine::Name(status.mode), LampOf(modes_.reference)};
  if (shift_) panel.lamps.push_back("SHIFT");
  const bool zeroes = IsByHand(view, machine::HandRun::kZero);
  if (zeroes) panel.lamps.push_back("ZERO AXES");  // OPT-4.49
  panel.message = told_ ? told_ : status.message;
  const auto show = [&panel](std::string text, bool flashing) {
    panel.display = OnDisplay(std::move(text));
    panel.flashing = flashing;
    return panel;
  };
  if (question_) {
    constexpr std::array<std::string_view, 4> kAsked = {"ZERO AXIS?", "DELETE Y / N ?",
                                                        "DELETE Y/N", "EXECUTION?"};
    return show(std::string(kAsked[static_cast<std::size_t>(*question_)]), false);
  }
  if (form_) return show(form_->text(), false);
  machine::ShownStep shown = status.shown;
  if (ready_ && !RunGoesOn(view)) {
    if (ready_->as == Ready::As::kLink) return show(PlacedText(shown, ready_->name), true);
    if (ready_->as != Ready::As::kOutput) return show(ready_->name, true);
    shown.instruction = ready_->name;
    return show(DefaultText(shown), true);
  }
  if (zeroes) return show("ZERO AXES", true);
  // The control knows its own numbers only. OPT-4.06
  if (panel.message && Lookup(*panel.message).family == ErrorFamily::kOptimo)
    return show("ERROR " + std::to_string(Lookup(*panel.message).number), false);
  if (view.compiles) return show("COMPILING", false);  // OPT-4.08
  // A run tells WORK of both. OPT-5.36
  if (shown.instruction == "WORK") {
    const Result<std::optional<Steps>> steps = Steps::Of(view.programs, shown.program);
    if (steps && *steps && (*steps)->Has(shown.step))
      shown = (*steps)->Show(shown.program, shown.step);
  }
  return show(DefaultText(shown), false);
}

// Nothing is ready to record that nobody has seen work: the display is free for the error, and REC
// does what it does with nothing flashing. NO of F3 records it all the same. OPT-4.06, OPT-9.35
void OptimoHandbox::FunctionFailed() {
  Drop();
  told_.reset();
}

void OptimoHandbox::CyclePower() {
  Drop();
  modes_ = {};
  shift_ = false;
  told_.reset();
  edit_.reset();
  first_point_.reset();
  next_move_ = {};
}

}  // namespace rmlcell::optimo
