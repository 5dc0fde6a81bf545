#include "server/web/rpc_exchange.h"

#include <google/protobuf/descriptor.h>

#include <deque>
#include <utility>

#include "server/web/rpc_call.h"
#include "server/web/rpc_codec.h"

namespace rmlcell::web {
namespace {

class RpcExchange : public Exchange, public std::enable_shared_from_this<RpcExchange> {
 public:
  RpcExchange(const Gateway& gateway, const RpcRoute& route, const HttpRequest& request,
              HeaderList metadata, std::shared_ptr<Connection> connection)
      : gateway_(gateway),
        route_(route),
        request_(request),
        metadata_(std::move(metadata)),
        codec_(MakeCodec(route, *gateway.event_texts)),
        streams_(codec_->streams()),
        connection_(std::move(connection)) {}

  void Start() override {
    RpcDecoding decoding = DecodeRpc(route_, request_);
    if (!decoding.status.ok()) {
      Take()->Send(codec_->Refusal({.status = std::move(decoding.status), .headers = {}}));
      return;
    }
    RpcCallSpec spec{.method = request_.path,
                     .message = codec_->Asked(std::move(decoding.request.message)),
                     .metadata = std::move(metadata_),
                     .timeout = decoding.request.timeout};
    const std::shared_ptr<RpcExchange> self = shared_from_this();
    call_ = RpcCall::Start(
        gateway_.channel, std::move(spec),
        {.on_message = [self](std::string bytes) { self->OnMessage(std::move(bytes)); },
         .on_end = [self](RpcCallEnd end) { self->OnEnd(std::move(end)); }});
    if (streams_) {
      Queue(Kind::kHead, {});  // at once, so that the client knows its stream is open
    } else {
      call_->ReadNext();
    }
  }

  void OnTaken() override {
    const Kind taken = writing_;
    writing_ = Kind::kNothing;
    if (taken == Kind::kEnd) {
      Take()->Finish();
      return;
    }
    if (call_ && (taken == Kind::kHead || taken == Kind::kMessage)) call_->ReadNext();
    WriteNext();
  }

  void OnQuiet() override {
    if (streams_ && writing_ == Kind::kNothing && queue_.empty() && !codec_->Quiet().empty()) {
      Queue(Kind::kQuiet, std::string(codec_->Quiet()));
    }
  }

  bool IsEndless() const override { return streams_; }

  void OnGone() override {
    if (call_) call_->Cancel();
    Take();
  }

 private:
  enum class Kind { kNothing, kHead, kMessage, kQuiet, kEnd };
  struct Piece {
    Kind kind;
    std::string bytes;
  };

  // The connection, which is not needed any more after this use.
  std::shared_ptr<Connection> Take() { return std::exchange(connection_, nullptr); }

  // On gRPC's threads, one at a time: texts are made here, so that long messages do not hold up
  // other connections. What a unary call keeps is touched by these two alone.
  void OnMessage(std::string bytes) {
    if (!streams_) {
      second_answer_ = answer_.has_value();
      answer_ = std::move(bytes);
      call_->ReadNext();
      return;
    }
    Result<std::string> piece = codec_->Message(bytes);
    Post([self = shared_from_this(), piece = std::move(piece)]() mutable {
      self->TakePiece(std::move(piece));
    });
  }

  void OnEnd(RpcCallEnd end) {
    if (streams_) {
      Post([self = shared_from_this(), end = std::move(end)] { self->TakeEnd(end); });
      return;
    }
    if (end.status.ok() && (!answer_ || second_answer_)) {
      end.status =
          FromError({ErrorCode::kCellInternal, "a unary method gave none or two answers", {}});
    }
    HttpResponse response =
        codec_->Whole(end.status, answer_.value_or(std::string()), end.headers, end.trailers);
    Post([self = shared_from_this(), response = std::move(response)]() mutable {
      self->call_.reset();
      if (self->connection_) self->Take()->Send(std::move(response));
    });
  }

  void Post(std::function<void()> work) {
    poster_->Post(std::move(work));  // not connection_: that one belongs to the strand
  }

  void TakePiece(Result<std::string> piece) {
    if (!connection_) return;
    if (piece) return Queue(Kind::kMessage, *std::move(piece));
    failure_ = FromError(piece.error());
    call_->Cancel();
  }

  void TakeEnd(const RpcCallEnd& end) {
    call_.reset();
    if (connection_)
      Queue(Kind::kEnd, codec_->End(failure_ ? *failure_ : end.status, end.trailers));
  }

  // Holds at most the head, one message, one comment and the end.
  void Queue(Kind kind, std::string bytes) {
    queue_.push_back({kind, std::move(bytes)});
    WriteNext();
  }

  void WriteNext() {
    if (writing_ != Kind::kNothing || queue_.empty()) return;
    Piece piece = std::move(queue_.front());
    queue_.pop_front();
    writing_ = piece.kind;
    if (piece.kind == Kind::kHead) {
      connection_->Begin(codec_->Head());
    } else {
      connection_->Write(std::move(piece.bytes));
    }
  }

  const Gateway& gateway_;
  const RpcRoute route_;
  const HttpRequest& request_;
  HeaderList metadata_;
  std::unique_ptr<RpcCodec> codec_;
  const bool streams_;
  std::shared_ptr<Connection> connection_;  // empty: the exchange is over
  const std::shared_ptr<Connection> poster_ = connection_;
  std::shared_ptr<RpcCall> call_;  // empty: not begun, or ended
  std::deque<Piece> queue_;
  Kind writing_ = Kind::kNothing;
  std::optional<std::string> answer_;  // of a unary call
  bool second_answer_ = false;
  std::optional<RpcStatus> failure_;  // ours, in place of the call's own end
};

}  // namespace

std::shared_ptr<Exchange> MakeRpcExchange(const Gateway& gateway, const RpcRoute& route,
                                          const HttpRequest& request, HeaderList metadata,
                                          std::shared_ptr<Connection> connection) {
  return std::make_shared<RpcExchange>(gateway, route, request, std::move(metadata),
                                       std::move(connection));
}

}  // namespace rmlcell::web
