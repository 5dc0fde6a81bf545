// A host gets its machine: by a lease, and with what it must know of it.
#include <google/protobuf/util/time_util.h>
#include <signal.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "engine/core/number_text.h"
#include "proto/bridge/findings.h"
#include "rmlcell/v1/cell.pb.h"
#include "server/base/host_protocol.h"
#include "server/base/names.h"
#include "server/base/secret.h"
#include "server/base/this_computer.h"
#include "server/machines/host_entries.h"
#include "server/machines/host_words.h"
#include "server/machines/hosted.h"
#include "server/records/job_messages.h"
#include "server/records/machine_options.h"

namespace rmlcell::server {
namespace {

using google::protobuf::util::TimeUtil;

constexpr std::chrono::seconds kObserved{5};  // beyond the lease: its holder is gone (PG-5.09)

// "hall/4711" is of the computer "hall".
bool IsOf(const std::string& host, const std::string& computer) {
  return !computer.empty() && host.starts_with(computer + "/");
}

// Whether the process that this host is, of the present boot of this computer, is gone. Of another
// boot it may be of another computer that has the same name. LIVE-3.02
bool IsGone(const std::string& host) {
  const std::string here = NameOfComputer();
  const std::string boot = NameOfBoot();
  if (!IsOf(host, here) || boot.empty()) return false;
  const std::string_view rest = std::string_view(host).substr(here.size() + 1);
  const std::size_t slash = rest.find('/');
  if (slash == std::string_view::npos || !rest.substr(slash + 1).starts_with(boot)) return false;
  const auto process = ParseInteger(rest.substr(0, slash));
  return process && *process > 1 && ::kill(static_cast<pid_t>(*process), 0) != 0 && errno == ESRCH;
}

v1::MachineMark MarkOf(const storage::MachineMark& stored) {
  v1::MachineMark mark;
  static_cast<void>(mark.ParseFromString(stored.note));
  mark.set_fence(stored.fence);
  mark.set_sequence(stored.sequence);
  mark.set_clean(stored.clean);
  return mark;
}

// Where the machine stands: by the store, or by what its host found beside it; where the store does
// not have what began there, as it was before.
std::optional<v1::MachineMark> NewerOf(const std::optional<storage::MachineMark>& stored,
                                       const v1::HostHello& hello) {
  const auto mark = stored ? std::optional(MarkOf(*stored)) : std::nullopt;
  const auto number = [](const auto& one) { return std::pair(one.fence(), one.sequence()); };
  const bool unbegun =
      hello.begin().fence() > 0 && (!mark || number(*mark) < number(hello.begin()));
  const bool found = unbegun ? hello.begin().has_mark() : hello.has_journal_mark();
  const v1::MachineMark& beside = unbegun ? hello.begin().mark() : hello.journal_mark();
  return found && (!mark || number(*mark) < number(beside)) ? beside : mark;
}

}  // namespace

bool Hosts::EndAbandoned(const std::string& machine) {
  const std::lock_guard joining(joining_);  // nobody comes for it meanwhile
  {
    // It may have been done by an earlier look, or be on again.
    const std::lock_guard lock(mutex_);
    const auto off = off_.find(machine);
    if (off == off_.end() || !off->second.held) return false;
  }
  const auto leases = needs_.store.MachineLeases();
  if (!leases) return false;  // it is asked again
  const auto lease = std::ranges::find(*leases, machine, &storage::MachineLease::machine);
  const bool is_held = lease != leases->end();
  const bool is_gone = is_held && IsGone(lease->host);
  if (is_held && !is_gone) {
    const std::lock_guard lock(mutex_);
    const auto off = off_.find(machine);
    if (off == off_.end()) return true;
    const Instant now = needs_.clock();
    if (off->second.seen.lease != *lease) off->second.seen = {.lease = *lease, .since = now};
    if (lease->pinned || now - off->second.seen.since < lease->duration + kObserved) return false;
  }
  // Who had it is told so when it is heard of again, and begins nothing.
  Result<storage::MachineLease> taken =
      needs_.store.TakeMachine({.machine = machine,
                                .host = needs_.server + "/nobody",
                                .server = needs_.server,
                                .duration = kLease,
                                .seen = is_held ? std::optional(*lease) : std::nullopt,
                                .by_hand = is_gone});
  if (!taken) return false;
  const Status ended = EndWithoutHost(needs_.store, machine);
  if (!ended) spdlog::warn("jobs of {}: {}", machine, bridge::ErrorText(ended.error()));
  static_cast<void>(needs_.store.ReleaseMachine(*taken));
  if (!ended) return false;
  const std::lock_guard lock(mutex_);
  if (const auto off = off_.find(machine); off != off_.end()) off->second.held = false;
  return true;
}

Status Hosts::Join(const std::shared_ptr<HostLink>& link, const v1::HostHello& hello) {
  if (!KnowsSecret(hello.join_token(), needs_.join_token))
    return Error{ErrorCode::kCellJoinRefused, "of a host", {}};
  if (!TakesHost(static_cast<int>(hello.protocol())))
    return Error{ErrorCode::kCellVersionMismatch,
                 "the host speaks protocol " + std::to_string(hello.protocol()) + ", this server " +
                     std::to_string(kHostProtocol),
                 {}};
  const Result<std::string> machine = ParseMachineName(hello.machine());
  if (!machine) return machine.error();
  const std::lock_guard joining(joining_);
  LookAtMemory();  // what came while nobody had a machine is in what is sent below
  const Result<Taken> taken = Take(hello, *machine);
  if (!taken) return taken.error();
  const HostPointer line_before = Find(*machine);
  if (line_before != nullptr) Retire(line_before);
  auto host = std::make_shared<Host>();
  host->id = *machine;
  host->link = link;
  host->lease = taken->lease;
  host->heard = needs_.clock();
  host->here = IsOf(hello.host(), NameOfComputer());
  if (const Status welcome = Welcome(host, hello, *taken); !welcome) return welcome.error();
  host->begin = hello.begin();
  // It may be more than up to the newest mark.
  if (line_before != nullptr && line_before->lease.fence == host->lease.fence)
    host->stored = std::max(host->stored, line_before->stored);
  HostPointer before;
  {
    const std::lock_guard lock(mutex_);
    if (closed_) return Error{ErrorCode::kCellUnavailable, "the server stops", {}};
    HostPointer& place = hosts_[*machine];
    before = std::exchange(place, host);
    off_.erase(*machine);
  }
  if (before != nullptr && before->link != link)
    before->link->Close(NotLive("the host has another line"));
  if (before != nullptr) HandOver(*before, *host);
  {
    const std::lock_guard looking(looking_);  // what is stored meanwhile is sent behind it
    SendMemory(host);
  }
  spdlog::info("{} has the host {}, fence {}", hello.machine(), hello.host(), host->lease.fence);
  Changed();
  RunOver(host->id);
  return {};
}

void Hosts::GiveTo(const std::string& machine, const std::string& computer,
                   const std::string& caller, const std::string& reason) {
  const std::lock_guard joining(joining_);
  given_[machine] = {.computer = computer,
                     .told = "taken by " + caller + ": " + bridge::Utf8(reason),
                     .until = needs_.clock() + kGivenFor};
}

// Precondition: joining_ is held.
std::optional<Hosts::Given> Hosts::GivenTo(const v1::HostHello& hello, const std::string& machine) {
  const auto given = given_.find(machine);
  if (given == given_.end() || given->second.computer != hello.computer() ||
      given->second.until < needs_.clock())
    return std::nullopt;
  return given->second;
}

// Of a holder that is gone: a process of this computer that is no more, or one that has not renewed
// its lease for as long as it holds. What has a device nobody else can have at the same time: who
// has the lock of it on the same computer has the machine, and a host of another one gets it from a
// person alone. LIVE-3.02, 3.03
Result<Hosts::Taken> Hosts::Take(const v1::HostHello& hello, const std::string& machine) {
  const auto held = needs_.store.MachineLeases();
  if (!held) return held.error();
  const auto other = std::ranges::find(*held, machine, &storage::MachineLease::machine);
  // A lease that was given back does not come to life again: who had it ends. LIVE-3.05
  if (hello.fence() != 0 && (other == held->end() || other->fence != hello.fence()))
    return Error{ErrorCode::kCellMachineTaken, "the lease of " + hello.host() + " is over", {}};
  storage::MachineClaim claim{.machine = machine,
                              .host = hello.host(),
                              .server = needs_.server,
                              .duration = kLease,
                              .pinned = hello.has_device()};
  Result<storage::MachineLease> lease = needs_.store.TakeMachine(claim);
  const std::optional<Given> given = GivenTo(hello, machine);
  if (lease || lease.error().code != ErrorCode::kCellMachineTaken) {
    seen_.erase(machine);
    if (!lease) return lease.error();
    if (given) given_.erase(machine);
    return Taken{.lease = *std::move(lease)};
  }
  if (other != held->end()) {
    const Instant now = needs_.clock();
    Seen& seen = seen_[machine];
    if (seen.lease != *other) seen = {.lease = *other, .since = now};
    claim.seen = *other;
    const bool could = !other->pinned || hello.has_device();
    claim.by_hand =
        could &&
        (given || (other->pinned ? IsOf(other->host, hello.computer()) : IsGone(other->host)));
    if (!claim.by_hand && (other->pinned || now - seen.since < other->duration + kObserved))
      return lease.error();
  }
  lease = needs_.store.TakeMachine(claim);
  if (!lease) return lease.error();
  seen_.erase(machine);
  if (given) given_.erase(machine);
  return Taken{.lease = *std::move(lease),
               .from = claim.seen,
               .by_hand = given ? given->told : std::string()};
}

// Its line is nobody's any more: who waits for an answer is told so, and what it was storing is
// stored, so that the next line knows what is.
void Hosts::Retire(const HostPointer& host) {
  std::map<std::int64_t, Host::Pending> pending;
  {
    std::unique_lock lock(host->mutex);
    host->gone = true;
    pending.swap(host->pending);
    // Not for ever: the thread that is to store may be the one that waits here.
    host->rests.wait_for(lock, kAnswerPatience, [&host] { return !host->storing; });
  }
  for (auto& [number, one] : pending) one.done(NotLive("its host is not heard of any more"));
}

// What would have halted it, and found no line. Of another fence it stands already. LIVE-2.10
void Hosts::HandOver(Host& before, const Host& host) const {
  std::vector<v1::HostOrder> kept;
  {
    const std::lock_guard lock(before.mutex);
    before.has_successor = true;
    const bool late = needs_.clock() - before.kept_since > kLease;
    kept.swap(before.kept);
    if (late || before.lease.fence != host.lease.fence) return;
  }
  for (v1::HostOrder& order : kept) {
    v1::HostResponse message;
    *message.mutable_order() = std::move(order);
    host.link->Send(std::move(message));
  }
}

Status Hosts::Welcome(const HostPointer& host, const v1::HostHello& hello, const Taken& taken) {
  const Result<storage::MachineRecord> machine = needs_.store.GetMachine(host->id);
  if (!machine) return machine.error();
  const auto mark = needs_.store.GetMachineMark(host->id);
  if (!mark) return mark.error();
  // All up to the mark is stored: each write ends with one.
  if (*mark && (*mark)->fence == host->lease.fence) host->stored = (*mark)->sequence;
  // A host that comes back knows better.
  if (hello.fence() != host->lease.fence) {
    if (const Status told = TellRecovery(*host, taken, NewerOf(*mark, hello)); !told)
      return told.error();
  } else {
    // One that stands says nothing more by itself; what it has to say comes before its first
    // status.
    const std::lock_guard lock(host->mutex);
    host->settled = true;
  }
  v1::HostResponse message;
  v1::HostWelcome& welcome = *message.mutable_welcome();
  welcome.set_fence(host->lease.fence);
  *welcome.mutable_lease() = TimeUtil::SecondsToDuration(kLease.count());
  *welcome.mutable_servers() = {needs_.servers.begin(), needs_.servers.end()};
  welcome.set_family(machine->family);
  welcome.set_profile(machine->profile);
  for (const auto& [name, value] : machine->parameters)
    (*welcome.mutable_parameters())[name] = value;
  if (auto options = OptionsOf(*machine)) *welcome.mutable_options() = *std::move(options);
  if (*mark) {
    *welcome.mutable_mark() = MarkOf(**mark);
    welcome.mutable_mark()->set_state((*mark)->state);
  }
  host->link->Send(std::move(message));
  return {};
}

// That a host is gone; from when to when status was shown that counts no more, and where the
// program was. LIVE-3.30, 5.20
Status Hosts::TellRecovery(const Host& host, const Taken& taken,
                           const std::optional<v1::MachineMark>& mark) {
  storage::MachineWrite write;
  const v1::MachineMark note = mark.value_or(v1::MachineMark());
  if (!taken.by_hand.empty()) {
    v1::MachineEvent given;
    given.mutable_run()->mutable_message()->set_text(taken.by_hand);
    given.set_fence(host.lease.fence);
    given.set_virtual_time_ns(note.virtual_time_ns());
    write.events.push_back(ToRecord(given));
  }
  if (taken.from) {
    v1::MachineEvent lost;
    lost.mutable_host_lost()->set_host(taken.from->host);
    lost.mutable_host_lost()->set_fence(taken.from->fence);
    lost.set_fence(host.lease.fence);
    lost.set_virtual_time_ns(note.virtual_time_ns());
    write.events.push_back(ToRecord(lost));
  }
  // Where the host handed it back, or none had it before, all that was shown is true.
  if (!mark || (mark->clean() && !taken.from))
    return write.events.empty() ? Status() : needs_.store.AppendMachine(host.lease, write);
  v1::MachineEvent event;
  v1::Recovered& recovered = *event.mutable_recovered();
  recovered.set_mark_virtual_time_ns(note.virtual_time_ns());
  recovered.set_mark_fence(mark->fence());
  if (note.has_place()) *recovered.mutable_place() = note.place();
  if (const HostPointer before = Find(host.id)) {
    const std::lock_guard lock(before->mutex);
    if (before->status) recovered.set_seen_until_ns(before->status->virtual_time_ns());
  }
  event.set_fence(host.lease.fence);
  event.set_virtual_time_ns(note.virtual_time_ns());
  write.events.push_back(ToRecord(event));
  return needs_.store.AppendMachine(host.lease, write);
}

}  // namespace rmlcell::server
