#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "storage/store.h"

namespace rmlcell::storage {

// Which store a cell has, and what is kept in it.
struct StoreChoice {
  // Empty: the embedded store in `directory`. "sqlite:/var/lib/rmlcell/cell.db": the embedded store
  // in this file.
  std::string url{};
  std::string directory{};
  std::int64_t keep_finished_jobs = 0;  // 0: all
  std::int64_t keep_record_events = 0;
  std::int64_t log_bytes_prepared = 0;
  ProgramMemoryOf program_memory{};  // of each machine; nothing to ask: as much as comes
};

// Whether there is a store of this kind; nothing is opened. Errors: CellConfiguration.
Status CheckStoreUrl(std::string_view url);

// Errors: those of CheckStoreUrl and of the store.
Result<std::unique_ptr<Store>> OpenStore(const StoreChoice& choice);

}  // namespace rmlcell::storage
