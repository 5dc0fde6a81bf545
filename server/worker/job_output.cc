#include "server/worker/job_output.h"

#include <utility>

#include "proto/bridge/framing.h"
#include "proto/bridge/milling.h"

namespace rmlcell::server {
namespace {

constexpr std::size_t kChunkBytes = 128 << 10;
// Products that go with the end of the attempt, each and all together.
constexpr std::size_t kSmallBytes = 32 << 10;
constexpr std::size_t kSmallBytesAll = 128 << 10;
constexpr std::size_t kChunksAtOnce = 8;  // then orders are looked at

}  // namespace

bool JobOutput::AddTrace(std::string_view record) {
  bridge::AddFrame(record, trace_);
  return Fits();
}

bool JobOutput::AddToolpath(std::string_view block) {
  bridge::AddFrame(block, toolpath_);
  return Fits();
}

bool JobOutput::SendNewToolpath(std::string open_block) {
  for (std::size_t chunk = 0; chunk < kChunksAtOnce; ++chunk) {
    Result<std::string> frames = toolpath_.Part(followed_bytes_, kChunkBytes);
    if (!frames) return true;  // its end tells what it was
    v1::WorkRequest message;
    v1::WorkerToolpath& toolpath = *message.mutable_toolpath();
    *toolpath.mutable_lease() = lease_;
    followed_bytes_ += static_cast<std::int64_t>(frames->size());
    const bool all = followed_bytes_ == toolpath_.size();
    if (all && frames->empty() && open_block == followed_block_) return true;
    toolpath.set_frames(*std::move(frames));
    if (all) toolpath.set_open_block(open_block);
    if (!line_.Send(message)) return true;
    if (!all) continue;
    followed_block_ = std::move(open_block);
    return true;
  }
  return false;
}

bool JobOutput::SendHeights(const simulation::HeightField& field,
                            std::vector<simulation::HeightTile> tiles) {
  v1::WorkRequest message;
  v1::WorkerHeights& heights = *message.mutable_heights();
  *heights.mutable_lease() = lease_;
  if (!std::exchange(grid_sent_, true)) {
    const simulation::HeightGridHead head = simulation::HeadOf(field);
    *heights.mutable_grid() = bridge::ToProto(head, simulation::LevelForScreen(head.size));
  }
  for (simulation::HeightTile& tile : tiles)
    *heights.add_tiles() = bridge::ToProto(std::move(tile));
  return line_.Send(message);
}

bool JobOutput::Fits(std::size_t more) const {
  const std::int64_t products = trace_.size() + toolpath_.size();
  return products + static_cast<std::int64_t>(event_bytes_ + more) <= bytes_max_;
}

void JobOutput::SendSpooled(const std::string& name, bridge::SpooledBytes& product) {
  const machine::Bytes bytes = product.Finish();
  Send(name, "application/octet-stream", *bytes, bytes.keeper());
}

void JobOutput::Send(const std::string& name, const std::string& media_type, std::string_view bytes,
                     const machine::BytesKeeper* keeper) {
  if (bytes.size() <= kSmallBytes && small_bytes_ + bytes.size() <= kSmallBytesAll) {
    small_bytes_ += bytes.size();
    v1::WorkerArtifact& artifact = *small_.add_artifacts();
    *artifact.mutable_lease() = lease_;
    artifact.set_name(name);
    artifact.set_media_type(media_type);
    artifact.set_chunk(std::string(bytes));
    return;
  }
  for (std::size_t sent = 0; sent == 0 || sent < bytes.size(); sent += kChunkBytes) {
    v1::WorkRequest message;
    v1::WorkerArtifact& artifact = *message.mutable_artifact();
    *artifact.mutable_lease() = lease_;
    artifact.set_name(name);
    artifact.set_media_type(media_type);
    artifact.set_chunk(std::string(bytes.substr(sent, kChunkBytes)));
    if (!line_.Send(message)) return;
    if (keeper != nullptr) keeper->Release();
  }
}

void JobOutput::MoveSmallTo(v1::WorkerFinish& finish) {
  finish.mutable_artifacts()->Swap(small_.mutable_artifacts());
}

}  // namespace rmlcell::server
