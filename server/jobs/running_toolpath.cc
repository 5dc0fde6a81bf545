#include "server/jobs/running_toolpath.h"

#include <utility>

namespace rmlcell::server {
namespace {

constexpr std::size_t kPartMax = std::size_t{256} << 10;

}  // namespace

RunningToolpath::Part RunningToolpath::Look(std::int64_t offset, std::uint64_t open_seen) const {
  const std::lock_guard lock(mutex_);
  Result<std::string> frames = frames_.Part(offset, kPartMax);
  if (!frames) return {.open_seen = open_seen, .ended = true};
  Part part{.frames = *std::move(frames),
            .open_seen = open_version_,
            .ended = ended(),
            .stored = stored()};
  if (part.frames.empty() && open_seen != open_version_) part.open_block = open_block_;
  return part;
}

void RunningToolpath::Add(std::string_view frames, std::string open_block) {
  const std::lock_guard lock(mutex_);
  frames_.append(frames);
  open_block_ = std::move(open_block);
  ++open_version_;
  WakeAll();
}

}  // namespace rmlcell::server
