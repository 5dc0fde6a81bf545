// Which call a request means, and with what deadline and message: tables of paths, types and
// headers.
#include "server/web/rpc_request.h"

#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include <cctype>
#include <string_view>

#include "rmlcell/v1/job.pb.h"
#include "server/web/base64.h"
#include "server/web/envelope.h"

namespace rmlcell::web {
namespace {

constexpr std::string_view kGet = "/rmlcell.v1.JobService/GetJob";
constexpr std::string_view kStream = "/rmlcell.v1.JobService/WatchJob";

HttpRequest RequestFor(std::string method, std::string_view path, HeaderList headers = {},
                       std::string query = {}, std::string body = {}) {
  HttpRequest request;
  request.method = std::move(method);
  request.path = std::string(path);
  request.headers = std::move(headers);
  request.query = std::move(query);
  request.body = std::move(body);
  return request;
}

TEST(MethodPaths, AServiceWithADotAndAMethod) {
  for (const std::string_view path :
       {"/a.b/C", "/a.B_9/z_0Z", "/A.z/_", "/rmlcell.v1.JobService/GetJob"}) {
    EXPECT_TRUE(LooksLikeMethod(path)) << path;
  }
  for (const std::string_view path :
       {"", "/", "a.b/C", "/a.b", "/a.b/", "/ab/C", "/a.b/C/", "/a.b/C/D", "/a-b.c/D", "/a.b/C-",
        "/a.b/C.D", "//C", "/a.`/C", "/a.{/C", "/a.@/C", "/a.[/C", "/a.:/C", "/a.//C"}) {
    EXPECT_FALSE(LooksLikeMethod(path)) << path;
  }
}

// What changes nothing begins with a word that says so, or is a stream from the server.
TEST(MethodPaths, GetCallsOnlyWhatChangesNothing) {
  for (const std::string service :
       {"JobService", "MachineService", "ProgramService", "ProjectService", "AccountService"}) {
    const auto* descriptor = google::protobuf::DescriptorPool::generated_pool()->FindServiceByName(
        "rmlcell.v1." + service);
    if (descriptor == nullptr) continue;
    for (int i = 0; i < descriptor->method_count(); ++i) {
      const auto& method = *descriptor->method(i);
      if (method.client_streaming()) continue;
      bool reads = method.server_streaming();
      for (const std::string_view word : {"Get", "List", "Watch", "Stream", "Explain"}) {
        reads = reads ||
                (method.name().starts_with(word) && std::isupper(method.name()[word.size()]) != 0);
      }
      const std::string path = "/rmlcell.v1." + service + "/" + method.name();
      const RpcRouting get = RouteRpc(RequestFor("GET", path));
      EXPECT_EQ(!get.refusal.has_value(), reads) << path;
      if (get.refusal) {
        EXPECT_EQ(get.refusal->http_status, 405);
        EXPECT_EQ(get.refusal->status.code, kCodeUnimplemented);
        EXPECT_TRUE(get.refusal->status.message.starts_with("CELL-E9014: ")) << path;
        EXPECT_EQ(get.refusal->headers, (HeaderList{{"Allow", "POST"}}));
      }
      const RpcRouting put = RouteRpc(RequestFor("PUT", path));
      ASSERT_TRUE(put.refusal) << path;
      EXPECT_EQ(put.refusal->http_status, 405);
      EXPECT_EQ(put.refusal->headers, (HeaderList{{"Allow", reads ? "GET, POST" : "POST"}}));
    }
  }
}

// Such a word is a whole one: it ends where the name does, or another begins. What goes on may
// change something.
TEST(MethodPaths, GetCallsByWholeWordsOnly) {
  for (const std::string_view reads :
       {"Get", "GetRow", "GetZero", "List", "ListAny", "WatchJob", "StreamJob", "Explain"}) {
    EXPECT_TRUE(OnlyReads(reads)) << reads;
  }
  for (const std::string_view other :
       {"", "Ge", "Getaway", "Get_row", "Get9", "Get[", "Get@", "Listen", "Watched", "Explained",
        "Streamline", "Forget", "Unlisted", "getRow"}) {
    EXPECT_FALSE(OnlyReads(other)) << other;
  }
}

// platform.md section 3: the forms by content type, for calls and for streams; nothing: refused.
TEST(Wires, ByContentType) {
  struct Row {
    std::string type;
    std::optional<Wire> call;
    std::optional<Wire> stream;
  };
  const std::vector<Row> rows = {
      {"application/json", Wire::kConnectJson, Wire::kEvents},
      {"application/json; charset=utf-8", Wire::kConnectJson, Wire::kEvents},
      {"application/json;charset=\"UTF-8\"; x=y", Wire::kConnectJson, Wire::kEvents},
      {"application/json; charset=utf8", Wire::kConnectJson, Wire::kEvents},
      {"application/json; charset=latin1", {}, {}},
      {"application/proto", Wire::kConnectProto, {}},
      {"application/connect+json", {}, Wire::kConnectStreamJson},
      {"application/connect+proto", {}, Wire::kConnectStreamProto},
      {"application/grpc-web", Wire::kGrpcWeb, Wire::kGrpcWeb},
      {"application/grpc-web+proto", Wire::kGrpcWeb, Wire::kGrpcWeb},
      {"application/grpc-web-text", Wire::kGrpcWebText, Wire::kGrpcWebText},
      {"application/grpc-web-text+proto", Wire::kGrpcWebText, Wire::kGrpcWebText},
      {"application/grpc", {}, {}},
      {"application/grpc+proto", {}, {}},
      {"text/plain", {}, {}},
      {"", {}, {}}};
  for (const Row& row : rows) {
    for (const bool stream : {false, true}) {
      const RpcRouting routing =
          RouteRpc(RequestFor("POST", stream ? kStream : kGet, {{"content-type", row.type}}));
      const std::optional<Wire> wanted = stream ? row.stream : row.call;
      EXPECT_EQ(!routing.refusal.has_value(), wanted.has_value()) << row.type << stream;
      if (wanted && !routing.refusal) {
        EXPECT_EQ(routing.route.wire, *wanted) << row.type << stream;
        EXPECT_EQ(routing.route.method->name(), stream ? "WatchJob" : "GetJob");
      }
      if (!wanted && routing.refusal) {
        EXPECT_EQ(routing.refusal->http_status, 415) << row.type;
        EXPECT_EQ(routing.refusal->status.code, kCodeInvalidArgument) << row.type;
        EXPECT_TRUE(routing.refusal->status.message.starts_with("CELL-E9003: ")) << row.type;
        EXPECT_EQ(routing.refusal->headers.front().first, "Accept-Post");
      }
    }
  }
}

// Why a type is not taken is said so that a developer can mend it.
TEST(Wires, ARefusalSaysWhatToUse) {
  const auto message = [](std::string_view path, std::string type) {
    return RouteRpc(RequestFor("POST", path, {{"content-type", std::move(type)}}))
        .refusal->status.message;
  };
  EXPECT_NE(message(kGet, "").find("needs a Content-Type"), std::string::npos);
  EXPECT_NE(message(kGet, "application/grpc").find("plain gRPC"), std::string::npos);
  EXPECT_NE(message(kGet, "application/grpc+json").find("plain gRPC"), std::string::npos);
  EXPECT_NE(message(kStream, "application/proto").find("WatchJob is a stream"), std::string::npos);
  EXPECT_NE(message(kGet, "application/connect+json").find("GetJob is no stream"),
            std::string::npos);
  EXPECT_NE(message(kGet, "text/plain").find("content type text/plain"), std::string::npos);
}

TEST(Wires, EventsAreAskedForByAccept) {
  const HeaderList events = {{"accept", "text/event-stream"}};
  EXPECT_EQ(RouteRpc(RequestFor("GET", kGet)).route.wire, Wire::kConnectJson);
  EXPECT_EQ(RouteRpc(RequestFor("GET", kGet, events)).route.wire, Wire::kEvents);
  EXPECT_EQ(RouteRpc(RequestFor("GET", kStream)).route.wire, Wire::kEvents);
  EXPECT_EQ(RouteRpc(RequestFor("GET", kGet, {}, "encoding=proto")).route.wire,
            Wire::kConnectProto);
  EXPECT_EQ(RouteRpc(RequestFor("GET", kGet, {}, "encoding=json")).route.wire, Wire::kConnectJson);
  EXPECT_EQ(RouteRpc(RequestFor("GET", kStream, {}, "encoding=proto")).route.wire, Wire::kEvents);
  HeaderList posted = events;
  posted.emplace_back("content-type", "application/json");
  EXPECT_EQ(RouteRpc(RequestFor("POST", kGet, posted)).route.wire, Wire::kEvents);
  EXPECT_FALSE(RouteRpc(RequestFor("GET", kGet)).route.connect_client);
  EXPECT_TRUE(RouteRpc(RequestFor("GET", kGet, {}, "connect=v1")).route.connect_client);
  EXPECT_TRUE(
      RouteRpc(RequestFor("PUT", kGet, {{"connect-protocol-version", "1"}})).route.connect_client);
}

class Decoding : public ::testing::Test {
 protected:
  static RpcDecoding Decode(const HttpRequest& request) {
    const RpcRouting routing = RouteRpc(request);
    EXPECT_FALSE(routing.refusal) << request.path;
    return DecodeRpc(routing.route, request);
  }
  static RpcDecoding Posted(std::string type, HeaderList headers, std::string body,
                            std::string_view path = kGet) {
    headers.emplace_back("content-type", std::move(type));
    return Decode(RequestFor("POST", path, std::move(headers), {}, std::move(body)));
  }
  static std::string NameIn(const RpcDecoding& decoding) {
    v1::GetJobRequest request;
    EXPECT_TRUE(decoding.status.ok()) << decoding.status.message;
    EXPECT_TRUE(request.ParseFromString(decoding.request.message));
    return request.name();
  }
  static std::string Bytes(const std::string& name) {
    v1::GetJobRequest request;
    request.set_name(name);
    return request.SerializeAsString();
  }
};

TEST_F(Decoding, OfEachForm) {
  const std::string bytes = Bytes("jobs/7");
  EXPECT_EQ(NameIn(Posted("application/json", {}, R"({"name":"jobs/7"})")), "jobs/7");
  EXPECT_EQ(NameIn(Posted("application/json", {}, "")), "");
  EXPECT_EQ(NameIn(Posted("application/proto", {}, bytes)), "jobs/7");
  EXPECT_EQ(NameIn(Posted("application/grpc-web", {}, MakeEnvelope(0, bytes))), "jobs/7");
  EXPECT_EQ(NameIn(Posted("application/grpc-web-text", {}, Base64(MakeEnvelope(0, bytes), true))),
            "jobs/7");
  EXPECT_EQ(NameIn(Posted("application/connect+proto", {}, MakeEnvelope(0, bytes), kStream)),
            "jobs/7");
  EXPECT_EQ(NameIn(Posted("application/connect+json", {}, MakeEnvelope(0, R"({"name":"jobs/7"})"),
                          kStream)),
            "jobs/7");
  const auto get = [](std::string query) {
    return Decode(RequestFor("GET", kGet, {}, std::move(query)));
  };
  EXPECT_EQ(NameIn(get("message={%22name%22:%22jobs/7%22}")), "jobs/7");
  EXPECT_EQ(NameIn(get("message=" + Base64(R"({"name":"jobs/7"})", false) + "&base64=1")),
            "jobs/7");
  EXPECT_EQ(NameIn(get("encoding=proto&base64=1&message=" + Base64(bytes, false))), "jobs/7");
  EXPECT_EQ(NameIn(get("compression=identity&encoding=json&message={%22name%22:%22a%22}")), "a");
  EXPECT_EQ(NameIn(get("compression=")), "");
  EXPECT_EQ(NameIn(get("base64=0&message={}")), "");
}

// What cannot be decoded: the code says whether it is wrong (3) or not offered (12).
TEST_F(Decoding, OfWhatIsNone) {
  const auto code = [](const RpcDecoding& decoding) { return decoding.status.code; };
  const auto get = [](std::string query) {
    return Decode(RequestFor("GET", kGet, {}, std::move(query)));
  };
  for (const std::string query :
       {"message=%", "base64=%", "encoding=%", "compression=%", "encoding=xml",
        "message=***&base64=1", "message=[]", "encoding=proto&message=%FF%FF"}) {
    EXPECT_EQ(code(get(query)), kCodeInvalidArgument) << query;
  }
  EXPECT_EQ(code(get("compression=gzip")), kCodeUnimplemented);
  for (const std::string name : {"content-encoding", "connect-content-encoding", "grpc-encoding"}) {
    EXPECT_EQ(code(Posted("application/json", {{name, "gzip"}}, "{}")), kCodeUnimplemented) << name;
    EXPECT_EQ(code(Posted("application/json", {{name, "identity"}}, "{}")), 0) << name;
  }
  EXPECT_EQ(code(Posted("application/grpc-web", {}, "abc")), kCodeInvalidArgument);
  EXPECT_EQ(code(Posted("application/grpc-web", {}, MakeEnvelope(1, "x"))), kCodeUnimplemented);
  EXPECT_EQ(code(Posted("application/grpc-web-text", {}, "***")), kCodeInvalidArgument);
  EXPECT_EQ(code(Posted("application/proto", {}, "\xFF\xFF")), kCodeInvalidArgument);
  EXPECT_EQ(code(Posted("application/json", {{"connect-protocol-version", "1"}}, "{}")), 0);
  EXPECT_EQ(code(Posted("application/json", {{"connect-protocol-version", "2"}}, "{}")),
            kCodeInvalidArgument);
}

// The first thing that is wrong is what is told, in the words for a developer.
TEST_F(Decoding, ToldWithItsReason) {
  const auto get = [](std::string query) {
    return Decode(RequestFor("GET", kGet, {}, std::move(query)));
  };
  const auto content = [](std::string name, std::string value) {
    return Posted("application/json", {{std::move(name), std::move(value)}}, "{", kStream);
  };
  const std::vector<std::pair<RpcDecoding, std::string>> rows = {
      {get("message=%&base64=1"), "the query has a malformed percent escape"},
      {get("encoding=xml&message=***&base64=1"), "encoding is neither json nor proto"},
      {get("compression=gzip&message=***&base64=1"), "compressed messages are not offered"},
      {get("message=***&base64=1"), "message is not base64"},
      {get("message=***"), "the JSON is no rmlcell.v1.GetJobRequest"},
      {content("connect-protocol-version", "2"), "connect-protocol-version is not 1"},
      {content("grpc-timeout", "1x"), "grpc-timeout is malformed"},
      {content("connect-timeout-ms", "soon"), "connect-timeout-ms is malformed"},
      {content("grpc-encoding", "gzip"), "grpc-encoding gzip is not offered"},
      {content("last-event-id", "x"), "Last-Event-ID is not the id of an event of this server"},
      {Posted("application/json", {{"content-encoding", "br"}, {"last-event-id", "x"}}, "",
              kStream),
       "content-encoding br is not offered"},
      {Posted("application/grpc-web", {}, "abc"), "the body holds no whole envelope"},
      {Posted("application/grpc-web", {}, MakeEnvelope(2, "x")), "the envelope has unknown flags"},
      {Posted("application/grpc-web-text", {}, "***"), "the body is not base64"},
      {Posted("application/proto", {}, "\xFF\xFF"), "the bytes are no rmlcell.v1.GetJobRequest"}};
  for (const auto& [decoding, reason] : rows) {
    EXPECT_NE(decoding.status.message.find(": " + reason), std::string::npos)
        << reason << " | " << decoding.status.message;
  }
}

// Each protocol has a header of its own; with both, that of the form counts.
TEST_F(Decoding, OfDeadlines) {
  using std::chrono::milliseconds;
  const HeaderList grpc = {{"grpc-timeout", "5S"}};
  const HeaderList connect = {{"connect-timeout-ms", "700"}};
  const HeaderList both = {{"grpc-timeout", "5S"}, {"connect-timeout-ms", "700"}};
  const auto timeout = [](const std::string& type, const HeaderList& headers) {
    const bool web = type != "application/json";
    const RpcDecoding decoding = Posted(type, headers, web ? MakeEnvelope(0, "") : "{}");
    EXPECT_TRUE(decoding.status.ok());
    return decoding.request.timeout;
  };
  EXPECT_EQ(timeout("application/json", {}), std::nullopt);
  EXPECT_EQ(timeout("application/json", grpc), milliseconds(5000));
  EXPECT_EQ(timeout("application/json", connect), milliseconds(700));
  EXPECT_EQ(timeout("application/json", both), milliseconds(700));
  EXPECT_EQ(timeout("application/grpc-web", grpc), milliseconds(5000));
  EXPECT_EQ(timeout("application/grpc-web", connect), milliseconds(700));
  EXPECT_EQ(timeout("application/grpc-web", both), milliseconds(5000));
  const RpcDecoding text =
      Posted("application/grpc-web-text", both, Base64(MakeEnvelope(0, ""), true));
  EXPECT_EQ(text.request.timeout, milliseconds(5000));
  for (const HeaderList& bad :
       {HeaderList{{"grpc-timeout", "x"}}, HeaderList{{"connect-timeout-ms", "x"}}}) {
    EXPECT_EQ(Posted("application/json", bad, "{}").status.code, kCodeInvalidArgument);
  }
}

// Where an event stream goes on: Last-Event-ID is after_sequence, in no other form.
TEST_F(Decoding, OfTheLastEvent) {
  const auto after = [](const std::string& type, const std::string& id, std::string body) {
    v1::WatchJobRequest request;
    const RpcDecoding decoding = Posted(type, {{"last-event-id", id}}, std::move(body), kStream);
    EXPECT_TRUE(decoding.status.ok()) << decoding.status.message;
    EXPECT_TRUE(request.ParseFromString(decoding.request.message));
    return request.after_sequence();
  };
  EXPECT_EQ(after("application/json", "17", "{}"), 17);
  EXPECT_EQ(after("application/json", "9223372036854775807", "{}"), 9223372036854775807);
  EXPECT_EQ(after("application/connect+json", "17", MakeEnvelope(0, "{}")), 0);
  for (const std::string bad : {"x", "-1", "9223372036854775808", "10000000000000000000", "1 "}) {
    EXPECT_EQ(Posted("application/json", {{"last-event-id", bad}}, "{}", kStream).status.code,
              kCodeInvalidArgument)
        << bad;
  }
}

TEST(Timeouts, TheLongestAreTenYears) {
  using std::chrono::hours;
  EXPECT_EQ(ParseGrpcTimeout("87600H"), hours(87600));
  EXPECT_EQ(ParseGrpcTimeout("87599H"), hours(87599));
  EXPECT_EQ(ParseGrpcTimeout("87601H"), hours(87600));
  EXPECT_EQ(ParseGrpcTimeout("5255999M"), std::chrono::minutes(5255999));
  EXPECT_EQ(ParseGrpcTimeout("5256001M"), hours(87600));
  EXPECT_EQ(ParseGrpcTimeout("99999999S"), std::chrono::seconds(99999999));
  EXPECT_EQ(ParseGrpcTimeout("12345678S"), std::chrono::seconds(12345678));
  EXPECT_EQ(ParseGrpcTimeout("0n"), std::chrono::nanoseconds(0));
}

}  // namespace
}  // namespace rmlcell::web
