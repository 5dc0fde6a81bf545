#include "server/worker/job_runner.h"

#include <spdlog/spdlog.h>
#include <time.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <new>
#include <thread>
#include <utility>
#include <vector>

#include "engine/families/families.h"
#include "engine/simulation/run/rehearsal.h"
#include "engine/simulation/run/simulate.h"
#include "engine/simulation/run/timetable.h"
#include "engine/simulation/verdict/verdict.h"
#include "proto/bridge/encoding.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/milling.h"
#include "proto/bridge/report.h"
#include "proto/bridge/setup.h"
#include "server/worker/assigned_programs.h"
#include "server/worker/job_events.h"
#include "server/worker/job_output.h"
#include "server/worker/material_files.h"
#include "server/worker/memory_budget.h"
#include "server/worker/pacer.h"

namespace rmlcell::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPositionInterval{50};  // at most 20 positions a second
// Virtual time of one step of the simulation: it adapts, so that a step takes about this long.
constexpr std::chrono::milliseconds kStepTarget{5};
constexpr SimTime kSliceMin = std::chrono::milliseconds(10);
constexpr SimTime kSliceMax = std::chrono::hours(10);
constexpr SimTime kPacedSliceMin = std::chrono::milliseconds(1);

double ProcessorTime_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

v1::Outcome OutcomeFor(machine::OutcomeKind kind, ErrorCode code, std::string detail = {}) {
  const machine::Outcome outcome{.kind = kind, .code = code, .detail = std::move(detail)};
  return bridge::ToProto(outcome, simulation::JudgeOutcome(outcome));
}

// One attempt.
class Attempt {
 public:
  Attempt(ServerLine& line, v1::WorkerAssignment assignment, const std::atomic<bool>& stopping)
      : line_(line),
        assignment_(std::move(assignment)),
        programs_(assignment_),
        stopping_(stopping),
        output_(line, assignment_.lease(), assignment_.budget().output_bytes()),
        events_([this](const v1::WorkerEvents& events) { SendEvents(events); }),
        started_s_(ProcessorTime_s()) {}

  enum class End { kFinished, kHandBack, kLost };

  End Run() {
    if (!ReceivePrograms()) return End::kLost;
    const End end = assignment_.job().kind() == v1::JOB_KIND_CHECK ? Check() : Simulate();
    if (end == End::kFinished) {
      events_.TellRest();
      events_.Flush();
      Finish();
    }
    return end;
  }

  // For what left the job by an exception.
  void Fail(const v1::Outcome& outcome) {
    outcome_ = outcome;
    Finish();
  }

  bool stop_asked() const { return stop_asked_; }

 private:
  bool ReceivePrograms() {
    while (!programs_.complete()) {
      std::optional<v1::WorkResponse> message = line_.Receive(std::chrono::seconds(60));
      if (!message) return false;
      if (message->has_blob()) {
        programs_.Add(message->blob());
      } else {
        Obey(*message);
      }
      if (released_) return false;
    }
    return true;
  }

  // A translation that fails ends the job with its first error; the findings are its report.
  void ReportFindings(const simulation::PreparedRun& made, const machine::Judgement& judgement,
                      const std::string& motion_check = {}) {
    v1::RunReport report;
    report.set_family(assignment_.family());
    bridge::SetMachine(programs_.Machine(), report);
    report.set_motion_check(bridge::Utf8(motion_check));
    for (Diagnostic diagnostic : made.diagnostics) {
      diagnostic.judged = machine::JudgedBy(judgement, diagnostic.code);
      *report.add_diagnostics() = bridge::ToProto(diagnostic);
      events_.OnDiagnostic(diagnostic.at.value_or(SimTime(0)), diagnostic);
    }
    report.set_diagnostics_dropped(static_cast<std::int64_t>(made.diagnostics_dropped));
    const auto first = std::ranges::find_if(
        made.diagnostics, [](const Diagnostic& d) { return IsError(d.severity); });
    outcome_ = v1::Outcome();
    outcome_.set_kind(v1::Outcome::KIND_COMPLETED);
    if (first != made.diagnostics.end()) {
      outcome_ = OutcomeFor(machine::OutcomeKind::kFailed, first->code, first->detail);
      outcome_.mutable_place()->set_program(first->program);
      outcome_.mutable_place()->set_step(first->step);
      outcome_.mutable_place()->set_line(first->where.line);
      outcome_.mutable_place()->set_column(first->where.column);
    }
    bridge::SetJudgement(judgement, outcome_);
    *report.mutable_outcome() = outcome_;
    const std::string bytes = bridge::StableBytes(report);
    if (!output_.Fits(bytes.size())) return ExceedOutput();
    output_.Send("report", "application/x-protobuf", bytes);
  }

  void ExceedOutput() {
    outcome_ = OutcomeFor(machine::OutcomeKind::kBudgetExceeded, ErrorCode::kCellOutputBudget);
  }

  End Check() {
    const simulation::ProgramMemory memory = programs_.Memory();
    const auto parameters =
        machine::MakeParameters(*memory.family, memory.profile, memory.parameters);
    if (!parameters) return Refuse(parameters.error());
    const int slot = assignment_.main_program();
    Result<simulation::ProgramCheck> check = simulation::CheckProgram(
        memory, *parameters, slot, true, bridge::InputsOf(assignment_.job().simulation()));
    if (!check) return Refuse(check.error());
    machine::Translation& translation = check->translation;
    for (Diagnostic& diagnostic : translation.diagnostics) diagnostic.program = slot;
    const machine::Judgement judgement =
        simulation::JudgeCheck(*memory.family, translation, check->motion);
    simulation::PreparedRun found{
        .diagnostics = std::move(translation.diagnostics),
        .diagnostics_dropped = translation.diagnostics_dropped + check->motion.findings_dropped};
    found.diagnostics.insert(found.diagnostics.end(), check->motion.findings.begin(),
                             check->motion.findings.end());
    std::string motion_check;
    if (!check->motion.cut_short.empty()) motion_check = check->motion.cut_short.begin()->second;
    while (const std::optional<v1::WorkResponse> message =
               line_.Receive(std::chrono::milliseconds(0))) {
      Obey(*message);
      if (released_) return End::kLost;
    }
    if (CancelOrdered()) return Cancelled();
    if (OverTime()) {
      outcome_ = OutcomeFor(machine::OutcomeKind::kBudgetExceeded, ErrorCode::kCellProcessorBudget);
      return End::kFinished;
    }
    ReportFindings(found, judgement, motion_check);
    return End::kFinished;
  }

  End Cancelled() {
    outcome_ = OutcomeFor(machine::OutcomeKind::kCancelled, ErrorCode::kCellCancelled);
    return End::kFinished;
  }

  End Refuse(const Error& error) {
    outcome_ = OutcomeFor(machine::OutcomeKind::kFailed, error.code, error.detail);
    return End::kFinished;
  }

  // What the run leaves, into the buffers of this attempt while they fit its budget.
  simulation::Products ProductsOf(const v1::SimulationOptions& options) {
    simulation::Products products;
    if (options.trace()) {
      products.trace = [this](const simulation::TraceRecord& record) {
        return output_.AddTrace(bridge::ToProto(record).SerializeAsString());
      };
    }
    products.toolpath = [this](std::string_view block) { return output_.AddToolpath(block); };
    if (options.toolpath_tolerance_mm() > 0.0) {
      products.toolpath_options.tolerance_mm = options.toolpath_tolerance_mm();
    }
    products.picture = true;
    products.also = &events_;
    return products;
  }

  End Simulate() {
    const v1::SimulationOptions& options = assignment_.job().simulation();
    const auto variables =
        bridge::ExpandVariables({options.variables().begin(), options.variables().end()});
    if (!variables) return Refuse(variables.error());
    simulation::Products products = ProductsOf(options);
    if (options.has_milling()) {
      Result<simulation::Milling> milling = bridge::FromProto(options.milling());
      if (!milling) return Refuse(milling.error());
      products.milling = *std::move(milling);
    }
    Result<simulation::PreparedRun> made = simulation::PrepareRun(
        programs_.Memory(),
        bridge::RunOptionsOf(options, assignment_.budget(), assignment_.main_program(),
                             machine::Mode::kRemote));
    if (!made) return Refuse(made.error());
    if (CancelOrdered()) return Cancelled();
    if (!made->setup) {
      ReportFindings(*made, simulation::JudgeFindings(made->diagnostics));
      return End::kFinished;
    }
    if (products.milling) {
      if (const std::optional<End> end = SetTarget(*products.milling)) return *end;
    }
    for (const Diagnostic& diagnostic : made->diagnostics)
      events_.OnDiagnostic(SimTime(0), diagnostic);
    const machine::MachineFamily& family = *families::FindFamily(assignment_.family());
    hold_key_ = machine::HoldKey(family.info(), made->setup->mode);
    if (options.pace() > 0.0) {  // else it is over as soon as that would be known
      Result<std::unique_ptr<simulation::TimetableRun>> timetable_run =
          simulation::TimetableRun::Of(family, *made->setup);
      if (timetable_run) timetable_run_ = *std::move(timetable_run);
    }
    const Result<simulation::BegunRun> begun =
        simulation::Begin(family, std::move(*made->setup), std::move(products));
    if (!begun) return Refuse(begun.error());
    if (const End end = Drive(*begun); end != End::kFinished) return end;

    const simulation::RunReport report = begun->simulation->Finish();
    std::map<std::string, std::string> values;
    for (const std::string& name : *variables) {
      if (const auto value = begun->run->ReadVariable(name)) values[name] = *value;
    }
    v1::RunReport message = bridge::ToProto(report, values);
    machine::MarkJudged(report.judgement, made->diagnostics);
    bridge::AddFindingsOfText(made->diagnostics, message);
    outcome_ = message.outcome();
    executables_ = begun->run->made_executables();
    return SendProducts(message, begun->recorder->Svg(report, {}), begun->recorder->milling());
  }

  // What is left is compared with the target of the job, when it has one. An end: there will be no
  // run.
  std::optional<End> SetTarget(simulation::Milling& milling) {
    const v1::SimulationOptions& options = assignment_.job().simulation();
    if (!assignment_.has_target()) return std::nullopt;
    // As the command runs such a program: by itself, with nobody at its keys.
    const simulation::RunOptions all = bridge::RunOptionsOf(
        options, assignment_.budget(), assignment_.main_program(), machine::Mode::kCycle);
    Result<std::vector<float>> heights = programs_.TargetHeights(
        milling,
        {.parameters = all.parameters, .mode = machine::Mode::kCycle, .budget = all.budget},
        [this] { return StopAsked() == Stop::kNone; });
    if (const Stop stop = StopAsked(); stop != Stop::kNone) return EndOf(stop);
    if (!heights) {
      const std::string& name = assignment_.target().file_name();
      return Refuse({heights.error().code,
                     (name.empty() ? "target: " : "target " + name + ": ") + heights.error().detail,
                     {}});
    }
    milling.target = simulation::Target{
        .heights = std::make_shared<const std::vector<float>>(*std::move(heights)),
        .tolerance_mm = bridge::TargetToleranceOf(options.milling().target())};
    return std::nullopt;
  }

  // All of them; or the report alone, which then says why the rest is not there. A job that is
  // cancelled meanwhile leaves no files of its block.
  End SendProducts(v1::RunReport& report, const std::string& picture,
                   const simulation::MillingRecorder* milling) {
    const v1::SimulationOptions& options = assignment_.job().simulation();
    std::string bytes = bridge::StableBytes(report);
    const std::size_t smaller = bytes.size() + picture.size();
    // A run that was broken off has no time left, or nobody who looks at its block.
    const bool broken_off = outcome_.kind() == v1::Outcome::KIND_BUDGET_EXCEEDED ||
                            outcome_.kind() == v1::Outcome::KIND_CANCELLED;
    std::optional<std::vector<ProductFile>> files;
    if (output_.Fits(smaller)) files.emplace();
    Stop stop = Stop::kNone;
    if (files && milling != nullptr && !broken_off) {
      const std::optional<simulation::Target>& target = milling->target();
      files = MaterialFiles(milling->material(), target ? &*target : nullptr, options.milling(),
                            [&](std::size_t material_bytes) {
                              stop = StopAsked();
                              return stop == Stop::kNone && output_.Fits(smaller + material_bytes);
                            });
    }
    if (stop == Stop::kLost || stop == Stop::kHandBack) return EndOf(stop);
    if (stop == Stop::kCancel) files.emplace();
    if (!files || stop != Stop::kNone) {
      if (stop == Stop::kNone) {
        ExceedOutput();
      } else {
        (void)EndOf(stop);
      }
      *report.mutable_outcome() = outcome_;
      bytes = bridge::StableBytes(report);
    }
    if (files || output_.Fits(bytes.size()))
      output_.Send("report", "application/x-protobuf", bytes);
    if (!files) return End::kFinished;
    output_.SendToolpath();
    if (options.trace()) output_.SendTrace();
    output_.Send("picture.svg", "image/svg+xml", picture);
    for (const ProductFile& file : *files) output_.Send(file.name, file.media_type, file.bytes);
    return End::kFinished;
  }

  // Why work that is no run, and so has nobody who drives it, should end where it is.
  enum class Stop { kNone, kLost, kHandBack, kCancel, kOverTime };

  Stop StopAsked() {
    while (const std::optional<v1::WorkResponse> message = line_.TryReceive()) Obey(*message);
    if (released_ || line_.gone()) return Stop::kLost;
    if (stopping_ || stop_asked_) return Stop::kHandBack;
    if (CancelOrdered()) return Stop::kCancel;
    return OverTime() ? Stop::kOverTime : Stop::kNone;
  }

  // Precondition: not kNone.
  End EndOf(Stop stop) {
    if (stop == Stop::kLost) return End::kLost;
    if (stop == Stop::kHandBack) return End::kHandBack;
    if (stop == Stop::kCancel) return Cancelled();
    outcome_ = OutcomeFor(machine::OutcomeKind::kBudgetExceeded, ErrorCode::kCellProcessorBudget);
    return End::kFinished;
  }

  End Drive(const simulation::BegunRun& begun) {
    machine::Run& run = *begun.run;
    simulation::Simulation& simulation = *begun.simulation;
    const simulation::Recorder& recorder = *begun.recorder;
    SimTime slice = std::chrono::milliseconds(100);
    Pacer pacer(assignment_.job().simulation().pace());
    Clock::time_point last_position = Clock::now();
    SendPosition(run);
    while (!simulation.finished()) {
      const Clock::time_point begin = Clock::now();
      PlanTime(begin);
      CarryOut(simulation);
      if (simulation.finished()) break;
      const SimTime due = pacer.Due(begin, simulation.state().time, slice);
      const bool early = pacer.paced() && due < kPacedSliceMin &&
                         simulation.phase() == machine::RunPhase::kRunning;
      const machine::RunPhase phase = early ? machine::RunPhase::kRunning : simulation.Step(due);
      const auto took = Clock::now() - begin;
      if (took < kStepTarget / 2) slice = std::min(slice * 2, kSliceMax);
      if (took > kStepTarget) slice = std::max(slice / 2, kSliceMin);
      // Held by a client: wait for orders, not for the clock of the program.
      const bool held = phase == machine::RunPhase::kHalted && orders_.empty();
      if (held && !hold_ordered_) {
        simulation.End(machine::OutcomeKind::kStopped, ErrorCode::kCellWaitsForever);
        break;
      }
      if (held) pacer.Stand();
      const auto patience = held    ? std::chrono::milliseconds(20)
                            : early ? Pacer::kWait
                                    : std::chrono::milliseconds(0);
      while (std::optional<v1::WorkResponse> message = line_.Receive(patience)) {
        Obey(*message);
        if (released_) return End::kLost;
        if (!orders_.empty()) break;
      }
      if (line_.gone()) return End::kLost;
      if (stopping_ || stop_asked_) return End::kHandBack;
      if (Clock::now() - last_position >= kPositionInterval) {
        last_position = Clock::now();
        events_.Flush();
        SendPosition(run);
      }
      if (simulation.finished()) break;
      if (recorder.cut_off() || !output_.Fits()) {
        simulation.End(machine::OutcomeKind::kBudgetExceeded, ErrorCode::kCellOutputBudget);
      } else if (OverTime()) {
        simulation.End(machine::OutcomeKind::kBudgetExceeded, ErrorCode::kCellProcessorBudget);
      }
    }
    return End::kFinished;
  }

  // How long the program takes is found out beside the run, a little at a time; not for ever, for a
  // program that has no end.
  void PlanTime(Clock::time_point begin) {
    constexpr std::chrono::milliseconds kAtATime{5};
    constexpr std::chrono::seconds kTogether{10};
    if (!timetable_run_ || timetable_run_->timetable().total()) return;
    while (!timetable_run_->Advance() && Clock::now() - begin < kAtATime) continue;
    planned_for_ += Clock::now() - begin;
    if (!timetable_run_->timetable().total() && planned_for_ > kTogether) timetable_run_.reset();
  }

  // Orders wait until the run is between two steps: they come in while the run itself tells of an
  // event.
  void Obey(const v1::WorkResponse& message) {
    const auto mine = [&](const v1::WorkerLease& lease) {
      return lease.job() == assignment_.lease().job() &&
             lease.fence() == assignment_.lease().fence();
    };
    if (message.has_stop()) {
      stop_asked_ = true;
    } else if (message.has_release() && mine(message.release().lease())) {
      released_ = true;
    } else if (message.has_events_stored() && mine(message.events_stored().lease())) {
      events_stored_ = message.events_stored().count();
    } else if (message.has_control() && mine(message.control().lease())) {
      orders_.push_back(message.control());
    }
  }

  bool CancelOrdered() const {
    return std::ranges::count(orders_, v1::WorkerControl::KIND_CANCEL, &v1::WorkerControl::kind) >
           0;
  }

  void CarryOut(simulation::Simulation& simulation) {
    for (const v1::WorkerControl& order : std::exchange(orders_, {})) {
      const SimTime now = simulation.state().time;
      switch (order.kind()) {
        case v1::WorkerControl::KIND_HOLD:
          hold_ordered_ = true;
          simulation.Apply({.at = now, .kind = hold_key_});
          break;
        case v1::WorkerControl::KIND_STOP:
          hold_ordered_ = true;
          simulation.Apply({.at = now, .kind = machine::InputKind::kStop});
          break;
        case v1::WorkerControl::KIND_RESUME:
          hold_ordered_ = false;
          simulation.Apply({.at = now, .kind = machine::InputKind::kStart});
          break;
        case v1::WorkerControl::KIND_OVERRIDE:
          simulation.Apply(
              {.at = now, .kind = machine::InputKind::kOverride, .value = order.value()});
          break;
        case v1::WorkerControl::KIND_CANCEL:
          simulation.Cancel();
          break;
        default:
          break;
      }
    }
  }

  bool OverTime() const {
    return ProcessorTime_s() - started_s_ > assignment_.budget().processor_s();
  }

  // At most a window of events is under way: a store that is slow slows the run, not the memory.
  void SendEvents(const v1::WorkerEvents& events) {
    v1::WorkRequest message;
    *message.mutable_events() = events;
    *message.mutable_events()->mutable_lease() = assignment_.lease();
    output_.CountEvents(events.ByteSizeLong());
    if (!line_.Send(message)) return;
    events_sent_ += events.events_size();
    while (events_sent_ - events_stored_ > line_.events_window() && !line_.gone() && !released_) {
      if (std::optional<v1::WorkResponse> answer = line_.Receive(std::chrono::milliseconds(100)))
        Obey(*answer);
    }
  }

  void SendPosition(const machine::Run& run) {
    v1::WorkRequest message;
    *message.mutable_heartbeat()->mutable_lease() = assignment_.lease();
    v1::JobProgress& progress = *message.mutable_heartbeat()->mutable_progress();
    progress = bridge::ToProto(run.state(), run.steps_executed());
    if (assignment_.job().simulation().pace() > 0.0) {
      progress.clear_progress();
      if (timetable_run_ && timetable_run_->timetable().total()) {
        simulation::Timetable& timetable = timetable_run_->timetable();
        progress.set_progress(timetable.ShareAt(run.steps_executed(), run.state().time));
        progress.set_planned_time_ns(timetable.total()->count());
      }
    }
    line_.Send(message);
  }

  void Finish() {
    v1::WorkRequest message;
    v1::WorkerFinish& finish = *message.mutable_finish();
    *finish.mutable_lease() = assignment_.lease();
    *finish.mutable_outcome() = outcome_;
    for (const auto& [slot, executable] : executables_)
      (*finish.mutable_executables())[slot] = executable;
    line_.Send(message);
  }

  ServerLine& line_;
  v1::WorkerAssignment assignment_;
  AssignedPrograms programs_;
  const std::atomic<bool>& stopping_;
  JobOutput output_;
  JobEvents events_;
  double started_s_;
  v1::Outcome outcome_;
  std::map<int, std::string> executables_;
  std::unique_ptr<simulation::TimetableRun> timetable_run_;  // of a run with a pace
  Clock::duration planned_for_{0};
  std::int64_t events_sent_ = 0;
  std::int64_t events_stored_ = 0;
  std::vector<v1::WorkerControl> orders_;  // not carried out yet
  bool hold_ordered_ = false;
  machine::InputKind hold_key_ = machine::InputKind::kHold;
  bool released_ = false;
  bool stop_asked_ = false;
};

}  // namespace

bool JobRunner::Work(v1::WorkerAssignment assignment) {
  const v1::WorkerLease lease = assignment.lease();
  const std::int64_t memory = assignment.budget().memory_bytes();
  Attempt attempt(line_, std::move(assignment), stopping_);
  Attempt::End end = Attempt::End::kFinished;
  // Translating a large program, a picture of a long path or a slow store may take longer than a
  // lease.
  const std::jthread heart([&](const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any wake;
    v1::WorkRequest message;
    *message.mutable_heartbeat()->mutable_lease() = lease;
    for (;;) {
      std::unique_lock lock(mutex);
      wake.wait_for(lock, stop, std::chrono::milliseconds(line_.lease_ms() / 3),
                    [] { return false; });
      if (stop.stop_requested()) return;
      try {
        line_.Send(message);
      } catch (const std::bad_alloc&) {
        // The job is at its memory budget, and ends by itself.
      }
    }
  });
  // The outermost frame of a job: whatever leaves it fails this job and not the worker.
  try {
    const MemoryBudget budget(memory);
    end = attempt.Run();
  } catch (const std::bad_alloc&) {
    attempt.Fail(OutcomeFor(machine::OutcomeKind::kBudgetExceeded, ErrorCode::kCellMemoryBudget));
  } catch (const std::exception& error) {
    spdlog::error("job {}: an exception left its folder: {}", lease.job(), error.what());
    attempt.Fail(OutcomeFor(machine::OutcomeKind::kFailed, ErrorCode::kCellInternal, error.what()));
  }
  if (end == Attempt::End::kHandBack) {
    v1::WorkRequest message;
    *message.mutable_hand_back()->mutable_lease() = lease;
    line_.Send(message);
  }
  return !attempt.stop_asked();
}

}  // namespace rmlcell::server
