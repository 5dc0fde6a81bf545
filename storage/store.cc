#include "storage/store.h"

#include <future>
#include <string>

namespace rmlcell::storage {
namespace {

// What `call` gives the Done<T> that it is called with.
template <class T, class Call>
Result<T> Waited(Call call) {
  std::promise<Result<T>> promise;
  std::future<Result<T>> future = promise.get_future();
  call([&](Result<T> result) { promise.set_value(std::move(result)); });
  return future.get();
}

}  // namespace

Result<SubmittedJob> Store::SubmitAndWait(NewJob job) {
  return Waited<SubmittedJob>(
      [&](Done<SubmittedJob> done) { Submit(std::move(job), std::move(done)); });
}

Result<std::int64_t> Store::AppendAndWait(const Lease& lease, std::vector<NewEvent> events) {
  return Waited<std::int64_t>(
      [&](Done<std::int64_t> done) { Append(lease, std::move(events), std::move(done)); });
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

Status CheckRoom(const std::optional<ProgramMemoryLimit>& limit, std::int64_t before,
                 std::int64_t after) {
  if (!limit || after <= limit->bytes || after <= before) return {};
  return Error{limit->full,
               "the program memory has " + std::to_string(limit->bytes) + " bytes, and " +
                   std::to_string(after) + " would be in it",
               {}};
}

void Store::SendRequestCancel(std::int64_t job, std::vector<NewEvent> events,
                              Done<JobRecord> done) {
  done(RequestCancel(job, events));
}

void Store::SendRenew(const Lease& lease, std::chrono::milliseconds duration,
                      Done<JobRecord> done) {
  done(Renew(lease, duration));
}

void Store::SendFinish(const Lease& lease, std::shared_ptr<const JobEnd> end,
                       std::optional<JobRequest> next, Done<FinishedJob> done) {
  Result<JobRecord> job = Finish(lease, *end);
  if (!job) return done(job.error());
  FinishedJob finished{.job = *std::move(job)};
  if (next) {
    if (auto leased = AcquireJobs(*next)) finished.next = *std::move(leased);
  }
  done(std::move(finished));
}

void Store::SendHandBack(const Lease& lease, LossPolicy policy, Done<JobRecord> done) {
  done(HandBack(lease, policy));
}

void Store::SendAbandon(const Lease& lease, LossPolicy policy, Done<JobRecord> done) {
  done(Abandon(lease, policy));
}

}  // namespace rmlcell::storage
