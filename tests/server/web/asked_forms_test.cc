// What a request means where its parts do not say the same.
#include <gtest/gtest.h>

#include <map>

#include "rmlcell/v1/job.pb.h"
#include "server/web/base64.h"
#include "server/web/request_guard.h"
#include "server/web/rpc_codec.h"
#include "server/web/rpc_request.h"

namespace rmlcell::web {
namespace {

HttpRequest WatchBy(std::string method, HeaderList headers, std::string query = {}) {
  HttpRequest request;
  request.method = std::move(method);
  request.path = "/rmlcell.v1.JobService/WatchJob";
  request.headers = std::move(headers);
  request.query = std::move(query);
  return request;
}

// Events may be asked for with bytes: the query says what its message is, not the form of the
// answer.
TEST(AskedForms, TheMessageOfAQueryIsWhatTheQuerySays) {
  v1::WatchJobRequest asked;
  asked.set_name("jobs/7");
  const auto decoded = [](const std::string& query) {
    const HttpRequest request = WatchBy("GET", {}, query);
    const RpcRouting routing = RouteRpc(request);
    EXPECT_EQ(routing.route.wire, Wire::kEvents);
    v1::WatchJobRequest read;
    const RpcDecoding decoding = DecodeRpc(routing.route, request);
    EXPECT_TRUE(decoding.status.ok()) << decoding.status.message;
    EXPECT_TRUE(read.ParseFromString(decoding.request.message));
    return read.name();
  };
  EXPECT_EQ(decoded("encoding=proto&base64=1&message=" + Base64(asked.SerializeAsString(), false)),
            "jobs/7");
  EXPECT_EQ(decoded("encoding=json&message={%22name%22:%22jobs/8%22}"), "jobs/8");
  EXPECT_EQ(decoded("message={%22name%22:%22jobs/9%22}"), "jobs/9");
}

// The form of gRPC-Web is that of a POST: whatever else it says, a GET is answered as one.
TEST(AskedForms, AGetIsRefusedAsAGet) {
  HttpRequest request = WatchBy("GET", {{"content-type", "application/grpc-web+proto"}});
  request.path = "/rmlcell.v1.JobService/SubmitJob";
  const RpcRouting routing = RouteRpc(request);
  ASSERT_TRUE(routing.refusal);
  EXPECT_EQ(RefusalOf(routing).status, 405);
}

// RFC 9110 12.5.1: events in a list of what is accepted are asked for, in any case of letters.
TEST(AskedForms, EventsMayStandInAList) {
  for (const std::string accept : {"text/event-stream", "application/json;q=0.5, Text/Event-Stream",
                                   "text/event-stream, */*"}) {
    HttpRequest request =
        WatchBy("POST", {{"content-type", "application/json"}, {"accept", accept}});
    request.path = "/rmlcell.v1.JobService/GetJob";
    EXPECT_EQ(RouteRpc(request).route.wire, Wire::kEvents) << accept;
    request.method = "GET";
    EXPECT_EQ(RouteRpc(request).route.wire, Wire::kEvents) << accept;
  }
  HttpRequest plain =
      WatchBy("POST", {{"content-type", "application/json"}, {"accept", "text/event-streams"}});
  plain.path = "/rmlcell.v1.JobService/GetJob";
  EXPECT_EQ(RouteRpc(plain).route.wire, Wire::kConnectJson);
}

// RFC 3986 2.1: an escape that the text ends in is none, whatever lies behind it in memory.
TEST(AskedForms, AnEscapeThatIsCutIsNone) {
  const std::string_view whole = "a%2F";
  EXPECT_EQ(PercentDecode(whole, false), "a/");
  for (const std::size_t size : {2U, 3U})
    EXPECT_EQ(PercentDecode(whole.substr(0, size), false), std::nullopt) << size;
}

// Fetch standard, CORS protocol: which headers a page may send and which it may read.
TEST(AskedForms, APreflightNamesTheHeaders) {
  const GuardRules rules{.address = "127.0.0.1",
                         .host_names = {},
                         .origins = {"http://desk:5173"},
                         .forwarded = {},
                         .secret = "s"};
  HttpRequest request = WatchBy(
      "OPTIONS", {{"origin", "http://desk:5173"}, {"access-control-request-method", "POST"}});
  HttpResponse answer = AnswerOptions(rules, request);
  AddCorsHeaders(rules, request, answer);
  const std::map<std::string, std::string> headers(answer.headers.begin(), answer.headers.end());
  for (const char* name : {"authorization", "content-type", "connect-protocol-version",
                           "connect-timeout-ms", "grpc-timeout", "last-event-id", "x-grpc-web"})
    EXPECT_NE(headers.at("Access-Control-Allow-Headers").find(name), std::string::npos) << name;
  for (const char* name : {"grpc-status", "grpc-message", "etag", "content-disposition"})
    EXPECT_NE(headers.at("Access-Control-Expose-Headers").find(name), std::string::npos) << name;
}

}  // namespace
}  // namespace rmlcell::web
