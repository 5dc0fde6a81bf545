#include "server/worker/job_output.h"

#include "proto/bridge/framing.h"

namespace rmlcell::server {
namespace {

constexpr std::size_t kChunkBytes = 128 << 10;

}  // namespace

bool JobOutput::AddTrace(std::string_view record) {
  bridge::AddFrame(record, trace_);
  return Fits();
}

bool JobOutput::AddToolpath(std::string_view block) {
  bridge::AddFrame(block, toolpath_);
  return Fits();
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

}  // namespace rmlcell::server
