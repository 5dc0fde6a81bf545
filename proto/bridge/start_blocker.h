#pragma once

#include "engine/core/result.h"
#include "rmlcell/v1/machine_status.pb.h"

namespace rmlcell::bridge {

// What keeps a machine from beginning a job. LIVE-5.02
v1::StartBlocker ToStartBlocker(const Error& error);

}  // namespace rmlcell::bridge
