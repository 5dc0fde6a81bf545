#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "rmlcell/v1/host.pb.h"
#include "server/base/executor.h"
#include "server/base/steady_clock.h"
#include "server/machines/hosts.h"
#include "storage/store.h"

namespace rmlcell::server {

struct Config;

// RUN jobs: one at a time goes to the host of its machine, as soon as that can begin it, and is
// never begun a second time (LIVE-5.01 to 5.04). What the host tells of it, its end among that, is
// stored by Hosts. Thread-safe.
class RunQueue {
 public:
  struct Needs {
    storage::Store& store;
    Hosts& hosts;
    const Config& config;
    Executor& executor;
    std::string server{};  // what the store knows this server by
    SteadyClock clock = SteadyTime;
  };
  // Of a job that its host does not speak of for so long it is asked whether it has begun it.
  static constexpr std::chrono::seconds kUnheardOf{3};

  // Behind a job that its machine did not take.
  static constexpr std::chrono::seconds kRests{5};

  explicit RunQueue(Needs needs) : needs_(std::move(needs)) {}

  // Something may have changed: a job was submitted, the machine can start again. Returns at once.
  void Wake(const std::string& machine);
  void WakeAll();

  // The machine whose host runs this job, or is about to, as far as this server has heard; empty:
  // none.
  std::string MachineOf(const std::string& job) const;
  // An order for the run of this job; refused where another run is open by then.
  void Ask(const std::string& job, v1::HostOrder order, Hosts::Answered done);
  void AskMachine(const std::string& machine, v1::HostOrder order, Hosts::Answered done) {
    needs_.hosts.Ask(machine, std::move(order), std::move(done));
  }
  // It was cut off, and its machine waits for somebody to decide what becomes of that. LIVE-5.10
  bool IsToBeDecided(const std::string& job) const;
  // The program of a job, whole. Errors: those of the store.
  Result<v1::AssignedProgram> ProgramOf(std::int64_t job);
  // Block and tool of the simulation that proves it; none: nobody has told them.
  std::optional<v1::Milling> MillingOf(std::int64_t job);
  // A person begins this job of the queue: as `order` says, without its program, a run_job or a
  // continue_job. Where its machine refuses that, the first waits on, and the other has ended. May
  // block. `done` is called once, on any thread. LIVE-5.04, 5.10
  void BeginByPerson(std::int64_t job, v1::HostOrder order, Hosts::Answered done);
  // Into a RUN that waits: all that keeps its machine from beginning it now; and who has control,
  // where it waits for nothing but its machine, and somebody else is there. LIVE-4.05, LIVE-5.02
  void TellWhyItWaits(v1::Job& job) const;
  // The run is over as soon as it stands.
  void Abort(
      const std::string& job, const std::string& caller, const std::string& request_id,
      Hosts::Answered done = [](const Result<v1::HostOrderAnswer>&) {});

 private:
  void AbortCancelled(const storage::JobRecord& job);
  void Look(const std::string& machine);
  void LookOnce(const std::string& machine);
  void AskWhetherBegun(const std::string& machine, const storage::LeasedJob& job);
  // Whether a job of the machine is under way. True where that is not known.
  bool IsBusy(const std::string& machine, const v1::MachineStatus& status);
  void BeginNext(const std::string& machine, const v1::MachineStatus& status);
  void Begin(const std::string& machine, const storage::LeasedJob& leased);
  void Send(const std::string& machine, const storage::LeasedJob& leased, v1::HostOrder order,
            Hosts::Answered done);
  void LookAtStep(const std::string& machine, const storage::LeasedJob& leased, v1::HostOrder order,
                  Hosts::Answered done);
  void Answered(const std::string& machine, const storage::LeasedJob& leased,
                const Result<v1::HostOrderAnswer>& answer);
  void EndUnread(const storage::LeasedJob& leased, const Error& why, bool held);
  std::optional<storage::LeasedJob> StillLeased(const storage::LeasedJob& leased);
  void GiveBack(const storage::LeasedJob& leased, const std::string& why, bool held = false);
  void End(const storage::LeasedJob& leased, const storage::JobOutcome& how);

  Needs needs_;
  mutable std::mutex mutex_;         // a leaf
  std::set<std::string> looking_;    // guarded by mutex_; looked at, or a job of it begins
  std::set<std::string> once_more_;  // guarded by mutex_
  // Guarded by mutex_. Jobs whose order is not answered, by name, with their machine; jobs that
  // their machine does not speak of, by their lease, and since when; jobs whose cancel was handed
  // on.
  std::map<std::string, std::string> beginning_;
  std::map<std::int64_t, std::chrono::steady_clock::time_point> unheard_of_;
  std::set<std::int64_t> aborted_;
  std::map<std::string, std::chrono::steady_clock::time_point> rests_until_;  // guarded by mutex_
};

}  // namespace rmlcell::server
