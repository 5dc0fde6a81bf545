#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "storage/sqlite/database.h"

namespace rmlcell::storage::sqlite {

// How often jobs and machines have changed, as of the newest commit. SQLite itself says which rows
// are touched, so that no way to change one can be forgotten.
class ChangeCounts {
 public:
  // `written`: the connection that writes; it outlives this.
  explicit ChangeCounts(Database& written);
  ~ChangeCounts();
  ChangeCounts(const ChangeCounts&) = delete;
  ChangeCounts& operator=(const ChangeCounts&) = delete;

  // By whoever has the turn to write. Between the two calls, around a commit, what was touched
  // counts as being changed: the rows may be seen already, and nobody was told. The second one also
  // when the commit fails, and before the first word of it to anybody.
  void BeforeCommit();
  void AfterCommit();

  // Any thread; 0 while it is being changed.
  std::uint64_t OfJob(std::int64_t id) const {
    return Told(jobs_[static_cast<std::size_t>(id) % kCounts]);
  }
  std::uint64_t OfMachines() const { return Told(machines_); }

 private:
  // Odd: it is being changed.
  using Count = std::atomic<std::uint64_t>;
  static constexpr std::size_t kCounts = 4'096;  // jobs so far from each other share one
  static std::uint64_t Told(std::uint64_t count) { return count % 2 == 0 ? count + 2 : 0; }
  void Touch(const char* table, std::int64_t row) noexcept;
  template <class Change>
  void ForTouched(Change change);

  Database& written_;
  std::vector<std::int64_t> touched_jobs_;
  bool touched_all_jobs_ = false;  // more than could be noted
  bool touched_machines_ = false;
  std::array<Count, kCounts> jobs_{};
  Count machines_ = 0;
};

}  // namespace rmlcell::storage::sqlite
