#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <vector>

#include "server/machines/hosts.h"

namespace rmlcell::server {

using Instant = std::chrono::steady_clock::time_point;

inline constexpr const char* kHaltsUnseen = "its host is silent: whether it halts is not known";

// What Hosts knows of one host, by one line of it. Only its own sources include this.
struct Hosts::Host {
  std::string id{};
  std::shared_ptr<HostLink> link;
  storage::MachineLease lease{};  // does not change but for its count, which nobody looks at

  // What halts and what begins go out one behind the other. Taken before `mutex`.
  std::mutex in_order;
  std::mutex telling;  // who watches hears of it in order; likewise

  std::mutex mutex;               // a leaf, like that of Hosts
  std::condition_variable rests;  // nothing of it is being stored
  bool gone = false;
  bool handed_back = false;
  struct Pending {
    Answered done;
    std::chrono::steady_clock::time_point until{};  // it is answered by then, or never
    bool halts = false;
    bool begins = false;  // and has not gone out: what halts the machine takes it back
  };
  std::map<std::int64_t, Pending> pending;
  // What halts, and came when it was gone: for the line that comes behind it. LIVE-2.10
  std::vector<v1::HostOrder> kept{};
  Instant kept_since{};
  bool has_successor = false;
  std::optional<v1::MachineStatus> status;
  bool here = false;  // on the computer of this server
  std::optional<v1::HandboxPanel> handbox;
  std::chrono::steady_clock::time_point heard{};
  std::vector<v1::JournalEntry> waiting;  // to be stored
  std::int64_t stored = 0;                // sequence of the last one that is
  bool storing = false;
  bool overflows = false;  // more came than may wait: nothing behind it is taken on this line
  bool settled = false;    // guarded by mutex: all that was before it is stored
  bool fresh = true;       // jobs of the one before may stand there
  v1::HostBegin begin{};   // of the one before; its host tells it until this is stored
};

}  // namespace rmlcell::server
