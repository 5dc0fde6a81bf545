#include "server/services/watch_registry.h"

#include <random>
#include <utility>

#include "engine/core/hex.h"
#include "server/base/readable.h"

namespace rmlcell::server {
namespace {

constexpr int kIdDigits = 32;

std::string RandomId() {
  std::random_device device;  // that of the system
  std::string id;
  for (int i = 0; i < kIdDigits; ++i) id += HexDigit(device());
  return id;
}

}  // namespace

std::string WatchRegistry::Add(const std::shared_ptr<Watch>& watch, std::string caller) {
  std::string id = RandomId();
  const std::lock_guard lock(mutex_);
  open_[id] = {.watch = watch, .caller = std::move(caller)};
  return id;
}

void WatchRegistry::Remove(const std::string& id) {
  const std::lock_guard lock(mutex_);
  open_.erase(id);
}

Status WatchRegistry::Change(const v1::UpdateWatchRequest& request, const std::string& caller) {
  auto add = MakeSubscriptions(request.add());
  if (!add) return add.error();
  std::shared_ptr<Watch> watch;
  {
    const std::lock_guard lock(mutex_);
    const auto found = open_.find(request.watch_id());
    if (found != open_.end() && found->second.caller == caller) watch = found->second.watch.lock();
  }
  if (watch == nullptr) {
    return Error{ErrorCode::kCellNotFound,
                 "no watch '" + Readable(request.watch_id()) + "' is open; begin a new one",
                 {}};
  }
  return watch->Change(
      {.add = *std::move(add), .remove = {request.remove().begin(), request.remove().end()}});
}

}  // namespace rmlcell::server
