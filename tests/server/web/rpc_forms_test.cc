// Every row of the table in platform.md section 3, byte by byte, against a real gRPC server.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "rmlcell/v1/job.pb.h"
#include "server/web/base64.h"
#include "server/web/envelope.h"
#include "tests/server/web/fake_cell.h"
#include "tests/server/web/raw_client.h"

namespace rmlcell::web::testing {
namespace {

using Json = nlohmann::json;

struct Frame {
  int flags = 0;
  std::string bytes;
};

// The envelopes of a body; the last one has flags -1 when the body ends inside of it.
std::vector<Frame> Frames(std::string_view body) {
  std::vector<Frame> frames;
  while (!body.empty()) {
    if (body.size() < 5) return frames.push_back({.flags = -1, .bytes = {}}), frames;
    std::size_t length = 0;
    for (int i = 1; i < 5; ++i)
      length = length * 256 + static_cast<unsigned char>(body[static_cast<std::size_t>(i)]);
    if (body.size() < 5 + length) return frames.push_back({.flags = -1, .bytes = {}}), frames;
    frames.push_back({static_cast<unsigned char>(body[0]), std::string(body.substr(5, length))});
    body.remove_prefix(5 + length);
  }
  return frames;
}

std::string JobRequest(const std::string& name) {
  v1::GetJobRequest request;
  request.set_name(name);
  return request.SerializeAsString();
}

class RpcForms : public ::testing::Test {
 protected:
  FakeCell cell_;
};

// platform.md 3, row 1: application/json on a unary method. 64-bit integers are strings, and fields
// with default values are printed.
TEST_F(RpcForms, JsonUnary) {
  const RawResponse response = Exchange(
      cell_.port(), Post(kGetJob, "application/json; charset=utf-8", R"({"name":"jobs/1"})"));
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(response.Header("content-type"), "application/json");
  EXPECT_EQ(response.Header("x-content-type-options"), "nosniff");
  const Json json = Json::parse(response.body);
  EXPECT_EQ(json["name"], "jobs/1");
  EXPECT_EQ(json["lastSequence"], "9007199254740993");
  EXPECT_EQ(json["state"], "STATE_UNSPECIFIED");
  EXPECT_EQ(json["title"], "");
}

// An empty body counts as {}, so `curl -X POST` needs no data.
TEST_F(RpcForms, EmptyJsonBodyIsAnEmptyMessage) {
  const RawResponse response = Exchange(
      cell_.port(), Post("/rmlcell.v1.MachineService/ListMachines", "application/json", ""));
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(Json::parse(response.body)["machines"][0]["name"], "machines/optimo-1");
}

// platform.md 3, row 2.
TEST_F(RpcForms, ConnectUnaryBinary) {
  const RawResponse response =
      Exchange(cell_.port(), Post(kGetJob, "application/proto", JobRequest("jobs/1")));
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(response.Header("content-type"), "application/proto");
  v1::Job job;
  ASSERT_TRUE(job.ParseFromString(response.body));
  EXPECT_EQ(job.name(), "jobs/1");
  EXPECT_EQ(job.last_sequence(), 9007199254740993);
}

// platform.md 3, row 3: ids from `sequence` (none for the snapshot, whose sequence is 0), data as
// JSON on one line, and the end as an event of its own.
TEST_F(RpcForms, EventsByPost) {
  const RawResponse response =
      Exchange(cell_.port(), Post(kWatchJob, "application/json", R"({"name":"jobs/1"})"));
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(response.Header("content-type"), "text/event-stream; charset=utf-8");
  EXPECT_EQ(response.Header("x-accel-buffering"), "no");
  EXPECT_TRUE(response.Header("cache-control").starts_with("no-cache"));
  EXPECT_TRUE(response.complete);
  const std::string& body = response.body;
  ASSERT_TRUE(body.starts_with("data: "));
  const Json first = Json::parse(body.substr(6, body.find('\n') - 6));
  EXPECT_EQ(first["snapshot"]["name"], "jobs/1");
  for (int i = 1; i <= 5; ++i) {
    const std::string id = "\n\nid: " + std::to_string(i) + "\ndata: {";
    EXPECT_NE(body.find(id), std::string::npos) << id;
  }
  EXPECT_EQ(body.find("id: 6"), std::string::npos);
  EXPECT_TRUE(body.ends_with("\n\nevent: end\ndata: {}\n\n"));
}

// platform.md 3, row 4: EventSource, which cannot POST; it resumes by Last-Event-ID, which goes
// into after_sequence (conventions.md 2) and outweighs what the query says.
TEST_F(RpcForms, EventsByGetResumeAfterLastEventId) {
  const std::string target = std::string(kWatchJob) + "?message=%7B%22name%22%3A%22jobs%2F1%22%7D";
  const RawResponse whole = Exchange(cell_.port(), Get(target, "Accept: text/event-stream\r\n"));
  EXPECT_EQ(whole.status, 200);
  EXPECT_NE(whole.body.find("id: 1\n"), std::string::npos);
  const RawResponse rest = Exchange(cell_.port(), Get(target, "Last-Event-ID: 3\r\n"));
  EXPECT_EQ(rest.body.find("id: 3\n"), std::string::npos);
  EXPECT_NE(rest.body.find("id: 4\n"), std::string::npos);
  EXPECT_NE(rest.body.find("id: 5\n"), std::string::npos);
}

// Last-Event-ID that is no number of ours is refused; it is not taken for zero, which would repeat
// events.
TEST_F(RpcForms, ForeignLastEventIdIsRefused) {
  for (const std::string_view id :
       {"abc", "-1", "1.A", "99999999999999999999", "9223372036854775808", "1 2"}) {
    const RawResponse response = Exchange(
        cell_.port(),
        Get(std::string(kWatchJob) + "?message={}", "Last-Event-ID: " + std::string(id) + "\r\n"));
    EXPECT_EQ(response.status, 400) << id;
  }
}

// A unary method by GET, for links and for people; Accept asks for events also there.
TEST_F(RpcForms, UnaryByGet) {
  const std::string target = std::string(kGetJob) + "?message={%22name%22:%22jobs/1%22}";
  const RawResponse json = Exchange(cell_.port(), Get(target));
  EXPECT_EQ(json.status, 200);
  EXPECT_EQ(Json::parse(json.body)["name"], "jobs/1");
  const RawResponse events =
      Exchange(cell_.port(), Get(target, "Accept: text/html, text/event-stream;q=0.9\r\n"));
  EXPECT_TRUE(events.body.starts_with("data: {")) << events.status << " " << events.body;
  EXPECT_TRUE(events.body.ends_with("event: end\ndata: {}\n\n"));
  // Connect's own GET: base64 and a binary message.
  const RawResponse binary = Exchange(
      cell_.port(), Get(std::string(kGetJob) + "?connect=v1&encoding=proto&base64=1&message=" +
                        Base64(JobRequest("jobs/1"), false)));
  EXPECT_EQ(binary.Header("content-type"), "application/proto");
  v1::Job job;
  ASSERT_TRUE(job.ParseFromString(binary.body));
  EXPECT_EQ(job.name(), "jobs/1");
}

// platform.md 3, row 5: envelopes; flag 2 closes the stream with JSON.
TEST_F(RpcForms, ConnectStreams) {
  const RawResponse json =
      Exchange(cell_.port(), Post(kWatchJob, "application/connect+json",
                                  MakeEnvelope(0, R"({"name":"jobs/1","afterSequence":"3"})")));
  EXPECT_EQ(json.status, 200);
  EXPECT_EQ(json.Header("content-type"), "application/connect+json");
  std::vector<Frame> frames = Frames(json.body);
  ASSERT_EQ(frames.size(), 4U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(frames[i].flags, 0) << i;
  EXPECT_EQ(Json::parse(frames[1].bytes)["sequence"], "4");
  EXPECT_EQ(frames[3].flags, 2);
  EXPECT_EQ(frames[3].bytes, "{}");

  v1::WatchJobRequest request;
  request.set_name("jobs/1");
  const RawResponse binary = Exchange(
      cell_.port(),
      Post(kWatchJob, "application/connect+proto", MakeEnvelope(0, request.SerializeAsString())));
  EXPECT_EQ(binary.Header("content-type"), "application/connect+proto");
  frames = Frames(binary.body);
  ASSERT_EQ(frames.size(), 7U);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(frames[i].flags, 0) << i;
  v1::WatchJobResponse last;
  ASSERT_TRUE(last.ParseFromString(frames[5].bytes));
  EXPECT_EQ(last.sequence(), 5);
  EXPECT_EQ(frames[6].flags, 2);
}

// platform.md 3, row 6: gRPC-Web, with trailers in a frame of flag 0x80.
TEST_F(RpcForms, GrpcWeb) {
  for (const std::string_view type : {"application/grpc-web", "application/grpc-web+proto"}) {
    const RawResponse response =
        Exchange(cell_.port(), Post(kGetJob, type, MakeEnvelope(0, JobRequest("jobs/1"))));
    EXPECT_EQ(response.status, 200);
    EXPECT_EQ(response.Header("content-type"), "application/grpc-web+proto");
    const std::vector<Frame> frames = Frames(response.body);
    ASSERT_EQ(frames.size(), 2U);
    EXPECT_EQ(frames[0].flags, 0);
    v1::Job job;
    ASSERT_TRUE(job.ParseFromString(frames[0].bytes));
    EXPECT_EQ(job.name(), "jobs/1");
    EXPECT_EQ(frames[1].flags, 0x80);
    EXPECT_EQ(frames[1].bytes, "grpc-status: 0\r\n");
  }
}

// platform.md 3, row 6: the text form is base64 both ways, also frame by frame with padding
// between.
TEST_F(RpcForms, GrpcWebText) {
  v1::WatchJobRequest request;
  request.set_name("jobs/1");
  request.set_after_sequence(4);
  const std::string frame = MakeEnvelope(0, request.SerializeAsString());
  const std::string body = Base64(frame.substr(0, 5), true) + Base64(frame.substr(5), true);
  const RawResponse response =
      Exchange(cell_.port(), Post(kWatchJob, "application/grpc-web-text", body));
  EXPECT_EQ(response.Header("content-type"), "application/grpc-web-text+proto");
  const auto bytes = Base64Decode(response.body);
  ASSERT_TRUE(bytes);
  const std::vector<Frame> frames = Frames(*bytes);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].flags, 0);
  EXPECT_EQ(frames[1].flags, 0);
  EXPECT_EQ(frames[2].flags, 0x80);
  EXPECT_EQ(frames[2].bytes, "grpc-status: 0\r\n");
}

// A message of zero bytes is a message: the end of a stream is told by a flag (platform.md 3,
// pitfalls).
TEST_F(RpcForms, EmptyMessageIsAMessage) {
  const RawResponse response =
      Exchange(cell_.port(), Post("/rmlcell.v1.MachineService/ListMachines",
                                  "application/grpc-web+proto", MakeEnvelope(0, "")));
  const std::vector<Frame> frames = Frames(response.body);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[1].bytes, "grpc-status: 0\r\n");
}

// The caller: our own metadata, the forwarded headers, nothing that a browser made up. Metadata of
// the answer comes back in each protocol's own place.
TEST_F(RpcForms, MetadataBothWays) {
  const RawResponse response = Exchange(
      cell_.port(),
      Post(kGetJob, "application/json", R"({"name":"jobs/meta"})",
           "Authorization: Bearer abc\r\nX-Request-Id: r-1\r\nX-Other: no\r\n"
           "Rmlcell-Web-Secret: guess\r\nrmlcell-web-peer: 1.2.3.4\r\nRmlcell-Role: admin\r\n"));
  ASSERT_EQ(response.status, 200);
  const std::string title = Json::parse(response.body)["title"];
  EXPECT_NE(title.find("authorization=Bearer abc\n"), std::string::npos);
  EXPECT_NE(title.find("x-request-id=r-1\n"), std::string::npos);
  EXPECT_NE(title.find("rmlcell-web-secret=" + std::string(kSecret) + "\n"), std::string::npos);
  EXPECT_NE(title.find("rmlcell-web-peer=127.0.0.1:"), std::string::npos);
  for (const std::string_view absent : {"guess", "1.2.3.4", "rmlcell-role", "x-other"}) {
    EXPECT_EQ(title.find(absent), std::string::npos) << absent;
  }
  EXPECT_EQ(response.Header("x-first"), "one");
  EXPECT_EQ(response.Header("trailer-x-last"), "three");  // the second of two
  EXPECT_EQ(response.Header("trailer-x-raw-bin"), "AP8");

  const RawResponse web = Exchange(cell_.port(), Post(kGetJob, "application/grpc-web+proto",
                                                      MakeEnvelope(0, JobRequest("jobs/meta"))));
  EXPECT_EQ(web.Header("x-first"), "one");
  const std::vector<Frame> frames = Frames(web.body);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_NE(frames[1].bytes.find("x-last: two\r\nx-last: three\r\n"), std::string::npos);
}

// Messages of more than gRPC's default of 4 MiB come through.
TEST_F(RpcForms, LargeAnswers) {
  const RawResponse big =
      Exchange(cell_.port(), Post(kGetJob, "application/json", R"({"name":"jobs/big"})"));
  EXPECT_EQ(Json::parse(big.body)["title"].get<std::string>().size(), std::size_t{1} << 20U);
  const RawResponse huge =
      Exchange(cell_.port(), Post(kGetJob, "application/proto", JobRequest("jobs/huge")));
  EXPECT_EQ(huge.status, 200);
  EXPECT_GT(huge.body.size(), std::size_t{6} << 20U);
}

// What is asked may be longer than what is read at a time: the end of the message comes last.
TEST_F(RpcForms, LargeRequests) {
  const std::string asked = "{\"name\":\"jobs/1\"" + std::string(200'000, ' ') + "}";
  const RawResponse response = Exchange(cell_.port(), Post(kGetJob, "application/json", asked));
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(Json::parse(response.body)["name"], "jobs/1");
}

// grpc-timeout and connect-timeout-ms become a deadline; the call behind is cancelled.
TEST_F(RpcForms, Deadlines) {
  const RawResponse connect = Exchange(
      cell_.port(),
      Post(kGetJob, "application/json", R"({"name":"jobs/slow"})", "Connect-Timeout-Ms: 100\r\n"));
  EXPECT_EQ(connect.status, 504);
  EXPECT_EQ(Json::parse(connect.body)["code"], "deadline_exceeded");
  const RawResponse web = Exchange(
      cell_.port(), Post(kGetJob, "application/grpc-web+proto",
                         MakeEnvelope(0, JobRequest("jobs/slow")), "grpc-timeout: 100m\r\n"));
  const std::vector<Frame> frames = Frames(web.body);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_TRUE(frames[0].bytes.starts_with("grpc-status: 4\r\n"));
  const RawResponse stream =
      Exchange(cell_.port(), Post(kWatchJob, "application/json", R"({"name":"jobs/idle"})",
                                  "Connect-Timeout-Ms: 100\r\n"));
  EXPECT_NE(stream.body.find("event: error\ndata: {\"code\":\"deadline_exceeded\""),
            std::string::npos);
  // Each call that came as far as its handler was cancelled there; on a slow machine not every one
  // does.
  const auto all_cancelled = [&] {
    return cell_.counters().open == 0 && cell_.counters().cancelled == cell_.counters().calls;
  };
  EXPECT_TRUE(FakeCell::Eventually([&] {
    Exchange(cell_.port(), Post(kGetJob, "application/json", R"({"name":"jobs/slow"})",
                                "Connect-Timeout-Ms: 100\r\n"));
    return cell_.counters().cancelled > 0;
  }));
  EXPECT_TRUE(FakeCell::Eventually(all_cancelled));
}

// The health service has a descriptor, so it is offered like any other.
TEST_F(RpcForms, HealthService) {
  const RawResponse response =
      Exchange(cell_.port(), Post("/grpc.health.v1.Health/Check", "application/json", "{}"));
  EXPECT_EQ(Json::parse(response.body)["status"], "SERVING");
}

}  // namespace
}  // namespace rmlcell::web::testing
