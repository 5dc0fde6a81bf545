#include "server/jobs/job_milling.h"

#include <algorithm>

#include "proto/bridge/milling.h"
#include "rmlcell/v1/project.pb.h"
#include "server/base/names.h"
#include "server/records/job_messages.h"

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

}  // namespace

Status SettleMilling(storage::Store& store, const machine::MachineShape& shape, v1::Job& job) {
  const v1::SimulationOptions& options = job.simulation();
  if (!options.has_milling() && options.milling_project().empty()) return {};
  if (!shape.has_work_origin) {
    return InvalidArgument("job.simulation.milling is for mills: this machine removes no material");
  }
  if (!options.has_milling()) {
    const int slot = job.has_program() ? ParseProgramName(job.program())->slot : InlineSlotOf(job);
    Result<v1::Milling> milling = MillingOfProject(store, options.milling_project(), slot);
    if (!milling) return milling.error();
    *job.mutable_simulation()->mutable_milling() = *std::move(milling);
  }
  const auto sound = bridge::FromProto(options.milling());
  return sound ? Status() : InvalidArgument("job.simulation.milling." + sound.error().detail);
}

}  // namespace rmlcell::server
