#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <set>

namespace rmlcell::storage::sqlite {

// Leases, by fence, whose jobs are over and whose ends are being staged: nobody renews them any
// more, and they do not run out. Thread-safe; outlives its holders.
class EndsUnderWay {
 public:
  class Holder {
   public:
    Holder(EndsUnderWay& ends, std::int64_t fence) : ends_(ends), fence_(fence) {
      const std::lock_guard lock(ends_.mutex_);
      ends_.fences_.insert(fence_);
    }
    Holder(const Holder&) = delete;
    Holder& operator=(const Holder&) = delete;
    ~Holder() {
      const std::lock_guard lock(ends_.mutex_);
      ends_.fences_.erase(ends_.fences_.find(fence_));
    }

   private:
    EndsUnderWay& ends_;
    const std::int64_t fence_;
  };

  bool Has(std::int64_t fence) const {
    const std::lock_guard lock(mutex_);
    return fences_.contains(fence);
  }

 private:
  mutable std::mutex mutex_;
  std::multiset<std::int64_t>
      fences_;  // guarded by mutex_; an end that was told twice is there twice
};

}  // namespace rmlcell::storage::sqlite
