#pragma once

#include <string>

#include "engine/core/result.h"

namespace rmlcell::server {

// Plays a recording (proto/recording) of the run of a job again and makes the products of that run:
// "report", "toolpath", "picture.svg", and "series" and "steps" where there are any, a file each in
// `folder`, which is there. LIVE-3.41
//
// Errors: CellFileUnreadable, CellFileUnwritable; those of recording::ReadFile and Replay;
// CellReplayDiffers: what is played is not what happened, and nothing is made; CellPrecondition:
// the recording ends before the run does.
Status MakeProducts(const std::string& recording, const std::string& folder);

}  // namespace rmlcell::server
