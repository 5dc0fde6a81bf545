// What the memory of a machine that lives holds, on its way to the host.
#include <spdlog/spdlog.h>

#include <set>
#include <utility>

#include "proto/bridge/findings.h"
#include "server/machines/host_words.h"
#include "server/machines/hosted.h"
#include "server/machines/teach_book.h"

namespace rmlcell::server {
namespace {

constexpr int kMemoryReadAhead = 1'000;

}  // namespace

void Hosts::SendMemory(const HostPointer& host) {
  const auto memory =
      needs_.store.GetMachineMemory(host->id, [](const storage::MachineRecord&) { return true; });
  if (!memory) {
    spdlog::warn("memory of {}: {}", host->id, bridge::ErrorText(memory.error()));
    unsent_.insert(host->id);
    return;
  }
  unsent_.erase(host->id);
  v1::HostResponse message;
  *message.mutable_memory() = MemoryOf(*memory);
  host->link->Send(std::move(message));
}

// What was stored in the memory of a machine that is hosted goes to its host. `at_once`: also what
// watchers have not been told yet.
void Hosts::LookAtMemory(bool at_once) {
  const std::lock_guard looking(looking_);  // until it is sent: who comes next may rely on it
  {
    const std::lock_guard lock(mutex_);
    if (hosts_.empty()) {  // who joins is sent all of it
      looked_until_ = needs_.feed.position();
      return;
    }
  }
  std::set<std::string> changed = std::exchange(unsent_, {});  // whose still fails comes again
  for (;;) {
    const auto events = at_once ? needs_.store.AllEvents(looked_until_, kMemoryReadAhead)
                                : needs_.feed.EventsAfter(looked_until_, kMemoryReadAhead);
    if (!events) {
      looked_until_ = needs_.feed.position();
      const std::lock_guard lock(mutex_);
      for (const auto& [id, host] : hosts_) changed.insert(id);
      break;
    }
    if (events->empty()) break;
    looked_until_ = events->back().position;
    for (const storage::EventRecord& event : *events) {
      const std::string_view resource = event.resource;
      constexpr std::string_view kMachines = "machines/";
      if (event.job != 0 || !resource.starts_with(kMachines)) continue;
      const std::size_t end = resource.find('/', kMachines.size());
      if (end == std::string_view::npos) continue;
      changed.emplace(resource.substr(kMachines.size(), end - kMachines.size()));
    }
  }
  for (const std::string& id : changed) {
    if (const HostPointer host = Find(id)) SendMemory(host);
  }
}

// What was taught at the machine. Its host hears of it as of anything that is stored. LIVE-7.08
void Hosts::StoreEdit(const HostPointer& host, v1::HostEdit edit) {
  auto shared = std::make_shared<const v1::HostEdit>(std::move(edit));
  needs_.executor.Post([this, host, shared] {
    const auto expected = static_cast<storage::Revision>(shared->object_revision());
    Status done;
    storage::Revision after = 0;
    if (shared->object().empty()) {
      done = needs_.store.DeleteProgram(host->id, shared->slot(), expected, shared->caller());
    } else {
      const auto put = needs_.store.PutPrograms(
          host->id, {{.slot = shared->slot(), .object = shared->object(), .expected = expected}},
          {}, shared->caller());
      if (!put) done = put.error();
      if (put) after = put->front().revision;
    }
    if (done && shared->has_taught()) {
      const auto kept = TeachBook(needs_.store).Add(host->id, shared->taught(), expected, after);
      // The program is stored: what was taught stands, and cannot be taken back.
      if (!kept)
        spdlog::error("what was taught at {}: {}", host->id, bridge::ErrorText(kept.error()));
    }
    v1::HostResponse message;
    message.mutable_edit_answer()->set_number(shared->number());
    if (!done)
      *message.mutable_edit_answer()->mutable_refusal() = bridge::ToErrorDetail(done.error());
    host->link->Send(std::move(message));
  });
}

void Hosts::TakePanel(const HostPointer& host, v1::HandboxPanel panel) {
  std::string bytes = panel.SerializeAsString();
  {
    const std::lock_guard lock(host->mutex);
    host->handbox = std::move(panel);
  }
  needs_.feed.Publish(HandboxOf(host->id), std::move(bytes));
}

std::optional<v1::HandboxPanel> Hosts::HandboxPanelOf(const std::string& machine) const {
  const HostPointer host = Find(machine);
  if (host == nullptr) return std::nullopt;
  const std::lock_guard lock(host->mutex);
  return host->handbox;
}

}  // namespace rmlcell::server
