#pragma once

#include <google/protobuf/util/time_util.h>

#include <chrono>

namespace rmlcell::server {

using WallTime = std::chrono::sys_time<std::chrono::microseconds>;

// When something happens at a host: by its steady clock, which never falls, and by that of people.
struct HostTime {
  std::chrono::nanoseconds steady{0};
  WallTime wall{};
};

inline google::protobuf::Timestamp Stamp(WallTime time) {
  return google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(time.time_since_epoch().count());
}

}  // namespace rmlcell::server
