#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "engine/core/result.h"
#include "rmlcell/v1/cell.pb.h"
#include "server/services/subscriptions.h"

namespace rmlcell::server {

// Subscriptions that a client adds to a watch that goes on, and takes from it.
struct WatchChange {
  std::vector<CellSubscription> add{};
  std::vector<std::string> remove{};
};

// The watches that are open, so that a call of its own can change one. Thread-safe.
class WatchRegistry {
 public:
  // Called by the thread of a call; must be quick. Error: CellInvalidArgument.
  class Watch {
   public:
    virtual ~Watch() = default;
    virtual Status Change(WatchChange change) = 0;
  };

  // The id by which the watch is known from now on; nobody can guess it.
  std::string Add(const std::shared_ptr<Watch>& watch, std::string caller);
  void Remove(const std::string& id);
  // Errors: CellNotFound, also for a watch of another caller; those of MakeSubscriptions and of the
  // watch.
  Status Change(const v1::UpdateWatchRequest& request, const std::string& caller);

 private:
  struct Open {
    std::weak_ptr<Watch> watch;
    std::string caller;
  };
  std::mutex mutex_;
  std::map<std::string, Open> open_;
};

}  // namespace rmlcell::server
