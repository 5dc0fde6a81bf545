#include "server/worker/job_drive.h"

#include <algorithm>
#include <utility>

#include "proto/bridge/report.h"
#include "server/worker/pacer.h"

namespace rmlcell::server {
namespace {

constexpr std::chrono::milliseconds kPositionInterval{50};  // at most 20 positions a second
constexpr std::chrono::milliseconds kFirstPosition{10};
constexpr std::chrono::milliseconds kToolpathInterval{200};
constexpr std::chrono::milliseconds kHeightsInterval{200};
constexpr std::size_t kTilesOfALook = 32;           // of at most 8 KiB
constexpr std::chrono::milliseconds kHeldWait{20};  // between two looks for an order
constexpr SimTime kPacedSliceMin = std::chrono::milliseconds(1);

// Virtual time of one step of the simulation: it adapts, so that a step takes about this long.
class Slice {
 public:
  SimTime time() const { return time_; }
  void Adapt(std::chrono::steady_clock::duration took) {
    if (took < kStepTarget / 2) time_ = std::min(time_ * 2, kMax);
    if (took > kStepTarget) time_ = std::max(time_ / 2, kMin);
  }

 private:
  static constexpr std::chrono::milliseconds kStepTarget{5};
  static constexpr SimTime kMin = std::chrono::milliseconds(10);
  static constexpr SimTime kMax = std::chrono::hours(10);

  SimTime time_ = std::chrono::milliseconds(100);
};

// What a log needs for the run to be carried out again.
v1::JobEvent Applied(const v1::WorkerControl& order, SimTime now) {
  v1::JobEvent event;
  event.set_virtual_time_ns(now.count());
  v1::InputApplied& applied = *event.mutable_input_applied();
  applied.set_fence(order.lease().fence());
  applied.set_virtual_time_ns(now.count());
  applied.set_caller(order.caller());
  applied.set_request_id(order.request_id());
  applied.set_source(v1::START_SOURCE_CONSOLE);
  v1::AppliedInput& input = *applied.mutable_input();
  switch (order.kind()) {
    case v1::WorkerControl::KIND_HOLD:
      input.set_hold(v1::HOLD_REASON_HOLD);
      break;
    case v1::WorkerControl::KIND_STOP:
      input.set_stop(v1::HOLD_REASON_STOP);
      break;
    case v1::WorkerControl::KIND_RESUME:
      input.mutable_resume()->set_source(v1::START_SOURCE_CONSOLE);
      break;
    case v1::WorkerControl::KIND_OVERRIDE:
      input.set_override_percent(order.value());
      break;
    case v1::WorkerControl::KIND_CANCEL:
      input.set_abort(v1::HOLD_REASON_ABORT);
      break;
    default:
      break;
  }
  return event;
}

}  // namespace

Stop JobDrive::Run(const simulation::BegunRun& begun) {
  simulation::Simulation& simulation = *begun.simulation;
  Slice slice;
  Pacer pacer(options_.pace);
  // The first one soon; a run that is over by then has none, as its end says all.
  Clock::time_point last_position = Clock::now() - kPositionInterval + kFirstPosition;
  if (options_.pace > 0.0) {
    last_position = Clock::now();
    SendPosition(*begun.run);
  }
  while (!simulation.finished()) {
    const Clock::time_point begin = Clock::now();
    PlanTime(begin);
    CarryOutOrders(simulation);
    if (simulation.finished()) break;
    const SimTime due = pacer.Due(begin, simulation.state().time, slice.time());
    const bool early =
        pacer.paced() && due < kPacedSliceMin && simulation.phase() == machine::RunPhase::kRunning;
    const machine::RunPhase phase = early ? machine::RunPhase::kRunning : simulation.Step(due);
    slice.Adapt(Clock::now() - begin);
    // Held by a client: wait for orders, not for the clock of the program.
    const bool halted = phase == machine::RunPhase::kHalted && !lease_.has_orders();
    if (halted && !held_) {
      simulation.End(machine::OutcomeKind::kStopped, ErrorCode::kCellWaitsForever);
      break;
    }
    if (halted) pacer.Stand();
    lease_.Listen(halted ? kHeldWait : early ? Pacer::kWait : std::chrono::milliseconds(0));
    if (lease_.lost()) return Stop::kLost;
    if (lease_.hand_back_asked()) return Stop::kHandBack;
    if (Clock::now() - last_position >= kPositionInterval) {
      last_position = Clock::now();
      options_.flush_events();
      SendPosition(*begun.run);
      SendToolpath(*begun.recorder, last_position);
      SendHeights(*begun.recorder, last_position);
    }
    if (simulation.finished()) break;
    if (begun.recorder->cut_off() || !output_.Fits()) {
      simulation.End(machine::OutcomeKind::kBudgetExceeded, ErrorCode::kCellOutputBudget);
    } else if (lease_.over_time()) {
      simulation.End(machine::OutcomeKind::kBudgetExceeded, ErrorCode::kCellProcessorBudget);
    }
  }
  // What is made of it yet may take a while; the way is all there.
  toolpath_sent_.reset();
  SendToolpath(*begun.recorder, Clock::now());
  while (SendHeights(*begun.recorder, std::nullopt)) continue;
  return Stop::kNone;
}

// How long the program takes is found out beside the run, a little at a time; not for ever, for a
// program that has no end.
void JobDrive::PlanTime(Clock::time_point begin) {
  constexpr std::chrono::milliseconds kAtATime{5};
  constexpr std::chrono::seconds kTogether{10};
  std::unique_ptr<simulation::TimetableRun>& timetable = options_.timetable;
  if (!timetable || timetable->timetable().total()) return;
  while (!timetable->Advance() && Clock::now() - begin < kAtATime) continue;
  planned_for_ += Clock::now() - begin;
  if (!timetable->timetable().total() && planned_for_ > kTogether) timetable.reset();
}

void JobDrive::CarryOutOrders(simulation::Simulation& simulation) {
  for (const v1::WorkerControl& order : lease_.TakeOrders()) {
    if (simulation.finished()) return;
    options_.tell(Applied(order, simulation.state().time));
    CarryOut(order, simulation);
  }
}

void JobDrive::SendToolpath(const simulation::Recorder& recorder, Clock::time_point now) {
  if (!lease_.toolpath_followed()) return;
  if (toolpath_sent_ && now - *toolpath_sent_ < kToolpathInterval) return;
  toolpath_sent_.reset();  // at once, where there is more
  if (output_.SendNewToolpath(recorder.OpenToolpathBlock())) toolpath_sent_ = now;
}

bool JobDrive::SendHeights(simulation::Recorder& recorder, std::optional<Clock::time_point> now) {
  simulation::MillingRecorder* milling = recorder.milling();
  if (milling == nullptr || !lease_.heights_followed()) return false;
  if (now && *now < heights_due_) return false;
  if (now) heights_due_ = *now + kHeightsInterval;
  std::vector<simulation::HeightTile> tiles = milling->TakeChanges(kTilesOfALook);
  if (!tiles.empty() || !std::exchange(grid_sent_, true)) {
    if (!output_.SendHeights(milling->material(), std::move(tiles))) return false;
  }
  return milling->any_change_left();
}

void JobDrive::CarryOut(const v1::WorkerControl& order, simulation::Simulation& simulation) {
  const SimTime now = simulation.state().time;
  switch (order.kind()) {
    case v1::WorkerControl::KIND_HOLD:
      held_ = true;
      simulation.Apply({.at = now, .kind = options_.hold_key});
      break;
    case v1::WorkerControl::KIND_STOP:
      held_ = true;
      simulation.Apply({.at = now, .kind = machine::InputKind::kStop});
      break;
    case v1::WorkerControl::KIND_RESUME:
      held_ = false;
      simulation.Apply({.at = now, .kind = machine::InputKind::kStart});
      break;
    case v1::WorkerControl::KIND_OVERRIDE:
      simulation.Apply({.at = now, .kind = machine::InputKind::kOverride, .value = order.value()});
      break;
    case v1::WorkerControl::KIND_CANCEL:
      simulation.Cancel();
      break;
    default:
      break;
  }
}

void JobDrive::SendPosition(const machine::Run& run) {
  v1::JobProgress progress = bridge::ToProto(options_.family, run.state(), run.steps_executed());
  if (options_.pace > 0.0) {
    progress.clear_progress();
    if (options_.timetable && options_.timetable->timetable().total()) {
      simulation::Timetable& timetable = options_.timetable->timetable();
      progress.set_progress(timetable.ShareAt(run.steps_executed(), run.state().time));
      progress.set_planned_time_ns(timetable.total()->count());
    }
  }
  lease_.SendProgress(progress);
}

}  // namespace rmlcell::server
