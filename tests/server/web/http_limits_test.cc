// Hostile and unusual HTTP, limits, and connections that are used again.
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <nlohmann/json.hpp>

#include "tests/server/web/fake_cell.h"
#include "tests/server/web/raw_client.h"

namespace rmlcell::web::testing {
namespace {

using std::chrono::milliseconds;

constexpr std::string_view kJob1 = R"({"name":"jobs/1"})";

WebOptions Small() {
  WebOptions options = AnyPort();
  options.header_bytes_max = 2048;
  options.call_bytes_max = 1000;
  options.upload_bytes_max = 100'000;
  options.connections_max = 4;
  return options;
}

// The code of the error that an answer tells, as "400 CELL-E9003".
std::string ErrorOf(const RawResponse& response) {
  const nlohmann::json body = nlohmann::json::parse(response.body, nullptr, false);
  const std::string code = body.is_object() ? body["details"][1].value("code", "") : "no error";
  return std::to_string(response.status) + " " + code;
}

class HttpLimits : public ::testing::Test {
 protected:
  void ExpectStillWell() {
    EXPECT_TRUE(FakeCell::Eventually([&] {
      return Exchange(cell_.port(), Post(kGetJob, "application/json", kJob1)).status == 200;
    }));
  }
  FakeCell cell_{Small()};
};

TEST_F(HttpLimits, MalformedRequestsGet400AndClose) {
  for (const std::string_view text :
       {"\r\n\r\n\r\n", "GET\r\n\r\n", "GET / HTTP/1.1\nHost: localhost\n\n",
        "GET / HTTP/1.1\r\nHost localhost\r\n\r\n",
        "GET / HTTP/1.1\r\n: x\r\nHost: localhost\r\n\r\n",
        "GET /\x01 HTTP/1.1\r\nHost: localhost\r\n\r\n",
        "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1x\r\n\r\n",
        "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: -1\r\n\r\n",
        "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\nTransfer-Encoding: "
        "chunked\r\n\r\n",
        "POST / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\nContent-Length: "
        "5\r\n\r\n",
        "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\nContent-Length: 6\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n", "GET / HTTP/1.1\r\n\r\n",
        "\x16\x03\x01\x02\x00\x01\x00\x01\xFC\x03\x03 TLS\r\n\r\n"}) {
    RawClient client(cell_.port());
    client.Send(text);
    const RawResponse response = client.Read();
    EXPECT_EQ(ErrorOf(response), "400 CELL-E9003") << text;
    EXPECT_EQ(response.Header("connection"), "close") << text;
    EXPECT_TRUE(client.AtEnd()) << text;
  }
  ExpectStillWell();
}

TEST_F(HttpLimits, OtherVersions) {
  EXPECT_EQ(ErrorOf(Exchange(cell_.port(), "GET / HTTP/3.0\r\nHost: localhost\r\n\r\n")),
            "505 CELL-E9003");
  // A gRPC client that took the wrong port.
  EXPECT_EQ(ErrorOf(Exchange(cell_.port(), "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n")), "505 CELL-E9003");
}

TEST_F(HttpLimits, Http10) {
  RawClient client(cell_.port());
  client.Send("GET /healthz HTTP/1.0\r\n\r\n");
  const RawResponse response = client.Read();
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(response.Header("connection"), "close");
  EXPECT_TRUE(client.AtEnd());
  // A stream of HTTP/1.0 ends with its connection, not with chunks.
  const RawResponse stream = Exchange(
      cell_.port(),
      "GET /rmlcell.v1.JobService/WatchJob?message={%22name%22:%22jobs/1%22} HTTP/1.0\r\n\r\n");
  EXPECT_EQ(stream.Header("transfer-encoding"), "");
  EXPECT_TRUE(stream.body.starts_with("data: "));
  EXPECT_TRUE(stream.body.ends_with("event: end\ndata: {}\n\n"));
  RawClient kept(cell_.port());
  kept.Send("GET /healthz HTTP/1.0\r\nConnection: keep-alive\r\n\r\n");
  EXPECT_EQ(kept.Read().Header("connection"), "keep-alive");
}

TEST_F(HttpLimits, AbsoluteTargetsAndForeignHosts) {
  EXPECT_EQ(
      Exchange(cell_.port(), "GET http://localhost:1/healthz HTTP/1.1\r\nHost: x.example\r\n\r\n")
          .status,
      200);
  EXPECT_EQ(
      Exchange(cell_.port(), "GET http://evil.example/healthz HTTP/1.1\r\nHost: localhost\r\n\r\n")
          .status,
      403);
  EXPECT_EQ(ErrorOf(Exchange(cell_.port(), "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n")),
            "403 CELL-E9012");
}

TEST_F(HttpLimits, PipelinedRequestsAreAnsweredInOrder) {
  RawClient client(cell_.port());
  std::string requests;
  for (int i = 0; i < 20; ++i) {
    requests += i % 2 == 0 ? Post(kGetJob, "application/json", kJob1) : Get("/favicon.svg");
  }
  client.Send(requests);
  for (int i = 0; i < 20; ++i) {
    const RawResponse response = client.Read();
    ASSERT_EQ(response.status, 200) << i;
    EXPECT_EQ(response.Header("content-type"), i % 2 == 0 ? "application/json" : "image/svg+xml")
        << i;
  }
}

// A request after a stream on the same connection is not swallowed while the stream runs.
TEST_F(HttpLimits, PipelinedBehindAStream) {
  RawClient client(cell_.port());
  client.Send(Get("/rmlcell.v1.JobService/WatchJob?message={%22name%22:%22jobs/1%22}") +
              Get("/healthz"));
  EXPECT_TRUE(client.Read().body.ends_with("event: end\ndata: {}\n\n"));
  EXPECT_EQ(client.Read().body, "{\"status\":\"SERVING\"}\n");
}

TEST_F(HttpLimits, ByteByByte) {
  RawClient client(cell_.port());
  for (const char byte : Post(kGetJob, "application/json", kJob1))
    client.Send(std::string(1, byte));
  EXPECT_EQ(client.Read().status, 200);
}

TEST_F(HttpLimits, ChunkedBodies) {
  RawClient client(cell_.port());
  const std::string head = "POST " + std::string(kGetJob) +
                           " HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
                           "Transfer-Encoding: chunked\r\n\r\n";
  client.Send(head + "4;x=y\r\n{\"na\r\nD\r\nme\":\"jobs/1\"}\r\n0\r\nTrailer: t\r\n\r\n");
  EXPECT_EQ(client.Read().status, 200);
  client.Send(head + "zz\r\n");
  EXPECT_EQ(client.Read().status, 400);
  EXPECT_TRUE(client.AtEnd());
}

// Limits on both sides: the last size that is taken, and one more.
TEST_F(HttpLimits, BodyOfACall) {
  const auto body = [](std::size_t size) {
    return "{\"name\":\"jobs/1\"" + std::string(size - 17, ' ') + "}";
  };
  EXPECT_EQ(Exchange(cell_.port(), Post(kGetJob, "application/json", body(1000))).status, 200);
  const RawResponse large = Exchange(cell_.port(), Post(kGetJob, "application/json", body(1001)));
  EXPECT_EQ(large.status, 413);
  EXPECT_EQ(nlohmann::json::parse(large.body)["details"][1]["code"], "CELL-E9007");
  // Chunks do not say beforehand how many there will be.
  std::string chunked = "POST " + std::string(kGetJob) +
                        " HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
                        "Transfer-Encoding: chunked\r\n\r\n";
  const std::string head = chunked;
  EXPECT_EQ(Exchange(cell_.port(), head + "3e8\r\n" + body(1000) + "\r\n0\r\n\r\n").status, 200);
  EXPECT_EQ(Exchange(cell_.port(), head + "3e9\r\n" + body(1001) + "\r\n0\r\n\r\n").status, 413);
  for (int i = 0; i < 100; ++i) chunked += "10\r\n                \r\n";
  EXPECT_EQ(ErrorOf(Exchange(cell_.port(), chunked + "0\r\n\r\n")), "413 CELL-E9007");
  EXPECT_EQ(Exchange(cell_.port(),
                     "GET /rmlcell.v1.JobService/GetJob HTTP/1.1\r\nHost: localhost\r\n"
                     "Content-Length: 1\r\n\r\nx")
                .status,
            413);
  ExpectStillWell();
}

// A client that sends all before it reads still gets its answer.
TEST_F(HttpLimits, RefusalReachesAClientThatGoesOnSending) {
  RawClient client(cell_.port());
  client.Send(Post(kGetJob, "application/json", std::string(3'000'000, ' ')));
  EXPECT_EQ(client.Read().status, 413);
}

TEST_F(HttpLimits, Headers) {
  EXPECT_EQ(Exchange(cell_.port(), Get("/healthz", "X: " + std::string(1500, 'x') + "\r\n")).status,
            200);
  EXPECT_EQ(Exchange(cell_.port(), Get("/healthz", "X: " + std::string(2100, 'x') + "\r\n")).status,
            431);
  EXPECT_EQ(ErrorOf(Exchange(cell_.port(), Get("/" + std::string(5000, 'x')))), "431 CELL-E9007");
  std::string many;
  for (int i = 0; i < 1000; ++i) many += "a: b\r\n";
  EXPECT_EQ(Exchange(cell_.port(), Get("/healthz", many)).status, 431);
}

// Who is late with its first byte is closed without a word: then the test was too slow, and tries
// again.
TEST(HttpPatience, SlowRequestsAreEnded) {
  WebOptions options = AnyPort();
  options.read_timeout = milliseconds(400);
  FakeCell cell(options);
  const auto ends_with_408 = [&](std::string_view request) {
    return FakeCell::Eventually(
        [&] { return ErrorOf(Exchange(cell.port(), request)) == "408 CELL-E9003"; });
  };
  EXPECT_TRUE(ends_with_408("GET / HTTP/1.1\r\nHost: loc"));
  EXPECT_TRUE(ends_with_408(
      "POST " + std::string(kGetJob) +
      " HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: "
      "20\r\n\r\n{"));
  // Nor may a body not begin at all.
  EXPECT_TRUE(ends_with_408(
      "POST " + std::string(kGetJob) +
      " HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: "
      "20\r\n\r\n"));
  // One byte now and then does not help; were each given time anew, so many would be too long a
  // header.
  const auto drip = [&] {
    RawClient client(cell.port());
    while (!client.AnswersWithin(milliseconds(10)) && client.Send("G")) {
    }
    return client.Read().status;
  };
  int status = drip();
  FakeCell::Eventually([&] { return status != 0 || (status = drip()) != 0; });
  EXPECT_EQ(status, 408);
}

// What a client that was too slow still sends is taken, or it would not see its answer. On a slow
// machine the beginning itself may come too late: then once more, with twice the time.
TEST(HttpPatience, TheRestOfALateRequestIsTaken) {
  const auto is_taken = [](milliseconds time) {
    WebOptions options = AnyPort();
    options.read_timeout = time;
    options.linger_timeout = std::chrono::hours(1);
    FakeCell cell(options);
    RawClient client(cell.port());
    client.Send("POST " + std::string(kGetJob) +
                " HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
                "Content-Length: 20\r\n\r\n{");
    return client.Read().status == 408 && client.Send(std::string(50'000'000, ' ')) &&
           client.AtEnd();
  };
  bool taken = false;
  for (milliseconds time(400); !taken && time < std::chrono::minutes(1); time *= 2)
    taken = is_taken(time);
  EXPECT_TRUE(taken);
}

TEST(HttpPatience, SilentConnectionsAreClosed) {
  WebOptions options = AnyPort();
  options.read_timeout = milliseconds(100);
  options.idle_timeout = std::chrono::hours(1);
  FakeCell cell(options);
  RawClient silent(cell.port());
  EXPECT_TRUE(silent.AtEnd());  // waits for the end
}

TEST(HttpPatience, IdleConnectionsAreClosed) {
  WebOptions options = AnyPort();
  options.idle_timeout = milliseconds(100);
  options.read_timeout = std::chrono::hours(1);
  FakeCell cell(options);
  RawClient kept(cell.port());
  kept.Send(Get("/healthz"));
  EXPECT_EQ(kept.Read().status, 200);
  EXPECT_TRUE(kept.AtEnd());
}

TEST_F(HttpLimits, TooManyConnectionsGet503) {
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 4; ++i) {
    clients.push_back(std::make_unique<RawClient>(cell_.port()));
    clients.back()->Send(
        Get("/rmlcell.v1.JobService/WatchJob?message={%22name%22:%22jobs/idle%22}"));
    EXPECT_EQ(clients.back()->ReadHead().status, 200);
  }
  RawClient fifth(cell_.port());
  const RawResponse refused = fifth.Read();
  EXPECT_EQ(ErrorOf(refused), "503 CELL-E9020");
  EXPECT_EQ(refused.Header("retry-after"), "2");
  EXPECT_EQ(refused.Header("connection"), "close");
  EXPECT_TRUE(fifth.AtEnd());
  clients.clear();
  ExpectStillWell();
}

// However many come at once and say nothing, and however long those that are told of it stay.
TEST(HttpRefusals, WhoeverIsOneTooManyIsTold) {
  WebOptions options = AnyPort();
  options.connections_max = 10;
  options.linger_timeout = std::chrono::hours(1);
  FakeCell cell(options);
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 160; ++i) clients.push_back(std::make_unique<RawClient>(cell.port()));
  for (std::size_t i = 10; i < clients.size(); ++i) {
    const RawResponse refused = clients[i]->Read();
    ASSERT_EQ(ErrorOf(refused), "503 CELL-E9020") << i;
    EXPECT_EQ(refused.Header("retry-after"), "2");
  }
}

// A hundred of them are waited for, each until it goes; the next one is told at once and left.
TEST(HttpRefusals, AHundredAreWaitedFor) {
  WebOptions options = AnyPort();
  options.connections_max = 10;
  options.read_timeout = std::chrono::hours(1);
  options.linger_timeout = std::chrono::hours(1);
  FakeCell cell(options);
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 111; ++i) clients.push_back(std::make_unique<RawClient>(cell.port()));
  for (std::size_t i = 10; i < clients.size(); ++i)
    ASSERT_EQ(ErrorOf(clients[i]->Read()), "503 CELL-E9020") << i;
  EXPECT_EQ(cell.web().connections(), 110U);
}

// Left unread, a request that is there already would have the system break the connection, which a
// client may see before its answer. It is there when its client came while the only thread was
// busy.
TEST(HttpRefusals, ARequestThatIsThereAlreadyIsTaken) {
  std::promise<void> busy;
  std::promise<void> go_on;
  std::atomic<bool> first = true;
  const auto logger = [&, may_go_on = go_on.get_future().share()](const WebLogEntry&) {
    if (!first.exchange(false)) return;
    busy.set_value();
    may_go_on.wait();
  };
  WebOptions options = AnyPort();
  options.connections_max = 1;
  options.read_timeout = std::chrono::hours(1);
  options.linger_timeout = std::chrono::hours(1);
  FakeResources resources;
  const auto web = WebServer::Start(options, nullptr, resources, logger);
  ASSERT_TRUE(web);
  RawClient served((*web)->port());
  std::vector<std::unique_ptr<RawClient>> refused;
  for (int i = 0; i < 100; ++i) {
    refused.push_back(std::make_unique<RawClient>((*web)->port()));
    EXPECT_EQ(refused.back()->Read().status, 503) << i;
  }
  served.Send(Get("/favicon.svg"));
  EXPECT_EQ(served.Read().status, 200);
  EXPECT_EQ(busy.get_future().wait_for(std::chrono::minutes(1)), std::future_status::ready);
  RawClient late((*web)->port());
  EXPECT_TRUE(late.Send(Get("/favicon.svg")));
  go_on.set_value();
  EXPECT_EQ(ErrorOf(late.Read()), "503 CELL-E9020");
  EXPECT_TRUE(late.AtEnd());
  served.Send(Get("/favicon.svg"));  // of the same thread: it has left the other behind
  EXPECT_EQ(served.Read().status, 200);
  EXPECT_TRUE(late.Send("x"));  // ended, and not broken
}

// A client that is refused before it has sent all may send the rest; then both ends close.
TEST(HttpRefusals, TheRestOfARefusedRequestIsTaken) {
  WebOptions options = AnyPort();
  options.linger_timeout = std::chrono::hours(1);
  FakeCell cell(options);
  RawClient client(cell.port());
  client.Send("POST " + std::string(kGetJob) +
              " HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
              "Content-Length: 50000000\r\n\r\n");
  EXPECT_EQ(client.Read().status, 413);
  EXPECT_TRUE(client.Send(std::string(50'000'000, ' ')));
  EXPECT_TRUE(client.AtEnd());
  client.Close();
  EXPECT_TRUE(FakeCell::Eventually([&] { return cell.web().connections() == 0; }));
}

TEST_F(HttpLimits, Expectations) {
  RawClient client(cell_.port());
  const std::string head = "POST " + std::string(kGetJob) +
                           " HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n";
  client.Send(head + "Content-Length: 17\r\nExpect: 100-continue\r\n\r\n");
  EXPECT_EQ(client.ReadUntil("\r\n\r\n"), "HTTP/1.1 100 Continue\r\n\r\n");
  client.Send(kJob1);
  EXPECT_EQ(client.Read().status, 200);
  EXPECT_EQ(ErrorOf(Exchange(cell_.port(), head + "Content-Length: 0\r\nExpect: magic\r\n\r\n")),
            "417 CELL-E9003");
  // Refused before the body is sent.
  EXPECT_EQ(
      Exchange(cell_.port(), head + "Content-Length: 5000\r\nExpect: 100-continue\r\n\r\n").status,
      413);
}

// RFC 9110 10.1.1: a client of HTTP/1.0 knows no 100, whatever it expects.
TEST_F(HttpLimits, AnExpectationOfHttp10IsNone) {
  RawClient client(cell_.port());
  client.Send("POST " + std::string(kGetJob) +
              " HTTP/1.0\r\nHost: localhost\r\nContent-Type: application/json\r\n"
              "Content-Length: 17\r\nExpect: 100-continue\r\n\r\n");
  EXPECT_FALSE(client.AnswersWithin(milliseconds(200)));
  client.Send(kJob1);
  EXPECT_EQ(client.Read().status, 200);
}

// A second server on the same port is an error that names it.
TEST_F(HttpLimits, UsedPortIsRefused) {
  WebOptions options;
  options.port = cell_.port();
  FakeResources resources;
  const auto second = WebServer::Start(options, nullptr, resources);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kCellPortUsed);
  EXPECT_NE(second.error().detail.find(std::to_string(cell_.port())), std::string::npos);
  options.address = "shop.example";
  const auto named = WebServer::Start(options, nullptr, resources);
  ASSERT_FALSE(named);
  EXPECT_EQ(named.error().code, ErrorCode::kCellConfiguration);
  options.address = "localhost";
  options.port = 65535;  // the last one that there is, whether it is free or not
  const auto last = WebServer::Start(options, nullptr, resources);
  EXPECT_TRUE(last || last.error().code == ErrorCode::kCellPortUsed);
  for (const int port : {-1, 65536}) {
    options.port = port;
    const auto none = WebServer::Start(options, nullptr, resources);
    ASSERT_FALSE(none) << port;
    EXPECT_EQ(none.error().code, ErrorCode::kCellConfiguration);
    EXPECT_NE(none.error().detail.find("localhost:" + std::to_string(port)), std::string::npos);
  }
}

}  // namespace
}  // namespace rmlcell::web::testing
