#include "server/host/arm_desk.h"

#include <algorithm>
#include <array>
#include <utility>

#include "server/base/secret.h"
#include "server/host/host_options.h"

namespace rmlcell::server {
namespace {

Error NotArmed(std::string detail) { return {ErrorCode::kCellNotArmed, std::move(detail), {}}; }

struct SeenTo {
  v1::Confirmation confirmation;
  std::string_view name;
};
constexpr std::array<SeenTo, 4> kSeenTo = {
    {{v1::CONFIRMATION_TOOL, "tool (CONFIRMATION_TOOL)"},
     {v1::CONFIRMATION_ORIGIN_VALID, "origin-valid (CONFIRMATION_ORIGIN_VALID)"},
     {v1::CONFIRMATION_CLAMPS, "clamps (CONFIRMATION_CLAMPS)"},
     {v1::CONFIRMATION_COVER, "cover (CONFIRMATION_COVER)"}}};

}  // namespace

Result<v1::ArmMachineResponse> ArmDesk::Arm(const v1::ArmMachineRequest& request,
                                            const std::string& caller, std::int64_t control_lease,
                                            std::uint64_t memory, const HostTime& now) {
  std::chrono::nanoseconds lasts = kLasts;
  if (request.has_armed_for()) {
    lasts = DurationOf(request.armed_for());
    if (lasts < std::chrono::seconds(1) || lasts > kLongest)
      return Error{ErrorCode::kCellInvalidArgument, "armed_for: 1 s to 600 s", {}};
  }
  // What nobody knows would be taken for a run that goes on.
  if (!v1::ControlLease::OnLoss_IsValid(request.on_loss()))
    return Error{ErrorCode::kCellInvalidArgument, "on_loss is none that there is", {}};
  for (const auto& [confirmation, name] : kSeenTo) {
    const auto& given = request.confirmations();
    if (std::ranges::find(given, confirmation) == given.end())
      return NotArmed("nobody has seen to " + std::string(name));
  }
  const auto until = std::chrono::ceil<std::chrono::microseconds>(now.wall + lasts);
  armed_ = Armed{.token = make_token_(),
                 .job = request.job(),
                 .by = caller,
                 .control_lease = control_lease,
                 .memory = memory,
                 .on_loss = request.on_loss(),
                 .until = now.steady + lasts,
                 .until_wall = until};
  v1::ArmMachineResponse response;
  response.set_arm_token(armed_->token);
  *response.mutable_expire_time() = Stamp(until);
  return response;
}

void ArmDesk::Expire(std::int64_t control_lease, std::uint64_t memory, const HostTime& now) {
  if (!armed_) return;
  const bool stands = now.steady < armed_->until && control_lease == armed_->control_lease &&
                      memory == armed_->memory;
  if (!stands) armed_.reset();
}

Status ArmDesk::MayStart(const std::string& job, const std::optional<std::string>& token) const {
  if (!armed_) return NotArmed("nobody has armed it, or that is over");
  if (!armed_->job.empty() && armed_->job != job)
    return NotArmed("it is armed for " + armed_->job + " and not for " + job);
  if (token && !KnowsSecret(*token, armed_->token))
    return NotArmed("this is not the token that it was armed with");
  return {};
}

v1::ControlLease::OnLoss ArmDesk::on_loss() const {
  return armed_ ? armed_->on_loss : v1::ControlLease::ON_LOSS_UNSPECIFIED;
}

void ArmDesk::AddTo(v1::MachineStatus& status) const {
  if (!armed_) return;
  *status.mutable_armed_until() = Stamp(armed_->until_wall);
  status.set_armed_by(armed_->by);
  status.set_armed_for(armed_->job);
}

}  // namespace rmlcell::server
