#pragma once

#include <atomic>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/base/executor.h"
#include "server/events/event_feed.h"
#include "server/machines/hosts.h"
#include "server/records/known_machines.h"
#include "storage/store.h"

namespace rmlcell::server {

// Tells the feed how machines stand that have no host: what the jobs of the store say of them. It
// looks when a job, a machine or its host changed. Thread-safe.
class MachineStatuses {
 public:
  // All of them outlive this. Without hosts no machine lives.
  MachineStatuses(storage::Store& store, EventFeed& feed, Executor& executor,
                  Hosts* hosts = nullptr);
  ~MachineStatuses();  // waits for a look that is under way
  MachineStatuses(const MachineStatuses&) = delete;
  MachineStatuses& operator=(const MachineStatuses&) = delete;

 private:
  void Woken();
  void Look();
  bool ChangedSinceLastLook();
  bool IsCountedOtherwise(const std::vector<storage::MachineJobs>& jobs) const;

  storage::Store& store_;
  KnownMachines machines_;
  EventFeed& feed_;
  Hosts* hosts_;
  Executor& executor_;
  std::mutex mutex_;
  std::condition_variable rests_;
  bool looking_ = false;  // guarded by mutex_; a look is posted or under way
  bool again_ = true;     // guarded by mutex_; there is something that it may have missed
  std::atomic<bool> host_changed_ = false;
  // Of the look alone.
  bool first_ = true;
  std::int64_t position_ = 0;  // events up to here are accounted for
  std::vector<storage::MachineJobs> counted_;
  std::map<std::string, std::string> told_;  // by name of the machine
  std::unique_ptr<EventFeed::Subscription> subscription_;
  // The feed may have read what the store has not counted yet: its own word comes behind that.
  std::unique_ptr<storage::Store::Subscription> count_;
};

}  // namespace rmlcell::server
