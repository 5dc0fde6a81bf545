#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "proto/bridge/spooled_bytes.h"

namespace rmlcell::server {

// The toolpath of a job that runs, as its worker makes it, for all who follow it: one copy of it,
// most of it in a file. Thread-safe.
class RunningToolpath : public std::enable_shared_from_this<RunningToolpath> {
 public:
  class Follower {
   public:
    ~Follower();
    Follower(const Follower&) = delete;
    Follower& operator=(const Follower&) = delete;

   private:
    friend RunningToolpath;
    Follower(std::shared_ptr<RunningToolpath> followed,
             std::list<std::function<void()>>::iterator at)
        : followed_(std::move(followed)), at_(at) {}
    std::shared_ptr<RunningToolpath> followed_;
    std::list<std::function<void()>>::iterator at_;
  };

  // `wake` is called when there is more, or it is over; it must not block, and not call this.
  std::unique_ptr<Follower> Follow(std::function<void()> wake);

  struct Part {
    std::string frames;           // from where it was asked for, perhaps in the middle of one
    std::string open_block;       // the block that is not full yet; empty when it is not new
    std::uint64_t open_seen = 0;  // to be given at the next look
    bool ended = false;           // no more comes
    bool stored = false;          // and what was made is in the store
  };
  Part Look(std::int64_t offset, std::uint64_t open_seen) const;

  // By the dispatcher.
  void Add(std::string_view frames, std::string open_block);
  void End(bool stored);

 private:
  mutable std::mutex mutex_;
  bridge::SpooledBytes frames_;
  std::string open_block_;
  std::uint64_t open_version_ = 0;
  bool ended_ = false;
  bool stored_ = false;
  std::list<std::function<void()>> followers_;
};

}  // namespace rmlcell::server
