#include "storage/sqlite/change_counts.h"

#include <string_view>
#include <utility>

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

// The parameters of a machine change with its own row only: that has the revision.
void ChangeCounts::Touch(const char* table, std::int64_t row) {
  if (std::string_view(table) == "job") {
    if (touched_jobs_.empty() || touched_jobs_.back() != row) touched_jobs_.push_back(row);
  } else if (std::string_view(table) == "machine") {
    touched_machines_ = true;
  }
}

void ChangeCounts::Publish() {
  for (const std::int64_t job : touched_jobs_) ++jobs_[static_cast<std::size_t>(job) % kCounts];
  touched_jobs_.clear();
  if (std::exchange(touched_machines_, false)) ++machines_;
}

}  // namespace rmlcell::storage::sqlite
