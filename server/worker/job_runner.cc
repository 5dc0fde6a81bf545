#include "server/worker/job_runner.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <new>
#include <utility>
#include <vector>

#include "engine/families/families.h"
#include "engine/simulation/run/rehearsal.h"
#include "engine/simulation/run/simulate.h"
#include "engine/simulation/verdict/verdict.h"
#include "proto/bridge/encoding.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/inputs.h"
#include "proto/bridge/milling.h"
#include "proto/bridge/report.h"
#include "proto/bridge/series.h"
#include "proto/bridge/setup.h"
#include "proto/bridge/sha256.h"
#include "proto/bridge/ticket.h"
#include "server/worker/assigned_programs.h"
#include "server/worker/job_drive.h"
#include "server/worker/job_events.h"
#include "server/worker/job_lease.h"
#include "server/worker/job_output.h"
#include "server/worker/material_files.h"
#include "server/worker/memory_budget.h"
#include "server/worker/step_map.h"

namespace rmlcell::server {
namespace {

v1::Outcome OutcomeFor(machine::OutcomeKind kind, ErrorCode code, Detail detail = {}) {
  const machine::Outcome outcome{.kind = kind, .code = code, .detail = std::move(detail)};
  return bridge::ToProto(outcome, simulation::JudgeOutcome(outcome));
}

// Of a job that is cancelled, or over its time: kCancel, kOverTime.
v1::Outcome OutcomeOf(Stop stop) {
  return stop == Stop::kCancel
             ? OutcomeFor(machine::OutcomeKind::kCancelled, ErrorCode::kCellCancelled)
             : OutcomeFor(machine::OutcomeKind::kBudgetExceeded, ErrorCode::kCellProcessorBudget);
}

// One attempt.
class Attempt {
 public:
  Attempt(ServerLine& line, v1::WorkerAssignment assignment, const std::atomic<bool>& stopping,
          const ProcessorTime& processor_time)
      : line_(line),
        assignment_(std::move(assignment)),
        programs_(assignment_),
        lease_(line, assignment_, stopping, processor_time),
        output_(line, assignment_.lease(), assignment_.budget().output_bytes()),
        events_([this](const v1::WorkerEvents& events) {
          output_.CountEvents(events.ByteSizeLong());
          lease_.SendEvents(events);
        }) {}

  enum class End { kFinished, kHandBack, kLost };

  End Run() {
    if (!ReceivePrograms()) return End::kLost;
    const End end = assignment_.job().kind() == v1::JOB_KIND_CHECK ? Check() : Simulate();
    if (end == End::kFinished) {
      events_.TellRest();
      Finish();
    }
    return end;
  }

  // For what left the job by an exception.
  void Fail(const v1::Outcome& outcome) {
    outcome_ = outcome;
    Finish();
  }

  bool stop_asked() const { return lease_.stop_asked(); }

 private:
  bool ReceivePrograms() {
    while (!programs_.complete()) {
      const std::optional<v1::WorkResponse> message = line_.Receive(std::chrono::seconds(60));
      if (!message) return false;
      if (message->has_blob()) programs_.Add(message->blob());
      lease_.Take(*message);
      if (lease_.lost()) return false;
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
    UntoldFindings untold = made.diagnostics_dropped;
    machine::MarkJudged(judgement, untold);
    bridge::SetUntold(untold, report);
    events_.AddUntold(untold);
    const auto first = std::ranges::find_if(
        made.diagnostics, [](const Diagnostic& d) { return IsError(d.severity); });
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
    const Result<machine::InputScript> inputs = bridge::InputsOf(assignment_.job().simulation());
    if (!inputs) return Refuse(inputs.error());
    const int slot = assignment_.main_program();
    Result<simulation::CheckedProgram> check =
        simulation::CheckProgram(memory, *parameters, slot, true, *inputs);
    if (!check) return Refuse(check.error());
    machine::Translation& translation = check->translation;
    for (Diagnostic& diagnostic : translation.diagnostics) diagnostic.program = slot;
    translation.diagnostics_dropped.ForEachPlace([&](Diagnostic& place) { place.program = slot; });
    const machine::Judgement judgement = simulation::JudgeCheck(*check);
    simulation::PreparedRun found{.diagnostics = std::move(translation.diagnostics),
                                  .diagnostics_dropped = translation.diagnostics_dropped};
    found.diagnostics_dropped.Add(check->motion.findings_dropped);
    found.diagnostics.insert(found.diagnostics.end(), check->motion.findings.begin(),
                             check->motion.findings.end());
    std::string motion_check;
    if (!check->motion.cut_short.empty())
      motion_check = check->motion.cut_short.begin()->second.text;
    // Done as it is, it need not be handed back.
    if (const Stop stop = lease_.StopAsked(); stop != Stop::kNone && stop != Stop::kHandBack)
      return EndOf(stop);
    ReportFindings(found, judgement, motion_check);
    return End::kFinished;
  }

  const machine::FamilyInfo& Family() const {
    return families::FindFamily(assignment_.family())->info();
  }

  End Refuse(const Error& error) {
    outcome_ = OutcomeFor(machine::OutcomeKind::kFailed, error.code, error.detail);
    return End::kFinished;
  }

  // What the run leaves, into the buffers of this attempt while they fit its budget.
  simulation::Products ProductsOf(const v1::SimulationOptions& options) {
    simulation::Products products;
    if (options.trace()) {
      products.trace = [this, &family = Family()](const simulation::TraceRecord& record) {
        return output_.AddTrace(bridge::ToProto(family, record).SerializeAsString());
      };
    }
    products.plot = options.series();
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
    const Result<simulation::RunOptions> how = bridge::RunOptionsOf(
        options, assignment_.budget(), assignment_.main_program(), machine::Mode::kRemote);
    if (!how) return Refuse(how.error());
    Result<simulation::PreparedRun> made = simulation::PrepareRun(programs_.Memory(), *how);
    if (!made) return Refuse(made.error());
    if (const Stop stop = lease_.StopAsked(); stop != Stop::kNone) return EndOf(stop);
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
    JobDrive::Options drive{.pace = options.pace(),
                            .family = family.info(),
                            .hold_key = machine::HoldKey(family.info(), made->setup->mode),
                            .flush_events = [this] { events_.Flush(); },
                            .tell = [this](v1::JobEvent event) { events_.Tell(std::move(event)); }};
    if (options.pace() > 0.0) {  // else it is over as soon as that would be known
      if (auto timetable = simulation::TimetableRun::Of(family, *made->setup))
        drive.timetable = *std::move(timetable);
    }
    steps_ = StepMapOf(family, *made->setup);
    depends_on_ = bridge::DigestsOf(bridge::DependenciesOf(family, *made->setup));
    Result<simulation::BegunRun> begun =
        simulation::Begin(family, std::move(*made->setup), std::move(products));
    if (!begun) return Refuse(begun.error());
    const Stop stop = JobDrive(lease_, output_, std::move(drive)).Run(*begun);
    return stop == Stop::kNone ? TellRun(*begun, *std::move(made), *variables) : EndOf(stop);
  }

  // What came of a run that is over, besides what went out while it ran.
  End TellRun(simulation::BegunRun& begun, simulation::PreparedRun before,
              const std::vector<std::string>& variables) {
    const simulation::RunReport report = begun.simulation->Finish();
    const std::vector<machine::NamedVariable> values =
        machine::ReadVariables(*begun.run, variables);
    executables_ = begun.run->made_executables();
    const std::string picture = begun.recorder->Svg(report, {});
    if (const simulation::TimeEnvelope* series = begun.recorder->Values(report.cycle_time))
      series_ = bridge::StableBytes(bridge::SeriesOf(Family(), *series, report.cycle_time));
    // What made them is large, and so is the report as a message.
    begun.simulation.reset();
    begun.run.reset();
    simulation::MillingRecorder* milling = begun.recorder->milling();
    if (milling == nullptr) begun.recorder.reset();
    v1::RunReport message = bridge::ToProto(Family(), report, values);
    machine::MarkJudged(report.judgement, before.diagnostics);
    machine::MarkJudged(report.judgement, before.diagnostics_dropped);
    bridge::AddFindingsOfText(before.diagnostics, before.diagnostics_dropped, message);
    message.mutable_inputs()->insert(depends_on_.begin(), depends_on_.end());
    outcome_ = message.outcome();
    outcome_.set_cycle_time_ns(report.cycle_time.count());
    return SendProducts(message, picture, milling);
  }

  // What is left is compared with the target of the job, when it has one. An end: there will be no
  // run.
  std::optional<End> SetTarget(simulation::Milling& milling) {
    const v1::SimulationOptions& options = assignment_.job().simulation();
    if (!assignment_.has_target()) return std::nullopt;
    // As the command runs such a program: by itself, with nobody at its keys.
    const Result<simulation::RunOptions> all = bridge::RunOptionsOf(
        options, assignment_.budget(), assignment_.main_program(), machine::Mode::kCycle);
    if (!all) return Refuse(all.error());
    Result<std::vector<float>> heights = programs_.TargetHeights(
        milling,
        {.parameters = all->parameters, .mode = machine::Mode::kCycle, .budget = all->budget},
        [this] { return lease_.StopAsked() == Stop::kNone; });
    if (const Stop stop = lease_.StopAsked(); stop != Stop::kNone) return EndOf(stop);
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
                   simulation::MillingRecorder* milling) {
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
                              stop = lease_.StopAsked();
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
    if (!series_.empty()) output_.Send("series", "application/x-protobuf", series_);
    if (!steps_.empty()) output_.Send("steps", "application/x-protobuf", steps_);
    if (options.trace()) output_.SendTrace();
    output_.Send("picture.svg", "image/svg+xml", picture);
    for (const ProductFile& file : *files) output_.Send(file.name, file.media_type, file.bytes);
    return End::kFinished;
  }

  // Precondition: not kNone.
  End EndOf(Stop stop) {
    if (stop == Stop::kLost) return End::kLost;
    if (stop == Stop::kHandBack) return End::kHandBack;
    outcome_ = OutcomeOf(stop);
    return End::kFinished;
  }

  void Finish() {
    v1::WorkerFinish finish;
    *finish.mutable_outcome() = outcome_;
    finish.mutable_events()->Swap(events_.TakeUnsent().mutable_events());
    for (const v1::AssignedProgram& program : assignment_.programs()) {
      const auto made = executables_.find(program.slot());
      if (made == executables_.end() || program.object_revision() == 0) continue;
      v1::LinkedExecutable& linked = *finish.add_executables();
      linked.set_slot(program.slot());
      linked.set_object_revision(program.object_revision());
      linked.set_content(std::move(made->second));
    }
    output_.MoveSmallTo(finish);
    lease_.SendFinish(std::move(finish));
  }

  ServerLine& line_;
  v1::WorkerAssignment assignment_;
  AssignedPrograms programs_;
  JobLease lease_;
  JobOutput output_;
  JobEvents events_;
  v1::Outcome outcome_;
  std::map<int, std::string> executables_;
  std::string steps_;                              // GetStepMapResponse
  std::map<std::string, std::string> depends_on_;  // RunReport.inputs
  std::string series_;                             // SeriesTable
};

}  // namespace

bool JobRunner::Work(v1::WorkerAssignment assignment) {
  const v1::WorkerLease lease = assignment.lease();
  const std::int64_t memory = assignment.budget().memory_bytes();
  heart_.BeatFor(lease);
  Attempt attempt(line_, std::move(assignment), stopping_, processor_time_);
  Attempt::End end = Attempt::End::kFinished;
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
  heart_.Rest();
  return !attempt.stop_asked();
}

}  // namespace rmlcell::server
