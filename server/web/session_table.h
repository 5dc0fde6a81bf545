#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <set>

namespace rmlcell::web {

class SessionTable;

// A connection, as the table knows it. It stays counted until all that a derived class adds is
// gone: whoever waits for an empty table may free what sockets and strands lived in.
class OpenSession {
 public:
  explicit OpenSession(SessionTable& table);
  virtual ~OpenSession();
  OpenSession(const OpenSession&) = delete;
  OpenSession& operator=(const OpenSession&) = delete;
  // Ends it: at once, or when the request under way is answered. From any thread; returns at once.
  virtual void End(bool at_once) = 0;

 private:
  SessionTable& table_;
};

// The connections that are open, so that they can be counted, told to end and waited for.
// Thread-safe.
class SessionTable {
 public:
  // Told to end with the others, from when it is whole until any part of it goes.
  void Add(OpenSession* session);
  void Remove(OpenSession* session);
  std::size_t size() const;

  void EndAll(bool at_once);
  // True when all are gone in time.
  bool WaitUntilEmpty(std::chrono::milliseconds patience);

 private:
  friend class OpenSession;
  void Count();
  void Uncount();

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::set<OpenSession*> sessions_;  // guarded by mutex_
  std::size_t counted_ = 0;          // guarded by mutex_
};

}  // namespace rmlcell::web
