#include "server/worker/server_line.h"

#include <google/protobuf/util/time_util.h>
#include <grpcpp/grpcpp.h>
#include <unistd.h>

#include "rmlcell/v1/worker.grpc.pb.h"
#include "server/base/credentials.h"
#include "server/base/version.h"

namespace rmlcell::server {
namespace {

constexpr std::chrono::seconds kConnectPatience{5};
// The server may send programs of 256 MiB; while nobody takes them off the reader stops reading,
// and the flow control of the connection holds the rest back.
constexpr std::size_t kInboxMax = 64;
constexpr std::size_t kInboxBytesMax = 1 << 20;

}  // namespace

struct ServerLine::Stream {
  std::shared_ptr<grpc::Channel> channel;
  std::unique_ptr<v1::WorkerService::Stub> stub;
  grpc::ClientContext context;
  std::unique_ptr<grpc::ClientReaderWriter<v1::WorkRequest, v1::WorkResponse>> line;
};

ServerLine::ServerLine() : stream_(std::make_unique<Stream>()) {}

Result<std::unique_ptr<ServerLine>> ServerLine::Join(const Options& options) {
  std::unique_ptr<ServerLine> made(new ServerLine());
  Stream& stream = *made->stream_;
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  // The window of a connection would grow to megabytes for programs that are read more slowly.
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  stream.channel = grpc::CreateCustomChannel(options.server, CredentialsOfChannel(), arguments);
  if (!stream.channel->WaitForConnected(std::chrono::system_clock::now() + kConnectPatience)) {
    return Error{ErrorCode::kCellUnavailable, "no server answers at " + options.server, {}};
  }
  stream.stub = v1::WorkerService::NewStub(stream.channel);
  stream.line = stream.stub->Work(&stream.context);
  v1::WorkRequest message;
  v1::WorkerHello& hello = *message.mutable_hello();
  hello.set_join_token(options.join_token);
  hello.set_worker(options.name);
  hello.set_version(std::string(kVersion));
  hello.add_kinds(v1::JOB_KIND_CHECK);
  hello.add_kinds(v1::JOB_KIND_SIMULATE);
  hello.set_process_id(::getpid());
  hello.set_pool(options.pool);
  v1::WorkResponse answer;
  if (!stream.line->Write(message) || !stream.line->Read(&answer) || !answer.has_welcome()) {
    const grpc::Status status = stream.line->Finish();
    const ErrorCode code = status.error_code() == grpc::StatusCode::UNAUTHENTICATED
                               ? ErrorCode::kCellJoinRefused
                           : status.error_code() == grpc::StatusCode::FAILED_PRECONDITION
                               ? ErrorCode::kCellVersionMismatch
                               : ErrorCode::kCellUnavailable;
    return Error{code, status.error_message(), {}};
  }
  made->lease_ms_ =
      google::protobuf::util::TimeUtil::DurationToMilliseconds(answer.welcome().lease());
  made->events_window_ = answer.welcome().events_window();
  made->reader_ = std::thread([line = made.get()] {
    v1::WorkResponse response;
    while (line->stream_->line->Read(&response)) {
      std::unique_lock lock(line->mutex_);
      line->arrived_.wait(lock, [line] {
        return (line->inbox_.size() < kInboxMax && line->inbox_bytes_ < kInboxBytesMax) ||
               line->gone_;
      });
      line->inbox_bytes_ += response.blob().chunk().size();
      line->inbox_.push_back(std::move(response));
      line->arrived_.notify_all();
    }
    const std::lock_guard lock(line->mutex_);
    line->gone_ = true;
    line->arrived_.notify_all();
  });
  return made;
}

ServerLine::~ServerLine() {
  if (!reader_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    gone_ = true;
    arrived_.notify_all();
  }
  stream_->context.TryCancel();
  reader_.join();
  (void)stream_->line->Finish();
}

std::optional<v1::WorkResponse> ServerLine::Receive(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  if (!arrived_.wait_for(lock, patience, [this] { return !inbox_.empty() || gone_; }))
    return std::nullopt;
  if (inbox_.empty()) return std::nullopt;
  v1::WorkResponse message = std::move(inbox_.front());
  inbox_.pop_front();
  inbox_bytes_ -= message.blob().chunk().size();
  arrived_.notify_all();
  return message;
}

bool ServerLine::gone() const {
  const std::lock_guard lock(mutex_);
  return gone_ && inbox_.empty();
}

bool ServerLine::Send(const v1::WorkRequest& message) {
  const std::lock_guard lock(sending_);
  return stream_->line->Write(message);
}

void ServerLine::Close() { stream_->line->WritesDone(); }

}  // namespace rmlcell::server
