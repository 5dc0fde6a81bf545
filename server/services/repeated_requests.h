#pragma once

#include <deque>
#include <map>
#include <mutex>
#include <string>

#include "engine/core/result.h"

namespace rmlcell::server {

// Requests of this server that were carried out, by caller and request id: a repeat acts never
// again. LIVE-9.01. Thread-safe.
class RepeatedRequests {
 public:
  static constexpr std::size_t kKept = 1'000;

  // Whether this was carried out already. Error: CellRequestIdReused, with another `content`.
  Result<bool> IsRepeat(const std::string& caller, const std::string& request_id,
                        const std::string& content) const {
    const std::lock_guard lock(mutex_);
    const auto known = contents_.find(KeyOf(caller, request_id));
    if (request_id.empty() || known == contents_.end()) return false;
    if (known->second != content) return Error{ErrorCode::kCellRequestIdReused, {}, {}};
    return true;
  }
  void Keep(const std::string& caller, const std::string& request_id, const std::string& content) {
    if (request_id.empty()) return;
    const std::lock_guard lock(mutex_);
    if (!contents_.emplace(KeyOf(caller, request_id), content).second) return;
    order_.push_back(KeyOf(caller, request_id));
    if (order_.size() <= kKept) return;
    contents_.erase(order_.front());
    order_.pop_front();
  }

 private:
  static std::string KeyOf(const std::string& caller, const std::string& request_id) {
    return request_id + '\n' + caller;
  }

  mutable std::mutex mutex_;
  std::map<std::string, std::string> contents_;  // guarded by mutex_
  std::deque<std::string> order_;                // likewise
};

}  // namespace rmlcell::server
