#include "server/host/control_desk.h"

#include <google/protobuf/util/time_util.h>

#include <utility>

#include "engine/core/characters.h"
#include "proto/bridge/sha256.h"
#include "server/base/secret.h"

namespace rmlcell::server {
namespace {

using google::protobuf::util::TimeUtil;

Error Wrong(std::string detail) { return {ErrorCode::kCellInvalidArgument, std::move(detail), {}}; }

std::size_t LengthOf(std::string_view text) { return CharactersIn(text, Encoding::kUtf32); }

}  // namespace

Result<v1::AcquireControlResponse> ControlDesk::Acquire(const v1::AcquireControlRequest& request,
                                                        const std::string& caller,
                                                        const HostTime& now) {
  std::chrono::nanoseconds ttl = kTtl;
  if (request.has_ttl()) {
    // The nanoseconds of what is far beyond it are no number.
    const bool known = request.ttl().seconds() >= 0 &&
                       request.ttl().seconds() <= kTtlMax / std::chrono::seconds(1);
    if (known) ttl = std::chrono::nanoseconds(TimeUtil::DurationToNanoseconds(request.ttl()));
    if (!known || ttl < kTtlMin || ttl > kTtlMax) return Wrong("ttl: allowed are 1 s to 60 s");
  }
  if (LengthOf(request.client()) > kClientMax) return Wrong("client: at most 100 characters");
  if (!v1::ControlLease::OnLoss_IsValid(request.on_loss()))
    return Wrong("on_loss is none that there is");
  std::string from;
  if (lease_) {
    from = lease_->holder();
    if (!request.take_over()) {
      const std::string client = lease_->client().empty() ? "" : " (" + lease_->client() + ")";
      return Error{ErrorCode::kCellLeaseHeld,
                   from + client + " has it since " + TimeUtil::ToString(lease_->since()),
                   {}};
    }
    const std::size_t length = LengthOf(request.reason());
    if (length < 1 || length > kReasonMax)
      return Wrong("reason: whoever takes control over says why, in 1 to 200 characters");
  }
  ttl_ = ttl;
  const std::string token = make_token_();
  token_sha256_ = bridge::Sha256Hex(token);
  Give(caller, request.on_loss(), now);
  lease_->set_client(request.client());
  Prolong(now);
  change_.emplace();
  change_->set_kind(from.empty() ? v1::ControlChanged::KIND_ACQUIRED
                                 : v1::ControlChanged::KIND_TAKEN_OVER);
  change_->set_from(from);
  change_->set_to(caller);
  if (!from.empty()) change_->set_reason(request.reason());
  change_->set_lease(number_);
  v1::AcquireControlResponse response;
  *response.mutable_lease() = *lease_;
  response.set_control_token(token);
  return response;
}

void ControlDesk::Give(const std::string& holder, v1::ControlLease::OnLoss on_loss,
                       const HostTime& now) {
  of_queue_ = false;
  behind_run_.reset();
  lease_.emplace();
  lease_->set_number(++number_);
  lease_->set_holder(holder);
  *lease_->mutable_since() = Stamp(now.wall);
  lease_->set_on_loss(on_loss == v1::ControlLease::ON_LOSS_GO_ON ? on_loss
                                                                 : v1::ControlLease::ON_LOSS_HOLD);
}

void ControlDesk::GiveToQueue(const std::string& job, v1::ControlLease::OnLoss on_loss,
                              const HostTime& now) {
  Give("queue/" + job, on_loss, now);
  token_sha256_.clear();
  of_queue_ = true;
  change_.emplace();
  change_->set_kind(v1::ControlChanged::KIND_ACQUIRED);
  change_->set_to(lease_->holder());
  change_->set_lease(number_);
}

void ControlDesk::RunBegins(v1::ControlLease::OnLoss wanted) {
  if (!lease_ || of_queue_ || wanted == v1::ControlLease::ON_LOSS_UNSPECIFIED) return;
  behind_run_ = lease_->on_loss();
  lease_->set_on_loss(wanted);
}

void ControlDesk::RunIsOver() {
  if (of_queue_) return End(v1::ControlChanged::KIND_RELEASED);
  if (behind_run_) lease_->set_on_loss(*std::exchange(behind_run_, std::nullopt));
}

void ControlDesk::Prolong(const HostTime& now) {
  runs_out_ = now.steady + ttl_;
  *lease_->mutable_expire_time() =
      Stamp(now.wall + std::chrono::duration_cast<std::chrono::microseconds>(ttl_));
}

bool ControlDesk::IsToken(std::string_view token) const {
  return lease_ && !of_queue_ && KnowsSecret(bridge::Sha256Hex(token), token_sha256_);
}

Status ControlDesk::Check(std::string_view token, const HostTime& now) const {
  const bool over = lease_ && !of_queue_ && now.steady >= runs_out_;
  if (IsToken(token) && !over) return {};
  const std::string who = lease_ && !over ? ": " + lease_->holder() + " has control" : "";
  return Error{ErrorCode::kCellControlNeeded,
               (token.empty() ? "no control token" : "the control token is over") + who,
               {}};
}

Result<v1::ControlLease> ControlDesk::Renew(std::string_view token, const HostTime& now) {
  if (const Status good = Check(token, now); !good) return good.error();
  Prolong(now);
  return *lease_;
}

Result<v1::ControlLease::OnLoss> ControlDesk::Release(std::string_view token, const HostTime& now) {
  if (const Status good = Check(token, now); !good) return good.error();
  const v1::ControlLease::OnLoss on_loss = lease_->on_loss();
  End(v1::ControlChanged::KIND_RELEASED);
  return on_loss;
}

std::optional<v1::ControlLease::OnLoss> ControlDesk::Expire(const HostTime& now) {
  if (!lease_ || of_queue_ || now.steady < runs_out_) return std::nullopt;
  const v1::ControlLease::OnLoss on_loss = lease_->on_loss();
  End(v1::ControlChanged::KIND_EXPIRED);
  return on_loss;
}

void ControlDesk::End(v1::ControlChanged::Kind kind) {
  change_.emplace();
  change_->set_kind(kind);
  change_->set_from(lease_->holder());
  lease_.reset();
  behind_run_.reset();
  token_sha256_.clear();
  of_queue_ = false;
}

std::optional<std::chrono::nanoseconds> ControlDesk::runs_out() const {
  return lease_ && !of_queue_ ? std::optional(runs_out_) : std::nullopt;
}

}  // namespace rmlcell::server
