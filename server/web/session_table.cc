#include "server/web/session_table.h"

namespace rmlcell::web {

OpenSession::OpenSession(SessionTable& table) : table_(table) { table_.Count(); }

OpenSession::~OpenSession() { table_.Uncount(); }

void SessionTable::Add(OpenSession* session) {
  const std::lock_guard lock(mutex_);
  sessions_.insert(session);
}

void SessionTable::Remove(OpenSession* session) {
  const std::lock_guard lock(mutex_);
  sessions_.erase(session);
}

void SessionTable::Count() {
  const std::lock_guard lock(mutex_);
  ++counted_;
}

void SessionTable::Uncount() {
  const std::lock_guard lock(mutex_);
  --counted_;
  changed_.notify_all();
}

std::size_t SessionTable::size() const {
  const std::lock_guard lock(mutex_);
  return counted_;
}

void SessionTable::EndAll(bool at_once) {
  const std::lock_guard lock(mutex_);
  for (OpenSession* session : sessions_) session->End(at_once);
}

bool SessionTable::WaitUntilEmpty(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, patience, [this] { return counted_ == 0; });
}

}  // namespace rmlcell::web
