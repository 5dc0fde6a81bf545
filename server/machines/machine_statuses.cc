#include "server/machines/machine_statuses.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "server/base/names.h"
#include "server/records/machine_messages.h"

namespace rmlcell::server {
namespace {

constexpr int kReadAhead = 1000;

// Whether a machine may stand otherwise after it.
bool Matters(const storage::EventRecord& event) {
  return event.job == 0 || event.kind == "state" || event.kind == "ended";
}

}  // namespace

MachineStatuses::MachineStatuses(storage::Store& store, EventFeed& feed, Executor& executor,
                                 Hosts* hosts)
    : store_(store), machines_(store), feed_(feed), hosts_(hosts), executor_(executor) {
  if (hosts_ != nullptr) {
    hosts_->OnChange([this] {
      host_changed_ = true;
      Woken();
    });
  }
  subscription_ = feed_.Subscribe(std::string(EventFeed::kEverything), [this] { Woken(); });
  count_ = store_.Watch([this] { Woken(); });
  Woken();
}

MachineStatuses::~MachineStatuses() {
  if (hosts_ != nullptr) hosts_->OnChange({});
  count_.reset();
  subscription_.reset();
  std::unique_lock lock(mutex_);
  rests_.wait(lock, [this] { return !looking_; });
}

void MachineStatuses::Woken() {
  {
    const std::lock_guard lock(mutex_);
    again_ = true;
    if (looking_) return;
    looking_ = true;
  }
  executor_.Post([this] { Look(); });
}

void MachineStatuses::Look() {
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      if (!again_) {
        looking_ = false;
        rests_.notify_all();  // under the lock: it may be gone right after
        return;
      }
      again_ = false;
    }
    const bool host_changed = host_changed_.exchange(false);
    const bool changed = ChangedSinceLastLook();
    const auto unfinished = store_.UnfinishedJobs();
    if (unfinished && !changed && !host_changed && !IsCountedOtherwise(*unfinished)) continue;
    const auto machines = machines_.List();
    if (!machines || !unfinished) {
      first_ = true;  // the next event brings a whole look
      continue;
    }
    std::map<std::string, std::string> now;
    std::set<std::string> hosted;  // its host tells of it
    for (const auto& [id, machine] : **machines) {
      const std::string name = MachineName(id);
      if (hosts_ != nullptr && hosts_->IsHosted(id)) {
        hosted.insert(name);
      } else {
        now[name] = StatusOf(hosts_, machine, *unfinished).SerializeAsString();
      }
    }
    for (const auto& [name, status] : now) {
      const auto before = told_.find(name);
      if (before == told_.end() || before->second != status) feed_.Publish(name, status);
    }
    for (const auto& [name, status] : told_) {
      if (!now.contains(name) && !hosted.contains(name)) feed_.Forget(name);
    }
    told_ = std::move(now);
    counted_ = *unfinished;
  }
}

bool MachineStatuses::IsCountedOtherwise(const std::vector<storage::MachineJobs>& jobs) const {
  const auto all = [](const storage::MachineJobs& one) {
    return std::tie(one.machine, one.unfinished, one.oldest_running);
  };
  return !std::ranges::equal(jobs, counted_, {}, all, all);
}

bool MachineStatuses::ChangedSinceLastLook() {
  bool changed = std::exchange(first_, false);
  if (changed) {
    position_ = feed_.position();
    return true;
  }
  while (true) {
    const auto events = feed_.EventsAfter(position_, kReadAhead);
    if (!events) {  // some are gone: whatever they told is seen below
      position_ = feed_.position();
      return true;
    }
    if (events->empty()) return changed;
    position_ = events->back().position;
    changed = changed || std::ranges::any_of(*events, Matters);
  }
}

}  // namespace rmlcell::server
