// What clients ask of a machine, on its way to the host, and what that answers.
#include <utility>
#include <vector>

#include "proto/bridge/findings.h"
#include "server/machines/host_words.h"
#include "server/machines/hosted.h"

namespace rmlcell::server {
namespace {

constexpr std::size_t kKeptMax = 16;  // of what halts a machine whose line is gone
constexpr const char* kSilent = "its host is silent";

bool Halts(const v1::HostOrder& order) {
  return order.has_stop() || order.has_hold() || order.has_emergency_stop() || order.has_abort();
}

bool Begins(const v1::HostOrder& order) {
  return order.has_start() || order.has_zero() || order.has_start_at_step() ||
         order.has_run_job() || order.has_continue_job();
}

bool RunsPrograms(const v1::HostOrder& order) { return Begins(order) || order.has_preview_start(); }

}  // namespace

// For the line that comes behind this one. False: there is one, or no room.
bool Hosts::Keep(Host& host, const v1::HostOrder& order) const {
  if (host.has_successor || host.kept.size() >= kKeptMax) return false;
  if (host.kept.empty()) host.kept_since = needs_.clock();
  host.kept.push_back(order);
  return true;
}

// Whoever asked for it of what would begin behind what halts it.
std::vector<Hosts::Answered> Hosts::Withdraw(Host& host) {
  std::vector<Answered> withdrawn;
  std::erase_if(host.pending, [&withdrawn](auto& row) {
    if (row.second.begins) withdrawn.push_back(std::move(row.second.done));
    return row.second.begins;
  });
  return withdrawn;
}

void Hosts::Ask(const std::string& machine, v1::HostOrder order, Answered done) {
  const HostPointer host = Find(machine);
  if (host == nullptr) return done(NotLive("the machine has no host: enable it"));
  order.set_number(++next_order_);
  const bool halts = Halts(order);
  std::unique_lock in_order(host->in_order, std::defer_lock);
  if (halts) in_order.lock();
  bool goes_out = true;
  std::optional<Error> unanswered;
  std::vector<Answered> withdrawn;
  {
    const std::lock_guard lock(host->mutex);
    if (halts && order.for_job().empty()) withdrawn = Withdraw(*host);
    if (host->gone) {
      const bool kept = halts && Keep(*host, order);
      unanswered = NotLive(kept ? "not delivered: it acts if this host is heard of again"
                                : "its host is not heard of");
      goes_out = false;
    } else if (host->status && host->status->state() == v1::MACHINE_STATE_LOST) {
      // Nothing begins that nobody sees; what halts acts when it comes there. LIVE-2.10
      unanswered = NotLive(halts ? kHaltsUnseen : kSilent);
      goes_out = halts;
    } else {
      const auto patience = order.has_preview_start() ? kPreviewPatience : kAnswerPatience;
      host->pending[order.number()] = {.done = done,
                                       .until = needs_.clock() + patience,
                                       .halts = halts,
                                       .begins = Begins(order)};
    }
  }
  v1::HostResponse message;
  *message.mutable_order() = std::move(order);
  if (goes_out && RunsPrograms(message.order())) {
    auto waits = std::make_shared<v1::HostResponse>(std::move(message));
    needs_.executor.Post([this, host, waits] { SendBehindMemory(host, std::move(*waits)); });
  } else if (goes_out) {
    host->link->Send(std::move(message));
  }
  if (in_order) in_order.unlock();
  for (const Answered& one : withdrawn) {
    v1::HostOrderAnswer answer;
    *answer.mutable_refusal() = bridge::ToErrorDetail(
        Error{ErrorCode::kCellMachineState, "it was halted before it began", {}});
    one(std::move(answer));
  }
  if (unanswered) done(*std::move(unanswered));
}

// Whoever has stored a program, and was told so, may begin it.
void Hosts::SendBehindMemory(const HostPointer& host, v1::HostResponse order) {
  LookAtMemory(true);
  bool known = false;
  {
    const std::lock_guard looking(looking_);
    known = !unsent_.contains(host->id);
  }
  std::unique_lock in_order(host->in_order);
  std::optional<Error> why;  // it does not go out
  Answered refused;
  {
    const std::lock_guard lock(host->mutex);
    // Who was told meanwhile that it does not begin is not to see it begin.
    const auto asked = host->pending.find(order.order().number());
    if (asked == host->pending.end()) return;
    if (host->status && host->status->state() == v1::MACHINE_STATE_LOST) why = NotLive(kSilent);
    // It would begin what was stored before. LIVE-5.03
    if (!known) why = Error{ErrorCode::kCellStoreFailed, "what is stored there cannot be read", {}};
    asked->second.begins = false;
    if (why) refused = host->pending.extract(asked).mapped().done;
  }
  if (!why) return host->link->Send(std::move(order));
  in_order.unlock();
  refused(*std::move(why));
}

void Hosts::TakeAnswer(const HostPointer& host, v1::HostOrderAnswer answer) {
  Answered done;
  {
    const std::lock_guard lock(host->mutex);
    const auto found = host->pending.find(answer.number());
    if (found == host->pending.end()) return;
    done = std::move(found->second.done);
    host->pending.erase(found);
  }
  done(std::move(answer));
}

void Hosts::DropLate(const HostPointer& host) {
  std::vector<Answered> late;
  {
    const std::lock_guard lock(host->mutex);
    const Instant now = needs_.clock();
    std::erase_if(host->pending, [&](auto& row) {
      if (now < row.second.until) return false;
      late.push_back(std::move(row.second.done));
      return true;
    });
  }
  for (const Answered& done : late) done(NotLive("its host does not answer"));
}

std::optional<std::int64_t> Hosts::End(const std::string& machine, const std::string& why) {
  const HostPointer host = Find(machine);
  if (host == nullptr) return std::nullopt;
  v1::HostResponse message;
  message.mutable_stop()->set_reason(why);
  host->link->Send(std::move(message));
  return host->lease.fence;
}

}  // namespace rmlcell::server
