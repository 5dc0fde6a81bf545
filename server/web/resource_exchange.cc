#include "server/web/resource_exchange.h"

#include <google/protobuf/descriptor.h>

#include <atomic>
#include <utility>

#include "google/rpc/status.pb.h"
#include "server/web/rpc_codec.h"
#include "server/web/rpc_json.h"

namespace rmlcell::web {
namespace {

constexpr std::size_t kPieceBytes = std::size_t{64}
                                    << 10U;  // of a download, at most in memory at once

// Pictures and listings hold what a program wrote: they are shown without scripts, plugins or
// origin.
constexpr std::string_view kResourcePolicy =
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; frame-ancestors 'self'; sandbox";

HttpResponse ErrorAnswer(RpcStatus status) {
  return JsonRefusal({.status = std::move(status), .headers = {}}, false);
}

RpcStatus Thrown() {
  return FromError({ErrorCode::kCellInternal, "reading or writing a resource failed", {}});
}

using Run = std::function<void(std::function<void()>)>;

// Work on other threads, with its result back on the strand. Nothing that throws may end the
// process: a failure of one request is that request's.
template <class Value>
void RunAndReturn(const Run& run, const std::shared_ptr<Connection>& connection,
                  std::function<Value()> work, std::function<void(std::optional<Value>)> then) {
  run([connection, work = std::move(work), then = std::move(then)] {
    auto value = std::make_shared<std::optional<Value>>();
    try {
      value->emplace(work());
    } catch (const std::exception&) {  // there is no value
    }
    connection->Post([value, then] { then(std::move(*value)); });
  });
}

class Download : public Exchange, public std::enable_shared_from_this<Download> {
 public:
  Download(const Gateway& gateway, ResourcePath path, const HttpRequest& request,
           WebCallerMetadata caller, std::shared_ptr<Connection> connection)
      : gateway_(gateway),
        path_(std::move(path)),
        if_none_match_(request.Header("if-none-match")),
        head_only_(request.method == "HEAD"),
        caller_(std::move(caller)),
        connection_(std::move(connection)) {}

  // Closing may block, so it happens where reading does.
  ~Download() override {
    if (resource_.reader) {
      gateway_.run_blocking(
          [reader = std::shared_ptr<ResourceReader>(std::move(resource_.reader))] {});
    }
  }
  Download(const Download&) = delete;
  Download& operator=(const Download&) = delete;

  void Start() override {
    const auto self = shared_from_this();
    RunAndReturn<Result<Resource>>(
        gateway_.run_blocking, connection_,
        [self] { return self->gateway_.resources->Find(self->path_, self->caller_); },
        [self](std::optional<Result<Resource>> found) { self->TakeResource(std::move(found)); });
  }

  void OnTaken() override {
    const auto self = shared_from_this();
    RunAndReturn<Result<std::string>>(
        gateway_.run_blocking, connection_,
        [self] { return self->resource_.reader->Read(kPieceBytes); },
        [self](std::optional<Result<std::string>> piece) { self->TakePiece(std::move(piece)); });
  }

  void OnGone() override {
    gone_ = true;
    connection_.reset();
  }

 private:
  void Make(HttpResponse head) {
    const auto self = shared_from_this();
    RunAndReturn<Result<std::string>>(
        gateway_.run_computing, connection_,
        [self]() -> Result<std::string> {
          return self->gone_ ? Result(std::string()) : self->resource_.make();
        },
        [self, head = std::move(head)](std::optional<Result<std::string>> made) mutable {
          if (!self->connection_) return;
          if (!made || !*made)
            head = ErrorAnswer(made ? FromError(made->error()) : Thrown());
          else
            head.body = **std::move(made);
          std::exchange(self->connection_, nullptr)->Send(std::move(head));
        });
  }

  void TakeResource(std::optional<Result<Resource>> found) {
    if (found && *found) resource_ = **std::move(found);  // also for nobody: it is closed elsewhere
    if (!connection_) return;
    if (!found || !*found) {
      std::exchange(connection_, nullptr)
          ->Send(ErrorAnswer(found ? FromError(found->error()) : Thrown()));
      return;
    }
    HttpResponse head = Head();
    const bool known = !resource_.etag.empty() && EtagMatches(if_none_match_, resource_.etag);
    if (known) {
      head.status = 304;
      std::exchange(connection_, nullptr)->Send(std::move(head));
    } else if (resource_.make) {
      Make(std::move(head));
    } else if (!resource_.reader) {
      head.body = std::move(resource_.bytes);
      std::exchange(connection_, nullptr)->Send(std::move(head));
    } else if (head_only_) {
      head.length = static_cast<std::size_t>(resource_.size);
      std::exchange(connection_, nullptr)->Send(std::move(head));
    } else {
      head.length = static_cast<std::size_t>(resource_.size);
      left_ = resource_.size;
      connection_->Begin(std::move(head));
    }
  }

  HttpResponse Head() const {
    HttpResponse head;
    head.headers.emplace_back("Content-Type", resource_.media_type);
    if (!resource_.etag.empty()) head.headers.emplace_back("ETag", '"' + resource_.etag + '"');
    // The same URL may hold another program tomorrow: keep it, but ask each time.
    head.headers.emplace_back("Cache-Control", "private, no-cache");
    head.headers.emplace_back("X-Content-Type-Options", "nosniff");
    head.headers.emplace_back("Content-Security-Policy", kResourcePolicy);
    head.headers.emplace_back("Cross-Origin-Resource-Policy", "same-origin");
    if (!resource_.file_name.empty()) {
      const bool program = std::holds_alternative<ProgramContentPath>(path_);
      head.headers.emplace_back(
          "Content-Disposition",
          ContentDisposition(program ? "attachment" : "inline", resource_.file_name));
    }
    return head;
  }

  void TakePiece(std::optional<Result<std::string>> piece) {
    if (!connection_) return;
    const bool good = piece && *piece;
    const auto size = good ? static_cast<std::int64_t>((*piece)->size()) : 0;
    // The length was promised: neither more nor less can be sent.
    if (!good || size > left_ || (size == 0 && left_ > 0)) {
      std::exchange(connection_, nullptr)->Abort();
      return;
    }
    left_ -= size;
    if (size == 0) {
      std::exchange(connection_, nullptr)->Finish();
    } else {
      connection_->Write(**std::move(piece));
    }
  }

  const Gateway& gateway_;
  const ResourcePath path_;
  const std::string if_none_match_;
  const bool head_only_;
  const WebCallerMetadata caller_;
  std::shared_ptr<Connection> connection_;
  std::atomic<bool> gone_ = false;  // nobody waits for it any more
  Resource resource_;
  std::int64_t left_ = 0;
};

class Upload : public Exchange, public std::enable_shared_from_this<Upload> {
 public:
  Upload(const Gateway& gateway, UploadHeader header, WebCallerMetadata caller,
         std::shared_ptr<Connection> connection)
      : gateway_(gateway),
        header_(std::move(header)),
        caller_(std::move(caller)),
        connection_(std::move(connection)) {}

  // A sink that was not finished throws its bytes away, which may block.
  ~Upload() override {
    if (sink_) gateway_.run_blocking([sink = std::shared_ptr<UploadSink>(std::move(sink_))] {});
  }
  Upload(const Upload&) = delete;
  Upload& operator=(const Upload&) = delete;

  void Start() override {
    using Sink = std::unique_ptr<UploadSink>;
    const auto self = shared_from_this();
    RunAndReturn<Result<Sink>>(
        gateway_.run_blocking, connection_,
        [self] { return self->gateway_.resources->BeginUpload(self->header_, self->caller_); },
        [self](std::optional<Result<Sink>> sink) {
          if (sink && *sink) self->sink_ = **std::move(sink);  // likewise
          if (!self->connection_) return;
          if (!sink || !*sink) return self->Fail(sink ? FromError(sink->error()) : Thrown());
          self->connection_->ReadBody();
        });
  }

  void OnBody(std::string_view chunk, bool last) override {
    const auto self = shared_from_this();
    RunAndReturn<Status>(
        gateway_.run_blocking, connection_,
        [self, bytes = std::string(chunk)] {
          return bytes.empty() ? Status() : self->sink_->Append(bytes);
        },
        [self, last](std::optional<Status> taken) {
          if (!self->connection_) return;
          if (!taken || !*taken) return self->Fail(taken ? FromError(taken->error()) : Thrown());
          if (last) return self->End();
          self->connection_->ReadBody();
        });
  }

  void OnGone() override { connection_.reset(); }

 private:
  void End() {
    const auto self = shared_from_this();
    RunAndReturn<UploadEnd>(
        gateway_.run_blocking, connection_, [self] { return self->sink_->Finish(); },
        [self](std::optional<UploadEnd> end) {
          if (self->connection_) self->TakeEnd(std::move(end));
        });
  }

  void TakeEnd(std::optional<UploadEnd> end) {
    if (!end) return Fail(Thrown());
    if (!end->status.empty()) {
      google::rpc::Status rich;
      if (!rich.ParseFromString(end->status)) return Fail(Thrown());
      return Fail({.code = rich.code(), .message = rich.message(), .details = end->status});
    }
    const auto* type = google::protobuf::DescriptorPool::generated_pool()->FindMessageTypeByName(
        end->message_type);
    if (type == nullptr) return Fail(Thrown());
    Result<JsonMessage> message = BytesToJson(*type, end->message);
    if (!message) return Fail(FromError(message.error()));
    HttpResponse response;
    AddNoCache(response);
    response.headers.emplace_back("Content-Type", "application/json");
    response.body = std::move(message->json);
    std::exchange(connection_, nullptr)->Send(std::move(response));
  }

  void Fail(RpcStatus status) {
    std::exchange(connection_, nullptr)->Send(ErrorAnswer(std::move(status)));
  }

  const Gateway& gateway_;
  const UploadHeader header_;
  const WebCallerMetadata caller_;
  std::shared_ptr<Connection> connection_;
  std::unique_ptr<UploadSink> sink_;
};

}  // namespace

std::shared_ptr<Exchange> MakeDownload(const Gateway& gateway, const ResourcePath& path,
                                       const HttpRequest& request, WebCallerMetadata caller,
                                       std::shared_ptr<Connection> connection) {
  return std::make_shared<Download>(gateway, path, request, std::move(caller),
                                    std::move(connection));
}

std::shared_ptr<Exchange> MakeUpload(const Gateway& gateway, UploadHeader header,
                                     WebCallerMetadata caller,
                                     std::shared_ptr<Connection> connection) {
  return std::make_shared<Upload>(gateway, std::move(header), std::move(caller),
                                  std::move(connection));
}

}  // namespace rmlcell::web
