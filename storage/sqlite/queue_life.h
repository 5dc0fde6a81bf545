#pragma once

#include <optional>
#include <vector>

#include "storage/sqlite/write_context.h"
#include "storage/store.h"

// What happens to the order of the queue: each function is a part of one write, and the contract of
// those that are named as methods of Store is that of the method.
namespace rmlcell::storage::sqlite {

// What keeps this queued job, whose `after` is there, from starting.
Status AddWait(Tables& tables, JobRecord& job, WallTime now);

// Of the jobs that a new one waits for those that have not succeeded yet. CellNotFound;
// CellPrecondition: one has ended otherwise.
Result<std::vector<std::int64_t>> StillWanted(WriteContext& context, const NewJob& job);
// Those that waited for this job, which has succeeded.
Status LetFollowersGo(WriteContext& context, std::int64_t job);

// The next one for this worker; nothing: none is ready.
Result<std::optional<std::int64_t>> NextFor(WriteContext& context, const JobRequest& request);

Result<JobRecord> HoldJobBack(WriteContext& context, std::int64_t id,
                              const std::vector<NewEvent>& events);
Result<JobRecord> LetJobGo(WriteContext& context, std::int64_t id,
                           const std::vector<NewEvent>& events);
Result<JobRecord> MoveJob(WriteContext& context, std::int64_t id, std::int64_t before,
                          std::optional<int> priority, const std::vector<NewEvent>& events);
Result<std::vector<JobRecord>> ActOnJobs(WriteContext& context, std::span<const std::int64_t> jobs,
                                         QueueAct act, const Store::EventOf& event);
// As Store::CountBefore.
Result<std::int64_t> CountBefore(Tables& tables, std::int64_t id);

// As Store::PutOrder and TakeOrders.
Status PutJobOrder(WriteContext& context, std::int64_t job, std::string_view from,
                   std::string_view payload);
Result<std::vector<TakenOrder>> TakeJobOrders(WriteContext& context, std::string_view server);

// Those whose time has come.
Status LetDueJobsGo(WriteContext& context);

}  // namespace rmlcell::storage::sqlite
