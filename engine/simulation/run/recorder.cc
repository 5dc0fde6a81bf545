#include "engine/simulation/run/recorder.h"

#include <array>
#include <optional>
#include <utility>

#include "engine/simulation/report/report_recorder.h"
#include "engine/simulation/run/version.h"
#include "engine/simulation/verdict/verdict.h"

namespace rmlcell::simulation {

struct Recorder::State {
  State(const machine::MachineShape& shape, InputDescription description, Products products)
      : inputs(std::move(description)), also(products.also), report(shape, products.each_step) {
    Join(also);
    Join(&report);
    if (products.trace) {
      Join(&trace.emplace(std::move(products.trace), products.trace_records_max));
    }
    if (products.toolpath) {
      Join(&toolpath.emplace(shape, products.toolpath_options, std::move(products.toolpath)));
    }
    if (products.picture) Join(&picture.emplace(shape));
    if (products.plot) Join(&plot.emplace(shape));
    if (products.samples) {
      Join(&samples.emplace(shape, products.samples_hz, std::move(products.samples)));
    }
    if (products.milling) Join(&milling.emplace(shape, *products.milling, products.parallel));
  }

  void Join(machine::RunObserver* observer) {
    if (observer != nullptr) observers[count++] = observer;
  }

  template <class Tell>
  void All(Tell tell) {
    for (std::size_t i = 0; i < count; ++i) tell(*observers[i]);
  }

  InputDescription inputs;
  machine::RunObserver* also;
  CurveMeasure measure;
  ReportRecorder report;
  std::optional<TraceRecorder> trace;
  std::optional<ToolpathRecorder> toolpath;
  std::optional<PictureRecorder> picture;
  std::optional<PlotRecorder> plot;
  std::optional<SampleRecorder> samples;
  std::optional<MillingRecorder> milling;
  std::array<machine::RunObserver*, 8> observers{};
  std::size_t count = 0;
};

Recorder::Recorder(const machine::MachineShape& shape, InputDescription inputs, Products products)
    : state_(std::make_unique<State>(shape, std::move(inputs), std::move(products))) {}

Recorder::~Recorder() = default;

void Recorder::OnStep(SimTime at, const machine::Place& place, std::string_view instruction) {
  state_->All([&](machine::RunObserver& to) { to.OnStep(at, place, instruction); });
}
void Recorder::OnMotion(const machine::MotionDone& done) {
  State& of = *state_;
  if (of.also != nullptr) of.also->OnMotion(done);
  // Three want to know how it goes; curves are measured once.
  PartShape shape({done.motion->path, done.motion->head, done.from, done.travelled}, of.measure);
  of.report.Add(done, shape);
  if (of.toolpath) of.toolpath->Add(done, shape);
  if (of.picture) of.picture->Add(done, shape);
  if (of.plot) of.plot->OnMotion(done);
  if (of.samples) of.samples->OnMotion(done);
  if (of.milling) of.milling->OnMotion(done);
}
void Recorder::OnMove(const machine::MoveDone& move) {
  state_->All([&](machine::RunObserver& to) { to.OnMove(move); });
}
void Recorder::OnSignal(const machine::SignalChange& change) {
  state_->All([&](machine::RunObserver& to) { to.OnSignal(change); });
}
void Recorder::OnWait(const machine::Wait& wait) {
  state_->All([&](machine::RunObserver& to) { to.OnWait(wait); });
}
void Recorder::OnHalt(const machine::Halt& halt) {
  state_->All([&](machine::RunObserver& to) { to.OnHalt(halt); });
}
void Recorder::OnResume(SimTime at, const machine::Place& place) {
  state_->All([&](machine::RunObserver& to) { to.OnResume(at, place); });
}
void Recorder::OnEntered(SimTime at) {
  state_->All([&](machine::RunObserver& to) { to.OnEntered(at); });
}
void Recorder::OnProgram(SimTime at, const machine::Place& place, std::string_view what,
                         int program) {
  state_->All([&](machine::RunObserver& to) { to.OnProgram(at, place, what, program); });
}
void Recorder::OnMessage(SimTime at, const machine::Place& place, std::string_view text) {
  state_->All([&](machine::RunObserver& to) { to.OnMessage(at, place, text); });
}
void Recorder::OnViolation(const machine::TravelViolation& violation) {
  state_->All([&](machine::RunObserver& to) { to.OnViolation(violation); });
}
void Recorder::OnLost(const machine::LostWay& way) {
  state_->All([&](machine::RunObserver& to) { to.OnLost(way); });
}
void Recorder::OnDiagnostic(SimTime at, const Diagnostic& diagnostic) {
  state_->All([&](machine::RunObserver& to) { to.OnDiagnostic(at, diagnostic); });
}
void Recorder::OnCounted(SimTime at, const Diagnostic& diagnostic) {
  state_->All([&](machine::RunObserver& to) { to.OnCounted(at, diagnostic); });
}
void Recorder::OnAssumed(const machine::Assumed& assumed) {
  state_->All([&](machine::RunObserver& to) { to.OnAssumed(assumed); });
}

void Recorder::Begin(const machine::Run& run) {
  const machine::RunState state = run.state();
  state_->report.Begin(run);
  if (state_->samples) state_->samples->StandsAt(state.tip, state.axes);
  if (state_->milling && state.work_origin) state_->milling->BeginAt(*state.work_origin);
}

bool Recorder::cut_off() const {
  return (state_->trace && state_->trace->dropped() > 0) ||
         (state_->toolpath && !state_->toolpath->complete());
}

std::string Recorder::OpenToolpathBlock() const {
  return state_->toolpath ? state_->toolpath->OpenBlock() : std::string();
}

const InputDescription& Recorder::inputs() const { return state_->inputs; }

void Recorder::Finish(const machine::Run& run) {
  const SimTime at = run.state().time;
  state_->report.Finish(at);
  if (state_->trace) state_->trace->End(at, run.outcome());
  if (state_->toolpath) state_->toolpath->Finish();
  if (state_->samples) state_->samples->Finish(at);
}

RunReport Recorder::Report(const machine::Run& run) const {
  RunReport report = state_->report.Report(run);
  report.family = state_->inputs.family;
  report.title = state_->inputs.title;
  report.engine_version = kEngineVersion;
  report.inputs_hash = state_->inputs.hash;
  report.machine = state_->inputs.machine;
  report.changed_parameters = state_->inputs.changed_parameters;
  if (const auto& trace = state_->trace) {
    report.trace = {.made = true,
                    .complete = trace->dropped() == 0,
                    .records = trace->records(),
                    .dropped = trace->dropped()};
  }
  if (const auto& toolpath = state_->toolpath) {
    report.toolpath = {.made = true,
                       .complete = toolpath->complete(),
                       .records = toolpath->points(),
                       .bytes = toolpath->bytes()};
  }
  if (const auto& picture = state_->picture) {
    report.picture = {.made = true, .complete = picture->exact(), .records = picture->elements()};
  }
  if (state_->milling) report.milling = state_->milling->Figures();
  if (!report.finished) return report;
  report.judgement = Judge(report);
  for (Finding& finding : report.findings)
    finding.diagnostic.judged = machine::JudgedBy(report.judgement, finding.diagnostic.code);
  machine::MarkJudged(report.judgement, report.findings_dropped);
  return report;
}

MillingRecorder* Recorder::milling() const { return state_->milling ? &*state_->milling : nullptr; }

std::string Recorder::Svg(const RunReport& report, const PictureOptions& options) const {
  return state_->picture ? state_->picture->Svg(report, options) : std::string();
}

const TimeEnvelope* Recorder::Values(SimTime until) const {
  return state_->plot ? &state_->plot->Values(until) : nullptr;
}

std::string Recorder::PlotSvg(const RunReport& report, const PlotOptions& options) const {
  return state_->plot ? state_->plot->Svg(report, options) : std::string();
}

}  // namespace rmlcell::simulation
