#include "clients/cli/handbox_hands.h"

#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "clients/cli/remote_call.h"

namespace rmlcell::cli {
namespace {

using google::protobuf::util::TimeUtil;

// So many may be without an answer: then the line stands, and the machine has stopped long since.
constexpr int kBeatsUnderWayMax = 20;

bool Halts(const KeyStroke& stroke) {
  constexpr std::array<std::string_view, 3> kHalt = {"STOP", "HOLD", "EMERGENCY_STOP"};
  return std::ranges::find(kHalt, stroke.key) != kHalt.end();
}

}  // namespace

google::protobuf::Timestamp SentNow() {
  // Not TimeUtil::GetCurrentTime(), which knows whole seconds alone.
  return TimeUtil::NanosecondsToTimestamp(
      std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count());
}

HandboxSession::HandboxSession(const std::shared_ptr<grpc::Channel>& channel,
                               const std::string& machine, const std::string& token,
                               std::chrono::seconds patience)
    : stub_(v1::HandboxService::NewStub(channel)), patience_(patience) {
  v1::CreateHandboxSessionRequest request;
  request.set_machine(machine);
  request.set_control_token(token);
  grpc::ClientContext context;
  Prepare(context);
  status_ = stub_->CreateHandboxSession(&context, request, &session_);
}

HandboxSession::~HandboxSession() {
  if (!status_.ok()) return;
  v1::DeleteHandboxSessionRequest request;
  request.set_name(session_.name());
  google::protobuf::Empty none;
  grpc::ClientContext context;
  Prepare(context, patience_);
  static_cast<void>(stub_->DeleteHandboxSession(&context, request, &none));
}

// Both live until they are answered, and end themselves.
struct HandboxHands::KeyCall {
  grpc::ClientContext context;
  v1::PressKeyRequest request;
  v1::PressKeyResponse response;
};
struct HandboxHands::BeatCall {
  grpc::ClientContext context;
  v1::HeartbeatHandboxRequest request;
  v1::HeartbeatResponse response;
  std::chrono::steady_clock::time_point begun = std::chrono::steady_clock::now();
};

HandboxHands::HandboxHands(const std::shared_ptr<grpc::Channel>& channel,
                           const std::string& session, const std::string& token,
                           std::function<void()> answered, std::chrono::seconds patience)
    : stub_(v1::HandboxService::NewStub(channel)),
      session_(session),
      token_(token),
      answered_(std::move(answered)),
      patience_(patience) {}

HandboxHands::~HandboxHands() {
  std::unique_lock lock(mutex_);
  ended_.wait(lock, [this] { return under_way_ == 0; });
}

void HandboxHands::Do(KeyStroke stroke) {
  const bool halts = Halts(stroke);
  if (halts) waiting_.clear();
  if (stroke.action == v1::KEY_ACTION_RELEASE) {
    // It never went down there.
    const auto press = std::ranges::find(waiting_, KeyStroke{stroke.key, v1::KEY_ACTION_PRESS});
    if (press != waiting_.end()) {
      waiting_.erase(press);
      return;
    }
    return Send(stroke, false);
  }
  if (halts) return Send(stroke, false);
  if (waiting_.size() < kWaitingMax) waiting_.push_back(std::move(stroke));
  SendNext();
}

void HandboxHands::SendNext() {
  if (waiting_.empty()) return;
  {
    const std::lock_guard lock(mutex_);
    // A beat that knows nothing of a key and comes in behind it says that it is up.
    const bool waits = waiting_.front().action == v1::KEY_ACTION_PRESS && beats_under_way_ > 0;
    if (turn_taken_ || waits) return;
    turn_taken_ = true;
  }
  Send(waiting_.front(), true);
  waiting_.pop_front();
}

void HandboxHands::Send(const KeyStroke& stroke, bool in_turn) {
  auto made = std::make_unique<KeyCall>();
  KeyCall* call = made.release();  // the answer owns it
  Prepare(call->context, patience_);
  call->request.set_session(session_);
  call->request.set_control_token(token_);
  call->request.set_key(stroke.key);
  call->request.set_action(stroke.action);
  call->request.set_sequence(++sequence_);
  {
    const std::lock_guard lock(mutex_);
    ++under_way_;
  }
  stub_->async()->PressKey(&call->context, &call->request, &call->response,
                           [this, call, in_turn](grpc::Status status) {
                             std::unique_ptr<KeyCall> own(call);
                             KeyAnswer answer{own->request.key(), std::move(status), own->response};
                             own.reset();  // with it the channel, before whoever waits lets it go
                             End(std::move(answer), in_turn);
                           });
}

void HandboxHands::Beat(const std::set<std::string>& down) {
  const bool unsent = std::ranges::any_of(
      waiting_, [](const KeyStroke& stroke) { return stroke.action == v1::KEY_ACTION_PRESS; });
  if (down.empty() || unsent) return;
  {
    const std::lock_guard lock(mutex_);
    if (beats_under_way_ >= kBeatsUnderWayMax) return;
    ++under_way_;
    ++beats_under_way_;
  }
  auto made = std::make_unique<BeatCall>();
  BeatCall* call = made.release();
  Prepare(call->context, patience_);
  call->request.set_session(session_);
  call->request.set_control_token(token_);
  call->request.set_number(++beats_);
  call->request.mutable_keys_down()->Add(down.begin(), down.end());
  *call->request.mutable_sent() = SentNow();
  if (const std::int64_t took = round_trip_ns_; took > 0)
    *call->request.mutable_round_trip() = TimeUtil::NanosecondsToDuration(took);
  stub_->async()->HeartbeatHandbox(
      &call->context, &call->request, &call->response, [this, call](grpc::Status status) {
        std::unique_ptr<BeatCall> own(call);
        const std::chrono::nanoseconds took = std::chrono::steady_clock::now() - own->begun;
        round_trip_ns_ = took.count();
        own.reset();
        End({.status = std::move(status)}, false);
      });
}

void HandboxHands::End(KeyAnswer answer, bool in_turn) {
  const bool beat = answer.key.empty();
  {
    const std::lock_guard lock(mutex_);
    if (beat) --beats_under_way_;
    if (in_turn) turn_taken_ = false;
    if (!beat || !answer.status.ok()) answers_.push_back(std::move(answer));
  }
  answered_();
  // Behind this there may be no `this` any more.
  const std::lock_guard lock(mutex_);
  --under_way_;
  ended_.notify_all();
}

std::vector<KeyAnswer> HandboxHands::TakeAnswers() {
  SendNext();
  const std::lock_guard lock(mutex_);
  return std::exchange(answers_, {});
}

bool HandboxHands::at_rest() const {
  const std::lock_guard lock(mutex_);
  return waiting_.empty() && under_way_ == 0;
}

}  // namespace rmlcell::cli
