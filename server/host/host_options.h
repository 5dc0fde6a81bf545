#pragma once

#include <google/protobuf/util/time_util.h>

#include <chrono>

#include "rmlcell/v1/machine.pb.h"

// What the options of a machine mean to its host.
namespace rmlcell::server {

inline std::chrono::nanoseconds DurationOf(const google::protobuf::Duration& duration) {
  return std::chrono::nanoseconds(
      google::protobuf::util::TimeUtil::DurationToNanoseconds(duration));
}

// A host that is so late while its machine moves stops it. LIVE-3.14
inline std::chrono::nanoseconds LateHold(const v1::MachineOptions& options) {
  return options.has_late_hold() ? DurationOf(options.late_hold()) : std::chrono::seconds(1);
}

// How long a run goes on without a server. LIVE-3.31
inline std::chrono::nanoseconds GoesOnWithoutServer(const v1::MachineOptions& options) {
  if (options.server_lost() != v1::MachineOptions::SERVER_LOST_GO_ON)
    return std::chrono::seconds(1);
  return options.has_server_lost_after() ? DurationOf(options.server_lost_after())
                                         : std::chrono::seconds(40);
}

}  // namespace rmlcell::server
