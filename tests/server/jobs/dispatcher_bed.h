#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>

#include "server/config.h"
#include "server/events/event_feed.h"
#include "server/executor.h"
#include "server/jobs/dispatcher.h"
#include "server/jobs/job_messages.h"
#include "server/version.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {

inline constexpr std::string_view kToken = "the token";
// Long enough for what must not come to come.
inline constexpr std::chrono::milliseconds kAWhile{120};

// The line to a worker, as seen from its end. Thread-safe.
class FakeLine final : public WorkerLine {
 public:
  void Send(v1::WorkResponse message) override;
  void SendProgram(int slot, std::shared_ptr<const std::string> bytes) override;
  void Close(const Error&) override {}

  // The next message of this kind; those of other kinds that came before it are dropped. An empty
  // one when none comes within `patience`.
  v1::WorkResponse Next(v1::WorkResponse::MessageCase kind,
                        std::chrono::milliseconds patience = kPatience);
  std::map<int, std::string> programs();

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<v1::WorkResponse> messages_;
  std::map<int, std::string> programs_;
};

v1::WorkerHello Hello(const std::string& name);

// A worker that does what the test says.
class FakeWorker {
 public:
  FakeWorker(Dispatcher& dispatcher, const std::string& name)
      : FakeWorker(dispatcher, Hello(name)) {}
  FakeWorker(Dispatcher& dispatcher, const v1::WorkerHello& hello);

  FakeLine& line() { return *line_; }

  // Waits for a job and takes it. False: none came.
  bool Take(std::chrono::milliseconds patience = kPatience);
  const v1::WorkerAssignment& assignment() const { return assignment_; }
  std::int64_t job() const { return assignment_.lease().job(); }

  void Heartbeat();
  void Position(std::int64_t time_ns);
  void Events(int count, const std::string& text = "text");
  void Artifact(const std::string& name, const std::string& bytes);
  void Finish(v1::Outcome::Kind kind = v1::Outcome::KIND_COMPLETED,
              const std::map<int, std::string>& executables = {});
  void HandBack();
  void Leave() { dispatcher_.Leave(id_); }

  // What the server says about the lease: stored, lost; nothing when it does not say.
  std::optional<bool> Released();
  v1::WorkerControl Ordered();

 private:
  void Send(v1::WorkRequest message) { dispatcher_.Receive(id_, std::move(message)); }

  Dispatcher& dispatcher_;
  std::shared_ptr<FakeLine> line_ = std::make_shared<FakeLine>();
  Dispatcher::WorkerId id_ = 0;
  v1::WorkerAssignment assignment_;
};

// A store that does something more around a call.
class HookedStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  std::function<void(bool found)> after_acquire;  // set before the dispatcher is made

  Result<std::optional<storage::LeasedJob>> Acquire(
      std::string_view worker, const std::vector<std::string>& kinds,
      std::chrono::milliseconds duration, const std::vector<storage::NewEvent>& events) override {
    auto leased = store_.Acquire(worker, kinds, duration, events);
    if (after_acquire) after_acquire(leased && leased->has_value());
    return leased;
  }
};

// A dispatcher with all that it needs, made when it is asked for first and ended as Cell::Stop
// does.
class DispatcherBed {
 public:
  DispatcherBed() { config.workers_lease_ms = 60'000; }
  ~DispatcherBed() { End(); }
  DispatcherBed(const DispatcherBed&) = delete;
  DispatcherBed& operator=(const DispatcherBed&) = delete;

  Dispatcher& dispatcher();
  EventFeed& feed();
  void End();

  storage::JobRecord Job(std::int64_t id) { return Must(server.store().GetJob(id)); }
  bool Becomes(std::int64_t id, storage::JobState state) {
    return Eventually([&] { return Job(id).state == state; });
  }
  // Kinds of the events of a job, and the code of the last one when it tells the end.
  std::vector<v1::JobEvent> Events(std::int64_t id);

  ServerBed server;
  HookedStore hooks{server.store()};
  Config config;

 private:
  std::unique_ptr<Executor> executor_;
  std::unique_ptr<EventFeed> feed_;
  std::unique_ptr<Dispatcher> dispatcher_;
};

}  // namespace rmlcell::server
