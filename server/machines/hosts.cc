#include "server/machines/hosts.h"

#include <google/protobuf/util/time_util.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "proto/bridge/findings.h"
#include "proto/bridge/standard_words.h"
#include "rmlcell/v1/cell.pb.h"
#include "server/base/names.h"
#include "server/machines/host_entries.h"
#include "server/machines/host_words.h"
#include "server/machines/hosted.h"
#include "server/records/job_messages.h"
#include "server/records/machine_messages.h"
#include "server/records/machine_options.h"

namespace rmlcell::server {
namespace {

using google::protobuf::util::TimeUtil;

// A line that is silent is closed; the machine is LOST before: of one that moves or has a run open,
// which has a word four times a second, after one second, or three over a network; of one that
// rests and has a word each second somewhat later. LIVE-2.10
constexpr std::chrono::seconds kSilence{5};
constexpr std::chrono::milliseconds kLostHere{1'000};
constexpr std::chrono::milliseconds kLostElsewhere{3'000};
constexpr std::chrono::milliseconds kLostAtRest{2'500};
constexpr std::chrono::seconds kBetweenLooks{5};  // at who holds a machine that is off
constexpr std::size_t kWaitingEntriesMax = 100'000;

// Nothing moves as far as anybody knows. LIVE-2.04, LIVE-2.14
void SetLost(v1::MachineStatus& status) {
  status.set_state(v1::MACHINE_STATE_LOST);
  status.clear_speed_mm_s();
  *status.mutable_words() = bridge::StandardWordsOf(status);
}

}  // namespace

Hosts::Hosts(Needs needs) : needs_(std::move(needs)) {
  looked_until_ = needs_.feed.position();
  subscription_ = needs_.feed.Subscribe(std::string(EventFeed::kEverything), [this] {
    const std::lock_guard lock(mutex_);
    if (hosts_.empty()) return;
    needs_.executor.Post([this] { LookAtMemory(); });
  });
}

Hosts::~Hosts() { subscription_.reset(); }

void Hosts::OnChange(std::function<void()> changed) {
  const std::lock_guard lock(changing_);
  changed_ = std::move(changed);
}

void Hosts::OnNews(std::function<void(const std::string&)> news) {
  const std::lock_guard lock(changing_);
  news_ = std::move(news);
}

void Hosts::OnRunOver(std::function<void(const std::string&)> over) {
  const std::lock_guard lock(changing_);
  over_ = std::move(over);
}

void Hosts::RunOver(const std::string& machine) {
  const std::lock_guard lock(changing_);
  if (over_) over_(machine);
}

void Hosts::OnAwaited(std::function<bool(const std::string&)> is_awaited) {
  const std::lock_guard lock(mutex_);
  is_awaited_ = std::move(is_awaited);
}

bool Hosts::IsAwaited(const std::string& machine) const {
  std::function<bool(const std::string&)> is_awaited;
  {
    const std::lock_guard lock(mutex_);
    is_awaited = is_awaited_;
  }
  return is_awaited && is_awaited(machine);
}

void Hosts::Changed() {
  const std::lock_guard lock(changing_);
  if (changed_) changed_();
}

void Hosts::Changed(const std::string& machine) {
  const std::lock_guard lock(changing_);
  if (news_) news_(machine);
}

Hosts::HostPointer Hosts::Find(const HostLink& link) const {
  const std::lock_guard lock(mutex_);
  for (const auto& [id, host] : hosts_) {
    if (host->link.get() == &link) return host;
  }
  return nullptr;
}

Hosts::HostPointer Hosts::Find(const std::string& machine) const {
  const std::lock_guard lock(mutex_);
  const auto found = hosts_.find(machine);
  return found == hosts_.end() ? nullptr : found->second;
}

void Hosts::Receive(const HostLink& link, v1::HostRequest message) {
  const HostPointer host = Find(link);
  if (host == nullptr) return;
  {
    const std::lock_guard lock(host->mutex);
    host->heard = needs_.clock();
  }
  switch (message.message_case()) {
    case v1::HostRequest::kStatus: {
      const bool is_heartbeat = bridge::IsAtRest(message.status().state());
      TakeStatus(host, std::move(*message.mutable_status()));
      if (is_heartbeat) AnswerHeartbeat(host, 0);
      break;
    }
    case v1::HostRequest::kAnswer:
      TakeAnswer(host, std::move(*message.mutable_answer()));
      break;
    case v1::HostRequest::kEntries:
      TakeEntries(host, message.entries());
      break;
    case v1::HostRequest::kPanel:
      TakePanel(host, std::move(*message.mutable_panel()));
      break;
    case v1::HostRequest::kEdit:
      StoreEdit(host, std::move(*message.mutable_edit()));
      break;
    case v1::HostRequest::kRenew:
      needs_.executor.Post([this, host] { Renew(host); });
      break;
    case v1::HostRequest::kHandBack:
      HandBack(host);
      break;
    case v1::HostRequest::kHeartbeat:
      AnswerHeartbeat(host, message.heartbeat().number());
      break;
    default:
      break;
  }
}

void Hosts::AnswerHeartbeat(const HostPointer& host, std::int64_t number) {
  v1::HostResponse answer;
  answer.mutable_heartbeat()->set_number(number);
  host->link->Send(std::move(answer));
  DropLate(host);
  StoreEntries(host);  // what the store did not take a moment ago
}

void Hosts::TakeStatus(const HostPointer& host, v1::MachineStatus status) {
  bool news = false;
  {
    const std::lock_guard lock(host->mutex);
    news = !host->status || host->status->state() != status.state() ||
           host->status->start_blockers_size() != status.start_blockers_size();
    host->status = std::move(status);
  }
  Publish(*host);
  if (news) Changed(host->id);
}

// How it stands now: what one thread learned of it is not told behind what another one did since.
void Hosts::Publish(Host& host) {
  const std::lock_guard telling(host.telling);
  v1::MachineStatus status;
  {
    const std::lock_guard lock(host.mutex);
    status = *host.status;
  }
  const std::string name = MachineName(host.id);
  if (const auto unfinished = needs_.store.UnfinishedJobs()) AddJobs(host.id, *unfinished, status);
  needs_.feed.Publish(name, status.SerializeAsString());
  if (!status.run().job().empty())
    needs_.feed.Publish(status.run().job(), ProgressOf(status).SerializeAsString());
}

void Hosts::TakeEntries(const HostPointer& host, const v1::HostEntries& entries) {
  bool all_stored = false;
  {
    const std::lock_guard lock(host->mutex);
    // A host that comes back sends again what it does not know to be stored.
    for (const v1::JournalEntry& entry : entries.entries()) {
      // Nothing behind it may be stored without it: the host sends all of it again, later.
      host->overflows = host->overflows || host->waiting.size() >= kWaitingEntriesMax;
      if (host->overflows) break;
      const std::int64_t last =
          host->waiting.empty() ? host->stored : host->waiting.back().sequence();
      if (entry.sequence() > last) host->waiting.push_back(entry);
    }
    // What is stored ends with a mark, whatever finds room.
    while (host->overflows && !host->waiting.empty() && !host->waiting.back().has_mark())
      host->waiting.pop_back();
    all_stored = host->waiting.empty() && host->stored > 0;
  }
  if (all_stored) TellStored(*host);
  StoreEntries(host);
}

// Sent under the lock: what is stored meanwhile is not told before it.
void Hosts::TellStored(Host& host) {
  const std::lock_guard lock(host.mutex);
  v1::HostResponse message;
  message.mutable_entries_stored()->set_fence(host.lease.fence);
  message.mutable_entries_stored()->set_sequence(host.stored);
  host.link->Send(std::move(message));
}

// One write under way for each machine, with all that has come meanwhile: events, and the newest
// mark.
void Hosts::StoreEntries(const HostPointer& host) {
  {
    const std::lock_guard lock(host->mutex);
    // A line that is gone stores no more, but for what came before the machine was given back.
    // Nor is there more to tell of one that came back, whose first words are stored.
    const bool gives_back = host->fresh && host->stored > 0;
    if (host->storing || (host->gone && !host->handed_back) ||
        (host->waiting.empty() && !gives_back))
      return;
    host->storing = true;
  }
  needs_.executor.Post([this, host] {
    std::vector<v1::JournalEntry> entries;
    {
      const std::lock_guard lock(host->mutex);
      entries = host->waiting;
    }
    StoredEntries done = server::StoreEntries(needs_.store, host->lease, entries);
    const Status& stored = done.how;
    bool sends_again = false;
    if (done.how && host->fresh)
      done.how = GiveBackUnbegun(needs_.store, host->id, host->lease.host, host->begin.job());
    {
      const std::lock_guard lock(host->mutex);
      if (done.how) host->fresh = false;
      host->settled = host->settled || done.how;
      host->storing = false;
      host->rests.notify_all();
      const auto count = static_cast<std::ptrdiff_t>(done.count);
      host->waiting.erase(host->waiting.begin(), host->waiting.begin() + count);
      if (count > 0) host->stored = entries[done.count - 1].sequence();
      sends_again = host->overflows && host->waiting.empty();
    }
    if (done.count > 0) TellStored(*host);
    if (sends_again) host->link->Close(NotLive("more was told than could wait: tell it again"));
    const auto ends = [](const v1::JournalEntry& entry) {
      return entry.has_run_over() && !entry.run_over().job().empty();
    };
    if (stored) {
      Changed(host->id);
      if (std::ranges::any_of(entries, ends)) RunOver(host->id);
      return StoreEntries(host);
    }
    spdlog::warn("what the host of {} tells: {}", host->id, bridge::ErrorText(stored.error()));
    if (stored.error().code != ErrorCode::kCellLeaseLost) return;
    v1::HostResponse message;
    message.mutable_lease_lost()->set_fence(host->lease.fence);
    host->link->Send(std::move(message));
  });
}

void Hosts::Renew(const HostPointer& host) {
  const auto renewed = needs_.store.RenewMachine(host->lease, needs_.server);
  v1::HostResponse message;
  if (renewed) {
    message.mutable_renewed()->set_fence(host->lease.fence);
    *message.mutable_renewed()->mutable_lease() = TimeUtil::SecondsToDuration(kLease.count());
  } else if (renewed.error().code == ErrorCode::kCellLeaseLost) {
    message.mutable_lease_lost()->set_fence(host->lease.fence);
  } else {
    spdlog::warn("the lease of {}: {}", host->id, bridge::ErrorText(renewed.error()));
    return;
  }
  host->link->Send(std::move(message));
}

// Behind what it told before.
void Hosts::HandBack(const HostPointer& host) {
  {
    const std::lock_guard lock(host->mutex);
    host->handed_back = true;
  }
  needs_.executor.Post([this, host] {
    {
      std::unique_lock lock(host->mutex);
      host->rests.wait_for(lock, kAnswerPatience,
                           [&host] { return !host->storing && host->waiting.empty(); });
    }
    Release(host);
  });
}

void Hosts::Release(const HostPointer& host) {
  const Status released = needs_.store.ReleaseMachine(host->lease);
  if (!released) spdlog::warn("the lease of {}: {}", host->id, bridge::ErrorText(released.error()));
}

void Hosts::Forget(const std::string& machine, std::optional<std::int64_t> fence) {
  const HostPointer host = Find(machine);
  if (host == nullptr || (fence && host->lease.fence != *fence)) return;
  Retire(host);
  Release(host);
  {
    const std::lock_guard lock(mutex_);
    if (const auto place = hosts_.find(machine); place != hosts_.end() && place->second == host)
      hosts_.erase(place);
  }
  host->link->Close(NotLive("the machine was disabled"));
  Changed();
}

void Hosts::NoteOff(const std::string& machine, const std::string& why) {
  Forget(machine);
  {
    const std::lock_guard lock(mutex_);
    off_[machine] = {.why = why, .held = true, .looks = needs_.clock()};
  }
  needs_.executor.Post([this, machine] {
    // The host of another server may have it by now, and run a job of it.
    EndAbandoned(machine);
    Changed();
  });
}

void Hosts::ClearOff(const std::string& machine) {
  const std::lock_guard lock(mutex_);
  off_.erase(machine);
}

std::optional<Error> Hosts::WhyOff(const std::string& machine) const {
  const std::lock_guard lock(mutex_);
  const auto found = off_.find(machine);
  return found != off_.end() ? std::optional(NotLive(found->second.why)) : std::nullopt;
}

void Hosts::Look() {
  std::vector<HostPointer> all;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, host] : hosts_) all.push_back(host);
    const Instant now = needs_.clock();
    for (auto& [id, off] : off_) {
      if (!off.held || now < off.looks) continue;
      off.looks = now + kBetweenLooks;
      needs_.executor.Post([this, machine = id] {
        if (EndAbandoned(machine)) Changed();
      });
    }
  }
  for (const HostPointer& host : all) {
    DropLate(host);
    bool silent = false;
    bool lost = false;
    std::vector<Answered> halts;  // that nobody has answered yet
    {
      const std::lock_guard lock(host->mutex);
      const auto quiet = needs_.clock() - host->heard;
      silent = !host->gone && quiet > kSilence;
      const std::chrono::milliseconds patience =
          host->status && bridge::IsAtRest(host->status->state()) ? kLostAtRest
          : host->here                                            ? kLostHere
                                                                  : kLostElsewhere;
      const bool told = host->status && host->status->state() != v1::MACHINE_STATE_LOST &&
                        host->status->state() != v1::MACHINE_STATE_STARTING;
      if (!host->gone && told && quiet > patience) {
        SetLost(*host->status);
        lost = true;
        std::erase_if(host->pending, [&halts](auto& row) {
          if (row.second.halts) halts.push_back(std::move(row.second.done));
          return row.second.halts;
        });
      }
    }
    for (const Answered& done : halts) done(NotLive(kHaltsUnseen));
    if (lost) {
      spdlog::warn("the host of {} is silent", MachineName(host->id));
      Publish(*host);
      Changed(host->id);
    }
    if (silent) host->link->Close(NotLive("the host is silent"));
  }
}

void Hosts::Leave(const HostLink& link) {
  const HostPointer host = Find(link);
  if (host == nullptr) return;
  std::map<std::int64_t, Host::Pending> pending;
  bool was_seen = false;
  bool handed_back = false;
  {
    const std::lock_guard lock(host->mutex);
    host->gone = true;
    pending.swap(host->pending);
    was_seen = host->status.has_value();
    if (was_seen) SetLost(*host->status);
    handed_back = host->handed_back;
  }
  if (handed_back) {
    const std::lock_guard lock(mutex_);
    if (const auto place = hosts_.find(host->id); place != hosts_.end() && place->second == host)
      hosts_.erase(place);
  } else if (was_seen) {
    Publish(*host);
  }
  for (auto& [number, one] : pending) one.done(NotLive("its host is not heard of any more"));
  spdlog::info("the host of {} is gone", MachineName(host->id));
  Changed();
}

void Hosts::CloseAll() {
  subscription_.reset();
  std::vector<std::shared_ptr<HostLink>> links;
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    for (const auto& [id, host] : hosts_) links.push_back(host->link);
  }
  for (const auto& link : links) link->Close({ErrorCode::kCellUnavailable, "the server stops", {}});
}

std::string Hosts::MachineThatRuns(const std::string& job) const {
  const std::lock_guard lock(mutex_);
  for (const auto& [id, host] : hosts_) {
    const std::lock_guard of_host(host->mutex);
    if (host->status && host->status->run().job() == job) return id;
  }
  return {};
}

bool Hosts::IsSettled(const std::string& machine) const {
  const HostPointer host = Find(machine);
  if (host == nullptr) return false;
  const std::lock_guard lock(host->mutex);
  return !host->gone && !host->storing && host->waiting.empty() && host->settled;
}

std::vector<std::string> Hosts::Machines() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> machines;
  for (const auto& [id, host] : hosts_) machines.push_back(id);
  return machines;
}

bool Hosts::IsHosted(const std::string& machine) const { return Find(machine) != nullptr; }

std::optional<std::int64_t> Hosts::FenceOf(const std::string& machine) const {
  const HostPointer host = Find(machine);
  return host != nullptr ? std::optional(host->lease.fence) : std::nullopt;
}

bool Hosts::IsHeard(const std::string& machine) const {
  {
    const std::lock_guard lock(mutex_);
    if (closed_) return true;  // nothing is to be started any more
  }
  const HostPointer host = Find(machine);
  if (host == nullptr) return false;
  const std::lock_guard lock(host->mutex);
  return !host->gone;
}

std::optional<v1::MachineStatus> Hosts::StatusOf(const std::string& machine) const {
  const HostPointer host = Find(machine);
  if (host == nullptr) return std::nullopt;
  v1::MachineStatus status;
  {
    const std::lock_guard lock(host->mutex);
    if (host->status) {
      status = *host->status;
    } else {
      status.set_machine(MachineName(machine));
      status.set_state(v1::MACHINE_STATE_STARTING);
      status.set_fence(host->lease.fence);
      status.set_host(host->lease.host);
    }
    status.set_age_ns(std::chrono::nanoseconds(needs_.clock() - host->heard).count());
  }
  if (const auto unfinished = needs_.store.UnfinishedJobs()) AddJobs(machine, *unfinished, status);
  return status;
}

v1::MachineStatus StatusOf(const Hosts* hosts, const storage::MachineRecord& machine,
                           const std::vector<storage::MachineJobs>& unfinished) {
  if (hosts != nullptr) {
    if (auto status = hosts->StatusOf(machine.id)) return *std::move(status);
  }
  v1::MachineStatus status = StatusOf(machine, unfinished);
  const auto off = hosts != nullptr ? hosts->WhyOff(machine.id) : std::nullopt;
  const bool disabled = hosts != nullptr && !IsEnabled(machine, true);
  if (hosts != nullptr && hosts->IsAwaited(machine.id))
    status.set_state(v1::MACHINE_STATE_STARTING);
  if (disabled) status.set_state(v1::MACHINE_STATE_OFF);
  if (off) {
    status.set_state(v1::MACHINE_STATE_OFF);
    *status.mutable_off_reason() = bridge::ToProto(
        Diagnostic{.code = off->code, .severity = Severity::kRequest, .detail = off->detail});
  }
  if (status.state() == v1::MACHINE_STATE_OFF || status.state() == v1::MACHINE_STATE_STARTING)
    *status.mutable_words() = bridge::StandardWordsOf(status);
  return status;
}

}  // namespace rmlcell::server
