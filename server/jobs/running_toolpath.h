#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "proto/bridge/spooled_bytes.h"
#include "server/jobs/followed.h"

namespace rmlcell::server {

// The toolpath of a job that runs: one copy of it for all who follow it, most of it in a file.
class RunningToolpath final : public Followed {
 public:
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

 private:
  bridge::SpooledBytes frames_;
  std::string open_block_;
  std::uint64_t open_version_ = 0;
};

}  // namespace rmlcell::server
