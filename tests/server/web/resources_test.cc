// Stable URLs, uploads, health and the page.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/server/web/fake_cell.h"
#include "tests/server/web/raw_client.h"

namespace rmlcell::web::testing {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kPicture = "/v1/jobs/17/artifacts/picture.svg";
constexpr std::string_view kContent = "/v1/machines/optimo-1/programs/45/content";

WebOptions SmallUploads() {
  WebOptions options = AnyPort();
  options.upload_bytes_max = 1'000'000;
  return options;
}

class Resources : public ::testing::Test {
 protected:
  FakeCell cell_{SmallUploads()};
};

TEST_F(Resources, PictureWithEtag) {
  const RawResponse response = Exchange(cell_.port(), Get(kPicture));
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(response.Header("content-type"), "image/svg+xml");
  EXPECT_EQ(response.Header("x-content-type-options"), "nosniff");
  EXPECT_NE(response.Header("content-security-policy").find("default-src 'none'"),
            std::string::npos);
  EXPECT_NE(response.Header("content-security-policy").find("sandbox"), std::string::npos);
  EXPECT_EQ(response.Header("etag"), "\"picture-1\"");
  EXPECT_EQ(response.Header("cache-control"), "private, no-cache");
  EXPECT_EQ(response.Header("cross-origin-resource-policy"), "same-origin");
  EXPECT_FALSE(response.Header("date").empty());
  EXPECT_TRUE(response.body.starts_with("<svg"));
  const RawResponse same =
      Exchange(cell_.port(), Get(kPicture, "If-None-Match: W/\"picture-1\"\r\n"));
  EXPECT_EQ(same.status, 304);
  EXPECT_EQ(same.Header("etag"), "\"picture-1\"");
  EXPECT_EQ(same.headers.contains("content-length"), false);
  EXPECT_EQ(Exchange(cell_.port(), Get(kPicture, "If-None-Match: \"picture-2\"\r\n")).status, 200);
}

// HEAD has the headers of GET and no body, also where GET is a stream.
TEST_F(Resources, Head) {
  for (const std::string& path :
       {std::string(kPicture), std::string("/v1/jobs/17/artifacts/toolpath"), std::string("/")}) {
    const RawResponse get = Exchange(cell_.port(), Get(path));
    RawClient client(cell_.port());
    client.Send("HEAD " + path + " HTTP/1.1\r\nHost: localhost\r\n\r\n" + Get("/healthz"));
    const RawResponse head = client.Read(true);
    EXPECT_EQ(head.status, 200) << path;
    EXPECT_EQ(head.Header("content-length"), std::to_string(get.body.size())) << path;
    EXPECT_EQ(head.Header("etag"), get.Header("etag")) << path;
    EXPECT_EQ(client.Read().body, "{\"status\":\"SERVING\"}\n") << path;  // nothing stood between
  }
}

TEST_F(Resources, LongDownloadsComePieceByPiece) {
  const RawResponse response = Exchange(cell_.port(), Get("/v1/jobs/17/artifacts/toolpath"));
  EXPECT_EQ(response.Header("content-length"), "3000001");
  ASSERT_TRUE(response.complete);
  for (const std::size_t i : {0U, 65535U, 65536U, 2'999'999U, 3'000'000U}) {
    EXPECT_EQ(response.body[i], static_cast<char>('a' + (i / 7 + i) % 26)) << i;
  }
  EXPECT_EQ(cell_.resources().largest_piece, 65'536U);  // in memory at once
}

// A download that breaks is visibly too short, never completed with nothing.
TEST_F(Resources, BrokenDownloadIsVisible) {
  const RawResponse response = Exchange(cell_.port(), Get("/v1/jobs/17/artifacts/broken"));
  EXPECT_EQ(response.status, 200);
  EXPECT_FALSE(response.complete);
  EXPECT_LE(response.body.size(), 200'000U);
}

// One that has more than was announced is cut off as well: what is too much would be taken for the
// next answer.
TEST_F(Resources, DownloadOfMoreThanAnnouncedIsCutOff) {
  const RawResponse response = Exchange(cell_.port(), Get("/v1/jobs/17/artifacts/longer"));
  EXPECT_EQ(response.Header("content-length"), "200000");
  EXPECT_FALSE(response.complete);
  EXPECT_LT(response.body.size(), 200'000U);
}

// Behind a whole download the connection serves on.
TEST_F(Resources, ConnectionOutlivesADownload) {
  RawClient client(cell_.port());
  client.Send(Get("/v1/jobs/17/artifacts/toolpath"));
  const RawResponse response = client.Read();
  EXPECT_TRUE(response.complete);
  EXPECT_EQ(response.body.size(), 3'000'001U);
  client.Send(Get("/healthz"));
  EXPECT_EQ(client.Read().body, "{\"status\":\"SERVING\"}\n");
}

TEST_F(Resources, ProgramsAreSavedAsFiles) {
  const RawResponse response = Exchange(cell_.port(), Get(std::string(kContent) + "?form=listing"));
  EXPECT_EQ(response.body, "; 45 listing\n");
  EXPECT_EQ(response.Header("content-disposition"),
            "attachment; filename=\"Tr__ger _1_.S\"; filename*=UTF-8''Tr%C3%A4ger%20%221%22.S");
  EXPECT_EQ(response.Header("content-type"), "text/plain; charset=utf-8");
}

TEST_F(Resources, Errors) {
  const RawResponse missing = Exchange(cell_.port(), Get("/v1/jobs/17/artifacts/none"));
  const auto error = [&](const std::string& request) {
    const RawResponse response = Exchange(cell_.port(), request);
    return std::to_string(response.status) + " " +
           std::string(Json::parse(response.body)["details"][1]["code"]);
  };
  EXPECT_EQ(error(Get("/nothing")), "404 CELL-E9004");
  EXPECT_EQ(error(Get("/v1/jobs/17/artifacts/..%2f..%2fetc%2fpasswd")), "400 CELL-E9003");
  EXPECT_EQ(error(Get("/v1/jobs/17/artifacts/throw")), "500 CELL-E9001");
  EXPECT_EQ(error(Get(kPicture, "Authorization: \xFF\r\n")), "400 CELL-E9003");
  EXPECT_EQ(error(Post(kPicture, "application/octet-stream", "x")), "405 CELL-E9014");
  EXPECT_EQ(error(Post("/page.js", "application/json", "{}")), "405 CELL-E9014");
  EXPECT_EQ(error(Post("/healthz", "application/json", "{}")), "405 CELL-E9014");
  EXPECT_EQ(missing.status, 404);
  EXPECT_EQ(Json::parse(missing.body)["details"][1]["code"], "CELL-E9004");
  EXPECT_EQ(Exchange(cell_.port(), Get("/v1/machines/none/programs/45/content")).status, 404);
  EXPECT_EQ(Exchange(cell_.port(), Get("/v1/machines/optimo-1/programs/200/content")).status, 400);
  EXPECT_EQ(Exchange(cell_.port(), Get("/v1/jobs/17/artifacts/..%2f..%2fetc%2fpasswd")).status,
            400);
  EXPECT_EQ(Exchange(cell_.port(), Get("/v1/jobs/17/artifacts/throw")).status, 500);
  const RawResponse put = Exchange(
      cell_.port(), "PUT " + std::string(kContent) + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(put.status, 405);
  EXPECT_EQ(put.Header("allow"), "GET, HEAD, POST");
  EXPECT_EQ(Exchange(cell_.port(), Post(kPicture, "application/octet-stream", "x")).status, 405);
}

TEST_F(Resources, CallerIsTheSameAsThatOfCalls) {
  Exchange(cell_.port(), Get(kPicture, "Authorization: Bearer t\r\nRmlcell-Web-Peer: x\r\n"));
  const std::lock_guard lock(cell_.resources().mutex);
  const WebCallerMetadata& caller = cell_.resources().last_caller;
  ASSERT_EQ(caller.size(), 3U);
  EXPECT_EQ(caller[0].second, kSecret);
  EXPECT_TRUE(caller[1].second.starts_with("127.0.0.1:"));
  EXPECT_EQ(caller[2], (std::pair<std::string, std::string>("authorization", "Bearer t")));
}

TEST_F(Resources, Upload) {
  std::string program;
  for (int i = 0; program.size() < 999'990; ++i) program += std::to_string(i) + ";";
  program.resize(999'999);
  const RawResponse response = Exchange(
      cell_.port(),
      Post(std::string(kContent) + "?file_name=part.S", "application/octet-stream", program));
  EXPECT_EQ(response.status, 200);
  const Json json = Json::parse(response.body);
  EXPECT_EQ(json["name"], "machines/optimo-1/programs/45");
  EXPECT_EQ(json["objectBytes"], "999999");
  EXPECT_EQ(cell_.resources().uploads["optimo-1/45"], program);
  EXPECT_EQ(cell_.resources().headers.back().size, 999'999);
  EXPECT_GT(cell_.resources().appended, 10);  // piece by piece
}

// web_server.h: each 64 KiB of an upload have the time to be read, so they are one piece.
TEST_F(Resources, PiecesOfAnUpload) {
  for (const auto& [bytes, pieces] : {std::pair{65'536U, 1}, {65'537U, 2}, {131'072U, 2}}) {
    const int before = cell_.resources().appended;
    EXPECT_EQ(
        Exchange(cell_.port(), Post(kContent, "application/octet-stream", std::string(bytes, 'x')))
            .status,
        200);
    EXPECT_EQ(cell_.resources().appended - before, pieces) << bytes;
  }
}

TEST_F(Resources, UploadInChunksAndWithContinue) {
  RawClient client(cell_.port());
  client.Send("POST " + std::string(kContent) +
              " HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/octet-stream\r\n"
              "Transfer-Encoding: chunked\r\nExpect: 100-continue\r\n\r\n");
  EXPECT_EQ(client.ReadUntil("\r\n\r\n"), "HTTP/1.1 100 Continue\r\n\r\n");
  client.Send("5\r\nMOVE \r\n3\r\nEND\r\n0\r\n\r\n");
  EXPECT_EQ(client.Read().status, 200);
  EXPECT_EQ(cell_.resources().uploads["optimo-1/45"], "MOVE END");
  EXPECT_EQ(cell_.resources().headers.back().size, -1);
}

// RFC 9110 10.1.1: who has nothing to send needs not be told to send it; the answer comes first.
TEST_F(Resources, AnUploadOfNothingIsNotWaitedFor) {
  const RawResponse answer = Exchange(
      cell_.port(), Post(kContent, "application/octet-stream", "", "Expect: 100-continue\r\n"));
  EXPECT_EQ(answer.status, 400);
  EXPECT_EQ(Json::parse(answer.body)["details"][1]["code"], "CELL-E9017");
}

// All or nothing: whatever goes wrong, nothing of the upload remains.
TEST_F(Resources, UploadsThatFail) {
  const auto upload = [&](const std::string& query, std::string_view body) {
    return Exchange(cell_.port(),
                    Post(std::string(kContent) + query, "application/octet-stream", body))
        .status;
  };
  EXPECT_EQ(upload("", std::string(1'000'001, 'x')), 413);
  EXPECT_EQ(upload("?file_name=full.S", std::string(500'000, 'x')), 429);
  EXPECT_EQ(upload("?file_name=throw.S", "x"), 500);
  EXPECT_EQ(upload("", ""), 400);
  EXPECT_EQ(upload("?sha256=1", "x"), 400);
  EXPECT_EQ(Exchange(cell_.port(), Post(kContent, "text/plain", "x")).status, 415);
  EXPECT_EQ(Exchange(cell_.port(), Post("/v1/machines/none/programs/45/content",
                                        "application/octet-stream", std::string(900'000, 'x')))
                .status,
            404);
  {
    RawClient left(cell_.port());
    left.Send(
        Post(kContent, "application/octet-stream", std::string(300'000, 'x')).substr(0, 200'000));
    EXPECT_TRUE(FakeCell::Eventually([&] { return cell_.resources().open_sinks == 1; }));
  }
  EXPECT_TRUE(FakeCell::Eventually([&] { return cell_.resources().open_sinks == 0; }));
  EXPECT_TRUE(cell_.resources().uploads.empty());
}

TEST_F(Resources, Health) {
  const RawResponse up = Exchange(cell_.port(), Get("/healthz"));
  EXPECT_EQ(up.status, 200);
  EXPECT_EQ(up.body, "{\"status\":\"SERVING\"}\n");
  cell_.SetServing(false);
  const RawResponse down = Exchange(cell_.port(), Get("/healthz"));
  EXPECT_EQ(down.status, 503);
  EXPECT_EQ(down.body, "{\"status\":\"NOT_SERVING\"}\n");
  EXPECT_EQ(Exchange(cell_.port(), Post("/healthz", "application/json", "{}")).status, 405);
}

TEST_F(Resources, Page) {
  const RawResponse page = Exchange(cell_.port(), Get("/"));
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.Header("content-type"), "text/html; charset=utf-8");
  const std::string policy = page.Header("content-security-policy");
  EXPECT_NE(policy.find("default-src 'none'"), std::string::npos);
  EXPECT_NE(policy.find("script-src 'self'"), std::string::npos);
  EXPECT_EQ(policy.find("unsafe"), std::string::npos);
  EXPECT_EQ(
      Exchange(cell_.port(), Get("/", "If-None-Match: " + page.Header("etag") + "\r\n")).status,
      304);
  EXPECT_EQ(Exchange(cell_.port(), Get("/page.js")).Header("content-type"),
            "text/javascript; charset=utf-8");
  EXPECT_EQ(Exchange(cell_.port(), Get("/page.css")).Header("content-type"),
            "text/css; charset=utf-8");
  EXPECT_EQ(Exchange(cell_.port(), Get("/favicon.svg")).Header("content-type"), "image/svg+xml");
  // The page works without any remote asset.
  for (const std::string name : {"/", "/page.js", "/page.css"}) {
    const std::string text = Exchange(cell_.port(), Get(name)).body;
    EXPECT_FALSE(text.empty());
    EXPECT_EQ(text.find("http://"), std::string::npos) << name;
    EXPECT_EQ(text.find("https://"), std::string::npos) << name;
  }
  for (const std::string path : {"/../CMakeLists.txt", "/index.html/", "/page.js/..", "//", "/.",
                                 "/etc/passwd", "/%2e%2e"}) {
    EXPECT_EQ(Exchange(cell_.port(), Get(path)).status, 404) << path;
  }
}

TEST_F(Resources, LogHasEveryRequestOnce) {
  Exchange(cell_.port(), Get("/healthz?token=secret", "X-Request-Id: r-7\r\n"));
  ASSERT_TRUE(FakeCell::Eventually([&] { return cell_.log().size() == 1; }));
  const WebLogEntry entry = cell_.log()[0];
  EXPECT_EQ(entry.method, "GET");
  EXPECT_EQ(entry.path, "/healthz");
  EXPECT_EQ(entry.request_id, "r-7");
  EXPECT_EQ(entry.http_status, 200);
  EXPECT_TRUE(entry.finished);
  EXPECT_GT(entry.bytes_sent, 20U);
}

// Each request by itself, on a connection that is used again; and once.
TEST_F(Resources, EachRequestIsLogged) {
  RawClient client(cell_.port());
  std::vector<std::size_t> sizes;
  for (int i = 0; i < 2; ++i) {
    client.Send(Get("/healthz?x=" + std::to_string(i)));
    const std::size_t head = client.ReadUntil("\r\n\r\n").size();
    sizes.push_back(head + client.ReadUntil("}\n").size());
  }
  client.Send(Get("/none"));
  EXPECT_EQ(client.Read().status, 404);
  client.Close();
  ASSERT_TRUE(FakeCell::Eventually(
      [&] { return cell_.log().size() == 3 && cell_.web().connections() == 0; }));
  const std::vector<WebLogEntry> log = cell_.log();
  ASSERT_EQ(log.size(), 3U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(log[i].method, "GET");
    EXPECT_EQ(log[i].path, "/healthz");
    EXPECT_EQ(log[i].request_id, "");
    EXPECT_EQ(log[i].http_status, 200);
    EXPECT_EQ(log[i].bytes_sent, sizes[i]);
    EXPECT_TRUE(log[i].finished);
    EXPECT_TRUE(log[i].peer.starts_with("127.0.0.1:")) << log[i].peer;
  }
  EXPECT_EQ(log[2].http_status, 404);
}

// A client that leaves before there is an answer.
TEST_F(Resources, WhoLeavesIsLoggedAsUnfinished) {
  RawClient client(cell_.port());
  client.Send(Post(kGetJob, "application/json", R"({"name":"jobs/slow"})"));
  EXPECT_TRUE(FakeCell::Eventually([&] { return cell_.counters().open == 1; }));
  client.Reset();
  ASSERT_TRUE(FakeCell::Eventually([&] { return !cell_.log().empty(); }));
  const WebLogEntry entry = cell_.log()[0];
  EXPECT_FALSE(entry.finished);
  EXPECT_EQ(entry.http_status, 0);
  EXPECT_EQ(entry.bytes_sent, 0U);
}

}  // namespace
}  // namespace rmlcell::web::testing
