#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/core/result.h"
#include "rmlcell/v1/handbox.pb.h"
#include "storage/store.h"

namespace rmlcell::server {

// What was taught at machines, and how it is taken back. LIVE-7.09. Thread-safe; blocks on the
// store. Errors everywhere: those of the store.
class TeachBook {
 public:
  explicit TeachBook(storage::Store& store) : store_(store) {}

  // Keeps what was done to a program; `before` and `after` are its revisions, 0: it was not there.
  // Returns the entry with its number.
  Result<v1::TeachEntry> Add(const std::string& machine, v1::TeachEntry entry,
                             storage::Revision before, storage::Revision after);
  Result<v1::ListTeachEntriesResponse> List(const v1::ListTeachEntriesRequest& request);

  // Takes back what was taught, down to an entry, and returns the entry that is made of it; asked
  // again, the same. Errors: CellNotFound, no such entry of the program; CellEtagMismatch, the
  // program was changed otherwise since the last of them; CellInvalidArgument.
  Result<v1::TeachEntry> TakeBack(const v1::UndoTeachEntriesRequest& request,
                                  const std::string& caller);

 private:
  // A program as it was before an entry.
  struct Undo {
    std::string machine{};
    int program = 0;
    std::string object{};            // empty: it was not there
    storage::Revision expected = 0;  // of the program now; 0: there is none
    std::int64_t down_to = 0;
    std::optional<v1::TeachEntry> done{};  // it was taken back already
  };
  Result<Undo> Prepare(const v1::UndoTeachEntriesRequest& request);
  Result<v1::TeachEntry> Carry(const Undo& undo, const std::string& caller);

  storage::Store& store_;
};

}  // namespace rmlcell::server
