// Connect: unary calls as plain JSON or binary, server streams in envelopes.
#include <google/protobuf/descriptor.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "server/web/envelope.h"
#include "server/web/rpc_codec.h"
#include "server/web/rpc_json.h"

namespace rmlcell::web {
namespace {

class ConnectUnary : public RpcCodec {
 public:
  explicit ConnectUnary(const RpcRoute& route) : route_(route) {}

  bool streams() const override { return false; }
  HttpResponse Head() const override { return {}; }
  Result<std::string> Message(std::string_view bytes) override { return std::string(bytes); }
  std::string End(const RpcStatus&, const HeaderList&) override { return {}; }

  HttpResponse Whole(const RpcStatus& status, std::string_view bytes, const HeaderList& headers,
                     const HeaderList& trailers) override {
    HttpResponse response = status.ok() ? Good(bytes) : Refusal({.status = status, .headers = {}});
    response.headers.insert(response.headers.end(), headers.begin(), headers.end());
    for (const auto& [name, value] : trailers)
      response.headers.emplace_back("trailer-" + name, value);
    return response;
  }

  HttpResponse Refusal(const RpcRefusal& refusal) override {
    return JsonRefusal(refusal, route_.connect_client || route_.wire == Wire::kConnectProto);
  }

 private:
  HttpResponse Good(std::string_view bytes) {
    HttpResponse response;
    AddNoCache(response);
    if (route_.wire == Wire::kConnectProto) {
      response.headers.emplace_back("Content-Type", "application/proto");
      response.body = std::string(bytes);
      return response;
    }
    Result<JsonMessage> message = BytesToJson(*route_.method->output_type(), bytes);
    if (!message) return Refusal({.status = FromError(message.error()), .headers = {}});
    response.headers.emplace_back("Content-Type", "application/json");
    response.body = std::move(message->json);
    return response;
  }

  RpcRoute route_;
};

// {"name":["value","value"]}: values of one name stand together, in the order of their first one.
std::string MetadataJson(const HeaderList& headers) {
  std::vector<std::pair<std::string, std::string>> groups;
  for (const auto& [name, value] : headers) {
    auto group = std::ranges::find(groups, name, &std::pair<std::string, std::string>::first);
    if (group == groups.end()) group = groups.emplace(groups.end(), name, std::string());
    if (!group->second.empty()) group->second += ',';
    group->second += JsonString(value);
  }
  std::string json = "{";
  for (const auto& [name, values] : groups) {
    if (json.size() > 1) json += ',';
    json += JsonString(name);
    json += ":[";
    json += values;
    json += ']';
  }
  json += '}';
  return json;
}

class ConnectStream : public RpcCodec {
 public:
  explicit ConnectStream(const RpcRoute& route) : route_(route) {}

  bool streams() const override { return true; }

  HttpResponse Head() const override {
    HttpResponse response;
    AddNoCache(response);
    response.headers.emplace_back("Content-Type", route_.wire == Wire::kConnectStreamJson
                                                      ? "application/connect+json"
                                                      : "application/connect+proto");
    return response;
  }

  Result<std::string> Message(std::string_view bytes) override {
    if (route_.wire == Wire::kConnectStreamProto) return MakeEnvelope(0, bytes);
    const Result<JsonMessage> message = BytesToJson(*route_.method->output_type(), bytes);
    if (!message) return message.error();
    return MakeEnvelope(0, message->json);
  }

  std::string End(const RpcStatus& status, const HeaderList& trailers) override {
    std::string json = "{";
    if (!status.ok()) json += "\"error\":" + ConnectErrorJson(status);
    if (!trailers.empty()) {
      if (!status.ok()) json += ',';
      json += "\"metadata\":" + MetadataJson(trailers);
    }
    return MakeEnvelope(kConnectEndStream, json + "}");
  }

  HttpResponse Whole(const RpcStatus& status, std::string_view, const HeaderList&,
                     const HeaderList&) override {
    return Refusal({.status = status, .headers = {}});
  }

  // In this form the HTTP status is always 200; the error is in the last envelope.
  HttpResponse Refusal(const RpcRefusal& refusal) override {
    HttpResponse response = Head();
    response.body = End(refusal.status, {});
    return response;
  }

 private:
  RpcRoute route_;
};

}  // namespace

std::unique_ptr<RpcCodec> MakeConnectUnary(const RpcRoute& route) {
  return std::make_unique<ConnectUnary>(route);
}

std::unique_ptr<RpcCodec> MakeConnectStream(const RpcRoute& route) {
  return std::make_unique<ConnectStream>(route);
}

}  // namespace rmlcell::web
