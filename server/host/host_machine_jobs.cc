// Jobs of the queue on a machine that lives: what keeps them from it, and how they begin.
#include <algorithm>
#include <utility>

#include "proto/bridge/findings.h"
#include "proto/bridge/start_blocker.h"
#include "proto/bridge/ticket.h"
#include "proto/recording/recording.h"
#include "server/host/host_machine.h"
#include "server/host/host_messages.h"

namespace rmlcell::server {
namespace {

constexpr std::size_t kJobsKnown = 16;  // the newest: whoever asks knows of the last one or two

}  // namespace

// All that keeps a job of this caller from beginning. LIVE-5.02 (a)
std::vector<Error> HostMachine::WhyNoJob(const std::string& caller) const {
  std::vector<Error> why;
  const auto& lease = desk_.lease();
  if (lease && lease->holder() != caller)
    why.push_back({ErrorCode::kCellLeaseHeld, lease->holder() + " has control", {}});
  const machine::MachineStatus status = machine().status();
  if (inspect_due_) why.push_back({ErrorCode::kCellInspect, "confirm that it was inspected", {}});
  for (const machine::Alarm& alarm : status.alarms) why.push_back({alarm.code, {}, {}});
  if (status.state == machine::MachineState::kOff)
    why.push_back({ErrorCode::kCellNotLive, "the machine is OFF", {}});
  if (status.open) why.push_back({ErrorCode::kCellMachineState, "a run is open", {}});
  if (status.mode != machine::Mode::kRemote)
    why.push_back({ErrorCode::kCellMode, "jobs run in REMOTE alone", {}});
  if (status.run.door_open) why.push_back({ErrorCode::kCellDoorOpen, {}, {}});
  // Nothing would be cut, and the job count as a part.
  if (machine().simulation_until()) {
    why.push_back({ErrorCode::kCellMachineState,
                   "SIMUL is armed, and the run would be dry: end that at the handbox, or by "
                   "SetSimulation without a step",
                   {}});
  }
  return why;
}

// The program that the job brought; nothing: what the memory has is the same.
Result<std::optional<machine::StoredProgram>> HostMachine::ProgramOfJob(
    const v1::WorkerAssignment& assignment) {
  const auto& programs = assignment.programs();
  const auto main =
      std::ranges::find(programs, assignment.main_program(), &v1::AssignedProgram::slot);
  if (main == programs.end())
    return Error{ErrorCode::kCellInvalidArgument, "the job came without its program", {}};
  const auto stored = machine().memory().programs.find(main->slot());
  if (!main->is_source() && stored != machine().memory().programs.end() &&
      *stored->second.object == main->content())
    return std::optional<machine::StoredProgram>();
  auto made = recording::ProgramOf(*main, *setup_.family, *parameters_);
  if (!made) return made.error();
  brought_ = *main;
  return std::optional(*std::move(made));
}

// The queue has control for it, where nobody has. LIVE-4.05
Status HostMachine::RunJob(const v1::HostOrder& order, const HostTime& now) {
  // Behind the intent, also where nothing begins: a crash later on finds no job that was to begin.
  mark_due_ = true;
  if (auto why = WhyNoJob(order.caller()); !why.empty()) return std::move(why.front());
  if (const Status may = MayStartJob(order, order.run_job()); !may) return may.error();
  if (!order.run_job().job().continues().empty()) {
    return Error{ErrorCode::kCellPreviewStale,
                 "decide again where " + order.run_job().job().continues() + " goes on",
                 {}};
  }
  const v1::WorkerAssignment& assignment = order.run_job();
  const v1::ControlLease::OnLoss armed_on_loss = arms_.on_loss();
  brought_.Clear();
  auto brought = ProgramOfJob(assignment);
  if (!brought) return brought.error();
  if (const Status may = CheckPrograms(assignment, *brought); !may) {
    brought_.Clear();
    return may.error();
  }
  job_ = assignment.job().name();
  const Status begun = Apply(machine::StartRun{.program = assignment.main_program(),
                                               .source = machine::StartSource::kQueue,
                                               .unzeroed = assignment.job().run().unzeroed(),
                                               .brought = *std::move(brought)},
                             &order);
  if (!begun) {
    job_.clear();
    brought_.Clear();
    return begun.error();
  }
  BeginsJob(assignment, now, armed_on_loss);
  return {};
}

// Whether all is there that would run, and it is what was simulated, where the machine asks for
// that, or the job has it. LIVE-5.02
Status HostMachine::CheckPrograms(const v1::WorkerAssignment& assignment,
                                  const std::optional<machine::StoredProgram>& brought) const {
  const machine::MachineMemory& memory = machine().memory();
  std::map<int, machine::StoredProgram> programs = memory.programs;
  if (brought) programs[assignment.main_program()] = *brought;
  return bridge::CheckRun({.family = *setup_.family,
                           .parameters = *parameters_,
                           .programs = programs,
                           .schedules = memory.schedules,
                           .main_program = assignment.main_program()},
                          assignment.has_ticket() ? &assignment.ticket() : nullptr,
                          setup_.options.ticket_needed());
}

// Who starts jobs here. LIVE-5.04
Status HostMachine::MayStartJob(const v1::HostOrder& order,
                                const v1::WorkerAssignment& assignment) const {
  const std::string& job = assignment.job().name();
  switch (setup_.options.start()) {
    case v1::MachineOptions::START_PERSON:
      if (order.has_by_person()) return {};
      return Error{ErrorCode::kCellMode, "a person starts each job here", {}};
    case v1::MachineOptions::START_ARMED:
      return arms_.MayStart(
          job, order.has_by_person() ? std::optional(order.by_person().arm_token()) : std::nullopt);
    default:
      return {};
  }
}

Result<v1::HostOrderAnswer> HostMachine::Arm(const v1::HostOrder& order, const HostTime& now) {
  if (order.has_disarm()) {
    arms_.Disarm();
    return v1::HostOrderAnswer();
  }
  if (setup_.options.start() != v1::MachineOptions::START_ARMED)
    return Error{ErrorCode::kCellNotLive, "jobs start here without being armed for", {}};
  if (auto why = WhyNoJob(order.caller()); !why.empty()) return std::move(why.front());
  auto armed = arms_.Arm(order.arm(), order.caller(), desk_.lease() ? desk_.lease()->number() : 0,
                         memory_changes(), now);
  if (!armed) return armed.error();
  v1::HostOrderAnswer answer;
  *answer.mutable_armed() = *std::move(armed);
  return answer;
}

void HostMachine::BeginsJob(const v1::WorkerAssignment& assignment, const HostTime& now,
                            v1::ControlLease::OnLoss armed_on_loss) {
  begun_jobs_.push_back(job_);
  if (begun_jobs_.size() > kJobsKnown) begun_jobs_.pop_front();
  begin_stored_by_ = sequence_;
  const v1::ControlLease::OnLoss asked = assignment.job().run().on_loss();
  const v1::ControlLease::OnLoss wanted =
      asked != v1::ControlLease::ON_LOSS_UNSPECIFIED ? asked : armed_on_loss;
  if (desk_.lease()) return desk_.RunBegins(wanted);
  desk_.GiveToQueue(job_, wanted, now);
  TellControl();
}

// Whether a job may begin at a step: where that of another one was cut off, a person has looked at
// the machine and decided so. LIVE-5.10
Status HostMachine::MayBeginAtStep(const v1::HostOrder& order,
                                   const v1::WorkerAssignment& assignment) const {
  const std::string& cut_off = assignment.job().continues();
  if (cut_off.empty()) {
    if (auto why = WhyNoJob(order.caller()); !why.empty()) return std::move(why.front());
    return MayStartJob(order, assignment);
  }
  if (inspect_due_ && inspect_job_ == cut_off) return {};
  return Error{ErrorCode::kCellMachineState, cut_off + " waits for no decision here", {}};
}

// A job whose run begins at a step, as the preview of its start has it.
Status HostMachine::BeginJobAtStep(const v1::HostOrder& order, const HostTime& now) {
  mark_due_ = true;
  const v1::WorkerAssignment& assignment = order.continue_job().assignment();
  const bool continues = !assignment.job().continues().empty();
  if (const Status may = MayBeginAtStep(order, assignment); !may) return may.error();
  const v1::ControlLease::OnLoss armed_on_loss = arms_.on_loss();
  auto start = starts_.Take(order.continue_job().start(), Basis(), now);
  if (!start) return start.error();
  brought_.Clear();
  auto brought = ProgramOfJob(assignment);
  if (!brought) return brought.error();
  const auto object = [this, &assignment](const std::optional<machine::StoredProgram>& one) {
    const auto& stored = machine().memory().programs;
    const auto found = stored.find(assignment.main_program());
    if (one) return *one->object;
    return found != stored.end() ? *found->second.object : std::string_view();
  };
  const bool same = object(*brought) == object(start->brought);
  if (start->program != assignment.main_program() || !same ||
      continues != start->base.has_value()) {
    brought_.Clear();
    return Error{ErrorCode::kCellPreviewStale, "it was for another run", {}};
  }
  const Status whole = continues ? Status() : CheckPrograms(assignment, *brought);
  if (!whole) {
    brought_.Clear();
    return whole.error();
  }
  start->source = machine::StartSource::kQueue;
  start->brought = *std::move(brought);
  const auto& request = order.continue_job().start();
  start->halt_at_entry = request.has_halt_at_entry() ? request.halt_at_entry()
                                                     : continues || setup_.options.halt_at_entry();
  job_ = assignment.job().name();
  inspect_due_ = false;
  const std::size_t told = entries_.size();
  const Status begun = Apply(*start, &order);
  if (!begun) {
    inspect_due_ = continues;
    job_.clear();
    brought_.Clear();
    return begun.error();
  }
  if (continues) SettleInspection(order, told);
  BeginsJob(assignment, now, armed_on_loss);
  if (start->halt_at_entry) held_for_ = v1::HOLD_REASON_ENTRY;
  return {};
}

// All that keeps jobs of this caller from being begun by the queue. LIVE-5.02 (a)
std::vector<Error> HostMachine::WhyNoStart(const std::string& caller) const {
  std::vector<Error> why;
  if (disk_is_late_) why.push_back({ErrorCode::kCellJournal, "the disk does not answer", {}});
  for (Error& one : WhyNoJob(caller)) why.push_back(std::move(one));
  if (setup_.options.start() == v1::MachineOptions::START_PERSON)
    why.push_back({ErrorCode::kCellMode, "a person starts each job here", {}});
  if (setup_.options.start() == v1::MachineOptions::START_ARMED && !arms_.is_armed())
    why.push_back({ErrorCode::kCellNotArmed, "nobody has armed it, or that is over", {}});
  if (!machine().status().run.zeroed && !machine().status().open)
    why.push_back({setup_.family->info().not_zeroed, "the axes have no reference", {}});
  return why;
}

// What keeps jobs in the queue; whoever has control does not keep his own.
void HostMachine::AddBlockers(v1::MachineStatus& status) const {
  std::vector<Error> why = WhyNoStart(desk_.lease() ? desk_.lease()->holder() : std::string());
  if (desk_.lease() && !desk_.IsOfQueue())
    why.push_back({ErrorCode::kCellLeaseHeld, desk_.lease()->holder() + " has control", {}});
  for (const Error& one : why) *status.add_start_blockers() = bridge::ToStartBlocker(one);
}

// The answer to a start that is refused for the machine as it stands: all that is in the way, what
// it was refused for first. What keeps the queue alone does not keep a person.
void HostMachine::AddBlockers(const v1::HostOrder& order, v1::HostOrderAnswer& refused) const {
  const bool of_a_job = order.has_run_job() || order.has_continue_job();
  if (!of_a_job && !order.has_start() && !order.has_arm()) return;
  std::vector<Error> why =
      of_a_job && !order.has_by_person() ? WhyNoStart(order.caller()) : WhyNoJob(order.caller());
  const auto named = std::ranges::find_if(
      why, [&](const Error& one) { return CodeText(one.code) == refused.refusal().code(); });
  if (named == why.end()) return;
  std::rotate(why.begin(), named, named + 1);
  for (const Error& one : why) *refused.add_start_blockers() = bridge::ToStartBlocker(one);
}

// Whether an order for a job is for the one that is meant by it here.
Status HostMachine::CheckJob(const v1::HostOrder& order) const {
  const std::string& job = order.for_job();
  if (job.empty()) return {};
  if (order.has_run_state()) {
    const bool known = std::ranges::find(begun_jobs_, job) != begun_jobs_.end();
    return known ? Status() : Error{ErrorCode::kCellNotFound, job + " was not begun here", {}};
  }
  if (order.has_confirm()) {
    if (!inspect_due_ || job == inspect_job_) return {};
    return Error{ErrorCode::kCellMachineState,
                 (inspect_job_.empty() ? "a run without a job" : inspect_job_) +
                     " was cut off here, not " + job,
                 {}};
  }
  if (job == job_) return {};
  return Error{ErrorCode::kCellMachineState, job + " does not run", {}};
}

Status HostMachine::Confirm(const v1::HostOrder& order) {
  if (!inspect_due_)
    return Error{ErrorCode::kCellMachineState, "nothing waits for a confirmation", {}};
  const auto& given = order.confirm().confirmations();
  if (std::ranges::find(given, v1::CONFIRMATION_INSPECTED) == given.end())
    return Error{ErrorCode::kCellInspect, "confirm CONFIRMATION_INSPECTED", {}};
  SettleInspection(order, entries_.size());
  return {};
}

// Who looked at it, and what he made of the run; it stands before the entries that it let come.
void HostMachine::SettleInspection(const v1::HostOrder& order, std::size_t place) {
  inspect_due_ = false;
  inspect_job_.clear();
  cut_off_base_.reset();
  mark_due_ = true;
  const std::string why = order.reason().empty() ? "" : ": " + bridge::Utf8(order.reason());
  Add(machine().time())
      .mutable_event()
      ->mutable_message()
      ->set_text("inspected by " + order.caller() + why);
  const auto begin = entries_.begin() + static_cast<std::ptrdiff_t>(place);
  std::rotate(begin, entries_.end() - 1, entries_.end());
  std::int64_t number = sequence_ - (entries_.end() - begin);
  std::for_each(begin, entries_.end(), [&](v1::JournalEntry& one) { one.set_sequence(++number); });
}

// Whoever watched it begin is told how it ended. LIVE-5.08
void HostMachine::TellCutOff(const v1::MachineMark& mark, ErrorCode why) {
  v1::RunOver& told = *Add(SimTime(mark.virtual_time_ns())).mutable_run_over();
  told.set_run(machine().status().last_run);
  told.set_program(mark.base().program());
  v1::Outcome& outcome = *told.mutable_outcome();
  outcome = bridge::ToProto(machine::Outcome{.kind = machine::OutcomeKind::kStopped, .code = why});
  outcome.set_kind(v1::Outcome::KIND_INTERRUPTED);
  *outcome.mutable_place() = mark.place();
  outcome.set_cycle_time_ns(mark.run_time_ns());
  told.set_job(mark.job());
  last_run_ = LastRunOf(told);
  inspect_job_ = mark.job();
  entries_.back().set_job(mark.job());
  entries_.back().set_run_time_ns(mark.run_time_ns());
}

void HostMachine::EndRun(const HostTime& now) {
  now_ = now;
  const machine::MachineStatus status = machine().status();
  if (!status.open || status.open->by_hand || ended_) return;
  // Whether it has begun the store knows, and by it the next host. LIVE-5.20
  if (waits_for_store()) return;
  v1::MachineMark where;
  where.set_virtual_time_ns(status.time.count());
  where.set_run_time_ns(status.run.time.count());
  *where.mutable_place() = bridge::ToProto(status.run.place);
  where.set_job(job_);
  where.mutable_base()->set_program(status.open->program);
  cut_off_base_ = BaseNow();
  TellCutOff(where, ErrorCode::kCellHostStopped);
  ended_ = true;
}

}  // namespace rmlcell::server
