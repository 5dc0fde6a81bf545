#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "rmlcell/v1/host.pb.h"
#include "server/host/host_clock.h"
#include "server/host/waiting_messages.h"

namespace rmlcell::server {

// Lines of a host to the other servers of its cell, beside the one that stores what it tells: what
// a client asks of any of them reaches the machine, and the status of the machine reaches them all,
// past the store. Of the thread of the machine. LIVE-3.06
class FurtherLines {
 public:
  static constexpr std::size_t kServersMax = 8;

  // `wake`: something has come; called on threads of this. A server that says nothing for longer
  // than `silence` is left.
  explicit FurtherLines(std::function<void()> wake,
                        std::chrono::nanoseconds silence = kServerSilent);
  ~FurtherLines();
  FurtherLines(const FurtherLines&) = delete;
  FurtherLines& operator=(const FurtherLines&) = delete;

  // From here on to these and to no others, which are greeted so.
  void Keep(const std::vector<std::string>& servers, v1::HostHello hello);

  // What came since the last call: orders, by numbers that no other line has, and that the host is
  // to end.
  WaitingMessages::Taken TakeMessages();
  // True where the order came over one of these lines: it is answered there, if that still stands.
  bool Answer(const v1::HostOrderAnswer& answer);
  void SendStatus(const v1::MachineStatus& status);
  void SendPanel(const v1::HandboxPanel& panel);

  // Whether whoever asked this still waits for it, over the line that brought it; of a number that
  // none of these lines has true.
  bool IsAskedFor(std::int64_t number) const;
  // Whether one of them stands that was not there the last time: it knows nothing yet.
  bool TakeFresh();
  // Whether one of them stands and is heard.
  bool IsHeard() const;

 private:
  class Line;
  struct Asked {
    std::string server{};
    std::int64_t line = 0;    // the how manieth to that server
    std::int64_t number = 0;  // by the server
  };
  void Hear(Line& line, v1::HostResponse message);
  void NoteCome();
  v1::HostHello hello() const;

  std::function<void()> wake_;
  const std::chrono::nanoseconds silence_;
  mutable std::mutex mutex_;
  v1::HostHello hello_;                  // guarded by mutex_
  WaitingMessages messages_;             // guarded by mutex_
  std::map<std::int64_t, Asked> asked_;  // by own number; guarded by mutex_
  std::int64_t next_ = -1;               // counts down; guarded by mutex_
  bool fresh_ = false;                   // guarded by mutex_
  // Of the thread of the machine; the last members: their threads use the others.
  std::map<std::string, std::unique_ptr<Line>> lines_;  // by server
  std::vector<std::unique_ptr<Line>> ended_;            // until their threads are over
};

}  // namespace rmlcell::server
