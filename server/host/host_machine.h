#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/machine/handbox.h"
#include "engine/machine/virtual_driver.h"
#include "rmlcell/v1/host.pb.h"
#include "server/host/answered_requests.h"
#include "server/host/arm_desk.h"
#include "server/host/control_desk.h"
#include "server/host/key_desk.h"
#include "server/host/machine_recorder.h"
#include "server/host/start_desk.h"

namespace rmlcell::server {

// A machine that lives, as its host has it: orders of clients act on it in the order in which they
// come, each at one instant of its time; who may move it, what happened, and where it stands. No
// clock, thread or file: times are given. One thread at a time.
class HostMachine : private machine::RunObserver {
 public:
  struct Setup {
    std::string name{};  // "machines/mill-1"
    std::string host{};  // "workshop/4711"
    std::int64_t fence = 0;
    const machine::MachineFamily* family = nullptr;
    std::string profile{};
    std::map<std::string, std::string> parameters{};
    v1::MachineOptions options{};
    machine::MachineMemory memory{};
    std::string state{};  // as the last mark has it; empty: a new machine
    // What happened under an earlier fence and is not in the store yet; marks aside.
    std::vector<v1::JournalEntry> untold{};
    bool cut_off = false;  // a run was open then, and nobody has decided yet: INSPECT
    // The run that the mark was in the middle of; absent: none, or its end was told already.
    std::optional<v1::MachineMark> open_run{};
    std::string inspect_job{};                  // whose run it was, where its end was told already
    std::optional<v1::RunBase> cut_off_base{};  // what it began with; absent: not known
    // Requests that an earlier host answered, and did as far as the state has it.
    std::vector<v1::JournalEntry> answered{};
    std::int64_t control_lease = 0;  // number of the newest one
    double factor = 0.0;             // of its time; 0: as the clock
    std::optional<v1::LastRun> last_run{};
    // Of the newest run of a job, as an earlier host has it.
    std::optional<MachineRecorder::OfJob> recording{};
  };

  // Errors: those of machine::MakeParameters and machine::Machine::Make.
  static Result<std::unique_ptr<HostMachine>> Make(Setup setup, const HostTime& now,
                                                   std::function<std::string()> make_token);

  // What a client asks. One that was answered before, by its request id, gets the same answer and
  // acts no more.
  v1::HostOrderAnswer Do(const v1::HostOrder& order, const HostTime& now);
  // A key that came before another one with a lower number: it is to be brought again.
  // Or while what keys before it asked for is not over, but one that moves does not wait for that.
  bool WaitsForKeys(const v1::HostOrder& order, const HostTime& now) const;
  bool Settles() const { return machine().settles(); }
  // A lower override acts, and is answered, whatever the disk does. LIVE-3.20
  bool SlowsDown(const v1::HostOrder& order) const {
    return order.has_override() &&
           order.override().override_percent() < machine().status().override_percent;
  }
  // A key that somebody else refused: its number is used up, and the next one may come.
  void PassKey(const v1::HostOrder& order, const v1::HostOrderAnswer& refused, const HostTime& now);
  // What a start at a step would do: worked out by `run`, which takes as long as the run to the
  // step and may be called on another thread, and answered behind it.
  struct PreviewTask {
    machine::StartAtStep start{};
    StartDesk::Basis basis{};
    std::function<Result<machine::StartPreview>(machine::StartAtStep& start,
                                                const machine::ReachLimits&)>
        run{};
  };
  Result<PreviewTask> PreparePreview(const v1::HostOrder& order, const HostTime& now);
  v1::HostOrderAnswer Previewed(const v1::HostOrder& order, PreviewTask task,
                                Result<machine::StartPreview> made, const HostTime& now);
  // Time goes on. False: there is more to compute; call again when orders were looked at.
  bool GoOn(const HostTime& now);
  // The disk does not answer, or does again: that keeps jobs from it.
  void NoteDisk(bool is_late) { disk_is_late_ = is_late; }
  // All entries up to this one are in the store: the run of a job may move from then on, so that a
  // job that the store knows nothing more of has moved nothing. LIVE-5.04
  void NoteStored(std::int64_t sequence) {
    if (sequence >= begin_stored_by_) begin_stored_by_ = 0;
  }
  // Of a job that has begun here, and perhaps not in the store.
  bool waits_for_store() const { return begin_stored_by_ > 0; }
  // Comes to rest, and holds a run with this reason.
  void Hold(v1::HoldReason reason, const HostTime& now);
  // The host ends in order: a run that is open ends with it. LIVE-5.09
  void EndRun(const HostTime& now);
  // Programs and schedules that were stored meanwhile; they act at the next start.
  void Change(const v1::HostMemory& memory, const HostTime& now);
  // The same at the beginning: what is there already did not happen now.
  void Begin(const v1::HostMemory& memory, const HostTime& now);

  v1::MachineState State() const;
  v1::MachineStatus StatusAt(const HostTime& now) const;
  bool moves() const;     // it is to be asked to go on again and again
  bool run_open() const;  // it is no time to end
  // When it is to be looked at again though nobody asks: control runs out.
  std::optional<std::chrono::nanoseconds> next_look() const { return desk_.runs_out(); }
  // Programs that were changed at the machine and are to be stored, since the last call. LIVE-7.08
  std::vector<v1::HostEdit> TakeEdits() { return std::exchange(edits_, {}); }
  void EditAnswered(const v1::HostEditAnswer& answer, const HostTime& now);
  void RefuseEdit(ErrorCode code, const HostTime& now);  // of what is not stored yet
  // Nothing: it has none.
  std::optional<v1::HandboxPanel> Handbox() const;

  // What happened since the last call, in order, and behind it where the machine stands; nothing
  // yet: a machine that moves says so a few times a second at most.
  // `at_once`: it says so now.
  std::vector<v1::JournalEntry> TakeEntries(const HostTime& now, bool at_once = false);
  // Behind it: what they are in the recording.
  MachineRecorder::Fresh TakeRecorded() { return recorder_.TakeFresh(); }
  // That this order is about to act: written before it does. LIVE-3.20
  v1::JournalEntry IntentOf(const v1::HostOrder& order, const HostTime& now);

 private:
  HostMachine(Setup setup, std::function<std::string()> make_token);

  v1::HostOrderAnswer Carry(const v1::HostOrder& order, const HostTime& now);
  Result<v1::HostOrderAnswer> CarryOut(const v1::HostOrder& order, const HostTime& now);
  Status CheckControl(const v1::HostOrder& order, const HostTime& now) const;
  Status CheckJob(const v1::HostOrder& order) const;
  Status RunJob(const v1::HostOrder& order, const HostTime& now);
  std::optional<v1::HostOrderAnswer> AnsweredKey(const v1::HostOrder& order) const;
  Status PressKey(const v1::HostOrder& order, const HostTime& now);
  // Of a panel or of a handbox.
  template <class Beat>
  static Status CheckBeat(const Beat& beat);
  template <class Beat>
  Result<v1::HeartbeatResponse> HearBeat(const Beat& beat, const HostTime& now);
  void LetGo(const std::string& key);
  void LetKeysGo(const HostTime& now);
  void BeginPanelKeys(const v1::HostOrder& order);
  void EndKeys();
  void DropMask();
  Result<v1::HostOrderAnswer> CarryOutKeys(const v1::HostOrder& order, const HostTime& now);
  Result<v1::HandboxSession> OpenSession();
  std::string SessionName() const;
  Status CheckSession(const std::string& name) const;
  Status CloseSession(const std::string& name, const std::string& caller);
  v1::HandboxPanel HandboxNow() const;
  Result<v1::PressKeyResponse> PressHandboxKey(const v1::HostOrder& order, const HostTime& now);
  Status Press(const machine::PressedKey& key, const v1::HostOrder* order);
  void Edit(const machine::ProgramEdit& edit, const std::string& caller);
  StartDesk::Basis Basis() const;
  Result<v1::HostOrderAnswer> Arm(const v1::HostOrder& order, const HostTime& now);
  Status MayStartJob(const v1::HostOrder& order, const v1::WorkerAssignment& assignment) const;
  Status MayBeginAtStep(const v1::HostOrder& order, const v1::WorkerAssignment& assignment) const;
  Status StartAt(const v1::HostOrder& order, const HostTime& now);
  Status BeginJobAtStep(const v1::HostOrder& order, const HostTime& now);
  void AddMadeExecutables(v1::JournalEntry& entry);
  void TellWhyHeld(v1::HoldReason reason);
  void SettleInspection(const v1::HostOrder& order, std::size_t place);
  std::optional<v1::RunBase> BaseNow() const;
  void BeginsJob(const v1::WorkerAssignment& assignment, const HostTime& now,
                 v1::ControlLease::OnLoss armed_on_loss = v1::ControlLease::ON_LOSS_UNSPECIFIED);
  Result<std::optional<machine::StoredProgram>> ProgramOfJob(
      const v1::WorkerAssignment& assignment);
  Status CheckPrograms(const v1::WorkerAssignment& assignment,
                       const std::optional<machine::StoredProgram>& brought) const;
  std::vector<Error> WhyNoJob(const std::string& caller) const;
  std::vector<Error> WhyNoStart(const std::string& caller) const;
  void AddBlockers(const v1::HostOrder& order, v1::HostOrderAnswer& refused) const;
  Result<v1::HostOrderAnswer> Control(const v1::HostOrder& order, const HostTime& now);
  Result<v1::HostOrderAnswer> Write(const v1::HostOrder& order);
  Status Confirm(const v1::HostOrder& order);
  Status Act(const v1::HostOrder& order);
  Status Apply(const machine::MachineInput& input, const v1::HostOrder* order);
  Status MayApply(const machine::MachineInput& input) const;
  v1::HostOrderAnswer Refuse(const Error& error) const;
  void Remember(const std::string& request_id, const v1::HostOrderAnswer& answer);
  void GoOnTo(const HostTime& now);
  machine::Progress Pump(const HostTime& now);
  void Notice();
  void TellOver(const machine::RunOver& run);
  void TellControl();
  bool MovesInHold() const;
  void NoteHold(const machine::MachineInput& input);
  void LoseControl(v1::ControlLease::OnLoss on_loss, const HostTime& now);
  void TellCutOff(const v1::MachineMark& mark, ErrorCode why);
  v1::JournalEntry& Add(SimTime at);
  v1::RunEvent& Event(SimTime of_run) { return *Add(run_begun_ + of_run).mutable_event(); }
  void Mark();
  v1::MachineMark MarkNow() const;
  void Record(const v1::MachineMark& mark, std::size_t entry);
  void TakeMemory(const v1::HostMemory& memory);
  void AddBlockers(v1::MachineStatus& status) const;

  // machine::RunObserver
  void OnRunBegun(const machine::RunNote& run) override;
  bool MayTell();
  void OnHalt(const machine::Halt& halt) override;
  void OnResume(SimTime at, const machine::Place& place) override;
  void OnMessage(SimTime at, const machine::Place& place, std::string_view text) override;
  void OnDiagnostic(SimTime at, const Diagnostic& diagnostic) override;

  machine::Machine& machine() { return driver_->machine(); }
  const machine::Machine& machine() const { return driver_->machine(); }

  Setup setup_;
  std::optional<machine::Parameters> parameters_;
  std::unique_ptr<machine::VirtualDriver> driver_;
  ControlDesk desk_;
  StartDesk starts_;
  ArmDesk arms_;
  std::uint64_t memory_changes() const { return program_changes_ + schedule_changes_; }
  std::uint64_t program_changes_ = 0, schedule_changes_ = 0;
  KeyDesk keys_;
  DeadMan dead_man_;
  LineSpeed line_speed_;
  std::int64_t keys_of_ = 0;  // control lease whose keys they are
  bool by_panel_ = false;     // a key is pressed at this moment
  std::int64_t session_ = 0;  // of the handbox; 0: none is open
  std::int64_t sessions_ = 0;
  std::int64_t beeps_ = 0;
  std::optional<std::int64_t> key_taken_{};  // its number, of the key under way
  std::optional<ErrorCode> key_message_{};   // what the control says to the key that is pressed
  std::vector<v1::HostEdit> edits_;
  std::int64_t edits_made_ = 0;
  std::map<int, std::int64_t> revisions_;  // of the programs in the store, by slot
  AnsweredRequests answered_;
  std::vector<v1::JournalEntry> entries_;
  MachineRecorder recorder_;
  std::size_t recorded_ = 0;       // of the entries
  v1::AssignedProgram brought_{};  // by the job that is about to begin
  HostTime now_{};                 // of the call under way
  std::uint64_t halts_ = 0;        // that somebody asked for
  bool disk_is_late_ = false;      // nothing that was to be written is
  bool late_ = false;              // by so much that the run is to be held
  std::int64_t sequence_ = 0;
  std::map<std::int64_t, WallTime> alarms_since_;  // by number
  std::optional<v1::HoldReason> held_for_;         // by the host itself, or for a client
  SimTime run_begun_{0};
  int told_of_run_ = 0;
  SimTime told_until_{0};  // of the newest entry
  std::optional<v1::LastRun> last_run_{};
  std::int64_t begin_stored_by_ = 0;  // the entry that the run of a job waits for; 0: none
  bool inspect_due_ = false;
  bool ended_ = false;  // by EndRun(): of the run that is open nothing more is told
  bool mark_due_ = true;
  bool begins_ = false;                 // a run began since the last mark
  std::string job_{};                   // "jobs/17": whose run is open, or begins; empty: nobody's
  std::deque<std::string> begun_jobs_;  // the newest, that of now among them
  std::string inspect_job_{};           // whose run was cut off, while that is to be looked at
  std::optional<v1::RunBase> cut_off_base_{};  // likewise; what it began with
  std::chrono::nanoseconds marked_at_{0};
};

}  // namespace rmlcell::server
