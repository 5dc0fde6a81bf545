#include "server/records/machine_options.h"

#include <google/protobuf/util/time_util.h>

#include "proto/bridge/encoding.h"

namespace rmlcell::server {
namespace {

using google::protobuf::util::TimeUtil;

constexpr std::int64_t kShortest_ms = 100;
constexpr std::int64_t kLongest_ms = 3'600'000;

Error Invalid(const std::string& what) {
  return {ErrorCode::kCellInvalidArgument, "machine.options." + what, {}};
}

Status CheckTime(bool stated, const google::protobuf::Duration& time, const std::string& name) {
  if (!stated) return {};
  const std::int64_t ms = TimeUtil::DurationToMilliseconds(time);
  if (ms >= kShortest_ms && ms <= kLongest_ms) return {};
  return Invalid(name + ": 0.1 s to 1 h");
}

}  // namespace

std::optional<v1::MachineOptions> OptionsOf(const storage::MachineRecord& record) {
  v1::MachineOptions options;
  if (record.options.empty() || !options.ParseFromString(record.options)) return std::nullopt;
  return options;
}

// Never empty: a record without options says nothing of them.
std::string BytesOf(const v1::MachineOptions& options) {
  v1::MachineOptions stated = options;
  if (stated.start() == v1::MachineOptions::START_UNSPECIFIED)
    stated.set_start(v1::MachineOptions::START_QUEUE);
  if (stated.enabled()) stated.clear_disabled();
  return bridge::StableBytes(stated);
}

bool IsEnabled(const storage::MachineRecord& record, bool by_default) {
  const auto options = OptionsOf(record);
  if (!options || (!options->enabled() && !options->disabled())) return by_default;
  return options->enabled();
}

bool LivesOtherwise(const storage::MachineRecord& before, const storage::MachineRecord& now) {
  return before.options != now.options || before.profile != now.profile ||
         before.parameters != now.parameters;
}

Status CheckOptions(const v1::MachineOptions& options) {
  if (!v1::MachineOptions::Start_IsValid(options.start()))
    return Invalid("start is none that there is");
  if (!v1::MachineOptions::ServerLost_IsValid(options.server_lost()))
    return Invalid("server_lost is none that there is");
  if (options.server_lost() == v1::MachineOptions::SERVER_LOST_FINISH)
    return Invalid("server_lost: FINISH is for machines with a device");
  if (options.pace() != v1::MachineOptions::PACE_UNSPECIFIED || options.has_lead() ||
      options.has_lead_max() || options.hold() != v1::MachineOptions::DEVICE_HOLD_UNSPECIFIED ||
      options.home() || options.unattended())
    return Invalid(
        "pace, lead, lead_max, hold, home and unattended are for machines with a device");
  if (const Status good = CheckTime(options.has_server_lost_after(), options.server_lost_after(),
                                    "server_lost_after");
      !good)
    return good.error();
  return CheckTime(options.has_late_hold(), options.late_hold(), "late_hold");
}

}  // namespace rmlcell::server
