#include "server/jobs/job_milling.h"

#include <algorithm>
#include <utility>

#include "proto/bridge/milling.h"
#include "rmlcell/v1/project.pb.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "server/records/file_family.h"
#include "server/records/job_messages.h"
#include "server/records/program_place.h"

namespace rmlcell::server {
namespace {

Result<v1::Milling> MillingOfProject(storage::Store& store, const std::string& name, int slot) {
  const Result<std::string> id = ParseProjectName(name);
  if (!id) return InvalidArgument("job.simulation.milling_project: " + id.error().detail);
  const Result<storage::ProjectRecord> record = store.GetProject(*id);
  if (!record) return record.error();
  v1::Project project;
  if (!project.ParseFromString(record->body))
    return Error{ErrorCode::kCellStoreCorrupt, "the body of " + name, {}};
  const auto found = std::ranges::find(project.programs(), slot, &v1::ProjectProgram::slot);
  if (found == project.programs().end() || !found->has_milling()) {
    return Error{
        ErrorCode::kCellNotFound, name + " has no milling for slot " + std::to_string(slot), {}};
  }
  return found->milling();
}

constexpr const char* kField = "job.simulation.milling.";
constexpr const char* kOctets = "application/octet-stream";

Status CheckSize(const std::string& bytes, const Config& config) {
  if (static_cast<std::int64_t>(bytes.size()) <= config.limit_target_bytes) return {};
  return Error{ErrorCode::kCellTooLarge,
               std::string(kField) + "target has " + std::to_string(bytes.size()) +
                   " bytes; limits.target_bytes is " + std::to_string(config.limit_target_bytes),
               {}};
}

Status AttachStored(storage::Store& store, const machine::MachineFamily& family, int slot,
                    storage::NewJob& made) {
  const auto found = store.GetProgramSummary(made.machine, slot);
  if (!found) {
    if (found.error().code != ErrorCode::kCellNotFound) return found.error();
    return EmptySlot(family, NameOfProgram(made.machine, slot));
  }
  made.attachments.push_back({std::string(kTargetAttachment), kOctets, {}, found->object_sha256});
  return {};
}

Status AttachTarget(storage::Store& store, const Config& config,
                    const machine::MachineFamily& family, storage::NewJob& made,
                    v1::MillTarget& target) {
  if (const Status sound = bridge::CheckTarget(target); !sound)
    return Error{sound.error().code, kField + sound.error().detail, {}};
  if (target.has_slot()) return AttachStored(store, family, target.slot(), made);
  std::string& bytes = target.has_file() ? *target.mutable_file()->mutable_content()
                                         : *target.mutable_inline_program()->mutable_content();
  if (const Status fits = CheckSize(bytes, config); !fits) return fits.error();
  const std::string& program_name = target.inline_program().file_name();
  if (const Status fits = CheckFileFamily(program_name, family); !fits) return fits.error();
  const std::string media_type = target.has_file() ? bridge::TargetMediaType(target) : kOctets;
  made.attachments.push_back(
      {std::string(kTargetAttachment), media_type, std::exchange(bytes, {}), {}});
  return {};
}

}  // namespace

Status SettleMilling(storage::Store& store, const Config& config,
                     const machine::MachineFamily& family, const machine::MachineShape& shape,
                     storage::NewJob& made, v1::Job& job) {
  const v1::SimulationOptions& options = job.simulation();
  if (!options.has_milling() && options.milling_project().empty()) return {};
  if (!shape.has_work_origin) {
    return InvalidArgument("job.simulation.milling is for mills: this machine removes no material");
  }
  if (!options.has_milling()) {
    const int slot = MainSlotOf(job);
    Result<v1::Milling> milling = MillingOfProject(store, options.milling_project(), slot);
    if (!milling) return milling.error();
    *job.mutable_simulation()->mutable_milling() = *std::move(milling);
  }
  const auto sound = bridge::FromProto(options.milling());
  if (!sound) return InvalidArgument(kField + sound.error().detail);
  if (!options.milling().has_target()) return {};
  return AttachTarget(store, config, family, made,
                      *job.mutable_simulation()->mutable_milling()->mutable_target());
}

}  // namespace rmlcell::server
