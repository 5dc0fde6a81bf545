#include "server/web/request_guard.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

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
        "[::1]:50080", "192.168.7.5:50080", "cell.shop", "127.0.0.255", "127.0.0.0", "localhost:09",
        "[::1]:09"}) {
    EXPECT_TRUE(IsOwnHost(rules, own)) << own;
  }
  for (const std::string_view foreign : {"",
                                         "evil.example",
                                         "localhost.evil.example",
                                         "127.0.0.1.evil.example",
                                         "192.168.7.6",
                                         "10.0.0.1",
                                         "localhost:x",
                                         "[::1",
                                         "[::1]x",
                                         "user@localhost",
                                         "127.0.0.256",
                                         "127.0.0",
                                         "[::2]",
                                         ":80",
                                         "127.0.0.0001",
                                         "127.0.0.1.1",
                                         "127.0.0.",
                                         "localhost:/",
                                         "localhost::",
                                         "[::1]:/",
                                         "[::1]::"}) {
    EXPECT_FALSE(IsOwnHost(rules, foreign)) << foreign;
  }
}

TEST(Host, LiteralsWhenAllAddressesAreListenedOn) {
  GuardRules rules = Rules();
  rules.address = "0.0.0.0";
  EXPECT_TRUE(IsOwnHost(rules, "10.1.2.3:50080"));
  EXPECT_TRUE(IsOwnHost(rules, "[fe80::1]:50080"));
  EXPECT_TRUE(IsOwnHost(rules, "[::ffff:10.1.2.3]"));
  for (const std::string_view digit : {"0", "9", "a", "f", "A", "F"})
    EXPECT_TRUE(IsOwnHost(rules, "[::" + std::string(digit) + "]")) << digit;
  for (const std::string_view other : {"/", ";", "`", "g"})
    EXPECT_FALSE(IsOwnHost(rules, "[::" + std::string(other) + "]")) << other;
  EXPECT_FALSE(IsOwnHost(rules, "evil.example"));
  EXPECT_FALSE(IsOwnHost(rules, "10.1.2.3.evil.example"));
}

// Nothing is no name: not that of a Host which cannot be read, whatever is configured.
TEST(Host, AnEmptyNameIsNobodys) {
  GuardRules rules = Rules();
  rules.host_names.emplace_back();
  for (const std::string_view none : {"", ":80", "[]", "[]:80", "localhost:x", "[::1", "[::1]x"}) {
    EXPECT_FALSE(IsOwnHost(rules, none)) << none;
  }
  EXPECT_TRUE(IsOwnHost(rules, "cell.shop"));
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
       {"host", "content-type", "content-length", "origin", "authorization", "last-event-id",
        "grpc-timeout", "connect-protocol-version", "connect-timeout-ms"}) {
    const auto refusal = RefuseRequest(rules, Request({{name, "1"}, {name, "1"}}));
    ASSERT_TRUE(refusal) << name;
    EXPECT_EQ(refusal->status, 400);
  }
}

// 400 is for what no request may look like, 403 for who may not ask; the detail names what it is.
TEST(Guard, ARefusalSaysWhatIsWrong) {
  const GuardRules rules = Rules();
  HttpRequest chunked = Request({{"transfer-encoding", "chunked"}});
  EXPECT_FALSE(RefuseRequest(rules, chunked));
  chunked.version = 10;
  HttpRequest plain = Request({});
  plain.version = 10;
  EXPECT_FALSE(RefuseRequest(rules, plain));
  plain.host = "";
  EXPECT_FALSE(RefuseRequest(rules, plain));  // HTTP/1.0 need not name its host
  const std::vector<std::tuple<HttpRequest, int, std::string, std::string>> cases = {
      {Request({{"origin", "http://localhost:5173"}, {"origin", "null"}}), 400, "CELL-E9003",
       "header origin stands twice"},
      {chunked, 400, "CELL-E9003", "HTTP/1.0 has no transfer encodings"},
      {Request({}, ""), 400, "CELL-E9003", "the request has no Host"},
      {Request({}, "evil.example:80"), 403, "CELL-E9012", "this server is not evil.example:80"},
      {Request({{"origin", "http://evil.example"}}), 403, "CELL-E9012",
       "pages of http://evil.example may not call"},
      {Request({{"sec-fetch-site", "cross-site"}}), 403, "CELL-E9012",
       "pages of other sites may not call"}};
  for (const auto& [request, status, code, detail] : cases) {
    const auto refusal = RefuseRequest(rules, request);
    ASSERT_TRUE(refusal) << detail;
    EXPECT_EQ(refusal->status, status) << detail;
    EXPECT_NE(refusal->body.find(code), std::string::npos) << refusal->body;
    EXPECT_NE(refusal->body.find(detail), std::string::npos) << refusal->body;
  }
}

// Links to the page itself and to resources are for everybody; calls are not.
TEST(Guard, LinksOfOtherSites) {
  HttpRequest link = Request({{"sec-fetch-site", "cross-site"}});
  for (const std::string path : {"/", "/v1/jobs/17/artifacts/report", "/index.html"}) {
    link.path = path;
    EXPECT_FALSE(RefuseRequest(Rules(), link)) << path;
  }
}

TEST(Guard, PreflightForConfiguredOriginsOnly) {
  const GuardRules rules = Rules();
  const HttpRequest good =
      Request({{"origin", "http://localhost:5173"}, {"access-control-request-method", "POST"}});
  HttpResponse answer = AnswerOptions(rules, good);
  AddCorsHeaders(rules, good, answer);
  EXPECT_EQ(answer.status, 204);
  const auto header = [&](std::string_view name) {
    const auto found = std::ranges::find(answer.headers, name, &HeaderList::value_type::first);
    return found == answer.headers.end() ? std::string("none") : found->second;
  };
  EXPECT_EQ(header("Allow"), "GET, HEAD, POST, OPTIONS");
  EXPECT_EQ(header("Access-Control-Allow-Methods"), "GET, HEAD, POST");
  EXPECT_EQ(header("Access-Control-Max-Age"), "7200");
  EXPECT_EQ(header("Access-Control-Allow-Private-Network"), "none");
  EXPECT_EQ(header("Vary"), "Origin");
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
  EXPECT_EQ(header("Vary"), "Origin");  // another origin would have another answer
  EXPECT_EQ(header("Allow"), "GET, HEAD, POST, OPTIONS");
}

// What a preflight asks is answered to a preflight: OPTIONS by itself only says what there is.
TEST(Guard, OptionsThatAreNoPreflight) {
  const HttpRequest plain = Request({{"origin", "http://localhost:5173"}});
  EXPECT_EQ(AnswerOptions(Rules(), plain).headers,
            (HeaderList{{"Allow", "GET, HEAD, POST, OPTIONS"}}));
}

// A page on another network reaches a server on loopback only when the server says so, to its own
// pages.
TEST(Guard, PreflightIntoAPrivateNetwork) {
  const auto allowed = [](const std::string& origin, const std::string& asked) {
    const HttpResponse answer =
        AnswerOptions(Rules(), Request({{"origin", origin},
                                        {"access-control-request-method", "POST"},
                                        {"access-control-request-private-network", asked}}));
    return std::ranges::count(
        answer.headers, HeaderList::value_type("Access-Control-Allow-Private-Network", "true"));
  };
  EXPECT_EQ(allowed("http://localhost:5173", "true"), 1);
  EXPECT_EQ(allowed("HTTP://LOCALHOST:5173", "true"), 1);
  EXPECT_EQ(allowed("http://localhost:5173", "false"), 0);
  EXPECT_EQ(allowed("http://evil.example", "true"), 0);
}

// Without configured origins no answer depends on where the page came from.
TEST(Guard, CorsHeaders) {
  GuardRules rules = Rules();
  HttpResponse answer;
  AddCorsHeaders(rules, Request({{"origin", "http://localhost:5173"}}), answer);
  ASSERT_EQ(answer.headers.size(), 3U);
  EXPECT_EQ(answer.headers[0], HeaderList::value_type("Vary", "Origin"));
  EXPECT_EQ(answer.headers[1],
            HeaderList::value_type("Access-Control-Allow-Origin", "http://localhost:5173"));
  EXPECT_EQ(answer.headers[2].first, "Access-Control-Expose-Headers");
  answer.headers.clear();
  AddCorsHeaders(rules, Request({}), answer);
  EXPECT_EQ(answer.headers, (HeaderList{{"Vary", "Origin"}}));
  rules.origins.clear();
  answer.headers.clear();
  AddCorsHeaders(rules, Request({{"origin", "http://localhost:5173"}}), answer);
  EXPECT_EQ(answer.headers, HeaderList{});
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
  EXPECT_TRUE(IsMetadata("az09-_.", "! ~"));
  EXPECT_TRUE(IsMetadata("x", ""));
  for (const std::string_view name :
       {"", "X-A", "a b", "a:b", "a/b", "a`b", "a{b", "grpc-timeout", "\xC3\xBC"}) {
    EXPECT_FALSE(IsMetadata(name, "v")) << name;
  }
  for (const std::string_view value : {"\x01", "\x7F", "\xFF", "a\n", " a", "a "}) {
    EXPECT_FALSE(IsMetadata("x", value));
  }
}

}  // namespace
}  // namespace rmlcell::web
