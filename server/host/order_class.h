#pragma once

#include "rmlcell/v1/host.pb.h"

namespace rmlcell::server {

// Before or behind what is written. LIVE-3.20
enum class OrderClass { kActsFirst, kWrittenFirst, kWrittenBehind, kAsks };

OrderClass ClassOf(const v1::HostOrder& order);

}  // namespace rmlcell::server
