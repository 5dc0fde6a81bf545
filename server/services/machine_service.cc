#include "server/services/machine_service.h"

#include <algorithm>
#include <map>

#include "engine/families/families.h"
#include "engine/machine/family.h"
#include "server/base/names.h"
#include "server/machines/host_processes.h"
#include "server/machines/hosts.h"
#include "server/records/job_messages.h"
#include "server/records/machine_capabilities.h"
#include "server/records/machine_messages.h"
#include "server/records/machine_options.h"
#include "server/records/program_place.h"
#include "server/services/journal_export.h"

namespace rmlcell::server {
namespace {

constexpr PageSizes kMachinePages{.fallback = 100, .max = 1000};

// What the contract has and this version does not do.
Status CheckNothingOfLater(const v1::Machine& machine) {
  if (machine.connection().kind() == v1::MachineConnection::KIND_DEVICE ||
      !machine.connection().device().empty())
    return Error{ErrorCode::kCellUnimplemented, "machine.connection: a device", {}};
  return {};
}

}  // namespace

grpc::ServerUnaryReactor* MachineService::ListFamilies(grpc::CallbackServerContext* context,
                                                       const v1::ListFamiliesRequest* request,
                                                       v1::ListFamiliesResponse* response) {
  return Answer(needs_, context, *request, "MachineService/ListFamilies",
                [response](const Caller&) {
                  for (const machine::MachineFamily* family : families::Families()) {
                    *response->add_families() = ToProto(*family);
                  }
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* MachineService::CreateMachine(grpc::CallbackServerContext* context,
                                                        const v1::CreateMachineRequest* request,
                                                        v1::Machine* response) {
  return Answer(needs_, context, *request, "MachineService/CreateMachine",
                [this, request, response](const Caller& caller) {
                  if (const Status id = CheckResourceId(request->machine_id(), "machine_id"); !id)
                    return ToGrpcStatus(id.error());
                  if (const Status now = CheckNothingOfLater(request->machine()); !now)
                    return ToGrpcStatus(now.error());
                  const storage::MachineRecord record =
                      FromProto(request->machine(), request->machine_id());
                  if (const Status good = CheckMachine(record); !good)
                    return ToGrpcStatus(good.error());
                  if (request->validate_only()) {
                    *response = ToProto(record);
                    response->clear_etag();
                    return grpc::Status::OK;
                  }
                  const auto stored = store_.PutMachine(record, 0, caller.identity);
                  if (!stored) return ToGrpcStatus(stored.error());
                  FollowOptions(*stored);
                  *response = ToProto(*stored);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* MachineService::GetMachine(grpc::CallbackServerContext* context,
                                                     const v1::GetMachineRequest* request,
                                                     v1::Machine* response) {
  const auto id = ParseMachineName(request->name());
  const auto tell = [this, response](const storage::MachineRecord& machine) {
    const auto unfinished = store_.UnfinishedJobs();
    if (!unfinished) return ToGrpcStatus(unfinished.error());
    *response = ToProto(machine);
    *response->mutable_status() = StatusOf(live_.hosts, machine, *unfinished);
    if (live_.hosts != nullptr && live_.hosts->IsHosted(machine.id))
      *response->mutable_capabilities() = CapabilitiesOf(machine);
    return grpc::Status::OK;
  };
  return AnswerFromMemory(
      needs_, context, *request, "MachineService/GetMachine",
      [this, id, tell](const Caller&) -> std::optional<grpc::Status> {
        const auto known = machines_.ListAtOnce();
        if (!id || !known) return std::nullopt;
        const auto found = known->find(*id);
        if (found == known->end()) return std::nullopt;
        return tell(found->second);
      },
      [this, id, tell](const Caller&) {
        if (!id) return ToGrpcStatus(id.error());
        const auto machine = machines_.Get(*id);
        return machine ? tell(*machine) : ToGrpcStatus(machine.error());
      });
}

grpc::ServerUnaryReactor* MachineService::ListMachines(grpc::CallbackServerContext* context,
                                                       const v1::ListMachinesRequest* request,
                                                       v1::ListMachinesResponse* response) {
  return Answer(
      needs_, context, *request, "MachineService/ListMachines",
      [this, request, response](const Caller&) {
        const Result<int> size = PageSize(request->page_size(), kMachinePages);
        if (!size) return ToGrpcStatus(size.error());
        const auto machines = machines_.List();
        if (!machines) return ToGrpcStatus(machines.error());
        const auto unfinished = store_.UnfinishedJobs();
        if (!unfinished) return ToGrpcStatus(unfinished.error());
        for (const auto& [id, machine] : **machines) {
          if (!request->page_token().empty() && id <= request->page_token()) continue;
          if (response->machines_size() == *size) {
            response->set_next_page_token(*ParseMachineName(response->machines(*size - 1).name()));
            break;
          }
          v1::Machine& made = *response->add_machines();
          made = ToProto(machine);
          *made.mutable_status() = StatusOf(live_.hosts, machine, *unfinished);
        }
        return grpc::Status::OK;
      });
}

grpc::ServerUnaryReactor* MachineService::UpdateMachine(grpc::CallbackServerContext* context,
                                                        const v1::UpdateMachineRequest* request,
                                                        v1::Machine* response) {
  return Answer(
      needs_.Computing(), context, *request, "MachineService/UpdateMachine",
      [this, request, response](const Caller& caller) {
        const auto id = ParseMachineName(request->machine().name());
        if (!id) return ToGrpcStatus(id.error());
        if (const Status now = CheckNothingOfLater(request->machine()); !now)
          return ToGrpcStatus(now.error());
        const auto expected = ParseEtag(request->machine().etag());
        if (!expected) return ToGrpcStatus(expected.error());
        const auto stands = store_.GetMachine(*id);
        if (!stands) return ToGrpcStatus(stands.error());
        const auto record = Updated(*stands, request->machine(), request->update_mask());
        if (!record) return ToGrpcStatus(record.error());
        if (LivesOtherwise(*stands, *record) && live_.hosts != nullptr) {
          const auto now = live_.hosts->StatusOf(*id);
          if (now && now->has_run())
            return ToGrpcStatus(Error{
                ErrorCode::kCellMachineState, "a run is open: change it when that is over", {}});
        }
        if (request->validate_only()) {
          *response = ToProto(*record);
          return grpc::Status::OK;
        }
        // Read and written by the same revision: a change in between is refused, not
        // lost.
        const auto stored = store_.PutMachine(
            *record, *expected == storage::kAnyRevision ? record->revision : *expected,
            caller.identity);
        if (!stored) return ToGrpcStatus(stored.error());
        FollowChange(*stands, *stored);
        *response = ToProto(*stored);
        return grpc::Status::OK;
      });
}

grpc::ServerUnaryReactor* MachineService::DeleteMachine(grpc::CallbackServerContext* context,
                                                        const v1::DeleteMachineRequest* request,
                                                        google::protobuf::Empty*) {
  return Answer(needs_.Computing(), context, *request, "MachineService/DeleteMachine",
                [this, request](const Caller& caller) {
                  const auto id = ParseMachineName(request->name());
                  if (!id) return ToGrpcStatus(id.error());
                  const auto expected = ParseEtag(request->etag());
                  if (!expected) return ToGrpcStatus(expected.error());
                  if (live_.hosts != nullptr && live_.hosts->IsHosted(*id)) {
                    const auto stands = store_.GetMachine(*id);
                    if (!stands) return ToGrpcStatus(stands.error());
                    if (*expected != storage::kAnyRevision && *expected != stands->revision)
                      return ToGrpcStatus(Error{ErrorCode::kCellEtagMismatch, request->name(), {}});
                    if (const Status ended = EndHost(*id, "it was deleted"); !ended)
                      return ToGrpcStatus(ended.error());
                  }
                  const Status deleted = store_.DeleteMachine(*id, *expected, caller.identity);
                  if (deleted && live_.processes != nullptr) live_.processes->Forget(*id);
                  if (!deleted) Restore(*id);
                  return deleted ? grpc::Status::OK : ToGrpcStatus(deleted.error());
                });
}

grpc::ServerUnaryReactor* MachineService::GetLaserSchedule(
    grpc::CallbackServerContext* context, const v1::GetLaserScheduleRequest* request,
    v1::LaserSchedule* response) {
  return Answer(needs_, context, *request, "MachineService/GetLaserSchedule",
                [this, request, response](const Caller&) {
                  const auto name = ParseScheduleName(request->name());
                  if (!name) return ToGrpcStatus(name.error());
                  const auto machine = store_.GetMachine(name->machine);
                  if (!machine) return ToGrpcStatus(machine.error());
                  const auto schedules = store_.ListSchedules(name->machine);
                  if (!schedules) return ToGrpcStatus(schedules.error());
                  const auto found =
                      std::ranges::find(*schedules, name->number, &storage::ScheduleRecord::number);
                  if (found == schedules->end())
                    return ToGrpcStatus(Error{ErrorCode::kCellNotFound, request->name(), {}});
                  *response = ToProto(*found);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* MachineService::ListLaserSchedules(
    grpc::CallbackServerContext* context, const v1::ListLaserSchedulesRequest* request,
    v1::ListLaserSchedulesResponse* response) {
  return Answer(needs_, context, *request, "MachineService/ListLaserSchedules",
                [this, request, response](const Caller&) {
                  const auto id = ParseMachineName(request->parent());
                  if (!id) return ToGrpcStatus(id.error());
                  if (const auto machine = store_.GetMachine(*id); !machine)
                    return ToGrpcStatus(machine.error());
                  const auto schedules = store_.ListSchedules(*id);
                  if (!schedules) return ToGrpcStatus(schedules.error());
                  for (const storage::ScheduleRecord& schedule : *schedules) {
                    *response->add_laser_schedules() = ToProto(schedule);
                  }
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* MachineService::PutLaserSchedule(
    grpc::CallbackServerContext* context, const v1::PutLaserScheduleRequest* request,
    v1::LaserSchedule* response) {
  return Answer(
      needs_, context, *request, "MachineService/PutLaserSchedule",
      [this, request, response](const Caller& caller) {
        const v1::LaserSchedule& wanted = request->laser_schedule();
        const auto name = ParseScheduleName(wanted.name());
        if (!name) return ToGrpcStatus(name.error());
        const auto expected = ParseEtag(wanted.etag());
        if (!expected) return ToGrpcStatus(expected.error());
        const auto machine = store_.GetMachine(name->machine);
        if (!machine) return ToGrpcStatus(machine.error());
        const machine::MachineFamily* family = families::FindFamily(machine->family);
        if (family == nullptr) return ToGrpcStatus(families::UnknownFamily(machine->family));
        if (const Status known = CheckSchedule(*family, name->number); !known)
          return ToGrpcStatus(known.error());
        if (const Status good = CheckTitle(wanted.title(), "title"); !good)
          return ToGrpcStatus(good.error());
        const auto mode = ModeText(wanted.mode());
        if (!mode) return ToGrpcStatus(mode.error());
        if (!(wanted.power_percent() >= 0.0 && wanted.power_percent() <= 100.0)) {
          return ToGrpcStatus(
              Error{ErrorCode::kCellInvalidArgument, "power_percent: allowed are 0 to 100", {}});
        }
        const auto stored = store_.PutSchedule({.machine = name->machine,
                                                .number = static_cast<int>(name->number),
                                                .name = wanted.title(),
                                                .mode = *mode,
                                                .power_percent = wanted.power_percent()},
                                               *expected, caller.identity);
        if (!stored) return ToGrpcStatus(stored.error());
        if (live_.hosts != nullptr) live_.hosts->TakeStored();
        *response = ToProto(*stored);
        return grpc::Status::OK;
      });
}

grpc::ServerUnaryReactor* MachineService::DeleteLaserSchedule(
    grpc::CallbackServerContext* context, const v1::DeleteLaserScheduleRequest* request,
    google::protobuf::Empty*) {
  return Answer(needs_, context, *request, "MachineService/DeleteLaserSchedule",
                [this, request](const Caller& caller) {
                  const auto name = ParseScheduleName(request->name());
                  if (!name) return ToGrpcStatus(name.error());
                  const auto machine = store_.GetMachine(name->machine);
                  if (!machine) return ToGrpcStatus(machine.error());
                  const machine::MachineFamily* family = families::FindFamily(machine->family);
                  if (family == nullptr)
                    return ToGrpcStatus(families::UnknownFamily(machine->family));
                  if (const Status known = CheckSchedule(*family, name->number); !known)
                    return ToGrpcStatus(known.error());
                  const Status deleted = store_.DeleteSchedule(
                      name->machine, static_cast<int>(name->number), caller.identity);
                  if (deleted && live_.hosts != nullptr) live_.hosts->TakeStored();
                  return deleted ? grpc::Status::OK : ToGrpcStatus(deleted.error());
                });
}

grpc::ServerWriteReactor<v1::WatchMachineResponse>* MachineService::WatchMachine(
    grpc::CallbackServerContext* context, const v1::WatchMachineRequest* request) {
  return OpenStream<v1::WatchMachineResponse>(
      needs_, *context, *request, "MachineService/WatchMachine",
      [&](const Caller&) { return MakeMachineWatch(watch_needs_, *request); });
}

grpc::ServerWriteReactor<v1::ExportJournalResponse>* MachineService::ExportJournal(
    grpc::CallbackServerContext* context, const v1::ExportJournalRequest* request) {
  return OpenStream<v1::ExportJournalResponse>(
      needs_, *context, *request, "MachineService/ExportJournal", [&](const Caller&) {
        return MakeJournalExport({.executor = needs_.executor,
                                  .open = watch_needs_.open,
                                  .store = store_,
                                  .hosts = live_.hosts},
                                 *request);
      });
}

}  // namespace rmlcell::server
