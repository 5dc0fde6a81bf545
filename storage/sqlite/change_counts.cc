#include "storage/sqlite/change_counts.h"

#include <algorithm>
#include <exception>
#include <string_view>

namespace rmlcell::storage::sqlite {

ChangeCounts::ChangeCounts(Database& written) : written_(written) {
  sqlite3_update_hook(
      written_.handle(),
      [](void* self, int, const char*, const char* table, sqlite3_int64 row) {
        static_cast<ChangeCounts*>(self)->Touch(table, row);
      },
      this);
}

ChangeCounts::~ChangeCounts() { sqlite3_update_hook(written_.handle(), nullptr, nullptr); }

// Called by SQLite: nothing may be thrown. The parameters of a machine change with its own row
// only: that has the revision.
void ChangeCounts::Touch(const char* table, std::int64_t row) noexcept {
  if (std::string_view(table) == "machine") touched_machines_ = true;
  if (std::string_view(table) != "job" || touched_all_jobs_) return;
  if (!touched_jobs_.empty() && touched_jobs_.back() == row) return;
  try {
    touched_jobs_.push_back(row);
  } catch (const std::exception&) {
    touched_all_jobs_ = true;
  }
}

template <class Change>
void ChangeCounts::ForTouched(Change change) {
  if (touched_machines_) change(machines_);
  if (touched_all_jobs_) return static_cast<void>(std::ranges::for_each(jobs_, change));
  for (const std::int64_t job : touched_jobs_)
    change(jobs_[static_cast<std::size_t>(job) % kCounts]);
}

// Several jobs may share a count: each is raised once.
void ChangeCounts::BeforeCommit() {
  ForTouched([](Count& count) {
    if (count % 2 == 0) ++count;
  });
}

void ChangeCounts::AfterCommit() {
  ForTouched([](Count& count) {
    if (count % 2 == 1) ++count;
  });
  touched_jobs_.clear();
  touched_all_jobs_ = false;
  touched_machines_ = false;
}

}  // namespace rmlcell::storage::sqlite
