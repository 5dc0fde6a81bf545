#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/simulation/material/height_tiles.h"
#include "proto/bridge/spooled_bytes.h"
#include "rmlcell/v1/worker.pb.h"
#include "server/worker/server_line.h"

namespace rmlcell::server {

// What a job puts out: the products that grow while it runs, within its budget, and how each goes
// to the server.
class JobOutput {
 public:
  // Both outlive this. `bytes_max`: of trace, toolpath, events and all other products together.
  JobOutput(ServerLine& line, const v1::WorkerLease& lease, std::int64_t bytes_max)
      : line_(line), lease_(lease), bytes_max_(bytes_max) {}

  // One record of the trace, one block of the toolpath, events that were sent. False: that is more
  // than the budget.
  bool AddTrace(std::string_view record);
  bool AddToolpath(std::string_view block);
  void CountEvents(std::size_t bytes) { event_bytes_ += bytes; }

  // For who follows the toolpath: what is new of it, and the block that is not full yet. False:
  // there is more, as is told next time.
  bool SendNewToolpath(std::string open_block);

  // For who looks at what is left of the block: the first time the grid, then tiles of it. False:
  // it cannot be sent.
  bool SendHeights(const simulation::HeightField& field, std::vector<simulation::HeightTile> tiles);

  // Whether all that the job has put out stays in its budget, `more` included.
  bool Fits(std::size_t more = 0) const;

  // Once, at the end.
  void SendTrace() { SendSpooled("trace", trace_); }
  void SendToolpath() { SendSpooled("toolpath", toolpath_); }
  void Send(const std::string& name, const std::string& media_type, std::string_view bytes,
            const machine::BytesKeeper* keeper = nullptr);
  // The small ones of what was sent: they go with the end of the attempt.
  void MoveSmallTo(v1::WorkerFinish& finish);

 private:
  void SendSpooled(const std::string& name, bridge::SpooledBytes& product);

  ServerLine& line_;
  const v1::WorkerLease& lease_;
  std::int64_t bytes_max_;
  bridge::SpooledBytes trace_;
  bridge::SpooledBytes toolpath_;
  v1::WorkerFinish small_;  // products that go with the end
  std::size_t small_bytes_ = 0;
  std::size_t event_bytes_ = 0;
  std::int64_t followed_bytes_ = 0;  // of the toolpath, that went to who follows it
  std::string followed_block_;       // the open one that went last
  bool grid_sent_ = false;
};

}  // namespace rmlcell::server
