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

  // What was touched since the last time counts, also when it was undone. By whoever has the turn
  // to write, between a commit and the first word of it to anybody.
  void Publish();

  // Any thread.
  std::uint64_t OfJob(std::int64_t id) const {
    return jobs_[static_cast<std::size_t>(id) % kCounts];
  }
  std::uint64_t OfMachines() const { return machines_; }

 private:
  static constexpr std::size_t kCounts = 4'096;  // jobs so far from each other share one
  void Touch(const char* table, std::int64_t row);

  Database& written_;
  std::vector<std::int64_t> touched_jobs_;
  bool touched_machines_ = false;
  std::array<std::atomic<std::uint64_t>, kCounts> jobs_{};
  std::atomic<std::uint64_t> machines_ = 0;
};

}  // namespace rmlcell::storage::sqlite
