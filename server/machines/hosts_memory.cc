// What the memory of a machine that lives holds, on its way to the host.
#include <spdlog/spdlog.h>

#include <set>

#include "proto/bridge/findings.h"
#include "server/machines/host_words.h"
#include "server/machines/hosted.h"

namespace rmlcell::server {
namespace {

constexpr int kMemoryReadAhead = 1'000;

}  // namespace

void Hosts::SendMemory(const HostPointer& host) {
  const auto memory =
      needs_.store.GetMachineMemory(host->id, [](const storage::MachineRecord&) { return true; });
  if (!memory) {
    spdlog::warn("memory of {}: {}", host->id, bridge::ErrorText(memory.error()));
    return;
  }
  v1::HostResponse message;
  *message.mutable_memory() = MemoryOf(*memory);
  host->link->Send(std::move(message));
}

// What was stored in the memory of a machine that is hosted goes to its host.
void Hosts::LookAtMemory() {
  std::set<std::string> changed;
  {
    const std::lock_guard looking(looking_);
    for (;;) {
      const auto events = needs_.feed.EventsAfter(looked_until_, kMemoryReadAhead);
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
  }
  for (const std::string& id : changed) {
    if (const HostPointer host = Find(id)) SendMemory(host);
  }
}

}  // namespace rmlcell::server
