#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "rmlcell/v1/job.pb.h"

namespace rmlcell::server {

// Jobs as they were told last, serialised. While nothing in one has changed, whoever asks again
// gets it from here, without the store: many ask for the same one over and over. Thread-safe and
// bounded.
class ToldJobs {
 public:
  static constexpr std::size_t kJobsMax = 1'024;        // the newest of those that share a place
  static constexpr std::size_t kBytesMax = 16 * 1'024;  // of one; larger ones are not kept

  // `changes`: Store::JobChanges now, and as it was before the job was read.
  // Null: it is not known, or has changed.
  std::shared_ptr<const std::string> Find(std::int64_t id, std::uint64_t changes) const;
  void Keep(std::int64_t id, std::uint64_t changes, const v1::Job& job);

 private:
  struct Told {
    std::int64_t id = 0;
    std::uint64_t changes = 0;
    std::shared_ptr<const std::string> job;
  };
  mutable std::mutex mutex_;
  std::array<Told, kJobsMax> told_;  // guarded by mutex_; by number, over and over
};

}  // namespace rmlcell::server
