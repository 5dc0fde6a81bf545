#pragma once

#include <memory>
#include <string>

#include "engine/core/result.h"
#include "server/base/config.h"

namespace rmlcell::server {

// The whole server of one process: store, queue, services, web port, its own workers.
class Cell {
 public:
  // Opens the store, listens, starts the workers. Errors: CellStoreBusy and the like, CellPortUsed,
  // CellConfiguration; then nothing is left running.
  static Result<std::unique_ptr<Cell>> Start(const Config& config);
  ~Cell();
  Cell(const Cell&) = delete;
  Cell& operator=(const Cell&) = delete;

  // Health to NOT_SERVING, streams told to come back, leases handed back, workers ended; within
  // shutdown.timeout_s and a second.
  void Stop();

  // Addresses as they are listened on, ports resolved: "127.0.0.1:50051", "unix:/run/cell.sock".
  const std::vector<std::string>& grpc_addresses() const;
  std::string web_address() const;  // "127.0.0.1:50080"; empty: none

 private:
  struct Parts;
  explicit Cell(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace rmlcell::server
