#include "server/host/host_line.h"

#include <grpcpp/grpcpp.h>

#include <utility>

#include "proto/bridge/standard_words.h"
#include "rmlcell/v1/host.grpc.pb.h"
#include "server/base/credentials.h"

namespace rmlcell::server {
namespace {

constexpr std::chrono::seconds kConnectPatience{5};
constexpr int kAgain_ms = 100;

ErrorCode CodeOf(const grpc::Status& status) {
  switch (status.error_code()) {
    case grpc::StatusCode::UNAUTHENTICATED:
      return ErrorCode::kCellJoinRefused;
    case grpc::StatusCode::ABORTED:
      return ErrorCode::kCellMachineTaken;
    case grpc::StatusCode::NOT_FOUND:
      return ErrorCode::kCellUnknownMachine;
    case grpc::StatusCode::FAILED_PRECONDITION:
      return ErrorCode::kCellVersionMismatch;
    default:
      return ErrorCode::kCellUnavailable;
  }
}

// A server that hangs is as good as none.
class CancelLate {
 public:
  explicit CancelLate(grpc::ClientContext& context)
      : thread_([this, &context] {
          std::unique_lock lock(mutex_);
          if (!answered_.wait_for(lock, kConnectPatience, [this] { return over_; }))
            context.TryCancel();
        }) {}
  ~CancelLate() {
    {
      const std::lock_guard lock(mutex_);
      over_ = true;
    }
    answered_.notify_one();
    thread_.join();
  }
  CancelLate(const CancelLate&) = delete;
  CancelLate& operator=(const CancelLate&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable answered_;
  bool over_ = false;   // guarded by mutex_
  std::thread thread_;  // the last member: it begins with the others made
};

}  // namespace

struct HostLine::Stream {
  std::shared_ptr<grpc::Channel> channel;
  std::unique_ptr<v1::HostService::Stub> stub;
  grpc::ClientContext context;
  std::unique_ptr<grpc::ClientReaderWriter<v1::HostRequest, v1::HostResponse>> line;
};

HostLine::HostLine(const LineTimes& times) : times_(times), stream_(std::make_unique<Stream>()) {}

Result<HostLine::Welcome> HostLine::Join(const std::string& server, const v1::HostHello& hello,
                                         std::function<void(v1::HostResponse)> heard,
                                         std::function<void()> gone, const LineTimes& times) {
  std::unique_ptr<HostLine> made(new HostLine(times));
  made->heard_ = std::move(heard);
  made->gone_ = std::move(gone);
  Stream& stream = *made->stream_;
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  // A server that was started again is found at once.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, kAgain_ms);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, kAgain_ms);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, kAgain_ms);
  // Nothing large comes here, and each message would be asked about by a ping.
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  stream.channel = grpc::CreateCustomChannel(server, CredentialsOfChannel(), arguments);
  if (!stream.channel->WaitForConnected(std::chrono::system_clock::now() + kConnectPatience))
    return Error{ErrorCode::kCellUnavailable, "no server answers at " + server, {}};
  stream.stub = v1::HostService::NewStub(stream.channel);
  stream.line = stream.stub->Host(&stream.context);
  v1::HostRequest request;
  *request.mutable_hello() = hello;
  v1::HostResponse answer;
  bool welcomed = false;
  {
    const CancelLate late(stream.context);
    welcomed = stream.line->Write(request) && stream.line->Read(&answer) && answer.has_welcome();
  }
  if (!welcomed) {
    stream.line->WritesDone();
    const grpc::Status status = stream.line->Finish();
    return Error{CodeOf(status), status.error_message(), {}};
  }
  Welcome welcome{.message = std::move(*answer.mutable_welcome()), .line = nullptr};
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
  bool written = false;
  {
    std::unique_lock lock(mutex_);
    written = to_send_.wait_for(lock, times_.last_words, [this] { return written_all_ || cut_; });
  }
  if (!written) stream_->context.TryCancel();
  writer_.join();
  if (written && !cut_) {
    stream_->line->WritesDone();
    // What was sent last is lost where the line is cut before the server has taken it.
    std::unique_lock lock(mutex_);
    to_send_.wait_for(lock, times_.last_words, [this] { return read_all_; });
  }
  stream_->context.TryCancel();
  reader_.join();
  static_cast<void>(stream_->line->Finish());
}

void HostLine::Cut() {
  {
    const std::lock_guard lock(mutex_);
    cut_ = true;
  }
  stream_->context.TryCancel();
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
  v1::HostResponse message;
  while (stream_->line->Read(&message)) {
    answers_ = answers_ || (message.has_heartbeat() && message.heartbeat().number() == 0);
    heard_(std::move(message));
  }
  gone_();
  const std::lock_guard lock(mutex_);
  read_all_ = true;
  to_send_.notify_all();
}

void HostLine::Write() {
  using Clock = std::chrono::steady_clock;
  std::int64_t heartbeats = 0;
  bool rests = false;  // as the server was told last
  Clock::time_point next_heartbeat = Clock::now() + times_.heartbeat;
  std::unique_lock lock(mutex_);
  for (;;) {
    to_send_.wait_until(lock, next_heartbeat, [this] { return ending_ || !queue_.empty(); });
    // What was queued goes out also at the end.
    if (ending_ && queue_.empty()) break;
    v1::HostRequest message;
    // Beside all that is told: the server answers it, and so shows that it is there.
    if (queue_.empty() || Clock::now() >= next_heartbeat) {
      next_heartbeat = Clock::now() + (rests ? times_.heartbeat_at_rest : times_.heartbeat);
      message.mutable_heartbeat()->set_number(++heartbeats);
    } else {
      message = std::move(queue_.front());
      queue_.pop_front();
    }
    if (message.has_status()) {
      const bool rested = std::exchange(rests, bridge::IsAtRest(message.status().state()));
      // A server that does not know a status for a heartbeat gets one.
      if (rests || rested)
        next_heartbeat =
            Clock::now() +
            (rests && answers_.exchange(false) ? times_.heartbeat_at_rest : Clock::duration(0));
    }
    lock.unlock();
    const bool sent = stream_->line->Write(message);
    lock.lock();
    if (!sent) break;
  }
  written_all_ = true;
  to_send_.notify_all();
}

}  // namespace rmlcell::server
