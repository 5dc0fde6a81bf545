// What stands in the answers besides what was asked for: headers for caches and proxies, and texts
// of refusals that a long request does not make long.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "rmlcell/v1/job.pb.h"
#include "server/web/envelope.h"
#include "server/web/resource_routes.h"
#include "server/web/rpc_json.h"
#include "tests/server/web/fake_cell.h"
#include "tests/server/web/raw_client.h"

namespace rmlcell::web::testing {
namespace {

constexpr std::string_view kFirst = R"({"name":"jobs/1"})";
constexpr std::string_view kSlot = "/v1/machines/optimo-1/programs/45/content";

class Answers : public ::testing::Test {
 protected:
  RawResponse Asked(std::string_view request) const { return Exchange(cell_.port(), request); }
  static std::string MessageOf(const RawResponse& response) {
    return nlohmann::json::parse(response.body).value("message", "none");
  }
  FakeCell cell_;
};

// What is so now is kept by nobody, and is taken for nothing but what it says it is.
TEST_F(Answers, AreNotKeptAndNotGuessedAt) {
  v1::GetJobRequest job;
  job.set_name("jobs/1");
  const std::string bytes = job.SerializeAsString();
  const std::pair<std::string, std::string> rows[] = {
      {Post(kGetJob, "application/json", kFirst), "application/json"},
      {Post(kGetJob, "application/proto", bytes), "application/proto"},
      {Post(kGetJob, "application/grpc-web+proto", MakeEnvelope(0, bytes)),
       "application/grpc-web+proto"},
      {Post(kWatchJob, "application/connect+json", MakeEnvelope(0, kFirst)),
       "application/connect+json"},
      {Post(kWatchJob, "application/connect+proto", MakeEnvelope(0, bytes)),
       "application/connect+proto"},
      {Post(kWatchJob, "application/json", kFirst), "text/event-stream; charset=utf-8"},
      {Post(kGetJob, "application/json", R"({"name":"jobs/999"})"), "application/json"},
      {Post(kSlot, "application/octet-stream", "MOVE"), "application/json"},
      {Post(kSlot, "text/plain", "MOVE"), "application/json"},
      {Get("/healthz"), "application/json"},
      {Get("/none"), "application/json"}};
  for (const auto& [request, type] : rows) {
    const RawResponse response = Asked(request);
    EXPECT_EQ(response.Header("content-type"), type) << request;
    EXPECT_EQ(response.Header("cache-control"), "no-cache, no-store") << request;
    EXPECT_EQ(response.Header("x-content-type-options"), "nosniff") << request;
  }
  EXPECT_EQ(Asked(Post(kWatchJob, "application/json", kFirst)).Header("x-accel-buffering"), "no");
}

// RFC 9110 8.6: no length without a body that there could be.
TEST_F(Answers, OptionsHaveNoBody) {
  RawClient client(cell_.port());
  client.Send("OPTIONS /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n" + Get("/healthz"));
  const RawResponse options = client.Read();
  EXPECT_EQ(options.status, 204);
  EXPECT_EQ(options.headers.count("content-length"), 0U);
  EXPECT_EQ(options.Header("allow"), "GET, HEAD, POST, OPTIONS");
  EXPECT_EQ(client.Read().status, 200);
}

// RFC 9110 15.5.6: what is offered stands there, wherever something is not.
TEST_F(Answers, WhatIsNotOfferedSaysWhatIs) {
  const auto expect = [&](const std::string& method, const std::string& path,
                          const std::string& allow, const std::string& message) {
    const RawResponse response =
        Asked(method + " " + path + " HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n\r\n");
    EXPECT_EQ(response.status, 405) << method << path;
    EXPECT_EQ(response.Header("allow"), allow) << method << path;
    EXPECT_NE(MessageOf(response).find(message), std::string::npos) << MessageOf(response);
  };
  expect("DELETE", "/healthz", "GET, HEAD", "use GET");
  expect("DELETE", "/page.js", "GET, HEAD", "DELETE is not offered here");
  expect("DELETE", std::string(kSlot), "GET, HEAD, POST", "DELETE is not offered here");
  expect("GET", "/v1/uploads", "POST", "GET is not offered here");
  expect("PUT", "/v1/jobs/17/artifacts/report", "GET, HEAD", "PUT is not offered here");
  expect("PUT", std::string(kGetJob), "GET, POST", "use POST");
}

// Of a long path its first 200 characters are told, of JSON that is none 400 of the reader's words.
TEST_F(Answers, RefusalsAreShort) {
  const std::string path = "/" + std::string(99, 'a') + std::string(200, 'b');
  const std::string nothing = MessageOf(Asked(Get(path)));
  EXPECT_NE(nothing.find("nothing at " + path.substr(0, 200) + ";"), std::string::npos) << nothing;
  const std::string method = "a.B/" + std::string(96, 'c') + std::string(200, 'd');
  const std::string none = MessageOf(Asked(Post("/" + method, "application/json", "{}")));
  EXPECT_NE(none.find("no method " + method.substr(0, 200) + " on the web port"), std::string::npos)
      << none;
  const auto& type = *v1::GetJobRequest::descriptor();
  const std::string head = "the JSON is no rmlcell.v1.GetJobRequest: ";
  EXPECT_EQ(JsonToBytes(type, "{\"" + std::string(2000, 'x') + "\":1}").error().detail.size(),
            head.size() + 400);
  EXPECT_LT(JsonToBytes(type, "{\"x\":1}").error().detail.size(), head.size() + 100);
}

// A refused upload has the form that people and curl read, with its code.
TEST_F(Answers, RefusedUploadsHaveTheirCode) {
  for (const std::string& request :
       {Post(kSlot, "text/plain", "x"),
        Post(kSlot, "application/octet-stream", "x", "Content-Encoding: gzip\r\n"),
        Post(std::string(kSlot) + "?force=1", "application/octet-stream", "x")}) {
    const RawResponse response = Asked(request);
    EXPECT_EQ(response.status, request.find("force") == std::string::npos ? 415 : 400);
    const auto detail = nlohmann::json::parse(response.body)["details"][1];
    EXPECT_EQ(detail["@type"], "type.googleapis.com/rmlcell.v1.ErrorDetail");
    EXPECT_EQ(detail["code"], "CELL-E9003");
  }
  EXPECT_EQ(
      Asked(Post(kSlot, "application/octet-stream", "x", "Content-Encoding: identity\r\n")).status,
      200);
}

// A foreign page that may call reads every answer, an error as well (the Fetch standard).
TEST(ForeignPages, ReadWhatTheyAskedFor) {
  WebOptions options = AnyPort();
  options.origins = {"http://localhost:5173"};
  FakeCell cell(options);
  for (const std::string_view job : {kFirst, std::string_view(R"({"name":"jobs/999"})")}) {
    const RawResponse response = Exchange(
        cell.port(), Post(kGetJob, "application/json", job, "Origin: http://localhost:5173\r\n"));
    EXPECT_EQ(response.Header("access-control-allow-origin"), "http://localhost:5173") << job;
    EXPECT_EQ(response.Header("vary"), "Origin") << job;
  }
}

// RFC 9110 5.1: names of headers have no case, also where they are configured.
TEST(ForwardedHeaders, MayBeConfiguredInAnyCase) {
  WebOptions options = AnyPort();
  options.forwarded_headers = {"X-Thing"};
  FakeCell cell(options);
  const RawResponse response =
      Exchange(cell.port(),
               Post(kGetJob, "application/json", R"({"name":"jobs/meta"})", "x-tHing: seven\r\n"));
  ASSERT_EQ(response.status, 200);
  const std::string title = nlohmann::json::parse(response.body)["title"];
  EXPECT_NE(title.find("x-thing=seven\n"), std::string::npos) << title;
}

// A length that no number of ours holds is one that is not known before the end.
TEST(UploadLengths, AreNumbersOrNotKnown) {
  const auto size = [](const std::string& length) {
    HttpRequest request;
    request.headers = {{"content-type", "application/octet-stream"}};
    if (!length.empty()) request.headers.emplace_back("content-length", length);
    return RouteUpload(request, UploadsPath()).header.size;
  };
  EXPECT_EQ(size("0"), 0);
  EXPECT_EQ(size("12"), 12);
  EXPECT_EQ(size(""), -1);
  EXPECT_EQ(size("99999999999999999999"), -1);
}

}  // namespace
}  // namespace rmlcell::web::testing
