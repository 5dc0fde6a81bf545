// How connections end: by a client that goes, by time, by a server that stops
// or has too many.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/prctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <nlohmann/json.hpp>
#include <string>

#include "server/web/refused_connection.h"
#include "tests/server/web/fake_cell.h"
#include "tests/server/web/raw_client.h"

namespace rmlcell::web::testing {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;

constexpr std::string_view kSlowCall = R"({"name":"jobs/slow"})";

std::string WatchOf(std::string_view job) {
  return Get("/rmlcell.v1.JobService/WatchJob?message={%22name%22:%22jobs/" + std::string(job) +
             "%22}");
}

// A stream of HTTP/1.0 ends with its connection, also where the client would
// keep it.
TEST(LastWords, AStreamOfHttp10EndsWithItsConnection) {
  FakeCell cell;
  RawClient client(cell.port());
  client.Send(
      "GET /rmlcell.v1.JobService/WatchJob?message={%22name%22:%22jobs/1%22} "
      "HTTP/1.0\r\n"
      "Connection: keep-alive\r\n\r\n");
  const RawResponse stream = client.Read();
  EXPECT_EQ(stream.Header("connection"), "close");
  EXPECT_TRUE(stream.body.ends_with("event: end\ndata: {}\n\n"));
  EXPECT_TRUE(client.AtEnd());
}

// Who ends his sending without a request is told nothing.
TEST(LastWords, NothingIsSaidToWhoAsksNothing) {
  FakeCell cell;
  RawClient client(cell.port());
  client.HalfClose();
  EXPECT_TRUE(client.AtEnd());
  EXPECT_TRUE(FakeCell::Eventually([&] { return cell.web().connections() == 0; }));
  EXPECT_TRUE(cell.log().empty());
}

// No further request on a connection that has said nothing yet, at once.
TEST(LastWords, ASilentConnectionIsClosedByAStop) {
  WebOptions options = AnyPort();
  options.read_timeout = hours(1);
  FakeCell cell(options);
  RawClient silent(cell.port());
  ASSERT_TRUE(FakeCell::Eventually([&] { return cell.web().connections() == 1; }));
  cell.web().StopAccepting();
  EXPECT_TRUE(silent.AtEnd());
}

// The end of the connection is seen behind a request that waits, also where
// nothing is ever told.
TEST(LastWords, ATabThatLeftIsSeenBehindItsNextRequest) {
  WebOptions options = AnyPort();
  options.quiet_interval = hours(1);
  FakeCell cell(options);
  RawClient client(cell.port());
  client.Send(WatchOf("idle"));
  client.ReadHead();
  client.ReadUntil("\n\n\r\n");  // all that comes: what is left unread would break the line
  client.Send(Get("/healthz"));
  client.Close();
  EXPECT_TRUE(FakeCell::Eventually([&] { return cell.counters().open == 0; }));
  EXPECT_EQ(cell.counters().cancelled, 1);
}

// A client that is gone is gone, whatever patience there is for one that has only ended its
// sending.
TEST(LastWords, AClosedTabIsSeenAtOnce) {
  WebOptions options = AnyPort();
  options.quiet_interval = hours(1);
  options.linger_timeout = hours(1);
  FakeCell cell(options);
  RawClient client(cell.port());
  client.Send(WatchOf("idle"));
  client.ReadHead();
  client.ReadUntil("\n\n\r\n");  // all that comes: what is left unread would break the line
  client.Close();
  EXPECT_TRUE(FakeCell::Eventually([&] { return cell.counters().open == 0; }));
  EXPECT_EQ(cell.counters().cancelled, 1);
}

// A request that its client breaks off is none, in its headers as in its body.
TEST(LastWords, WhoBreaksOffIsToldNothing) {
  FakeCell cell;
  const std::string call = Post(kGetJob, "application/json", kSlowCall);
  for (const std::string& part :
       {std::string("GET /healthz HT"), call.substr(0, call.size() - 5)}) {
    RawClient client(cell.port());
    client.Send(part);
    client.HalfClose();
    EXPECT_EQ(client.Read().status, 0) << part;
    EXPECT_TRUE(client.AtEnd()) << part;
  }
  EXPECT_EQ(cell.counters().calls, 0);
}

// Who is told that the connection ends, and leaves it open, does not keep it.
TEST(LastWords, WhoDoesNotCloseIsClosed) {
  WebOptions options = AnyPort();
  options.linger_timeout = milliseconds(100);
  FakeCell cell(options);
  RawClient client(cell.port());
  client.Send("GET /healthz HTTP/1.0\r\n\r\n");
  EXPECT_EQ(client.Read().status, 200);
  EXPECT_TRUE(client.AtEnd());
  EXPECT_TRUE(FakeCell::Eventually([&] { return cell.web().connections() == 0; }));
}

// Who is waited for after his answer, and is cut off by a stop, has had it: it is logged once.
TEST(LastWords, ARequestIsLoggedOnce) {
  WebOptions options = AnyPort();
  options.linger_timeout = hours(1);
  FakeCell cell(options);
  RawClient client(cell.port());
  client.Send("GET /healthz HTTP/1.0\r\n\r\n");
  EXPECT_EQ(client.Read().status, 200);
  EXPECT_TRUE(FakeCell::Eventually([&] { return cell.log().size() == 1; }));
  cell.web().Stop(milliseconds(0));
  ASSERT_EQ(cell.log().size(), 1U);
  EXPECT_TRUE(cell.log()[0].finished);
}

// web_server.h: a stop may be called again, in whatever order.
TEST(LastWords, AStopMayBeAskedForAgain) {
  FakeCell cell;
  cell.web().StopAccepting();
  cell.web().StopAccepting();
  cell.web().Stop(milliseconds(0));
  cell.web().StopAccepting();
  cell.web().Stop(milliseconds(0));
  EXPECT_EQ(cell.web().connections(), 0U);
}

// web_server.h: nobody new, and nobody who would wait for an answer that does not come.
TEST(LastWords, AStopTakesNobodyNew) {
  FakeCell cell;
  cell.web().StopAccepting();
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(RawClient(cell.port()).Send(Get("/healthz"))) << i;
}

// With a time that is too short for a slow machine what is said itself may come too late: then once
// more, with twice the time.
void ExpectOfSomeTime(const std::function<bool(milliseconds)>& holds) {
  bool held = false;
  for (milliseconds time(300); !held && time < std::chrono::minutes(1); time *= 2)
    held = holds(time);
  EXPECT_TRUE(held);
}

// That a call is given up after three times as long.
std::string ThreeTimes(milliseconds time) {
  return "Connect-Timeout-Ms: " + std::to_string(3 * time.count()) + "\r\n";
}

// RFC 9112 9.6: who has ended his sending gets his answer, and the connection ends with it.
TEST(LastWords, WhoEndsHisSendingGetsHisAnswer) {
  ExpectOfSomeTime([](milliseconds time) {
    const FakeCell cell;
    RawClient client(cell.port());
    client.Send(Post(kGetJob, "application/json", kSlowCall, ThreeTimes(time)));
    client.HalfClose();  // too late, where the call is given up before
    const RawResponse answer = client.Read();
    return answer.status == 504 && answer.Header("connection") == "close" && client.AtEnd();
  });
}

// The time that a write may take is none between two of them.
TEST(LastWords, AStreamMayBeQuietForLongerThanAWriteTakes) {
  ExpectOfSomeTime([](milliseconds time) {
    WebOptions options = AnyPort();
    options.write_timeout = time;
    options.quiet_interval = hours(1);
    const FakeCell cell(options);
    const RawResponse stream =
        Exchange(cell.port(), Post("/rmlcell.v1.JobService/WatchJob", "application/json",
                                   R"({"name":"jobs/idle"})", ThreeTimes(time)));
    return stream.complete && stream.body.find("\"deadline_exceeded\"") != std::string::npos;
  });
}

// The time to read a request is no limit of its answer.
TEST(LastWords, AnAnswerMayTakeLongerThanARequest) {
  ExpectOfSomeTime([](milliseconds time) {
    WebOptions options = AnyPort();
    options.read_timeout = time;
    const FakeCell cell(options);
    const std::string slow_get =
        Get("/rmlcell.v1.JobService/GetJob?message={%22name%22:%22jobs/slow%22}", ThreeTimes(time));
    const std::string slow_post = Post(kGetJob, "application/json", kSlowCall, ThreeTimes(time));
    return Exchange(cell.port(), slow_post).status == 504 &&
           Exchange(cell.port(), slow_get).status == 504;
  });
}

// What has come already of a further request is its beginning: that one has the time of a request,
// and not the time between two.
TEST(LastWords, AFirstByteBeginsARequest) {
  ExpectOfSomeTime([](milliseconds time) {
    WebOptions options = AnyPort();
    options.read_timeout = time;
    options.idle_timeout = hours(1);
    const FakeCell cell(options);
    RawClient client(cell.port());
    client.Send(Get("/healthz") + "G");
    return client.Read().status == 200 && client.Read().status == 408;
  });
}

// web_server.h: a reader is stuck when nothing goes on. One that is slow may take longer for an
// answer than a write may be stuck.
TEST(LastWords, AReaderMayBeSlow) {
  constexpr std::size_t kPart = std::size_t{1} << 20U;  // more than the buffers of a connection
  ExpectOfSomeTime([](milliseconds time) {
    WebOptions options = AnyPort();
    options.write_timeout = time;
    const FakeCell cell(options);
    RawClient client(cell.port(), 64 << 10);
    client.Send(Post(kGetJob, "application/json", R"({"name":"jobs/huge"})"));
    const std::string part(kPart, 'h');
    for (int i = 0; i < 6; ++i) {
      if (!client.ReadUntil(part).ends_with(part)) return false;
      // A call that is given up takes its time.
      const std::string half = "Connect-Timeout-Ms: " + std::to_string(time.count() / 2) + "\r\n";
      Exchange(cell.port(), Post(kGetJob, "application/json", kSlowCall, half));
    }
    return true;
  });
}

// A line that says nothing is for a stream that is quiet, which one that is written to in between
// is not. The cell of these tests tells something ten times a second, for six seconds.
TEST(LastWords, AStreamThatTellsSomethingIsNotQuiet) {
  ExpectOfSomeTime([](milliseconds time) {
    const milliseconds longest = std::min<milliseconds>(3 * time, milliseconds(6000));
    if (longest <= time) return false;  // it does not tell for so long
    WebOptions options = AnyPort();
    options.quiet_interval = time;
    const FakeCell cell(options);
    RawClient client(cell.port());
    client.Send(Get("/rmlcell.v1.CellService/WatchCell"));
    if (client.ReadHead().status != 200) return false;
    for (milliseconds told(0); told < longest; told += milliseconds(100)) {
      const std::string piece = client.ReadUntil("\n\n\r\n");
      if (piece.find("data: {") == std::string::npos || piece.find(": quiet") != std::string::npos)
        return false;
    }
    return true;
  });
}

// The only thread is busy until the time for a request is over, which has come meanwhile.
bool IsServedAfterBusyThread(milliseconds time) {
  std::promise<void> busy;
  std::promise<void> go_on;
  std::atomic<bool> first = true;
  const auto logger = [&, may_go_on = go_on.get_future().share()](const WebLogEntry&) {
    if (!first.exchange(false)) return;
    busy.set_value();
    may_go_on.wait();
  };
  WebOptions options = AnyPort();
  options.read_timeout = time;
  FakeResources resources;
  const auto web = WebServer::Start(options, nullptr, resources, logger);
  if (!web) return false;
  RawClient client((*web)->port());
  RawClient other((*web)->port());
  other.Send(Get("/favicon.svg"));
  const bool held =
      other.Read().status == 200 &&
      busy.get_future().wait_for(std::chrono::minutes(1)) == std::future_status::ready;
  client.Send(Get("/favicon.svg"));
  const bool waited = !client.AnswersWithin(2 * time);
  go_on.set_value();
  const bool answered = client.Read().status == 200;
  client.Send(Get("/favicon.svg"));
  return held && waited && answered && client.Read().status == 200;
}

// What has come is not late because nobody had the time to look at it, and its connection stands.
TEST(LastWords, WhatHasComeIsNotLate) { ExpectOfSomeTime(IsServedAfterBusyThread); }

// A server has been at this port and is gone, and the port is free.
bool IsFreeBehindItsServer() {
  int port = 0;
  {
    FakeCell cell;
    port = cell.port();
    RawClient client(port);
    client.Send("GET /healthz HTTP/1.0\r\n\r\n");  // the server ends it
    EXPECT_EQ(client.Read().status, 200);
    EXPECT_TRUE(client.AtEnd());
    client.Close();
    EXPECT_TRUE(FakeCell::Eventually([&] { return cell.web().connections() == 0; }));
  }
  WebOptions options;
  options.port = port;
  FakeResources resources;
  return WebServer::Start(options, nullptr, resources).has_value();
}

// The port is free as soon as its server is gone, though the system still waits
// for stray packets of connections that the server ended first. Any other program may be given it
// meanwhile: then once more, with another port.
TEST(LastWords, APortIsFreeAgainAtOnce) {
  bool free = false;
  for (int i = 0; i < 5 && !free; ++i) free = IsFreeBehindItsServer();
  EXPECT_TRUE(free);
}

// Below the limit nobody is refused, however near it is.
TEST(LastWords, AHundredAndTwentyConnectionsAreAHundredAndTwenty) {
  WebOptions options = AnyPort();
  options.connections_max = 120;
  FakeCell cell(options);
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 120; ++i) {
    clients.push_back(std::make_unique<RawClient>(cell.port()));
    clients.back()->Send(Get("/healthz"));
    ASSERT_EQ(clients.back()->Read().status, 200) << i;
  }
}

// What is told at once is the answer that others get, and ends the connection.
TEST(LastWords, WhoIsOneTooManyIsToldThatItEnds) {
  const HttpResponse answer = TooManyConnections();
  EXPECT_EQ(answer.status, 503);
  const std::string text = TooManyConnectionsText();
  EXPECT_TRUE(text.starts_with("HTTP/1.1 503 Service Unavailable\r\n"));
  EXPECT_NE(text.find("\r\nContent-Length: " + std::to_string(answer.body.size()) + "\r\n"),
            std::string::npos);
  EXPECT_NE(text.find("\r\nConnection: close\r\n\r\n" + answer.body), std::string::npos);
}

// Headers may have the room that is configured, more than is read at a time.
TEST(LastWords, HeadersHaveTheRoomThatIsConfigured) {
  WebOptions options = AnyPort();
  options.header_bytes_max = 100'000;
  FakeCell cell(options);
  const auto status = [&](std::size_t bytes) {
    const std::string half(bytes / 2, 'x');
    return Exchange(cell.port(), Get("/healthz", "A: " + half + "\r\nB: " + half + "\r\n")).status;
  };
  EXPECT_EQ(status(99'000), 200);
  EXPECT_EQ(status(100'000), 431);
}

// An upload has the limit of uploads, far above what a library takes of itself.
TEST(LastWords, AnUploadOfMegabytesIsTaken) {
  FakeCell cell;
  const std::string program(9'000'000, ';');
  EXPECT_EQ(Exchange(cell.port(), Post("/v1/machines/optimo-1/programs/45/content",
                                       "application/octet-stream", program))
                .status,
            200);
  EXPECT_EQ(cell.resources().uploads["optimo-1/45"].size(), 9'000'000U);
}

int OptionOf(int descriptor, int level, int name) {
  int value = 0;
  socklen_t size = sizeof(value);
  return getsockopt(descriptor, level, name, &value, &size) == 0 ? value : -1;
}

// The descriptors of this process that are connected from this port.
std::vector<int> AcceptedAt(int port) {
  std::vector<int> found;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    const int descriptor = std::stoi(entry.path().filename());
    sockaddr_in own{};
    sockaddr_in peer{};
    socklen_t size = sizeof(own);
    socklen_t peer_size = sizeof(peer);
    if (getsockname(descriptor, reinterpret_cast<sockaddr*>(&own), &size) == 0 &&
        getpeername(descriptor, reinterpret_cast<sockaddr*>(&peer), &peer_size) == 0 &&
        own.sin_family == AF_INET && ntohs(own.sin_port) == port)
      found.push_back(descriptor);
  }
  return found;
}

// A short event goes out at once, a dead line is found out, and what a reader
// leaves lying is bounded; the system gives twice of what it is asked for
// (socket(7)).
TEST(LastWords, ConnectionsAreMadeForStreams) {
  FakeCell cell;
  RawClient client(cell.port());
  client.Send(Get("/healthz"));
  EXPECT_EQ(client.Read().status, 200);
  const std::vector<int> accepted = AcceptedAt(cell.port());
  ASSERT_EQ(accepted.size(), 1U);
  EXPECT_NE(OptionOf(accepted[0], IPPROTO_TCP, TCP_NODELAY), 0);
  EXPECT_NE(OptionOf(accepted[0], SOL_SOCKET, SO_KEEPALIVE), 0);
  EXPECT_LE(OptionOf(accepted[0], SOL_SOCKET, SO_SNDBUF), 2 * (256 << 10));
}

// As long as it lives this thread has a name, which those that it begins inherit: they are counted,
// and not what others leave behind or begin meanwhile. prctl(2)
class NamedThreads {
 public:
  NamedThreads() {
    prctl(PR_GET_NAME, before_.data());
    prctl(PR_SET_NAME, kName);
  }
  ~NamedThreads() { prctl(PR_SET_NAME, before_.data()); }
  NamedThreads(const NamedThreads&) = delete;
  NamedThreads& operator=(const NamedThreads&) = delete;

  // Without the one that began them.
  static int Begun() {
    int named = -1;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
      std::ifstream file(entry.path() / "comm");
      std::string name;
      if (std::getline(file, name) && name == kName) ++named;
    }
    return named;
  }

 private:
  static constexpr const char* kName = "of_one_server";
  std::array<char, 16> before_{};
};

// One that makes pictures, and of the others so many as are asked for, from 1
// to 64 of each kind.
TEST(LastWords, ThreadsAreFromOneToSixtyFour) {
  FakeResources resources;
  for (const auto& [asked, made] : {std::pair{0, 1}, {1, 1}, {3, 3}, {64, 64}, {1000, 64}}) {
    WebOptions options = AnyPort();
    options.io_threads = asked;
    options.blocking_threads = asked;
    const NamedThreads named;
    const auto server = WebServer::Start(options, nullptr, resources);
    ASSERT_TRUE(server);
    EXPECT_EQ(NamedThreads::Begun(), 2 * made + 1) << asked;
    (*server)->Stop(milliseconds(0));
    EXPECT_TRUE(FakeCell::Eventually([&] { return NamedThreads::Begun() == 0; })) << asked;
  }
}

}  // namespace
}  // namespace rmlcell::web::testing
