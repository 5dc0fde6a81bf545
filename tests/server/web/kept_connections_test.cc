// A connection that is used again: what a request left behind is nothing to the
// next one.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/server/web/fake_cell.h"
#include "tests/server/web/raw_client.h"

namespace rmlcell::web::testing {
namespace {

constexpr std::string_view kFirstJob = R"({"name":"jobs/1"})";
constexpr std::string_view kSlot45 = "/v1/machines/optimo-1/programs/45/content";
constexpr std::string_view kWatchOfOne =
    "/rmlcell.v1.JobService/WatchJob?message={%22name%22:%22jobs/1%22}";

WebOptions ThousandBytes() {
  WebOptions options = AnyPort();
  options.call_bytes_max = 1000;
  return options;
}

class KeptConnections : public ::testing::Test {
 protected:
  RawResponse Asked(std::string_view request) {
    client_.Send(request);
    return client_.Read();
  }
  FakeCell cell_{ThousandBytes()};
  RawClient client_{cell_.port()};
};

// The limit is that of one body, however many came before.
TEST_F(KeptConnections, EachBodyHasTheWholeLimit) {
  const std::string body = "{\"name\":\"jobs/1\"" + std::string(983, ' ') + "}";
  ASSERT_EQ(body.size(), 1000U);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(Asked(Post(kGetJob, "application/json", body)).status, 200) << i;
}

// RFC 9110 10.1.1: whoever waits for it is told to go on, each time.
TEST_F(KeptConnections, EachExpectationIsAnswered) {
  for (int i = 0; i < 2; ++i) {
    client_.Send("POST " + std::string(kGetJob) +
                 " HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
                 "Content-Length: 17\r\nExpect: 100-continue\r\n\r\n");
    ASSERT_EQ(client_.ReadUntil("\r\n\r\n"), "HTTP/1.1 100 Continue\r\n\r\n") << i;
    EXPECT_EQ(Asked(kFirstJob).status, 200) << i;
  }
}

// No byte of an upload is taken for one of the next, which has none.
TEST_F(KeptConnections, AnUploadWithoutBytesHasNone) {
  const auto upload = [&](std::string_view bytes) {
    return Asked(Post(kSlot45, "application/octet-stream", bytes));
  };
  EXPECT_EQ(upload("").status, 400);
  EXPECT_EQ(upload("MOVE").status, 200);
  const RawResponse empty = upload("");
  EXPECT_EQ(empty.status, 400);
  EXPECT_EQ(nlohmann::json::parse(empty.body)["details"][1]["code"], "CELL-E9017");
  EXPECT_EQ(upload("END").status, 200);
  EXPECT_EQ(cell_.resources().uploads["optimo-1/45"], "END");
}

// What ends with one write, what ends with a last chunk, and what ends with its
// length.
TEST_F(KeptConnections, AnswersOfEveryKindFollowEachOther) {
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(Asked(Get("/healthz")).body, "{\"status\":\"SERVING\"}\n") << i;
    const RawResponse stream = Asked(Get(kWatchOfOne));
    EXPECT_TRUE(stream.complete) << i;
    EXPECT_TRUE(stream.body.ends_with("event: end\ndata: {}\n\n")) << i;
    const RawResponse download = Asked(Get("/v1/jobs/17/artifacts/toolpath"));
    EXPECT_TRUE(download.complete) << i;
    EXPECT_EQ(download.body.size(), 3'000'001U) << i;
    EXPECT_EQ(Asked(Post(kGetJob, "application/json", kFirstJob)).status, 200) << i;
  }
}

// Of who leaves before there is an answer the log says so, also where another
// was answered before.
TEST_F(KeptConnections, WhoLeavesLaterIsLoggedAsUnfinished) {
  EXPECT_EQ(Asked(Get("/healthz")).status, 200);
  client_.Send(Post(kGetJob, "application/json", R"({"name":"jobs/slow"})"));
  ASSERT_TRUE(FakeCell::Eventually([&] { return cell_.counters().open == 1; }));
  client_.Reset();
  ASSERT_TRUE(FakeCell::Eventually([&] { return cell_.log().size() == 2; }));
  const std::vector<WebLogEntry> log = cell_.log();
  EXPECT_TRUE(log[0].finished);
  EXPECT_EQ(log[1].path, kGetJob);
  EXPECT_EQ(log[1].http_status, 0);
  EXPECT_EQ(log[1].bytes_sent, 0U);
  EXPECT_FALSE(log[1].finished);
}

// Who goes while a long answer is on its way has not had it.
TEST_F(KeptConnections, WhoLeavesWithinAnAnswerIsLoggedAsUnfinished) {
  RawClient leaving(cell_.port(), 4096);
  leaving.Send(Post(kGetJob, "application/json", R"({"name":"jobs/huge"})"));
  EXPECT_EQ(leaving.ReadHead().status, 200);
  leaving.Reset();
  ASSERT_TRUE(FakeCell::Eventually([&] { return cell_.log().size() == 1; }));
  const WebLogEntry entry = cell_.log()[0];
  EXPECT_EQ(entry.http_status, 200);
  EXPECT_FALSE(entry.finished);
}

// A download that broke is no finished request, though its head went out.
TEST_F(KeptConnections, ABrokenDownloadIsLoggedAsUnfinished) {
  EXPECT_FALSE(Asked(Get("/v1/jobs/17/artifacts/broken")).complete);
  EXPECT_TRUE(client_.AtEnd());
  ASSERT_TRUE(FakeCell::Eventually([&] { return cell_.log().size() == 1; }));
  const WebLogEntry entry = cell_.log()[0];
  EXPECT_EQ(entry.http_status, 200);
  EXPECT_FALSE(entry.finished);
}

// How long a request took is counted from its own headers on.
TEST_F(KeptConnections, ARequestTakesItsOwnTime) {
  using std::chrono::steady_clock;
  const RawResponse slow = Asked(
      Post(kGetJob, "application/json", R"({"name":"jobs/slow"})", "Connect-Timeout-Ms: 500\r\n"));
  EXPECT_EQ(slow.status, 504);
  const auto begin = steady_clock::now();
  EXPECT_EQ(Asked(Get("/healthz")).status, 200);
  ASSERT_TRUE(FakeCell::Eventually([&] { return cell_.log().size() == 2; }));
  EXPECT_LE(cell_.log()[1].duration, steady_clock::now() - begin);
}

}  // namespace
}  // namespace rmlcell::web::testing
