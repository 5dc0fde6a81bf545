#include "proto/recording/replay.h"

#include <algorithm>
#include <deque>
#include <memory>
#include <utility>

#include "engine/core/hex.h"
#include "engine/families/families.h"
#include "proto/bridge/encoding.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/machine_inputs.h"
#include "proto/bridge/sha256.h"
#include "proto/recording/told.h"

namespace rmlcell::recording {
namespace {

// Hands on what runs tell, and keeps of it what stands in a journal.
class Listener final : public machine::RunObserver {
 public:
  struct Told {
    SimTime at{0};
    v1::RunEvent event{};
  };

  explicit Listener(machine::RunObserver* also) : also_(also != nullptr ? *also : nobody_) {}

  std::deque<Told>& told() { return told_; }

  void OnRunBegun(const machine::RunNote& run) override {
    begun_ = run.begun;  // one that begins at a step began before that
    told_of_run_ = 0;
    also_.OnRunBegun(run);
  }
  void OnStep(SimTime at, const machine::Place& place, std::string_view instruction) override {
    also_.OnStep(at, place, instruction);
  }
  void OnMotion(const machine::MotionDone& done) override { also_.OnMotion(done); }
  void OnMove(const machine::MoveDone& move) override { also_.OnMove(move); }
  void OnSignal(const machine::SignalChange& change) override { also_.OnSignal(change); }
  void OnWait(const machine::Wait& wait) override { also_.OnWait(wait); }
  void OnHalt(const machine::Halt& halt) override {
    *Event(halt.at).mutable_halted() = HaltedOf(halt);
    also_.OnHalt(halt);
  }
  void OnResume(SimTime at, const machine::Place& place) override {
    *Event(at).mutable_resumed() = ResumedOf(place);
    also_.OnResume(at, place);
  }
  void OnEntered(SimTime at) override { also_.OnEntered(at); }
  void OnProgram(SimTime at, const machine::Place& place, std::string_view what,
                 int program) override {
    also_.OnProgram(at, place, what, program);
  }
  void OnMessage(SimTime at, const machine::Place& place, std::string_view text) override {
    if (MayTell()) *Event(at).mutable_message() = MessageOf(place, text);
    also_.OnMessage(at, place, text);
  }
  void OnViolation(const machine::TravelViolation& violation) override {
    also_.OnViolation(violation);
  }
  void OnLost(const machine::LostWay& way) override { also_.OnLost(way); }
  void OnDiagnostic(SimTime at, const Diagnostic& diagnostic) override {
    if (MayTell()) *Event(at).mutable_diagnostic() = bridge::ToProto(diagnostic);
    also_.OnDiagnostic(at, diagnostic);
  }
  void OnCounted(SimTime at, const Diagnostic& diagnostic) override {
    also_.OnCounted(at, diagnostic);
  }
  void OnAssumed(const machine::Assumed& assumed) override { also_.OnAssumed(assumed); }

 private:
  bool MayTell() { return ++told_of_run_ <= kToldOfRunMax; }
  v1::RunEvent& Event(SimTime of_run) {
    return told_.emplace_back(Told{.at = begun_ + of_run}).event;
  }

  machine::RunObserver nobody_;
  machine::RunObserver& also_;
  SimTime begun_{0};
  int told_of_run_ = 0;
  std::deque<Told> told_;
};

std::string TextOf(const google::protobuf::Message& message) {
  return bridge::StableJson(message).value_or("?");
}

// What the host adds to what the machine does.
v1::RunOver OfMachine(v1::RunOver over) {
  over.clear_job();
  return over;
}

v1::RunEvent OfMachine(v1::RunEvent event) {
  if (event.has_halted()) event.mutable_halted()->clear_reason();
  return event;
}

// The host cut a run off, or somebody looked at the machine: the machine did nothing.
bool IsOfHost(const v1::JournalEntry& entry) {
  if (entry.has_run_over())
    return entry.run_over().outcome().kind() == v1::Outcome::KIND_INTERRUPTED &&
           entry.run_over().outcome().code() != CodeText(ErrorCode::kCellPowerOff);
  return entry.has_event() && entry.event().has_message() && !entry.event().message().has_place();
}

class Player {
 public:
  Player(const Recording& recording, const ReplayOptions& options)
      : recording_(recording), options_(options), listener_(options.observer) {}

  Status Prepare() {
    auto machine = MachineOf(recording_.head);
    if (!machine) return machine.error();
    family_ = machine->family;
    parameters_.emplace(std::move(machine->parameters));
    auto made = machine::Machine::Make(*family_, *parameters_, MemoryOf(recording_.head),
                                       recording_.entries.front().mark().state(), listener_);
    if (!made) return made.error();
    machine_ = *std::move(made);
    begun_ = machine_->status().last_run;
    if (!recording_.head.has_brought()) return {};
    auto brought = ProgramOf(recording_.head.brought(), *family_, *parameters_);
    if (!brought) return brought.error();
    brought_ = *std::move(brought);
    return {};
  }

  Result<Replayed> Play() {
    for (const v1::JournalEntry& entry : recording_.entries) {
      if (SimTime(entry.virtual_time_ns()) > options_.to) break;
      if (!GoTo(SimTime(entry.virtual_time_ns()))) break;
      if (const Status played = Take(entry); !played) return played.error();
      if (replayed_.difference) break;
    }
    const SimTime to =
        options_.stands
            ? std::min(options_.to, SimTime(recording_.entries.back().virtual_time_ns()))
            : options_.to;
    if (!replayed_.difference && to != SimTime::max() && to > machine_->time())
      static_cast<void>(GoTo(to));
    if (options_.stands && !stopped_ && !replayed_.difference) options_.stands(*machine_);
    // What ends with the last entry is told when the machine goes on behind it.
    if (!stopped_ && !replayed_.difference && !ends_.empty())
      static_cast<void>(GoTo(machine_->time() + SimTime(1)));
    if (!stopped_) CompareRest();
    replayed_.until = machine_->time();
    return replayed_;
  }

 private:
  bool GoTo(SimTime time) {
    if (!GoesOn()) return false;
    if (time > machine_->time()) return Advance(time);
    Notice();
    return true;
  }

  // With what is due at that very instant.
  bool Advance(SimTime time) {
    while (machine_->Advance(time) == machine::Progress::kMoreWork) {
      if (!GoesOn()) return false;
    }
    Notice();
    return true;
  }

  // Who has what he wanted is not told what is missing behind it.
  bool GoesOn() {
    stopped_ = stopped_ || (options_.goes_on && !options_.goes_on(machine_->time()));
    return !stopped_;
  }

  void Notice() {
    for (machine::RunOver& over : machine_->TakeRunsOver()) {
      if (options_.over) options_.over(over);
      over_.push_back(OverOf(over));
    }
    while (!over_.empty() && !ends_.empty()) CompareEnd();
    while (!listener_.told().empty() && !events_.empty()) CompareEvent();
    static_cast<void>(machine_->TakeMadeExecutables());
    begun_ = std::max(begun_, machine_->status().last_run);
  }

  Status Take(const v1::JournalEntry& entry) {
    entry_ = &entry;
    if (IsOfHost(entry)) {
      if (entry.has_run_over() && options_.cut_off) CutOff(entry.run_over().outcome());
      return {};
    }
    switch (entry.what_case()) {
      case v1::JournalEntry::kApplied:
        return Apply(entry.applied().input());
      case v1::JournalEntry::kMark: {
        // What is told before it, as the end of a run that took no time, has been done.
        const bool late = !ends_.empty() || !events_.empty();
        if (late && !Advance(machine_->time())) return {};
        const std::string played = bridge::Sha256Hex(machine_->Save());
        Compare("mark.state_sha256", HexOf(entry.mark().state_sha256()), played);
        ++replayed_.marks;
        break;
      }
      case v1::JournalEntry::kRunBegun:
        Compare("run_begun.run", std::to_string(entry.run_begun().run()),
                std::to_string(machine_->status().last_run));
        ++replayed_.events;
        break;
      case v1::JournalEntry::kRunOver:
        ends_.push_back(&entry);
        Notice();
        break;
      case v1::JournalEntry::kEvent:
        events_.push_back(&entry);
        Notice();
        break;
      default:
        break;
    }
    return {};
  }

  // It ends where it is, as one that loses its power does.
  void CutOff(const v1::Outcome& outcome) {
    if (!machine_->status().open || !machine_->Apply(machine::SwitchPower{.on = false})) return;
    for (const machine::RunOver& over : machine_->TakeRunsOver()) options_.cut_off(over, outcome);
  }

  Status Apply(const v1::AppliedInput& applied) {
    auto input = bridge::InputOf(applied);
    if (!input)
      return Error{ErrorCode::kCellBadText,
                   "entry " + std::to_string(entry_->sequence()) + ": " + input.error().detail,
                   {}};
    if (!*input) return {};
    auto* start = std::get_if<machine::StartRun>(&**input);
    auto* enters = std::get_if<machine::StartAtStep>(&**input);
    if (start != nullptr) start->brought = std::exchange(brought_, std::nullopt);
    if (enters != nullptr) enters->brought = std::exchange(brought_, std::nullopt);
    const Status done = machine_->Apply(**input);
    if (!done) {
      Compare("applied", TextOf(applied), bridge::ErrorText(done.error()));
      return {};
    }
    ++replayed_.inputs;
    const machine::MachineStatus status = machine_->status();
    if (status.open && status.open->number > begun_ && options_.begun)
      options_.begun(*machine_->open_run());
    Notice();
    return {};
  }

  // What happens at an instant is told as soon as the machine goes on behind it: the played one may
  // come later than the entry.
  void CompareEnd() {
    entry_ = ends_.front();
    ends_.pop_front();
    const v1::RunOver played = std::move(over_.front());
    over_.pop_front();
    Compare("run_over", TextOf(OfMachine(entry_->run_over())), TextOf(OfMachine(played)));
    ++replayed_.events;
  }

  void CompareEvent() {
    entry_ = events_.front();
    events_.pop_front();
    const Listener::Told played = std::move(listener_.told().front());
    listener_.told().pop_front();
    Compare("event", TextOf(OfMachine(entry_->event())), TextOf(OfMachine(played.event)));
    Compare("event.virtual_time_ns", std::to_string(entry_->virtual_time_ns()),
            std::to_string(played.at.count()));
    ++replayed_.events;
  }

  // What one side alone has, though the machine is past it.
  void CompareRest() {
    const auto past = [this](std::int64_t time_ns) { return SimTime(time_ns) < machine_->time(); };
    if (!ends_.empty() && past(ends_.front()->virtual_time_ns())) {
      entry_ = ends_.front();
      Compare("run_over", TextOf(OfMachine(entry_->run_over())), "no end of a run");
    }
    if (!events_.empty() && past(events_.front()->virtual_time_ns())) {
      entry_ = events_.front();
      Compare("event", TextOf(OfMachine(entry_->event())), "no event");
    }
    if (!over_.empty()) Compare("run_over", "no end of a run", TextOf(OfMachine(over_.front())));
    if (!listener_.told().empty())
      Compare("event", "no event", TextOf(OfMachine(listener_.told().front().event)));
  }

  void Compare(const std::string& field, const std::string& recorded, const std::string& played) {
    if (replayed_.difference || recorded == played) return;
    replayed_.difference = Difference{.fence = entry_->fence(),
                                      .sequence = entry_->sequence(),
                                      .at = SimTime(entry_->virtual_time_ns()),
                                      .field = field,
                                      .recorded = recorded,
                                      .played = played};
  }

  const Recording& recording_;
  const ReplayOptions& options_;
  Listener listener_;
  const machine::MachineFamily* family_ = nullptr;
  std::optional<machine::Parameters> parameters_;
  std::optional<machine::StoredProgram> brought_;
  std::unique_ptr<machine::Machine> machine_;
  const v1::JournalEntry* entry_ = nullptr;     // that is played
  std::int64_t begun_ = 0;                      // number of the newest run
  std::deque<v1::RunOver> over_;                // that no entry has told yet
  std::deque<const v1::JournalEntry*> ends_;    // that the machine has not played yet
  std::deque<const v1::JournalEntry*> events_;  // likewise
  bool stopped_ = false;
  Replayed replayed_{};
};

}  // namespace

Result<RecordedMachine> MachineOf(const v1::MachineRecording& head) {
  const machine::MachineFamily* family = families::FindFamily(head.family());
  if (family == nullptr) return families::UnknownFamily(head.family());
  auto parameters = machine::MakeParameters(*family, head.profile(),
                                            {head.parameters().begin(), head.parameters().end()});
  if (!parameters) return parameters.error();
  return RecordedMachine{.family = family, .parameters = *std::move(parameters)};
}

Result<Replayed> Replay(const Recording& recording, const ReplayOptions& options) {
  Player player(recording, options);
  if (const Status prepared = player.Prepare(); !prepared) return prepared.error();
  return player.Play();
}

}  // namespace rmlcell::recording
