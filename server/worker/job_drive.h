#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>

#include "engine/simulation/run/simulate.h"
#include "engine/simulation/run/timetable.h"
#include "server/worker/job_lease.h"
#include "server/worker/job_output.h"

namespace rmlcell::server {

// Drives the run of a job to its end: in slices of virtual time, at the pace asked for, with the
// orders of clients carried out between two of them, and tells where it is.
class JobDrive {
 public:
  struct Options {
    double pace = 0.0;  // virtual seconds a real second; 0: as fast as the processor allows
    machine::FamilyInfo family{};
    machine::InputKind hold_key = machine::InputKind::kHold;  // what HOLD is on this machine
    // Of a run with a pace, where one can be made: how long it will take is not known before.
    std::unique_ptr<simulation::TimetableRun> timetable{};
    std::function<void()> flush_events{};      // as often as positions are sent
    std::function<void(v1::JobEvent)> tell{};  // for the log of the job
  };
  // Both outlive this.
  JobDrive(JobLease& lease, JobOutput& output, Options options)
      : lease_(lease), output_(output), options_(std::move(options)) {}

  // kNone: the run is over. kLost, kHandBack: it is not, and nobody waits for it here.
  Stop Run(const simulation::BegunRun& begun);

 private:
  using Clock = std::chrono::steady_clock;

  void CarryOutOrders(simulation::Simulation& simulation);
  void SendToolpath(const simulation::Recorder& recorder, Clock::time_point now);
  // Without a time: at once. True: there may be more.
  bool SendHeights(simulation::Recorder& recorder, std::optional<Clock::time_point> now);
  void CarryOut(const v1::WorkerControl& order, simulation::Simulation& simulation);
  void PlanTime(Clock::time_point begin);
  void SendPosition(const machine::Run& run);

  JobLease& lease_;
  JobOutput& output_;
  Options options_;
  Clock::duration planned_for_{0};
  std::optional<Clock::time_point> toolpath_sent_;
  Clock::time_point heights_due_{};
  bool grid_sent_ = false;
  bool held_ = false;  // by a client, who may let it go on
};

}  // namespace rmlcell::server
