#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "rmlcell/v1/host.pb.h"
#include "server/host/unstored_entries.h"

namespace rmlcell::server {

// What happened at a machine, on the disk of its host, in one order: so a mark that is there has
// everything before it there. LIVE-3.22, 3.24
//
// A file of records, each a length, the CRC-32C of what follows, and an entry
// (rmlcell.v1.JournalEntry). A record that was torn by a crash ends it. One thread at a time.
class Journal {
 public:
  // Grows to this before what the store has is dropped, and never beyond kBytesMax.
  static constexpr std::int64_t kBytesKept = std::int64_t{4} << 20;
  static constexpr std::int64_t kBytesMax = std::int64_t{64} << 20;

  struct Found {
    std::unique_ptr<Journal> journal;
    std::vector<v1::JournalEntry> entries{};  // those that were whole
    std::int64_t torn_bytes = 0;              // behind them, and cut off now
  };
  // Made where there is none. Errors: CellJournal, with the path.
  static Result<Found> Open(const std::string& path);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  // In order, and on the disk when this returns. Where there is no room, marks that have a newer
  // one behind them make some. After an error nothing of it is there, as far as anybody reads.
  // Errors: CellJournal: the disk is full or fails, or there is no room.
  Status Write(const std::vector<v1::JournalEntry>& entries);
  // All up to this entry is in the store, and a mark behind which everything else lies is the last
  // of it: it is dropped when it is worth while.
  void Stored(std::int64_t fence, std::int64_t sequence);

  // These are all of it. Errors: CellJournal.
  Status Replace(const std::vector<v1::JournalEntry>& entries);

  std::int64_t bytes() const { return bytes_; }
  const std::string& path() const { return path_; }

 private:
  Journal(std::string path, int file, std::int64_t bytes)
      : path_(std::move(path)), file_(file), bytes_(bytes) {}
  struct Place {
    std::int64_t fence = 0;
    std::int64_t sequence = 0;
    std::int64_t end = 0;  // of its record in the file
    EntryKind kind = EntryKind::kOther;
  };
  Status Rewrite(std::string_view records);
  static Place PlaceOf(const v1::JournalEntry& entry, std::int64_t end);
  std::int64_t BytesOfOldMarks() const;
  Status DropOldMarks();

  const std::string path_;
  int file_;
  std::int64_t bytes_;
  std::vector<Place> places_;  // of the entries that are there, in order
};

// The records of these entries, and what can be read of such bytes.
std::string RecordsOf(const std::vector<v1::JournalEntry>& entries);
struct ReadRecords {
  std::vector<v1::JournalEntry> entries{};
  std::vector<std::int64_t> ends{};  // of each record
};
ReadRecords ReadJournal(std::string_view bytes);

}  // namespace rmlcell::server
