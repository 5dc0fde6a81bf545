// gRPC-Web, binary and text: the HTTP status is always 200, the outcome stands in a last frame of
// trailers.
#include <google/protobuf/descriptor.h>

#include "server/web/base64.h"
#include "server/web/envelope.h"
#include "server/web/rpc_codec.h"

namespace rmlcell::web {
namespace {

class GrpcWeb : public RpcCodec {
 public:
  explicit GrpcWeb(const RpcRoute& route)
      : text_(route.wire == Wire::kGrpcWebText),
        streams_(route.method != nullptr && route.method->server_streaming()) {}

  bool streams() const override { return streams_; }

  HttpResponse Head() const override {
    HttpResponse response;
    AddNoCache(response);
    response.headers.emplace_back(
        "Content-Type", text_ ? "application/grpc-web-text+proto" : "application/grpc-web+proto");
    return response;
  }

  Result<std::string> Message(std::string_view bytes) override {
    return Coded(MakeEnvelope(0, bytes));
  }

  std::string End(const RpcStatus& status, const HeaderList& trailers) override {
    return Coded(MakeEnvelope(kGrpcWebTrailers, TrailerBlock(status, trailers)));
  }

  HttpResponse Whole(const RpcStatus& status, std::string_view bytes, const HeaderList& headers,
                     const HeaderList& trailers) override {
    HttpResponse response = Head();
    response.headers.insert(response.headers.end(), headers.begin(), headers.end());
    // One piece of base64 for both frames: some readers stop at the first padding.
    std::string body = status.ok() ? MakeEnvelope(0, bytes) : std::string();
    body += MakeEnvelope(kGrpcWebTrailers, TrailerBlock(status, trailers));
    response.body = Coded(std::move(body));
    return response;
  }

  HttpResponse Refusal(const RpcRefusal& refusal) override {
    return Whole(refusal.status, {}, {}, {});
  }

 private:
  std::string Coded(std::string frames) const { return text_ ? Base64(frames, true) : frames; }

  static std::string TrailerBlock(const RpcStatus& status, const HeaderList& trailers) {
    std::string block = "grpc-status: " + std::to_string(status.code) + "\r\n";
    if (!status.message.empty()) {
      block += "grpc-message: " + EncodeGrpcMessage(status.message) + "\r\n";
    }
    if (!status.details.empty()) {
      block += "grpc-status-details-bin: " + Base64(status.details, false) + "\r\n";
    }
    for (const auto& [name, value] : trailers) block += name + ": " + value + "\r\n";
    return block;
  }

  bool text_;
  bool streams_;
};

}  // namespace

std::unique_ptr<RpcCodec> MakeGrpcWeb(const RpcRoute& route) {
  return std::make_unique<GrpcWeb>(route);
}

}  // namespace rmlcell::web
