// Streams that are slow, quiet, left or ended: nothing leaks, nobody else waits.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <iterator>

#include "server/web/envelope.h"
#include "tests/server/web/fake_cell.h"
#include "tests/server/web/raw_client.h"

namespace rmlcell::web::testing {
namespace {

using std::chrono::milliseconds;

std::string Watch(std::string_view job) {
  return Get("/rmlcell.v1.JobService/WatchJob?message={%22name%22:%22jobs/" + std::string(job) +
             "%22}");
}

WebOptions Quick() {
  WebOptions options = AnyPort();
  options.quiet_interval = milliseconds(200);
  options.write_timeout = milliseconds(1500);
  options.linger_timeout = milliseconds(200);
  return options;
}

std::ptrdiff_t OpenDescriptors() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
}

class Streams : public ::testing::Test {
 protected:
  bool AllEnded() {
    return FakeCell::Eventually(
        [&] { return cell_.counters().open == 0 && cell_.web().connections() == 0; });
  }
  FakeCell cell_{Quick()};
};

// The head comes at once, the first message behind it, and quiet streams get comment lines; on a
// slow machine also before that message.
TEST_F(Streams, QuietStreamsAreKeptAlive) {
  RawClient client(cell_.port());
  client.Send(Watch("idle"));
  EXPECT_EQ(client.ReadHead().status, 200);
  EXPECT_TRUE(client.ReadUntil("\"snapshot\"").ends_with("\"snapshot\""));
  for (int i = 0; i < 3; ++i)
    EXPECT_NE(client.ReadUntil(": quiet\n\n").find(": quiet"), std::string::npos);
}

// Only events have a line that says nothing: a quiet stream of another form stands as it is.
TEST_F(Streams, AQuietStreamOfAnotherFormIsLeftAlone) {
  RawClient connect(cell_.port());
  connect.Send(
      Post(kWatchJob, "application/connect+json", MakeEnvelope(0, R"({"name":"jobs/stop"})")));
  connect.ReadUntil("\"snapshot\"");
  RawClient events(cell_.port());
  events.Send(Watch("idle"));
  for (int i = 0; i < 3; ++i)
    EXPECT_NE(events.ReadUntil(": quiet\n\n").find(": quiet"), std::string::npos);
  cell_.StopStreams();
  EXPECT_NE(connect.ReadUntil("\r\n0\r\n\r\n").find("{\"error\":{\"code\":\"unavailable\""),
            std::string::npos);
}

// A stream that is quiet stands, whatever its client has sent behind it.
TEST_F(Streams, ARequestThatWaitsEndsNoStream) {
  RawClient client(cell_.port());
  client.Send(Watch("idle"));
  EXPECT_EQ(client.ReadHead().status, 200);
  client.Send(Get("/healthz"));
  for (int i = 0; i < 3; ++i)
    EXPECT_NE(client.ReadUntil(": quiet\n\n").find(": quiet"), std::string::npos);
}

// A closed tab is noticed while nothing is sent, long before a comment line would fail.
TEST_F(Streams, ClosedTabCancelsTheCall) {
  for (const bool reset : {false, true}) {
    const int before = cell_.counters().cancelled;
    RawClient client(cell_.port());
    client.Send(Watch("idle"));
    client.ReadUntil("\"snapshot\"");
    EXPECT_EQ(cell_.counters().open, 1);
    reset ? client.Reset() : client.Close();
    EXPECT_TRUE(AllEnded());
    EXPECT_EQ(cell_.counters().cancelled, before + 1);
  }
}

// The end of the connection is noticed also behind a request that waits its turn.
TEST_F(Streams, ClosedTabBehindAPipelinedRequest) {
  RawClient client(cell_.port());
  client.Send(Watch("idle") + Get("/healthz"));
  client.ReadUntil("\"snapshot\"");
  client.Close();
  EXPECT_TRUE(AllEnded());
  EXPECT_EQ(cell_.counters().cancelled, 1);
}

// Also when it was still there at the first look: that a quiet stream of events has its lines tells
// how much time has passed.
TEST_F(Streams, ATabThatIsClosedLaterBehindAPipelinedRequest) {
  RawClient connect(cell_.port());
  connect.Send(
      Post(kWatchJob, "application/connect+json", MakeEnvelope(0, R"({"name":"jobs/idle"})")));
  connect.ReadUntil("\"snapshot\"");
  connect.Send(Get("/healthz"));
  RawClient events(cell_.port());
  events.Send(Watch("idle"));
  for (int i = 0; i < 3; ++i) events.ReadUntil(": quiet\n\n");
  connect.Close();
  EXPECT_TRUE(FakeCell::Eventually([&] { return cell_.counters().cancelled == 1; }));
  events.Close();
  EXPECT_TRUE(AllEnded());
}

TEST_F(Streams, AbandonedUnaryCallIsCancelled) {
  RawClient client(cell_.port());
  client.Send(Post("/rmlcell.v1.JobService/GetJob", "application/json", R"({"name":"jobs/slow"})"));
  EXPECT_TRUE(FakeCell::Eventually([&] { return cell_.counters().open == 1; }));
  client.Close();
  EXPECT_TRUE(AllEnded());
  EXPECT_EQ(cell_.counters().cancelled, 1);
}

// A reader that never reads is dropped after the write timeout; it may come back and resume.
TEST_F(Streams, StuckReaderIsDropped) {
  RawClient client(cell_.port(), 4096);
  client.Send(Watch("flood"));
  EXPECT_EQ(client.ReadHead().status, 200);
  EXPECT_TRUE(AllEnded());
  EXPECT_EQ(cell_.counters().cancelled, 1);
}

// platform.md 2, pitfalls: at the stop handlers end their streams; event clients are told to come
// back, the others get the status.
TEST_F(Streams, StopTellsClientsToComeBack) {
  RawClient events(cell_.port());
  events.Send(Watch("stop"));
  events.ReadUntil("\"snapshot\"");
  RawClient connect(cell_.port());
  connect.Send(Post("/rmlcell.v1.JobService/WatchJob", "application/connect+json",
                    MakeEnvelope(0, R"({"name":"jobs/stop"})")));
  connect.ReadUntil("\"snapshot\"");
  RawClient idle(cell_.port());
  idle.Send(Get("/healthz"));
  EXPECT_EQ(idle.Read().status, 200);

  cell_.SetServing(false);
  EXPECT_EQ(Exchange(cell_.port(), Get("/healthz")).status, 503);
  cell_.web().StopAccepting();
  EXPECT_TRUE(idle.AtEnd());
  EXPECT_EQ(RawClient(cell_.port()).Send("x") && RawClient(cell_.port()).Read().status != 0, false);
  cell_.StopStreams();
  EXPECT_NE(events.ReadUntil("0\r\n\r\n").find("event: reconnect\ndata: {\"code\":\"unavailable\""),
            std::string::npos);
  EXPECT_NE(connect.ReadUntil("0\r\n\r\n").find("{\"error\":{\"code\":\"unavailable\""),
            std::string::npos);
  cell_.web().Stop(std::chrono::minutes(1));  // nothing is left that it would have to cut off
  // Its client may have heard of the end of a call before its server has.
  EXPECT_TRUE(FakeCell::Eventually([&] { return cell_.counters().open == 0; }));
  EXPECT_EQ(cell_.counters().cancelled, 0);
  for (const WebLogEntry& entry : cell_.log()) EXPECT_TRUE(entry.finished) << entry.path;
}

// Streams that do not end are cut off when the grace is over.
TEST_F(Streams, StopEndsWhatDoesNotEnd) {
  RawClient idle(cell_.port());
  idle.Send(Watch("idle"));
  idle.ReadUntil("\"snapshot\"");
  RawClient flood(cell_.port(), 4096);
  flood.Send(Watch("flood"));
  flood.ReadHead();
  RawClient half(cell_.port());
  half.Send("GET / HTT");
  cell_.web().Stop(milliseconds(300));
  EXPECT_TRUE(FakeCell::Eventually([&] { return cell_.counters().open == 0; }));
  EXPECT_EQ(cell_.web().connections(), 0U);
}

// Hundreds of streams that leave in every way: all calls are cancelled, no descriptor is left.
TEST_F(Streams, NothingLeaks) {
  EXPECT_TRUE(AllEnded());
  const std::ptrdiff_t before = OpenDescriptors();
  for (int round = 0; round < 4; ++round) {
    std::vector<std::unique_ptr<RawClient>> clients;
    for (int i = 0; i < 60; ++i) {
      clients.push_back(std::make_unique<RawClient>(cell_.port()));
      clients.back()->Send(Watch(i % 3 == 0 ? "flood" : i % 3 == 1 ? "idle" : "1"));
    }
    for (std::size_t i = 0; i < clients.size(); ++i) {
      if (i % 2 == 0) clients[i]->ReadHead();
      if (i % 5 == 0) clients[i]->Reset();
    }
  }
  // Whoever is served now stood behind all of them: none is still to be taken.
  EXPECT_EQ(Exchange(cell_.port(), Get("/favicon.svg")).status, 200);
  // A call that was left may come to its server behind all that, and ends there.
  EXPECT_TRUE(FakeCell::Eventually(
      [&] { return cell_.counters().open == 0 && OpenDescriptors() <= before + 2; }));
  EXPECT_TRUE(AllEnded());
}

// Many streams on one thread, each with its own events in order.
TEST_F(Streams, ManyAtOnce) {
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 300; ++i) {
    clients.push_back(std::make_unique<RawClient>(cell_.port()));
    clients.back()->Send(Watch("1"));
  }
  for (const auto& client : clients) {
    const RawResponse response = client->Read();
    ASSERT_TRUE(response.complete);
    std::size_t at = 0;
    for (int id = 1; id <= 5; ++id) {
      at = response.body.find("id: " + std::to_string(id) + "\n", at);
      ASSERT_NE(at, std::string::npos);
    }
  }
}

// The next message is made only when the socket took the last: a reader that does not read stops
// its producer after what the buffers of the connection hold, and others are served meanwhile.
TEST(SlowReader, SlowsItsProducerOnly) {
  constexpr int kReceiveBytes = 64 << 10;
  constexpr int kSendBytes = 256 << 10;    // the gateway gives each connection so much
  constexpr int kSegmentBytes = 64 << 10;  // by which a buffer of the system may be overrun
  // The system doubles what it is asked for (socket(7)). One message more is being written, and the
  // one after it is made but larger than the window of gRPC, so it does not get away.
  constexpr int kHeld = (2 * kReceiveBytes + 2 * kSendBytes + 2 * kSegmentBytes) / kFloodBytes + 2;
  FakeCell cell;
  RawClient client(cell.port(), kReceiveBytes);
  client.Send(Watch("flood"));
  EXPECT_EQ(client.ReadHead().status, 200);
  // Others have hundreds of their calls answered by the same threads, in which it could make
  // thousands.
  for (int i = 0; i < 300; ++i) {
    ASSERT_EQ(
        Exchange(cell.port(), Post(kGetJob, "application/json", R"({"name":"jobs/1"})")).status,
        200);
  }
  EXPECT_TRUE(FakeCell::Eventually([&] { return cell.counters().produced > 0; }));
  EXPECT_LE(cell.counters().produced, kHeld);
  for (int read = 1; read <= 60; ++read) {
    ASSERT_NE(client.ReadUntil("\r\nid: ").size(), 0U);
    ASSERT_LE(cell.counters().produced, read + kHeld);
  }
  EXPECT_GE(cell.counters().produced, 60);  // it went on when it was read
}

// Several threads of the gateway serve the same requests.
TEST(StreamsOnThreads, FourThreads) {
  WebOptions options = Quick();
  options.io_threads = 4;
  FakeCell cell(options);
  std::vector<std::thread> threads;
  std::atomic<int> good{0};
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 30; ++i) {
        good +=
            Exchange(cell.port(), Watch("1")).body.ends_with("event: end\ndata: {}\n\n") ? 1 : 0;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(good, 240);
}

}  // namespace
}  // namespace rmlcell::web::testing
