#include "engine/simulation/run/timetable.h"

#include <algorithm>

#include "engine/core/check.h"

namespace rmlcell::simulation {

void Timetable::Note(std::uint64_t steps, SimTime time) {
  const Entry& last = entries_.back();
  if (steps <= last.steps || time - last.time < spacing_) return;
  if (entries_.size() == kEntriesMax) {
    std::size_t kept = 0;
    for (std::size_t n = 0; n < entries_.size(); n += 2) entries_[kept++] = entries_[n];
    entries_.resize(kept);
    spacing_ = std::max(2 * spacing_, time / static_cast<SimTime::rep>(kEntriesMax));
  }
  entries_.push_back({steps, time});
}

double Timetable::ShareAt(std::uint64_t steps, SimTime time) {
  RMLCELL_CHECK(total_.has_value());
  std::size_t now = here_;
  while (now + 1 < entries_.size() && entries_[now + 1].steps <= steps) ++now;
  if (now != here_) {
    here_ = now;
    reached_ = time;
  }
  const SimTime next = now + 1 < entries_.size() ? entries_[now + 1].time : *total_;
  const SimTime planned = std::min(entries_[now].time + (time - reached_), next);
  return *total_ > SimTime(0) ? ToSeconds(planned) / ToSeconds(*total_) : 0.0;
}

Result<std::unique_ptr<TimetableRun>> TimetableRun::Of(const machine::MachineFamily& family,
                                                       machine::RunSetup setup) {
  std::unique_ptr<TimetableRun> made(new TimetableRun);
  for (const machine::InputChange& input : setup.inputs) made->input_times_.push_back(input.at);
  Result<std::unique_ptr<machine::Run>> run = family.NewRun(std::move(setup), made->nobody_);
  if (!run) return run.error();
  made->run_ = *std::move(run);
  made->drive_.emplace(*made->run_, made->input_times_);
  return made;
}

bool TimetableRun::Advance() {
  if (timetable_.total()) return true;
  const SimTime before = run_->state().time;
  const machine::RunPhase phase = drive_->Step(std::chrono::milliseconds(100));
  const SimTime now = run_->state().time;
  timetable_.Note(run_->steps_executed(), before);  // or a little later
  const bool stays = phase == machine::RunPhase::kHalted && !drive_->Start();
  if (stays || phase == machine::RunPhase::kFinished) timetable_.End(now);
  return timetable_.total().has_value();
}

}  // namespace rmlcell::simulation
