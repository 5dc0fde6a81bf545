// Errors in each protocol's own form, and what is not offered.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "rmlcell/v1/job.pb.h"
#include "server/web/base64.h"
#include "server/web/envelope.h"
#include "tests/server/web/fake_cell.h"
#include "tests/server/web/raw_client.h"

namespace rmlcell::web::testing {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kSubmitJob = "/rmlcell.v1.JobService/SubmitJob";
constexpr std::string_view kMissing = R"({"name":"jobs/999"})";

class RpcErrors : public ::testing::Test {
 protected:
  FakeCell cell_;
};

// design.md 5: status, code name, message, and details with @type, for people and curl.
TEST_F(RpcErrors, PlainJson) {
  const RawResponse response = Exchange(cell_.port(), Post(kGetJob, "application/json", kMissing));
  EXPECT_EQ(response.status, 404);
  EXPECT_EQ(response.Header("content-type"), "application/json");
  const Json json = Json::parse(response.body);
  EXPECT_EQ(json["code"], "not_found");
  EXPECT_EQ(json["message"], "no job f\u00FCr 100 %\njobs/999");
  EXPECT_EQ(json["details"][0]["@type"], "type.googleapis.com/google.rpc.ErrorInfo");
  EXPECT_EQ(json["details"][0]["reason"], "HOLE_RADIUS_ZERO");
  EXPECT_EQ(json["details"][1]["@type"], "type.googleapis.com/rmlcell.v1.ErrorDetail");
  EXPECT_EQ(json["details"][1]["code"], "CELL-E9004");
  EXPECT_EQ(json["details"][1]["place"]["line"], 12);
}

// Connect: the details are base64 without padding and give back the message.
TEST_F(RpcErrors, ConnectUnary) {
  const RawResponse response = Exchange(
      cell_.port(), Post(kGetJob, "application/json", kMissing, "Connect-Protocol-Version: 1\r\n"));
  EXPECT_EQ(response.status, 404);
  const Json detail = Json::parse(response.body)["details"][0];
  EXPECT_EQ(detail["type"], "google.rpc.ErrorInfo");
  const std::string value = detail["value"];
  EXPECT_EQ(value.find('='), std::string::npos);
  google::rpc::ErrorInfo info;
  ASSERT_TRUE(info.ParseFromString(Base64Decode(value).value_or("?")));
  EXPECT_EQ(info.metadata().at("code"), "CELL-E9004");
  EXPECT_EQ(detail["debug"]["reason"], "HOLE_RADIUS_ZERO");
}

// gRPC-Web: HTTP 200, percent-encoded text, the whole status in grpc-status-details-bin.
TEST_F(RpcErrors, GrpcWeb) {
  v1::GetJobRequest request;
  request.set_name("jobs/999");
  const RawResponse response = Exchange(
      cell_.port(),
      Post(kGetJob, "application/grpc-web+proto", MakeEnvelope(0, request.SerializeAsString())));
  EXPECT_EQ(response.status, 200);
  ASSERT_GT(response.body.size(), 5U);
  EXPECT_EQ(static_cast<unsigned char>(response.body[0]), 0x80);
  const std::string trailers = response.body.substr(5);
  EXPECT_TRUE(trailers.starts_with(
      "grpc-status: 5\r\ngrpc-message: no job f%C3%BCr 100 %25%0Ajobs/999\r\n"));
  const std::size_t at = trailers.find("grpc-status-details-bin: ") + 25;
  google::rpc::Status rich;
  ASSERT_TRUE(rich.ParseFromString(
      Base64Decode(trailers.substr(at, trailers.find('\r', at) - at)).value_or("?")));
  EXPECT_EQ(rich.code(), 5);
  EXPECT_EQ(rich.details_size(), 2);
}

// An error in the middle of a stream comes after the messages before it, in every form.
TEST_F(RpcErrors, InMidStream) {
  const RawResponse events =
      Exchange(cell_.port(), Post(kWatchJob, "application/json", R"({"name":"jobs/fail"})"));
  EXPECT_NE(events.body.find("id: 2\n"), std::string::npos);
  const std::size_t at = events.body.find("event: error\ndata: ") + 19;
  const Json error = Json::parse(events.body.substr(at, events.body.find('\n', at) - at));
  EXPECT_EQ(error["code"], "failed_precondition");
  EXPECT_EQ(error["details"][1]["code"], "OPT-E348");
  EXPECT_EQ(events.body.find("event: end"), std::string::npos);

  const RawResponse connect = Exchange(
      cell_.port(),
      Post(kWatchJob, "application/connect+json", MakeEnvelope(0, R"({"name":"jobs/fail"})")));
  EXPECT_EQ(connect.status, 200);
  const std::size_t json = connect.body.rfind(R"({"error":{"code":"failed_precondition")");
  ASSERT_NE(json, std::string::npos);
  EXPECT_EQ(connect.body[json - 5], 2);
  EXPECT_EQ(Json::parse(connect.body.substr(json))["error"]["details"][0]["type"],
            "google.rpc.ErrorInfo");
}

TEST_F(RpcErrors, MethodsThatAreNotOffered) {
  const std::pair<std::string_view, int> rows[] = {
      {"/rmlcell.v1.JobService/Nothing", 404},
      {"/rmlcell.v1.NoService/GetJob", 404},
      {"/rmlcell.v1.WorkerService/Work", 404},
      {"/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", 404},
      {"/rmlcell.v1.ProgramService/UploadProgram", 501}};
  for (const auto& [path, status] : rows) {
    const RawResponse response = Exchange(cell_.port(), Post(path, "application/json", "{}"));
    EXPECT_EQ(response.status, status) << path;
    EXPECT_EQ(Json::parse(response.body)["code"], "unimplemented") << path;
    const RawResponse web =
        Exchange(cell_.port(), Post(path, "application/grpc-web+proto", MakeEnvelope(0, "")));
    EXPECT_EQ(web.status, 200) << path;
    EXPECT_EQ(web.body.substr(5, 16), "grpc-status: 12\r") << path;
  }
  // A service that is there but does not have the method yet.
  EXPECT_EQ(Exchange(cell_.port(), Post("/rmlcell.v1.JobService/HoldJob", "application/json", "{}"))
                .status,
            501);
}

// A POST without one of our content types could come from the form of a foreign page.
TEST_F(RpcErrors, ContentTypes) {
  for (const std::string_view type :
       {"", "text/plain", "application/x-www-form-urlencoded", "multipart/form-data; boundary=x",
        "application/grpc", "application/xml", "application/json; charset=latin1",
        "application/connect+json"}) {
    const RawResponse response = Exchange(cell_.port(), Post(kSubmitJob, type, "{}"));
    EXPECT_EQ(response.status, 415) << type;
    EXPECT_NE(response.Header("accept-post").find("application/json"), std::string::npos) << type;
  }
  EXPECT_EQ(Exchange(cell_.port(), Post(kWatchJob, "application/proto", "")).status, 415);
  EXPECT_EQ(cell_.counters().submitted, 0);
}

// No GET changes anything, whatever its query says.
TEST_F(RpcErrors, GetNeverChangesAnything) {
  const RawResponse response = Exchange(cell_.port(), Get(std::string(kSubmitJob) + "?message={}"));
  EXPECT_EQ(response.status, 405);
  EXPECT_EQ(response.Header("allow"), "POST");
  for (const std::string_view method : {"PUT", "DELETE", "PATCH", "HEAD"}) {
    const std::string request = std::string(method) + " " + std::string(kSubmitJob) +
                                " HTTP/1.1\r\nHost: localhost\r\n\r\n";
    EXPECT_EQ(Exchange(cell_.port(), request).status, 405) << method;
  }
  EXPECT_EQ(cell_.counters().submitted, 0);
}

TEST_F(RpcErrors, WhatCannotBeRead) {
  for (const std::string_view body : {"{", "{\"nam\":1}", "[]", "\xFF", "{\"name\":\"\xFF\"}"}) {
    const RawResponse response = Exchange(cell_.port(), Post(kGetJob, "application/json", body));
    EXPECT_EQ(response.status, 400) << body;
    const Json json = Json::parse(response.body);
    EXPECT_EQ(json["code"], "invalid_argument");
    EXPECT_EQ(json["details"][1]["code"], "CELL-E9003");
  }
  for (const std::string_view header :
       {"Connect-Protocol-Version: 2\r\n", "Connect-Timeout-Ms: soon\r\n", "Grpc-Timeout: 1x\r\n",
        "Authorization: a\xFF\r\n"}) {
    EXPECT_EQ(Exchange(cell_.port(), Post(kGetJob, "application/json", "{}", header)).status, 400)
        << header;
  }
  EXPECT_EQ(
      Exchange(cell_.port(), Post(kGetJob, "application/json", "{}", "Content-Encoding: gzip\r\n"))
          .status,
      501);
  EXPECT_EQ(Exchange(cell_.port(), Get(std::string(kGetJob) + "?message=%7")).status, 400);
  EXPECT_EQ(Exchange(cell_.port(), Get(std::string(kGetJob) + "?message=***&base64=1")).status,
            400);
  // Bytes that are no message are refused by the server itself.
  EXPECT_NE(Exchange(cell_.port(), Post(kGetJob, "application/proto", "\xFF\xFF\xFF")).status, 200);
  EXPECT_EQ(cell_.counters().calls, 0);
}

}  // namespace
}  // namespace rmlcell::web::testing
