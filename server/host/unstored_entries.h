#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "engine/core/result.h"
#include "rmlcell/v1/host.pb.h"

namespace rmlcell::server {

// Entries that are in the journal of a host and that the store is not known to have. As many as the
// journal has room for: it is what bounds them.
class UnstoredEntries {
 public:
  // From here on marks that have a newer one behind them are left out, events never are. LIVE-3.25
  static constexpr std::size_t kMarksKept = 10'000;

  void Add(const std::vector<v1::JournalEntry>& entries);
  void Stored(std::int64_t sequence);  // all up to this one
  std::vector<v1::JournalEntry> all() const { return {entries_.begin(), entries_.end()}; }
  bool empty() const { return entries_.empty(); }

  // The machine is another host's now: nobody takes them any more, and they are kept beside the
  // journal, behind what was kept so before. Returns where, empty: there are none. Error:
  // CellJournal. LIVE-3.05
  Result<std::string> KeepAsOrphan(const std::string& journal) const;

 private:
  std::deque<v1::JournalEntry> entries_;
  std::size_t looked_at_ = kMarksKept;  // so many more, and it is worth while to look for marks
};

// Messages that a server takes, however much there is, each but the last with a mark at its end.
// LIVE-3.25
std::vector<v1::HostRequest> EntriesInParts(const std::vector<v1::JournalEntry>& entries,
                                            std::int64_t fence);

enum class EntryKind : std::uint8_t { kOther, kMark, kRunOver };
EntryKind KindOf(const v1::JournalEntry& entry);
// Which of them are marks that have a newer one behind them; that behind the end of a run is none,
// since both are stored at once, and now and then one stays for a part to end with.
std::vector<bool> OldMarks(const std::vector<EntryKind>& kinds);
// All but those.
std::vector<v1::JournalEntry> WithoutOldMarks(std::vector<v1::JournalEntry> entries);

}  // namespace rmlcell::server
