#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "engine/core/result.h"

namespace rmlcell::storage {
class Store;
}

namespace rmlcell::server {

class Hosts;

// The name under which the recording of a RUN is kept with its job.
inline constexpr std::string_view kRecording = "recording";

// What the host of a machine has recorded: of the run of this job, or the newest. `done` is called
// once, on any thread, with the file of a recording (proto/recording). Errors: CellNotLive;
// CellNotFound: the host has none.
using RecordingFetched = std::function<void(Result<std::string>)>;
void FetchRecording(Hosts& hosts, const std::string& machine, const std::string& job,
                    RecordingFetched done);

}  // namespace rmlcell::server
