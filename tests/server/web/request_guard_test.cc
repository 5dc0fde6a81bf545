#include "server/web/request_guard.h"

#include <gtest/gtest.h>

#include "server/web/rpc_call.h"

namespace rmlcell::web {
namespace {

GuardRules Rules() {
  return {.address = "192.168.7.5",
          .host_names = {"cell.shop"},
          .origins = {"http://localhost:5173"},
          .forwarded = {"authorization", "x-request-id", "rmlcell-role", "x-blob-bin"},
          .secret = "s"};
}

HttpRequest Request(HeaderList headers, std::string host = "localhost:50080") {
  HttpRequest request;
  request.method = "POST";
  request.path = "/rmlcell.v1.JobService/GetJob";
  request.host = std::move(host);
  request.headers = std::move(headers);
  request.peer = "127.0.0.1:1";
  return request;
}

// DNS rebinding: a foreign name that leads to us comes in the Host header.
TEST(Host, LoopbackConfiguredAndFurtherNames) {
  const GuardRules rules = Rules();
  for (const std::string_view own :
       {"localhost", "LocalHost:1", "cell.localhost", "127.0.0.1", "127.9.9.9:80", "[::1]",
        "[::1]:50080", "192.168.7.5:50080", "cell.shop"}) {
    EXPECT_TRUE(IsOwnHost(rules, own)) << own;
  }
  for (const std::string_view foreign :
       {"", "evil.example", "localhost.evil.example", "127.0.0.1.evil.example", "192.168.7.6",
        "10.0.0.1", "localhost:x", "[::1", "[::1]x", "user@localhost", "127.0.0.256", "127.0.0",
        "[::2]", ":80"}) {
    EXPECT_FALSE(IsOwnHost(rules, foreign)) << foreign;
  }
}

TEST(Host, LiteralsWhenAllAddressesAreListenedOn) {
  GuardRules rules = Rules();
  rules.address = "0.0.0.0";
  EXPECT_TRUE(IsOwnHost(rules, "10.1.2.3:50080"));
  EXPECT_TRUE(IsOwnHost(rules, "[fe80::1]:50080"));
  EXPECT_FALSE(IsOwnHost(rules, "evil.example"));
  EXPECT_FALSE(IsOwnHost(rules, "10.1.2.3.evil.example"));
}

TEST(Guard, OriginsAndSites) {
  const GuardRules rules = Rules();
  EXPECT_FALSE(RefuseRequest(rules, Request({})));
  EXPECT_FALSE(RefuseRequest(rules, Request({{"origin", "http://localhost:50080"}})));
  EXPECT_FALSE(RefuseRequest(rules, Request({{"origin", "http://localhost:5173"}})));
  EXPECT_FALSE(RefuseRequest(rules, Request({{"sec-fetch-site", "same-origin"}})));
  EXPECT_FALSE(RefuseRequest(rules, Request({{"sec-fetch-site", "none"}})));
  for (const HeaderList& foreign :
       {HeaderList{{"origin", "http://evil.example"}}, HeaderList{{"origin", "null"}},
        HeaderList{{"origin", "http://localhost:9999"}},
        HeaderList{{"sec-fetch-site", "cross-site"}},
        HeaderList{{"sec-fetch-site", "same-site"}}}) {
    const auto refusal = RefuseRequest(rules, Request(foreign));
    ASSERT_TRUE(refusal) << foreign[0].second;
    EXPECT_EQ(refusal->status, 403);
  }
}

TEST(Guard, HeadersThatMayStandOnce) {
  const GuardRules rules = Rules();
  for (const std::string name :
       {"host", "content-type", "authorization", "content-length", "last-event-id"}) {
    const auto refusal = RefuseRequest(rules, Request({{name, "1"}, {name, "1"}}));
    ASSERT_TRUE(refusal) << name;
    EXPECT_EQ(refusal->status, 400);
  }
}

TEST(Guard, PreflightForConfiguredOriginsOnly) {
  const GuardRules rules = Rules();
  const HttpRequest good =
      Request({{"origin", "http://localhost:5173"}, {"access-control-request-method", "POST"}});
  HttpResponse answer = AnswerOptions(rules, good);
  AddCorsHeaders(rules, good, answer);
  EXPECT_EQ(answer.status, 204);
  std::string text = SerializeHead(answer, Framing::kNone, 0, true);
  EXPECT_NE(text.find("Access-Control-Allow-Origin: http://localhost:5173\r\n"), std::string::npos);
  EXPECT_NE(text.find("connect-protocol-version"), std::string::npos);
  EXPECT_NE(text.find("grpc-status-details-bin"), std::string::npos);
  const HttpRequest bad =
      Request({{"origin", "http://evil.example"}, {"access-control-request-method", "POST"}});
  answer = AnswerOptions(rules, bad);
  AddCorsHeaders(rules, bad, answer);
  text = SerializeHead(answer, Framing::kNone, 0, true);
  EXPECT_EQ(text.find("Access-Control"), std::string::npos);
}

// A name of ours is never forwarded, even when the configuration asks for it; what gRPC would end
// the process on is refused.
TEST(Guard, CallerMetadata) {
  const GuardRules rules = Rules();
  const auto metadata = CallerMetadata(
      rules,
      Request({{"authorization", "Bearer x"}, {"rmlcell-role", "admin"}, {"x-blob-bin", "AP8"}}));
  ASSERT_TRUE(metadata);
  EXPECT_EQ(*metadata, (HeaderList{{"rmlcell-web-secret", "s"},
                                   {"rmlcell-web-peer", "127.0.0.1:1"},
                                   {"authorization", "Bearer x"},
                                   {"x-blob-bin", std::string("\0\xFF", 2)}}));
  EXPECT_FALSE(CallerMetadata(rules, Request({{"authorization", "Bearer \xFF"}})));
  EXPECT_FALSE(CallerMetadata(rules, Request({{"x-blob-bin", "***"}})));
}

TEST(Metadata, WhatGrpcCanSend) {
  EXPECT_TRUE(IsMetadata("x-request-id", "a b"));
  EXPECT_TRUE(IsMetadata("x-raw-bin", "\x01\xFF"));
  for (const std::string_view name : {"", "X-A", "a b", "a:b", "grpc-timeout", "\xC3\xBC"}) {
    EXPECT_FALSE(IsMetadata(name, "v")) << name;
  }
  for (const std::string_view value : {"\x01", "\x7F", "\xFF", "a\n", " a", "a "}) {
    EXPECT_FALSE(IsMetadata("x", value));
  }
}

}  // namespace
}  // namespace rmlcell::web
