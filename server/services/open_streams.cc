#include <google/protobuf/util/time_util.h>

#include "server/services/pull_stream.h"

namespace rmlcell::server {

v1::Reconnect ServerStopped() {
  v1::Reconnect message;
  *message.mutable_after() = google::protobuf::util::TimeUtil::MillisecondsToDuration(250);
  return message;
}

void OpenStreams::Add(Stream* stream) {
  bool stopping = false;
  {
    const std::lock_guard lock(mutex_);
    streams_.insert(stream);
    stopping = stopping_;
  }
  if (stopping) stream->ServerStops();
}

void OpenStreams::Remove(Stream* stream) {
  const std::lock_guard lock(mutex_);
  streams_.erase(stream);
}

void OpenStreams::StopAll() {
  // ServerStops does not block and does not come back here, so the lock can be held: it keeps a
  // stream from going away in the middle.
  const std::lock_guard lock(mutex_);
  stopping_ = true;
  for (Stream* stream : streams_) stream->ServerStops();
}

void OpenStreams::AskAgain() {
  const std::lock_guard lock(mutex_);
  for (Stream* stream : streams_) stream->RightsChanged();
}

std::size_t OpenStreams::count() const {
  const std::lock_guard lock(mutex_);
  return streams_.size();
}

}  // namespace rmlcell::server
