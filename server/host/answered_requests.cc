#include "server/host/answered_requests.h"

#include <memory>
#include <utility>

#include "proto/bridge/encoding.h"
#include "proto/bridge/sha256.h"
#include "server/host/host_messages.h"
#include "server/host/order_class.h"

namespace rmlcell::server {
namespace {

constexpr std::size_t kDigestDigits = 32;
constexpr std::size_t kBytesMax = 4'096;  // of an answer; those that act have less

std::string KeyOf(const std::string& request_id, const std::string& caller) {
  return request_id.empty() ? "" : request_id + "\n" + caller;
}

std::chrono::microseconds AgeOf(const v1::JournalEntry& entry, WallTime now) {
  using google::protobuf::util::TimeUtil;
  return now.time_since_epoch() -
         std::chrono::microseconds(TimeUtil::TimestampToMicroseconds(entry.time()));
}

}  // namespace

bool IsAskedFor(const v1::JournalEntry& answered, WallTime now) {
  return AgeOf(answered, now) <= AnsweredRequests::kKeptFor;
}

std::string AnsweredRequests::KeyOf(const v1::HostOrder& order) {
  if (IsHalt(order)) return {};
  return server::KeyOf(FieldOf(order, "request_id").value_or(""), order.caller());
}

const v1::HostOrderAnswer* AnsweredRequests::Find(const std::string& key) const {
  const auto found = answered_.find(key);
  return key.empty() || found == answered_.end() ? nullptr : &found->second.answer;
}

std::string AnsweredRequests::DigestOf(const v1::HostOrder& order) {
  const google::protobuf::Message* asked = RequestOf(order);
  if (asked == nullptr) return {};
  const std::unique_ptr<google::protobuf::Message> copy(asked->New());
  copy->CopyFrom(*asked);
  if (const auto* token = copy->GetDescriptor()->FindFieldByName("control_token"))
    copy->GetReflection()->ClearField(copy.get(), token);
  // Orders for a job have it beside what is asked.
  const std::string about =
      std::to_string(order.request_case()) + "\n" + order.for_job() + "\n" + order.reason() + "\n";
  return bridge::Sha256Hex(about + bridge::StableBytes(*copy)).substr(0, kDigestDigits);
}

bool AnsweredRequests::IsAnother(const std::string& key, const std::string& digest) const {
  const std::string& known = answered_.at(key).digest;
  return !known.empty() && known != digest;
}

void AnsweredRequests::Keep(const std::string& key, const std::string& digest,
                            const v1::HostOrderAnswer& answer, const HostTime& now) {
  Keep(key, {.answer = answer, .digest = digest, .at = now.steady}, now.steady);
}

void AnsweredRequests::Keep(const std::string& key, Answered answered,
                            std::chrono::nanoseconds now) {
  if (key.empty() || !answered_.emplace(key, std::move(answered)).second) return;
  order_.push_back(key);
  while (order_.size() > kKept || now - answered_.at(order_.front()).at > kKeptFor) {
    answered_.erase(order_.front());
    order_.pop_front();
  }
}

std::optional<v1::AnsweredRequest> AnsweredRequests::EntryOf(const v1::HostOrder& order,
                                                             const v1::HostOrderAnswer& answer) {
  const OrderClass kind = ClassOf(order);
  if (kind == OrderClass::kActsFirst || kind == OrderClass::kAsks) return std::nullopt;
  // What they prove is over with the host.
  if (answer.has_control() || answer.has_control_kept() || answer.has_armed() ||
      answer.has_session() || answer.has_key())
    return std::nullopt;
  v1::AnsweredRequest entry;
  entry.set_request_id(FieldOf(order, "request_id").value_or(""));
  if (entry.request_id().empty()) return std::nullopt;
  entry.set_kind(order.request_case());
  entry.set_caller(order.caller());
  *entry.mutable_answer() = answer;
  entry.set_by_status(answer.has_status());
  entry.set_digest(DigestOf(order));
  if (answer.has_status()) entry.mutable_answer()->clear_status();
  if (entry.ByteSizeLong() > kBytesMax) return std::nullopt;
  return entry;
}

void AnsweredRequests::Recover(const std::vector<v1::JournalEntry>& entries,
                               const v1::MachineStatus& status, const HostTime& now) {
  for (const v1::JournalEntry& entry : entries) {
    if (!entry.has_answered() || !IsAskedFor(entry, now.wall)) continue;
    const v1::AnsweredRequest& one = entry.answered();
    v1::HostOrderAnswer answer = one.answer();
    if (one.by_status()) *answer.mutable_status() = status;
    Keep(server::KeyOf(one.request_id(), one.caller()),
         {.answer = std::move(answer),
          .digest = one.digest(),
          .at = now.steady - AgeOf(entry, now.wall)},
         now.steady);
  }
}

}  // namespace rmlcell::server
