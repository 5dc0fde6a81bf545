#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <set>

namespace rmlcell::web {

// A connection, as the table knows it.
class OpenSession {
 public:
  virtual ~OpenSession() = default;
  // Ends it: at once, or when the request under way is answered. From any thread; returns at once.
  virtual void End(bool at_once) = 0;
};

// The connections that are open, so that they can be counted, told to end and waited for.
// Thread-safe.
class SessionTable {
 public:
  void Add(OpenSession* session);
  void Remove(OpenSession* session);  // before it is freed
  std::size_t size() const;

  void EndAll(bool at_once);
  // True when all are gone in time.
  bool WaitUntilEmpty(std::chrono::milliseconds patience);

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::set<OpenSession*> sessions_;  // guarded by mutex_
};

}  // namespace rmlcell::web
