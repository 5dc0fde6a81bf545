#include "storage/store.h"

#include <future>

namespace rmlcell::storage {

Result<SubmittedJob> Store::SubmitAndWait(NewJob job) {
  std::promise<Result<SubmittedJob>> promise;
  std::future<Result<SubmittedJob>> future = promise.get_future();
  Submit(std::move(job),
         [&](Result<SubmittedJob> result) { promise.set_value(std::move(result)); });
  return future.get();
}

Result<std::optional<LeasedJob>> Store::Acquire(std::string_view worker,
                                                const std::vector<std::string>& kinds,
                                                std::chrono::milliseconds duration,
                                                const std::vector<NewEvent>& events) {
  Result<std::vector<LeasedJob>> leased = AcquireJobs(
      {.worker = std::string(worker), .kinds = kinds, .duration = duration, .events = events});
  if (!leased) return leased.error();
  if (leased->empty()) return std::optional<LeasedJob>();
  return std::optional(std::move(leased->front()));
}

Result<std::int64_t> Store::AppendAndWait(const Lease& lease, std::vector<NewEvent> events) {
  std::promise<Result<std::int64_t>> promise;
  std::future<Result<std::int64_t>> future = promise.get_future();
  Append(lease, std::move(events),
         [&](Result<std::int64_t> result) { promise.set_value(std::move(result)); });
  return future.get();
}

}  // namespace rmlcell::storage
