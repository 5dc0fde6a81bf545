// Lines between hosts and servers of one process: what HostLine and HostService do over gRPC, with
// nothing between them that the race detector cannot see.
#include <chrono>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <utility>

#include "server/host/host_line.h"
#include "tests/server/services/listening.h"

namespace rmlcell::server {
namespace {

// The server's end of a line, and what it has said on it.
class Wire final : public HostLink {
 public:
  void Send(v1::HostResponse message) override {
    const std::lock_guard lock(mutex_);
    if (!closed_) messages_.push_back(std::move(message));
    changed_.notify_all();
  }
  void Close(const Error& /*why*/) override {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }
  // Nothing: it is closed.
  std::optional<v1::HostResponse> Next() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || !messages_.empty(); });
    if (messages_.empty()) return std::nullopt;
    v1::HostResponse message = std::move(messages_.front());
    messages_.pop_front();
    return message;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<v1::HostResponse> messages_;  // guarded by mutex_
  bool closed_ = false;                    // guarded by mutex_
};

// Who listens at an address; whoever calls its hosts holds it.
struct Door {
  std::shared_mutex mutex;
  Hosts* hosts = nullptr;  // guarded by mutex
};

std::shared_ptr<Door> DoorAt(const std::string& address) {
  static std::mutex mutex;
  static std::map<std::string, std::shared_ptr<Door>> doors;
  const std::lock_guard lock(mutex);
  std::shared_ptr<Door>& door = doors[address];
  if (door == nullptr) door = std::make_shared<Door>();
  return door;
}

}  // namespace

struct Listening::Server {
  std::shared_ptr<Door> door;
};

Listening::Listening(const std::string& address, Hosts& hosts, Executor& /*executor*/)
    : server_(std::make_unique<Server>(DoorAt(address))) {
  const std::unique_lock lock(server_->door->mutex);
  server_->door->hosts = &hosts;
}

Listening::~Listening() { End(); }

void Listening::End() {
  const std::unique_lock lock(server_->door->mutex);
  server_->door->hosts = nullptr;
}

struct HostLine::Stream {
  std::shared_ptr<Door> door;
  std::shared_ptr<Wire> wire = std::make_shared<Wire>();

  // False: nobody listens any more.
  bool Tell(v1::HostRequest message) {
    const std::shared_lock lock(door->mutex);
    if (door->hosts != nullptr) door->hosts->Receive(*wire, std::move(message));
    return door->hosts != nullptr;
  }
  void Leave() {
    const std::shared_lock lock(door->mutex);
    if (door->hosts != nullptr) door->hosts->Leave(*wire);
  }
};

HostLine::HostLine(const LineTimes& times) : times_(times), stream_(std::make_unique<Stream>()) {}

Result<HostLine::Welcome> HostLine::Join(const std::string& server, const v1::HostHello& hello,
                                         std::function<void(v1::HostResponse)> heard,
                                         std::function<void()> gone, const LineTimes& times) {
  std::unique_ptr<HostLine> made(new HostLine(times));
  made->heard_ = std::move(heard);
  made->gone_ = std::move(gone);
  Stream& stream = *made->stream_;
  stream.door = DoorAt(server);
  {
    const std::shared_lock lock(stream.door->mutex);
    if (stream.door->hosts == nullptr)
      return Error{ErrorCode::kCellUnavailable, "no server answers at " + server, {}};
    if (const Status joined = stream.door->hosts->Join(stream.wire, hello); !joined)
      return joined.error();
  }
  std::optional<v1::HostResponse> answer = stream.wire->Next();
  if (!answer || !answer->has_welcome())
    return Error{ErrorCode::kCellUnavailable, "the server says no welcome", {}};
  Welcome welcome{.message = std::move(*answer->mutable_welcome()), .line = nullptr};
  made->reader_ = std::thread([line = made.get()] { line->Read(); });
  made->writer_ = std::thread([line = made.get()] { line->Write(); });
  welcome.line = std::move(made);
  return welcome;
}

HostLine::~HostLine() {
  if (!reader_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  to_send_.notify_all();
  writer_.join();
  stream_->Leave();
  Cut();
  reader_.join();
}

void HostLine::Cut() {
  {
    const std::lock_guard lock(mutex_);
    cut_ = true;
  }
  stream_->wire->Close({ErrorCode::kCellUnavailable, "the line is cut", {}});
}

void HostLine::Send(v1::HostRequest message) {
  {
    const std::lock_guard lock(mutex_);
    queue_.push_back(std::move(message));
  }
  to_send_.notify_one();
}

void HostLine::SendStatus(v1::MachineStatus status) {
  {
    const std::lock_guard lock(mutex_);
    if (queue_.empty() || !queue_.back().has_status()) queue_.emplace_back();
    *queue_.back().mutable_status() = std::move(status);
  }
  to_send_.notify_one();
}

void HostLine::Read() {
  while (std::optional<v1::HostResponse> message = stream_->wire->Next())
    heard_(*std::move(message));
  gone_();
}

void HostLine::Write() {
  std::int64_t heartbeats = 0;
  std::unique_lock lock(mutex_);
  for (;;) {
    to_send_.wait_for(lock, times_.heartbeat, [this] { return ending_ || !queue_.empty(); });
    if (ending_ && (queue_.empty() || cut_)) return;
    v1::HostRequest message;
    if (queue_.empty()) {
      message.mutable_heartbeat()->set_number(++heartbeats);
    } else {
      message = std::move(queue_.front());
      queue_.pop_front();
    }
    lock.unlock();
    const bool told = stream_->Tell(std::move(message));
    lock.lock();
    if (!told) return;
  }
}

}  // namespace rmlcell::server
