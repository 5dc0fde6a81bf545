#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "rmlcell/v1/host.pb.h"
#include "server/base/executor.h"
#include "server/base/steady_clock.h"
#include "server/events/event_feed.h"
#include "storage/store.h"

namespace rmlcell::server {

// The server's end of the line of a host. Thread-safe; neither blocks.
class HostLink {
 public:
  virtual ~HostLink() = default;
  virtual void Send(v1::HostResponse message) = 0;
  virtual void Close(const Error& why) = 0;
};

// The hosts of machines that live, as this server hears of them: it gives them their leases, hands
// orders of clients over and stores what they tell. Orders and status never pass the store.
// Thread-safe. Lock order: mutex_, that of a host; the store is called under neither.
class Hosts {
 public:
  static constexpr std::chrono::seconds kLease{60};  // PG-5.08
  static constexpr std::chrono::seconds kAnswerPatience{10};
  static constexpr std::chrono::seconds kPreviewPatience{75};  // a run is simulated for it
  static constexpr std::chrono::minutes kGivenFor{10};

  struct Needs {
    storage::Store& store;
    EventFeed& feed;
    Executor& executor;
    std::string server{};      // name of this server
    std::string join_token{};  // known to its hosts
    // "host:port" or "unix:/path": every server of the store, this one among them. Empty: none but
    // this. LIVE-3.06
    std::vector<std::string> servers{};
    SteadyClock clock = SteadyTime;
  };
  explicit Hosts(Needs needs);
  ~Hosts();
  Hosts(const Hosts&) = delete;
  Hosts& operator=(const Hosts&) = delete;

  // From here on a host is heard by this link. May block. Errors: CellJoinRefused,
  // CellInvalidArgument, CellVersionMismatch, CellUnknownMachine, CellMachineTaken.
  Status Join(const std::shared_ptr<HostLink>& link, const v1::HostHello& hello);
  void Receive(const HostLink& link, v1::HostRequest message);
  void Leave(const HostLink& link);

  // What a client asks of a machine. `done` is called once, on any thread: with the host's answer,
  // or CellNotLive. What halts goes out at once; what would begin, and has not gone out by then, is
  // refused with CellMachineState.
  using Answered = std::function<void(Result<v1::HostOrderAnswer>)>;
  void Ask(const std::string& machine, v1::HostOrder order, Answered done);
  // It comes to rest, gives the machine back and ends. The fence of the host that was told so;
  // nothing: it has none.
  std::optional<std::int64_t> End(const std::string& machine, const std::string& why);

  // The server stops: lines end, no host joins any more; machines and their hosts go on.
  void CloseAll();

  // It has no host any more, whatever that is doing: of one that is not heard of. With a fence: if
  // it is this host.
  void Forget(const std::string& machine, std::optional<std::int64_t> fence = {});
  // The same, and why: told until it has one again.
  void NoteOff(const std::string& machine, const std::string& why);
  void ClearOff(const std::string& machine);
  std::optional<Error> WhyOff(const std::string& machine) const;
  // The next host of this computer gets the machine, whoever has it, if it comes within kGivenFor.
  // LIVE-3.03
  void GiveTo(const std::string& machine, const std::string& computer, const std::string& caller,
              const std::string& reason);
  // From time to time: orders that nobody answers, lines that are silent.
  void Look();

  bool IsHosted(const std::string& machine) const;
  std::optional<std::int64_t> FenceOf(const std::string& machine) const;  // of its host
  bool IsHeard(const std::string& machine) const;                         // its host has a line
  // What its host told last, with its age; LOST where it is not heard; nothing: it has no host.
  std::optional<v1::MachineStatus> StatusOf(const std::string& machine) const;
  // What is to be seen at its handbox; nothing: it has none, or is not hosted. Changes are
  // published under the name that follows.
  std::optional<v1::HandboxPanel> HandboxPanelOf(const std::string& machine) const;
  static std::string HandboxOf(const std::string& machine) { return "handboxes/" + machine; }
  // Asked whether a host of a machine that has none is about to come; any thread.
  void OnAwaited(std::function<bool(const std::string& machine)> is_awaited);
  bool IsAwaited(const std::string& machine) const;
  // What was stored in the memory of machines is on its way to their hosts, before any order that
  // is sent from here on.
  void TakeStored() { LookAtMemory(true); }
  // Called when a machine is hosted, or no more.
  void OnChange(std::function<void()> changed);
  // Called when the state of a machine, or what keeps a job from it, has changed, or something of
  // it was stored; on any thread, and not for long.
  void OnNews(std::function<void(const std::string& machine)> news);
  // Called when the end of a job of the machine is stored, and when its host is heard again; on any
  // thread, and not for long.
  void OnRunOver(std::function<void(const std::string& machine)> over);
  // The id of the machine that runs this job, as its host says; empty: none that is known.
  std::string MachineThatRuns(const std::string& job) const;
  std::vector<std::string> Machines() const;  // ids of those with a host
  // Whether all that its host has told is in the store, what an earlier one left among that.
  bool IsSettled(const std::string& machine) const;

 private:
  struct Host;
  using HostPointer = std::shared_ptr<Host>;

  HostPointer Find(const HostLink& link) const;
  HostPointer Find(const std::string& machine) const;
  // Of a machine that is off: its jobs end when nobody has it, or who has it is gone. False:
  // somebody has it.
  bool EndAbandoned(const std::string& machine);
  struct Taken {
    storage::MachineLease lease{};
    std::optional<storage::MachineLease> from{};  // whose host is gone
    std::string by_hand{};                        // who gave it to this one, and why; "": nobody
  };
  struct Given {
    std::string computer{};
    std::string told{};  // "taken by anna: the computer of the hall burns"
    std::chrono::steady_clock::time_point until{};
  };
  Result<Taken> Take(const v1::HostHello& hello, const std::string& machine);
  std::optional<Given> GivenTo(const v1::HostHello& hello, const std::string& machine);
  Status Welcome(const HostPointer& host, const v1::HostHello& hello, const Taken& taken);
  Status TellRecovery(const Host& host, const Taken& taken,
                      const std::optional<v1::MachineMark>& mark);
  void SendMemory(const HostPointer& host);  // with looking_ held: in the order of what was stored
  bool Keep(Host& host, const v1::HostOrder& order) const;  // with its mutex held
  static std::vector<Answered> Withdraw(Host& host);        // likewise
  void SendBehindMemory(const HostPointer& host, v1::HostResponse order);
  void StoreEdit(const HostPointer& host, v1::HostEdit edit);
  void TakePanel(const HostPointer& host, v1::HandboxPanel panel);
  void AnswerHeartbeat(const HostPointer& host, std::int64_t number);
  void TakeStatus(const HostPointer& host, v1::MachineStatus status);
  void TakeAnswer(const HostPointer& host, v1::HostOrderAnswer answer);
  void TakeEntries(const HostPointer& host, const v1::HostEntries& entries);
  static void TellStored(Host& host);
  void StoreEntries(const HostPointer& host);
  void Renew(const HostPointer& host);
  void HandBack(const HostPointer& host);
  void DropLate(const HostPointer& host);
  static void Retire(const HostPointer& host);
  void HandOver(Host& before, const Host& host) const;
  void Release(const HostPointer& host);
  void Publish(Host& host);  // precondition: it has told how it stands
  void LookAtMemory(bool at_once = false);
  void Changed();
  void Changed(const std::string& machine);
  void RunOver(const std::string& machine);

  Needs needs_;
  std::mutex changing_;
  std::function<bool(const std::string&)> is_awaited_;  // guarded by mutex_
  std::function<void()> changed_;                       // guarded by changing_
  std::function<void(const std::string&)> news_;        // likewise
  std::function<void(const std::string&)> over_;        // likewise
  // Over all lines, and those of a server before: an answer is to one order alone.
  std::atomic<std::int64_t> next_order_ = std::chrono::duration_cast<std::chrono::microseconds>(
                                              std::chrono::system_clock::now().time_since_epoch())
                                              .count();
  mutable std::mutex mutex_;
  bool closed_ = false;                       // guarded by mutex_
  std::map<std::string, HostPointer> hosts_;  // by id of the machine; guarded by mutex_
  // Leases of others, and since when they stand unchanged. Of Join alone, guarded by joining_.
  std::mutex joining_;
  struct Seen {
    storage::MachineLease lease{};
    std::chrono::steady_clock::time_point since{};
  };
  std::map<std::string, Seen> seen_;
  struct Off {
    std::string why{};
    bool held = false;  // by somebody, and perhaps there are jobs of it
    Seen seen{};
    std::chrono::steady_clock::time_point looks{};
  };
  std::map<std::string, Off> off_;      // guarded by mutex_
  std::map<std::string, Given> given_;  // by machine; guarded by joining_
  std::int64_t looked_until_ = 0;       // of the log; guarded by looking_
  std::set<std::string> unsent_;        // whose memory could not be read; guarded by looking_
  std::mutex looking_;
  std::unique_ptr<EventFeed::Subscription> subscription_;
};

// As its host tells, or as far as its jobs do.
v1::MachineStatus StatusOf(const Hosts* hosts, const storage::MachineRecord& machine,
                           const std::vector<storage::MachineJobs>& unfinished);

}  // namespace rmlcell::server
