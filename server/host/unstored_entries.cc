#include "server/host/unstored_entries.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

#include "server/host/journal.h"

namespace rmlcell::server {

std::vector<v1::JournalEntry> WithoutOldMarks(std::vector<v1::JournalEntry> entries) {
  const auto newest = std::find_if(entries.rbegin(), entries.rend(),
                                   [](const auto& one) { return one.has_mark(); });
  if (newest == entries.rend()) return entries;
  const auto end = std::remove_if(entries.begin(), std::prev(newest.base()),
                                  [](const auto& one) { return one.has_mark(); });
  entries.erase(end, std::prev(newest.base()));
  return entries;
}

void UnstoredEntries::Add(const std::vector<v1::JournalEntry>& entries) {
  entries_.insert(entries_.end(), entries.begin(), entries.end());
  if (entries_.size() < looked_at_) return;
  const std::vector<v1::JournalEntry> kept = WithoutOldMarks(all());
  entries_.assign(kept.begin(), kept.end());
  looked_at_ = 2 * entries_.size() + kMarksKept;
}

void UnstoredEntries::Stored(std::int64_t sequence) {
  while (!entries_.empty() && entries_.front().sequence() <= sequence) entries_.pop_front();
  if (entries_.empty()) looked_at_ = kMarksKept;
}

Result<std::string> UnstoredEntries::KeepAsOrphan(const std::string& journal) const {
  if (entries_.empty()) return std::string();
  std::string path = journal + ".orphan";
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << RecordsOf(all()) << std::flush;
  if (!file) return Error{ErrorCode::kCellJournal, path + ": " + std::strerror(errno), {}};
  return path;
}

}  // namespace rmlcell::server
