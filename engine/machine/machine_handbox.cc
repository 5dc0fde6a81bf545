#include <utility>

#include "engine/core/check.h"
#include "engine/machine/handbox.h"
#include "engine/machine/machine.h"
#include "engine/machine/machine_states.h"
#include "engine/machine/refusal.h"

// The machine and the handbox on it: keys become what they ask for. LIVE-7.01
namespace rmlcell::machine {

namespace {

// Of the run. An executable takes no time here; whoever looks 20 times a second still sees that it
// was made, at the speed of the machine.
constexpr SimTime kCompilingIsShown = std::chrono::milliseconds(250);

}  // namespace

MachineView Machine::View() const {
  MachineView view{.status = status(),
                   .programs = memory_.programs,
                   .modal_values = modal_values(),
                   .loaded = {}};
  if (run_ == nullptr) return view;
  view.compiles = !note_.by_hand && view.status.run.time < kCompilingIsShown &&
                  !run_->made_executables().empty();
  view.loaded.insert(note_.program);
  for (const Place& place : run_->stack()) view.loaded.insert(place.program);
  return view;
}

Panel Machine::panel() const {
  if (handbox_ == nullptr) return family_.ShowPanel(status());
  MachineView view = View();
  // A FUNCTION shows where it is; what is selected, and taught into, is another program. OPT-9.37
  const RunState& run = view.status.run;
  if (run_ != nullptr && Pauses() && run.phase == RunPhase::kRunning && run.place.step > 0) {
    view.status.shown = {.program = run.place.program,
                         .step = run.place.step,
                         .instruction = std::string(run.instruction)};
  }
  Panel panel = handbox_->panel(view);
  if (on_ && mode_ == Mode::kManual) panel.run_on = run_on(handbox_->jog_reference());
  return panel;
}

bool Machine::settles() const {
  const bool edits = handbox_ != nullptr && handbox_->open_edit() != nullptr;
  return edits || (jog_.moves() && !jog_.asks());
}

// While a run stands, what it stands at is not what is looked at any more.
void Machine::Select(ShownStep shown) {
  shown_ = std::move(shown);
  selected_ = run_ != nullptr;
}

// What an open run counts belongs to its own program.
void Machine::SelectProgram() {
  if (run_ == nullptr) return standing_->SelectProgram();
  selected_program_ = true;
}

Result<KeyAnswer> Machine::PressKey(std::string_view key, KeyAction action) {
  if (handbox_ == nullptr)
    return Error{
        ErrorCode::kCellNotLive, Told("machine", family_.info().title) + " has no handbox", {}};
  Result<HandboxAnswer> asked = handbox_->Press(key, action, View());
  if (!asked) return asked.error();
  Status done;
  for (const MachineInput& request : asked->requests) {
    done = Apply(request);
    if (!done) break;
  }
  if (done && asked->run) done = BeginByHand(*asked->run);
  if (done && asked->setting) standing_->SetModal(asked->setting->name, asked->setting->values);
  if (done && asked->shown) Select(*std::move(asked->shown));
  if (done && asked->selects_program) SelectProgram();
  const std::optional<ErrorCode> refused = handbox_->Done(done);
  Settle();  // a FUNCTION may have failed before anything moved
  return KeyAnswer{.message = refused ? refused : asked->message,
                   .beeps = asked->beeps,
                   .edit = std::move(asked->edit)};
}

// LIVE-2.10 x7
Status Machine::MayMoveByHand(bool manual) const {
  StateGuards now = guards();
  now.manual = manual;
  const Transition next = Next(state(), MachineEvent::kMoveByHand, now);
  if (next.code == ErrorCode::kCellMode)
    return Error{ErrorCode::kCellMode,
                 "ZERO works in MANUAL, and from the console in REMOTE while no run is open",
                 {}};
  if (next.code) return Refusal(*next.code);
  if (jog_.moves()) return NotNow(state(), kReleaseKeys);
  if (run_ != nullptr && !run_->may_be_moved())
    return NotNow(state(), "a run is open; end it first");
  return {};
}

double Machine::OverrideOf(std::optional<HandRun> hand) const {
  if (!hand || *hand == HandRun::kZero || handbox_ == nullptr) return override_percent_;
  return handbox_->OverrideOf(*hand, override_percent_);
}

Status Machine::BeginByHand(const RunByHand& asked) {
  if (const Status may = MayMoveByHand(mode_ == Mode::kManual); !may) return may.error();
  if (!status().run.zeroed)
    return Error{family_.info().not_zeroed, "the axes have no reference", {}};
  if (run_ != nullptr) {
    if (asked.what != HandRun::kFunction) return SendByHand(asked);
    return NotNow(state(), "a run is open; end it first");
  }
  Translation made = family_.Translate({.bytes = asked.text}, parameters_, {.advice = false});
  RMLCELL_CHECK(made.ok);
  return Begin(
      {.program = kNoProgram,
       .source = StartSource::kPanel,
       .brought = StoredProgram{.name = "HANDBOX", .object = Bytes::Of(std::move(made.object))}},
      Mode::kCycle, asked.what);
}

// LIVE-2.10 x7: in MANUAL, and from the console in REMOTE, but not beside a run that is held: there
// program 4 follows, and a machine has one run. OPT-4.49, 4.50
Status Machine::Act(const ZeroAxes& /*input*/) {
  const FamilyInfo& info = family_.info();
  if (info.zero_program.empty())
    return Error{ErrorCode::kCellNotLive,
                 "the axes of " + Told("machine", info.title) + " have their reference always",
                 {}};
  const bool goes_home = mode_ == Mode::kRemote && run_ == nullptr;
  if (const Status may = MayMoveByHand(mode_ == Mode::kManual || goes_home); !may)
    return may.error();
  if (run_ != nullptr)
    return SendByHand({.what = HandRun::kZero, .text = std::string(info.zero_program)});
  Translation zero =
      family_.Translate({.bytes = info.zero_program}, parameters_, {.advice = false});
  RMLCELL_CHECK(zero.ok);
  const Status begun =
      Begin({.program = kNoProgram,
             .unzeroed = true,
             .brought = StoredProgram{.name = "ZERO", .object = Bytes::Of(std::move(zero.object))}},
            Mode::kRemote, HandRun::kZero);
  goes_home_ = begun && goes_home;
  return begun;
}

// Of what runs by hand the text is in no slot, and its steps are not those of anybody's program.
Place Machine::OfMemory(const Place& place) const {
  return note_.by_hand && place.program == kNoProgram ? Place{} : place;
}

// ZERO from the console goes on; at the machine itself it ends at the reference (OPT-4.50). What
// failed is not there to be recorded (OPT-9.37).
void Machine::EndByHand(const Outcome& outcome) {
  const bool failed = outcome.code && Lookup(*outcome.code).family != ErrorFamily::kCell;
  if (failed && handbox_ != nullptr && note_.hand == HandRun::kFunction) handbox_->FunctionFailed();
  if (!std::exchange(goes_home_, false) || outcome.kind != OutcomeKind::kCompleted) return;
  const Status begun = Act(StartRun{.program = family_.info().home_program});
  if (begun) return;
  const Error& error = begun.error();
  Show(error.code);
  // Nobody called for it who were answered: what was called for is ZERO, and that has failed.
  Outcome& whole = over_.back().outcome;
  whole.kind = OutcomeKind::kFailed;
  whole.code = error.code;
  whole.detail = error.detail;
  whole.place = {.program = family_.info().home_program};
  const SimTime at = over_.back().lasted;
  observer_.OnDiagnostic(at, {.code = error.code,
                              .severity = Lookup(error.code).severity,
                              .detail = error.detail,
                              .rule = "OPT-4.50",
                              .program = family_.info().home_program,
                              .at = at});
}

Status Machine::Act(const PressedKey& input) {
  const Result<KeyAnswer> answer = PressKey(input.key, input.action);
  if (!answer) return answer.error();
  return {};
}

Status Machine::Act(const RefuseEdit& input) {
  if (handbox_ != nullptr && handbox_->open_edit() != nullptr) handbox_->EditRefused(input.code);
  return {};
}

// The program of this slot is this one now; nothing: there is none. Whether a key asked for that.
bool Machine::EndEdit(int slot, std::string_view object) {
  const ProgramEdit* edit = handbox_ != nullptr ? handbox_->open_edit() : nullptr;
  if (edit == nullptr || edit->program != slot || edit->object != object) return false;
  if (std::optional<ShownStep> shown = handbox_->EditStored()) Select(*std::move(shown));
  return true;
}

// LIVE-7.02. What a run is at is shown as it was read; a job of the queue leaves what is selected.
void Machine::ShowAgain(int slot) {
  const bool of_run = run_ != nullptr && !selected_ && !note_.by_hand && !of_a_job_;
  if (handbox_ == nullptr || of_run || shown_.program != slot) return;
  MachineView view = View();
  view.status.shown = shown_;
  shown_ = handbox_->ShowAgain(view);
}

}  // namespace rmlcell::machine
