#include "server/records/machine_messages.h"

#include <algorithm>
#include <array>
#include <sstream>

#include "engine/core/number_text.h"
#include "engine/families/families.h"
#include "engine/machine/family.h"
#include "engine/machine/machine_note.h"
#include "proto/bridge/setup.h"
#include "server/base/names.h"
#include "server/records/job_messages.h"
#include "server/records/machine_options.h"
#include "server/records/update_mask.h"

namespace rmlcell::server {
namespace {

constexpr std::array<std::string_view, 4> kMachineFields = {"title", "profile", "parameters",
                                                            "options"};

v1::ParameterInfo ToProto(const machine::ParameterInfo& info) {
  v1::ParameterInfo message;
  message.set_name(std::string(info.name));
  message.set_unit(std::string(info.unit));
  message.set_description(std::string(info.text));
  if (info.choices.empty()) {
    message.set_default_value(ShortestText(info.standard));
    message.set_minimum(info.minimum);
    message.set_maximum(info.maximum);
  } else {
    for (const std::string& word : WordsOf(info.choices)) message.add_choices(word);
    message.set_default_value(message.choices(0));
  }
  return message;
}

}  // namespace

std::vector<std::string> WordsOf(std::string_view text) {
  std::vector<std::string> words;
  std::istringstream stream{std::string(text)};
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

v1::Family ToProto(const machine::MachineFamily& family) {
  const machine::FamilyInfo& info = family.info();
  v1::Family message;
  message.set_id(std::string(info.id));
  message.set_title(std::string(info.title));
  for (const std::string& extension : WordsOf(info.extensions)) message.add_extensions(extension);
  for (const std::string& axis : WordsOf(info.axes)) message.add_axes(axis);
  message.set_has_executables(info.has_executables);
  message.set_has_schedules(info.schedules > 0);
  for (const machine::ParameterInfo& parameter : family.parameters())
    *message.add_parameters() = ToProto(parameter);
  for (const machine::MachineProfile& profile : family.profiles()) {
    v1::MachineProfile& made = *message.add_profiles();
    made.set_id(std::string(profile.id));
    made.set_title(std::string(profile.title));
    for (const machine::ParameterValue& value : profile.values) {
      (*made.mutable_parameters())[std::string(value.name)] = value.Text();
    }
  }
  return message;
}

v1::Machine ToProto(const storage::MachineRecord& record) {
  v1::Machine message;
  message.set_name(MachineName(record.id));
  message.set_family(record.family);
  message.set_title(record.title);
  message.set_profile(record.profile);
  for (const auto& [name, value] : record.parameters) (*message.mutable_parameters())[name] = value;
  message.mutable_connection()->set_kind(v1::MachineConnection::KIND_VIRTUAL);
  *message.mutable_status() = StatusOf(record, {});
  if (auto options = OptionsOf(record)) *message.mutable_options() = *std::move(options);
  message.set_etag(std::to_string(record.revision));
  *message.mutable_create_time() = ToProto(record.created_at);
  *message.mutable_update_time() = ToProto(record.updated_at);
  return message;
}

void AddJobs(std::string_view machine, const std::vector<storage::MachineJobs>& unfinished,
             v1::MachineStatus& status) {
  const auto jobs = std::ranges::find(unfinished, machine, &storage::MachineJobs::machine);
  if (jobs == unfinished.end()) return;
  status.set_jobs_active(static_cast<std::int32_t>(jobs->unfinished));
  if (jobs->oldest_running > 0) status.set_simulating_job(JobName(jobs->oldest_running));
}

v1::MachineStatus StatusOf(const storage::MachineRecord& record,
                           const std::vector<storage::MachineJobs>& unfinished) {
  v1::MachineStatus status;
  status.set_machine(MachineName(record.id));
  AddJobs(record.id, unfinished, status);
  status.set_state(status.simulating_job().empty() ? v1::MACHINE_STATE_IDLE
                                                   : v1::MACHINE_STATE_RUNNING);
  return status;
}

v1::Machine ToProto(const storage::MachineRecord& record,
                    const std::vector<storage::MachineJobs>& unfinished) {
  v1::Machine message = ToProto(record);
  *message.mutable_status() = StatusOf(record, unfinished);
  return message;
}

Result<std::string> ModeText(v1::LaserMode mode) {
  switch (mode) {
    case v1::LASER_MODE_UNSPECIFIED:
    case v1::LASER_MODE_CW:
      return std::string("CW");
    case v1::LASER_MODE_PULSE:
      return std::string("PULSE");
    default:
      return InvalidArgument("mode is none that there is");
  }
}

v1::LaserMode ModeOf(std::string_view text) {
  return text == "PULSE" ? v1::LASER_MODE_PULSE : v1::LASER_MODE_CW;
}

Result<std::string> StateForRun(std::string_view machine,
                                const std::optional<storage::MachineMark>& mark) {
  if (!mark) return std::string();
  Result<machine::MachineNote> note = machine::ReadMachineNote(mark->state);
  if (note) return std::move(note->family);
  return Error{ErrorCode::kCellStoreCorrupt,
               "how machine " + std::string(machine) + " stands cannot be read",
               {}};
}

v1::LaserSchedule ToProto(const storage::ScheduleRecord& record) {
  v1::LaserSchedule message;
  message.set_name(NameOfSchedule(record.machine, record.number));
  message.set_title(record.name);
  message.set_mode(ModeOf(record.mode));
  message.set_power_percent(record.power_percent);
  message.set_etag(std::to_string(record.revision));
  return message;
}

storage::MachineRecord FromProto(const v1::Machine& message, const std::string& id) {
  return {.id = id,
          .family = message.family(),
          .title = message.title(),
          .profile = message.profile(),
          .parameters = {message.parameters().begin(), message.parameters().end()},
          .options = message.has_options() ? BytesOf(message.options()) : std::string()};
}

Result<storage::MachineRecord> Updated(storage::MachineRecord machine, const v1::Machine& wanted,
                                       const google::protobuf::FieldMask& mask) {
  if (!wanted.family().empty() && wanted.family() != machine.family)
    return InvalidArgument("the family of a machine cannot be changed");
  const auto named = FieldsToUpdate(mask, wanted, kMachineFields);
  if (!named) return named.error();
  storage::MachineRecord values = FromProto(wanted, machine.id);
  if (named->contains("title")) machine.title = std::move(values.title);
  if (named->contains("profile")) machine.profile = std::move(values.profile);
  if (named->contains("parameters")) machine.parameters = std::move(values.parameters);
  if (named->contains("options")) machine.options = std::move(values.options);
  if (const Status good = CheckMachine(machine); !good) return good.error();
  return machine;
}

Status CheckMachine(const storage::MachineRecord& machine) {
  const machine::MachineFamily* family = families::FindFamily(machine.family);
  if (family == nullptr) return families::UnknownFamily(machine.family);
  if (const Status good = CheckTitle(machine.title, "title"); !good) return good.error();
  const auto parameters = machine::MakeParameters(*family, machine.profile, machine.parameters);
  if (!parameters) return parameters.error();
  const auto options = OptionsOf(machine);
  return options ? CheckOptions(*options) : Status();
}

v1::AssignedSchedule ToAssigned(const storage::ScheduleRecord& schedule) {
  v1::AssignedSchedule made;
  made.set_number(schedule.number);
  made.set_title(schedule.name);
  made.set_mode(schedule.mode);
  made.set_power_percent(schedule.power_percent);
  return made;
}

}  // namespace rmlcell::server
