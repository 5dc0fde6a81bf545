#include "server/host/unstored_entries.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <utility>

#include "server/host/journal.h"

namespace rmlcell::server {
namespace {

constexpr std::size_t kPartBytes = std::size_t{1} << 20;
constexpr std::size_t kBetweenMarks = 200;  // other entries, of which some hundred make a part

}  // namespace

EntryKind KindOf(const v1::JournalEntry& entry) {
  if (entry.has_mark()) return EntryKind::kMark;
  return entry.has_run_over() ? EntryKind::kRunOver : EntryKind::kOther;
}

std::vector<bool> OldMarks(const std::vector<EntryKind>& kinds) {
  std::vector<bool> old(kinds.size());
  std::optional<std::size_t> newest;
  std::size_t others = 0;   // behind the newest mark that stays
  bool behind_run = false;  // no mark stands behind the newest end
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (kinds[i] == EntryKind::kRunOver) behind_run = true;
    if (kinds[i] != EntryKind::kMark) {
      ++others;
      continue;
    }
    if (newest) old[*newest] = true;
    const bool stays = behind_run || others >= kBetweenMarks;
    if (stays) others = 0;
    newest = stays ? std::nullopt : std::optional(i);
    behind_run = false;
  }
  return old;
}

std::vector<v1::JournalEntry> WithoutOldMarks(std::vector<v1::JournalEntry> entries) {
  std::vector<EntryKind> kinds;
  std::ranges::transform(entries, std::back_inserter(kinds), KindOf);
  const std::vector<bool> old = OldMarks(kinds);
  std::size_t i = 0;
  std::erase_if(entries, [&](const v1::JournalEntry& /*entry*/) { return old[i++]; });
  return entries;
}

std::vector<v1::HostRequest> EntriesInParts(const std::vector<v1::JournalEntry>& entries,
                                            std::int64_t fence) {
  std::vector<v1::HostRequest> parts;
  std::size_t bytes = 0;
  bool over = true;
  for (const v1::JournalEntry& entry : entries) {
    if (std::exchange(over, false)) {
      bytes = 0;
      parts.emplace_back().mutable_entries()->set_fence(fence);
    }
    bytes += entry.ByteSizeLong();
    *parts.back().mutable_entries()->add_entries() = entry;
    // What is stored ends with a mark.
    over = bytes >= kPartBytes && entry.has_mark();
  }
  return parts;
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
  std::ofstream file(path, std::ios::binary | std::ios::app);
  file << RecordsOf(all()) << std::flush;
  if (!file) return Error{ErrorCode::kCellJournal, path + ": " + std::strerror(errno), {}};
  return path;
}

}  // namespace rmlcell::server
