#include "server/runs/run_queue.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <utility>

#include "proto/bridge/findings.h"
#include "proto/bridge/milling.h"
#include "proto/bridge/start_blocker.h"
#include "server/base/names.h"
#include "server/jobs/assignment.h"
#include "server/machines/host_entries.h"
#include "server/records/job_messages.h"
#include "server/records/machine_options.h"
#include "server/runs/run_advice.h"
#include "server/runs/run_ticket.h"
#include "storage/jobs/job_rules.h"
#include "storage/trouble.h"

namespace rmlcell::server {
namespace {

// Its lease is that of the machine: it does not run out by itself. LIVE-5.01
constexpr std::chrono::milliseconds kWhileTheMachineIsHeld = std::chrono::days(366);

constexpr std::size_t kNotedMax = 1'000;

// Of these another try may go better; of all others the job ends.
bool MayGoBetterLater(ErrorCode code) {
  constexpr std::array kLater = {ErrorCode::kCellMachineState, ErrorCode::kCellMode,
                                 ErrorCode::kCellNotLive,      ErrorCode::kCellInspect,
                                 ErrorCode::kCellJournal,      ErrorCode::kCellLeaseHeld,
                                 ErrorCode::kCellDoorOpen,     ErrorCode::kCellUnimplemented,
                                 ErrorCode::kCellNotArmed,     ErrorCode::kCellUnavailable};
  return std::ranges::find(kLater, code) != kLater.end() ||
         Lookup(code).severity == Severity::kAlarm;
}

ErrorCode CodeOf(const v1::ErrorDetail& refusal) {
  const auto found = FindByText(refusal.code());
  return found.empty() ? ErrorCode::kCellInternal : found.front()->code;
}

// Why a job that does not wait any more is not begun; nothing: it runs.
std::optional<Error> WhyNotBegun(const storage::JobRecord& job) {
  if (job.state == storage::JobState::kRunning) return std::nullopt;
  const auto& outcome = job.outcome;
  if (job.state == storage::JobState::kFailed && outcome && outcome->code &&
      Lookup(*outcome->code).family == ErrorFamily::kCell)
    return Error{*outcome->code, outcome->detail, {}};
  return Error{ErrorCode::kCellPrecondition, JobName(job.id) + " waits no more", {}};
}

v1::Job SpecificationOf(const storage::JobRecord& job) {
  v1::Job specification;
  if (!specification.ParseFromString(job.specification)) specification.Clear();
  return specification;
}

bool Continues(const storage::JobRecord& job) { return !SpecificationOf(job).continues().empty(); }

// What a preview that may not begin says, as a host that refuses the job would.
v1::HostOrderAnswer RefusedFor(ErrorCode code, const std::string& why) {
  v1::HostOrderAnswer answer;
  answer.mutable_refusal()->set_code(CodeText(code));
  answer.mutable_refusal()->set_message(why);
  return answer;
}
v1::HostOrderAnswer RefusedBy(const v1::PreviewStartResponse& preview) {
  if (preview.refusals().empty()) return RefusedFor(ErrorCode::kCellStepUnreachable, {});
  v1::HostOrderAnswer answer = RefusedFor(ErrorCode::kCellInternal, preview.refusals(0).message());
  answer.mutable_refusal()->set_code(preview.refusals(0).code());
  return answer;
}

// Whether jobs of this machine start when their turn comes, once somebody has armed it or not at
// all, and no person says so of each. LIVE-5.04
bool StartsByItself(storage::Store& store, const std::string& machine) {
  const auto record = store.GetMachine(machine);
  if (!record) return true;
  const auto options = OptionsOf(*record);
  return !options || options->start() != v1::MachineOptions::START_PERSON;
}

// Of what a start at a step asks a person, that which the job does not say that it was seen to.
std::string UnseenOf(const v1::PreviewStartResponse& preview, const v1::RunOptions& run) {
  std::string unseen;
  for (const v1::StartDifference& one : preview.differences()) {
    const bool seen =
        one.action() != v1::START_ACTION_ASK ||
        std::ranges::find(run.confirmations(), one.confirmation()) != run.confirmations().end();
    if (!seen) unseen += (unseen.empty() ? "" : ", ") + one.item();
  }
  return unseen;
}

// Whether this is nothing to a job of this caller.
bool Allows(const v1::StartBlocker& blocker, const v1::MachineStatus& status,
            const std::string& caller, bool unzeroed) {
  const auto found = FindByText(blocker.code());
  if (found.empty()) return false;
  const ErrorCode code = found.front()->code;
  if (code == ErrorCode::kCellLeaseHeld) return status.control().holder() == caller;
  // Else it is that the axes have no reference.
  return unzeroed && !status.zeroed() && found.front()->family != ErrorFamily::kCell &&
         status.alarms().empty();
}

// The program of the job alone: the host has the rest. Where it goes on with a run, a person has
// looked at what it does, and it needs no ticket.
Result<v1::WorkerAssignment> ForHost(storage::Store& store, const Config& config,
                                     const storage::LeasedJob& leased, bool continues) {
  Result<AssignmentMessages> made = MakeAssignment(store, config, leased);
  if (!made) return made.error();
  v1::WorkerAssignment assignment = std::move(*made->first.mutable_assignment());
  auto& programs = *assignment.mutable_programs();
  for (const auto& [slot, bytes] : made->programs) {
    const auto program = std::ranges::find(programs, slot, &v1::AssignedProgram::slot);
    if (program != programs.end()) program->set_content(*bytes);
  }
  programs.erase(std::remove_if(programs.begin(), programs.end(),
                                [&](const v1::AssignedProgram& program) {
                                  return program.slot() != assignment.main_program();
                                }),
                 programs.end());
  assignment.clear_machine_state();
  assignment.clear_schedules();
  assignment.clear_deleted_programs();
  const std::string& simulation = assignment.job().run().ticket();
  if (!simulation.empty() && !continues) {
    Result<v1::RunTicket> ticket = TicketOf(store, simulation);
    if (!ticket) return ticket.error();
    *assignment.mutable_ticket() = *std::move(ticket);
  }
  assignment.mutable_lease()->set_job(leased.lease.job);
  assignment.mutable_lease()->set_attempt(leased.lease.attempt);
  assignment.mutable_lease()->set_fence(leased.lease.fence);
  return assignment;
}

}  // namespace

void RunQueue::Wake(const std::string& machine) {
  {
    const std::lock_guard lock(mutex_);
    if (!looking_.insert(machine).second) {
      once_more_.insert(machine);
      return;
    }
  }
  needs_.executor.Post([this, machine] { Look(machine); });
}

void RunQueue::WakeAll() {
  for (const std::string& machine : needs_.hosts.Machines()) Wake(machine);
}

// One at a time for each machine.
void RunQueue::Look(const std::string& machine) {
  LookOnce(machine);
  {
    const std::lock_guard lock(mutex_);
    if (once_more_.erase(machine) == 0) {
      looking_.erase(machine);
      return;
    }
  }
  needs_.executor.Post([this, machine] { Look(machine); });
}

void RunQueue::LookOnce(const std::string& machine) {
  const auto status = needs_.hosts.StatusOf(machine);
  if (!status || status->state() == v1::MACHINE_STATE_LOST ||
      status->state() == v1::MACHINE_STATE_STARTING)
    return;
  if (!IsBusy(machine, *status)) BeginNext(machine, *status);
}

std::string RunQueue::MachineOf(const std::string& job) const {
  {
    const std::lock_guard lock(mutex_);
    const auto beginning = beginning_.find(job);
    if (beginning != beginning_.end()) return beginning->second;
  }
  return needs_.hosts.MachineThatRuns(job);
}

bool RunQueue::IsToBeDecided(const std::string& job) const {
  const std::vector<std::string> machines = needs_.hosts.Machines();
  return std::ranges::any_of(machines, [&](const std::string& machine) {
    const auto status = needs_.hosts.StatusOf(machine);
    return status && status->cut_off_job() == job;
  });
}

bool RunQueue::IsBusy(const std::string& machine, const v1::MachineStatus& status) {
  const auto running = needs_.store.ListJobs({.machine = machine,
                                              .state = storage::JobState::kRunning,
                                              .kind = std::string(storage::kRunKind),
                                              .limit = 1});
  if (!running) return true;
  if (running->empty()) return false;
  {
    // What is left of jobs that are over; there are no more RUNs under way than machines.
    const std::lock_guard lock(mutex_);
    if (unheard_of_.size() > kNotedMax) unheard_of_.clear();
    if (aborted_.size() > kNotedMax) aborted_.clear();
  }
  const storage::JobRecord& job = running->front();
  const std::string name = JobName(job.id);
  if (status.run().job() == name) {
    bool abort = false;
    if (job.cancel_requested) {
      const std::lock_guard lock(mutex_);
      abort = aborted_.insert(job.id).second;
    }
    if (abort) AbortCancelled(job);
    return true;
  }
  const auto attempts = needs_.store.ListAttempts(job.id);
  if (!attempts || attempts->empty() || attempts->back().ended_at) return true;
  const storage::AttemptRecord& attempt = attempts->back();
  {
    const std::lock_guard lock(mutex_);
    if (beginning_.contains(name)) return true;
    const auto [since, first] = unheard_of_.emplace(attempt.fence, needs_.clock());
    if (first || needs_.clock() - since->second < kUnheardOf) return true;
    since->second = needs_.clock();  // asked again later, where nobody answers
  }
  // What an earlier host had is told by the first that this one tells.
  if (attempt.worker != status.host() || !needs_.hosts.IsSettled(machine)) return true;
  AskWhetherBegun(machine, {.lease = {.job = job.id,
                                      .attempt = attempt.number,
                                      .fence = attempt.fence,
                                      .worker = attempt.worker},
                            .job = job});
  return true;
}

// Its order may be lost, or its end on the way: the host knows.
void RunQueue::AskWhetherBegun(const std::string& machine, const storage::LeasedJob& job) {
  v1::HostOrder order;
  order.mutable_run_state()->set_machine(MachineName(machine));
  order.set_for_job(JobName(job.lease.job));
  needs_.hosts.Ask(
      machine, std::move(order), [this, job](const Result<v1::HostOrderAnswer>& answer) {
        if (!answer || !answer->has_refusal() ||
            answer->refusal().code() != CodeText(ErrorCode::kCellNotFound))
          return;
        needs_.executor.Post([this, job] { GiveBack(job, "the host never heard of it"); });
      });
}

void RunQueue::BeginNext(const std::string& machine, const v1::MachineStatus& status) {
  {
    const std::lock_guard lock(mutex_);
    const auto rests = rests_until_.find(machine);
    if (rests != rests_until_.end() && needs_.clock() < rests->second) return;
    rests_until_.erase(machine);
  }
  const auto waiting = needs_.store.ListJobs({.machine = machine,
                                              .state = storage::JobState::kQueued,
                                              .kind = std::string(storage::kRunKind),
                                              .order = storage::JobOrder::kQueue,
                                              .limit = 1});
  if (!waiting || waiting->empty() || waiting->front().blocked) return;
  const auto job = needs_.store.GetJob(waiting->front().id);
  v1::Job asked;
  if (!job || !asked.ParseFromString(job->specification)) return;
  const std::string& armed_for = status.armed_for();
  if (!armed_for.empty() && armed_for != JobName(job->id)) return;
  const bool may = std::ranges::all_of(status.start_blockers(), [&](const auto& blocker) {
    return Allows(blocker, status, job->caller, asked.run().unzeroed());
  });
  if (!may) return;
  const auto leased =
      needs_.store.AcquireJobs({.worker = status.host(),
                                .server = needs_.server,
                                .kinds = {std::string(storage::kRunKind)},
                                .run_machines = {machine},
                                .duration = kWhileTheMachineIsHeld,
                                .events = {StateEvent(storage::JobState::kRunning)}});
  if (!leased) {
    spdlog::warn("a job for {}: {}", machine, bridge::ErrorText(leased.error()));
    return;
  }
  if (!leased->empty()) Begin(machine, leased->front());
}

// Where it goes on a person says, and nobody else. LIVE-2.05
void RunQueue::Begin(const std::string& machine, const storage::LeasedJob& leased) {
  if (Continues(leased.job)) {
    return End(leased, {.state = storage::JobState::kFailed,
                        .code = ErrorCode::kCellPreviewStale,
                        .detail = "decide again where it goes on"});
  }
  v1::HostOrder order;
  order.set_caller(leased.job.caller);
  Send(machine, leased, std::move(order),
       [this, machine, leased](const Result<v1::HostOrderAnswer>& answer) {
         needs_.executor.Post(
             [this, machine, leased, answer] { Answered(machine, leased, answer); });
       });
}

// With its program. Where it does not go out `done` is told why.
void RunQueue::Send(const std::string& machine, const storage::LeasedJob& leased,
                    v1::HostOrder order, Hosts::Answered done) {
  if (leased.job.cancel_requested) {
    End(leased, storage::CancelledOutcome());
    return done(Error{ErrorCode::kCellCancelled, JobName(leased.job.id) + " was cancelled", {}});
  }
  const bool continues = Continues(leased.job);
  if (!order.has_continue_job() && SpecificationOf(leased.job).run().has_step())
    return LookAtStep(machine, leased, std::move(order), std::move(done));
  Result<v1::WorkerAssignment> assignment = ForHost(needs_.store, needs_.config, leased, continues);
  if (!assignment) {
    EndUnread(leased, assignment.error(), continues);
    return done(assignment.error());
  }
  spdlog::info("{} goes to {}", JobName(leased.job.id), machine);
  {
    const std::lock_guard lock(mutex_);
    beginning_[JobName(leased.job.id)] = machine;
  }
  (order.has_continue_job() ? *order.mutable_continue_job()->mutable_assignment()
                            : *order.mutable_run_job()) = *std::move(assignment);
  needs_.hosts.Ask(machine, std::move(order),
                   [this, leased, done = std::move(done)](Result<v1::HostOrderAnswer> answer) {
                     {
                       const std::lock_guard lock(mutex_);
                       beginning_.erase(JobName(leased.job.id));
                     }
                     done(std::move(answer));
                   });
}

// Whose program, or what else it needs, could not be had.
void RunQueue::EndUnread(const storage::LeasedJob& leased, const Error& why, bool held) {
  if (storage::IsTroubleOfTheStore(why))
    return GiveBack(leased, "its program could not be read", held);
  End(leased, {.state = storage::JobState::kFailed, .code = why.code, .detail = why.detail});
}

// As it is by now, with a cancel that came meanwhile; nothing: it is not this server's any more, or
// the store does not say.
std::optional<storage::LeasedJob> RunQueue::StillLeased(const storage::LeasedJob& leased) {
  const auto job = needs_.store.GetJob(leased.job.id);
  const auto attempts = needs_.store.ListAttempts(leased.job.id);
  if (!job || !attempts || attempts->empty()) return std::nullopt;
  const storage::AttemptRecord& attempt = attempts->back();
  if (attempt.fence != leased.lease.fence || attempt.ended_at) return std::nullopt;
  return storage::LeasedJob{.lease = leased.lease, .job = *job};
}

// One that begins at a step: what it would do comes first, as a person has it. LIVE-6.08
void RunQueue::LookAtStep(const std::string& machine, const storage::LeasedJob& leased,
                          v1::HostOrder order, Hosts::Answered done) {
  auto program = ProgramOf(leased.job.id);
  if (!program) {
    EndUnread(leased, program.error(), false);
    return done(program.error());
  }
  const v1::RunOptions run = SpecificationOf(leased.job).run();
  v1::HostOrder question;
  question.set_caller(order.caller());
  question.set_for_job(JobName(leased.job.id));
  v1::PreviewStartRequest& asked = *question.mutable_preview_start();
  asked.set_machine(MachineName(machine));
  asked.set_program(program->slot());
  *asked.mutable_step() = run.step();
  asked.set_occurrence(run.occurrence());
  asked.set_off_until_work_on(run.off_until_work_on());
  *question.mutable_brought() = *std::move(program);
  if (auto milling = MillingOf(leased.job.id)) *asked.mutable_milling() = *std::move(milling);
  {
    const std::lock_guard lock(mutex_);
    beginning_[JobName(leased.job.id)] = machine;
  }
  needs_.hosts.Ask(
      machine, std::move(question),
      [this, machine, leased, run, order = std::move(order),
       done = std::move(done)](Result<v1::HostOrderAnswer> answer) mutable {
        {
          const std::lock_guard lock(mutex_);
          beginning_.erase(JobName(leased.job.id));
        }
        if (!answer || answer->has_refusal()) return done(std::move(answer));
        const v1::PreviewStartResponse& preview = answer->preview();
        if (preview.preview_token().empty()) return done(RefusedBy(preview));
        if (const std::string unseen = UnseenOf(preview, run); !unseen.empty())
          return done(RefusedFor(ErrorCode::kCellInvalidArgument,
                                 "job.run.confirmations: nobody has seen to " + unseen));
        v1::StartAtStepRequest& start = *order.mutable_continue_job()->mutable_start();
        start.set_machine(MachineName(machine));
        start.set_preview_token(preview.preview_token());
        *start.mutable_confirmations() = run.confirmations();
        needs_.executor.Post([this, machine, leased, order, done] {
          // It took a while: somebody may have stopped it meanwhile.
          if (const auto now = StillLeased(leased)) return Send(machine, *now, order, done);
          done(Error{ErrorCode::kCellLeaseLost, JobName(leased.job.id) + " was taken away", {}});
        });
      });
}

// One that was not answered may have begun: what its host says later tells.
void RunQueue::Answered(const std::string& machine, const storage::LeasedJob& leased,
                        const Result<v1::HostOrderAnswer>& answer) {
  if (!answer) return;
  if (!answer->has_refusal()) return Wake(machine);  // a cancel may have come meanwhile
  const v1::ErrorDetail& refusal = answer->refusal();
  const ErrorCode code = CodeOf(refusal);
  spdlog::info("{}: {} {}", JobName(leased.job.id), refusal.code(), refusal.message());
  // Somebody has looked at another start meanwhile, or the machine was changed.
  const bool looked_at_again = code == ErrorCode::kCellPreviewStale && !Continues(leased.job);
  if (!looked_at_again && !MayGoBetterLater(code)) {
    return End(
        leased,
        {.state = storage::JobState::kFailed, .code = code, .detail = Detail(refusal.message())});
  }
  {
    const std::lock_guard lock(mutex_);
    rests_until_[machine] = needs_.clock() + kRests;
  }
  // Somebody was at the machine at the same moment, or it knows no jobs: a person lets the job go.
  // LIVE-2.05
  const bool held = code == ErrorCode::kCellMachineState || code == ErrorCode::kCellUnimplemented;
  GiveBack(leased, CodeText(code) + ": " + refusal.message(), held);
}

Result<v1::AssignedProgram> RunQueue::ProgramOf(std::int64_t job) {
  return ProgramOfJob(needs_.store, job);
}

std::optional<v1::Milling> RunQueue::MillingOf(std::int64_t job) {
  const auto run = SpecificationOf(needs_.store, job);
  if (!run) return std::nullopt;
  const auto id = ParseJobName(run->run().ticket());
  if (!id) return std::nullopt;
  const auto simulation = SpecificationOf(needs_.store, *id);
  if (!simulation || !simulation->simulation().has_milling()) return std::nullopt;
  // Its cells were for pictures; where they cannot be fine enough nobody is refused for it.
  v1::Milling milling = simulation->simulation().milling();
  milling.clear_cell_mm();
  milling.clear_target();
  const auto read = bridge::FromProto(milling);
  if (!read || read->stock.cell > read->tool.radius_mm) return std::nullopt;
  return milling;
}

void RunQueue::BeginByPerson(std::int64_t id, v1::HostOrder order, Hosts::Answered done) {
  const auto job = needs_.store.GetJob(id);
  if (!job) return done(job.error());
  const bool continues = order.has_continue_job();
  const auto status = needs_.hosts.StatusOf(job->machine);
  if (job->state != storage::JobState::kQueued) {
    if (auto why = WhyNotBegun(*job)) return done(*std::move(why));
    v1::HostOrderAnswer begun;
    if (status) *begun.mutable_status() = *status;
    return done(std::move(begun));
  }
  // It waits for nobody else: it is over, or it stays as it is.
  const auto refuse = [this, id, continues, &done](const Error& why) {
    if (continues && !storage::IsTroubleOfTheStore(why))
      static_cast<void>(
          needs_.store.RequestCancel(id, {EndedEvent(ToProto(storage::CancelledOutcome()))}));
    done(why);
  };
  if (job->kind != storage::kRunKind)
    return done(Error{ErrorCode::kCellPrecondition, JobName(id) + " is no RUN", {}});
  if (!continues && Continues(*job))
    return done(Error{ErrorCode::kCellPreviewStale, "decide again where it goes on", {}});
  if (!status) return refuse({ErrorCode::kCellNotLive, job->machine + " has no host", {}});
  const auto leased =
      needs_.store.AcquireJobs({.worker = status->host(),
                                .server = needs_.server,
                                .kinds = {std::string(storage::kRunKind)},
                                .job = id,
                                .duration = kWhileTheMachineIsHeld,
                                .events = {StateEvent(storage::JobState::kRunning)}});
  if (!leased) return refuse(leased.error());
  if (leased->empty()) {
    // The queue, which may begin it as well, was first; or another one runs.
    const auto now = needs_.store.GetJob(id);
    if (now && now->state != storage::JobState::kQueued)
      return BeginByPerson(id, std::move(order), std::move(done));
    return refuse({ErrorCode::kCellMachineState, "another job runs on " + job->machine, {}});
  }
  Send(job->machine, leased->front(), std::move(order),
       [this, machine = job->machine, leased = leased->front(), continues,
        done = std::move(done)](Result<v1::HostOrderAnswer> answer) {
         needs_.executor.Post([this, machine, leased, continues, answer, done] {
           if (!answer || !answer->has_refusal()) {
             Wake(machine);
           } else if (continues) {
             End(leased, {.state = storage::JobState::kFailed,
                          .code = CodeOf(answer->refusal()),
                          .detail = Detail(answer->refusal().message())});
           } else {
             // Where the queue starts jobs it is not to begin by itself: whoever began it may have
             // pressed STOP since. LIVE-2.05
             GiveBack(leased, answer->refusal().code() + ": " + answer->refusal().message(),
                      StartsByItself(needs_.store, machine));
           }
           done(answer);
         });
       });
}

void RunQueue::TellWhyItWaits(v1::Job& job) const {
  const auto add = [&job](const Error& error) {
    *job.add_start_blockers() = bridge::ToStartBlocker(error);
  };
  const auto machine = ParseMachineName(job.machine());
  const auto status = machine ? needs_.hosts.StatusOf(*machine) : std::nullopt;
  const Result<std::int64_t> id = ParseJobName(job.name());
  if (id && job.continues().empty()) {
    if (const auto why = WhyItWouldFail(needs_.store, needs_.config, *id))
      add({why->code, "the job would end with this: " + why->detail, {}});
  }
  const bool heard_of = status && status->state() != v1::MACHINE_STATE_LOST &&
                        status->state() != v1::MACHINE_STATE_STARTING;
  if (!heard_of) return add({ErrorCode::kCellNotLive, "no host tells of it", {}});
  for (const v1::StartBlocker& blocker : status->start_blockers()) {
    if (!Allows(blocker, *status, job.caller(), job.run().unzeroed()))
      *job.add_start_blockers() = blocker;
  }
  const std::string& armed_for = status->armed_for();
  if (!armed_for.empty() && armed_for != job.name())
    add({ErrorCode::kCellNotArmed, "it is armed for " + armed_for, {}});
  const std::string& holder = status->control().holder();
  const bool by_somebody_else = std::ranges::any_of(
      job.start_blockers(), [held = CodeText(ErrorCode::kCellLeaseHeld)](
                                const v1::StartBlocker& one) { return one.code() == held; });
  if (!by_somebody_else || job.wait_reason() != v1::WAIT_REASON_MACHINE_NOT_READY) return;
  job.set_wait_reason(v1::WAIT_REASON_CONTROL);
  job.set_waits_for("control: " + holder);
}

void RunQueue::GiveBack(const storage::LeasedJob& leased, const std::string& why, bool held) {
  {
    const std::lock_guard lock(mutex_);
    unheard_of_.erase(leased.lease.fence);
    aborted_.erase(leased.lease.job);
  }
  const Status back = server::GiveBack(needs_.store, leased.lease, why, held);
  if (!back) spdlog::warn("{}: {}", JobName(leased.job.id), bridge::ErrorText(back.error()));
}

void RunQueue::End(const storage::LeasedJob& leased, const storage::JobOutcome& how) {
  const v1::Outcome outcome = ToProto(how);
  const auto ended = needs_.store.Finish(
      leased.lease, {.outcome = OutcomeOf(outcome), .events = {EndedEvent(outcome)}});
  if (!ended) spdlog::warn("{}: {}", JobName(leased.job.id), bridge::ErrorText(ended.error()));
}

void RunQueue::Ask(const std::string& job, v1::HostOrder order, Hosts::Answered done) {
  const std::string machine = MachineOf(job);
  if (machine.empty())
    return done(Error{ErrorCode::kCellNotLive, "no machine is heard of that runs " + job, {}});
  order.set_for_job(job);
  needs_.hosts.Ask(machine, std::move(order), std::move(done));
}

void RunQueue::Abort(const std::string& job, const std::string& caller,
                     const std::string& request_id, Hosts::Answered done) {
  v1::HostOrder order;
  order.set_caller(caller);
  order.mutable_abort()->set_request_id(request_id);
  Ask(job, std::move(order), std::move(done));
}

void RunQueue::AbortCancelled(const storage::JobRecord& job) {
  const auto answered = [this, id = job.id](const Result<v1::HostOrderAnswer>& answer) {
    if (answer || answer.error().code != ErrorCode::kCellNotLive) return;
    const std::lock_guard lock(mutex_);
    aborted_.erase(id);  // nobody has heard it: again, when its host is there
  };
  Abort(JobName(job.id), job.caller, {}, answered);
}

}  // namespace rmlcell::server
