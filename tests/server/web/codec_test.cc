// The pure parts: base64, envelopes, percent-encoding, deadlines, the texts of each protocol.
#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "google/rpc/status.pb.h"
#include "rmlcell/v1/cell.pb.h"
#include "rmlcell/v1/job.pb.h"
#include "server/web/base64.h"
#include "server/web/envelope.h"
#include "server/web/event_texts.h"
#include "server/web/rpc_codec.h"
#include "server/web/rpc_json.h"
#include "server/web/rpc_status.h"

namespace rmlcell::web {
namespace {

using Json = nlohmann::json;

// RFC 4648 section 10.
TEST(Base64, VectorsOfTheStandard) {
  const std::pair<std::string_view, std::string_view> vectors[] = {{"", ""},
                                                                   {"f", "Zg=="},
                                                                   {"fo", "Zm8="},
                                                                   {"foo", "Zm9v"},
                                                                   {"foob", "Zm9vYg=="},
                                                                   {"fooba", "Zm9vYmE="},
                                                                   {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : vectors) {
    EXPECT_EQ(Base64(bytes, true), text);
    EXPECT_EQ(Base64Decode(text), bytes);
    const std::string bare = Base64(bytes, false);
    EXPECT_EQ(bare.find('='), std::string::npos);
    EXPECT_EQ(Base64Decode(bare), bytes);
  }
}

// Of a view nothing counts that lies behind it in memory.
TEST(Base64, TheBytesBehindAreNotTaken) {
  EXPECT_EQ(Base64(std::string_view("fo\xFF").substr(0, 2), true), "Zm8=");
  EXPECT_EQ(Base64(std::string_view("f\xFF\xFF").substr(0, 1), true), "Zg==");
}

TEST(Base64, PiecesAndUrlAlphabet) {
  EXPECT_EQ(Base64Decode("Zg==Zm8=Zm9v"), "ffofoo");
  EXPECT_EQ(Base64Decode("-_-_"), Base64Decode("+/+/"));
}

TEST(Base64, RefusesWhatIsNone) {
  for (const std::string_view text :
       {"Z", "Zg=", "Zg=a", "=", "Zm9v=", "Zm 9v", "Zh==", "Zm9=", "Zg===", "A", "E", "Zm9vQ"}) {
    EXPECT_EQ(Base64Decode(text), std::nullopt) << text;
  }
  EXPECT_EQ(Base64Decode(std::string_view("\0AAA", 4)), std::nullopt);
}

TEST(Base64, AnyBytesComeBack) {
  std::mt19937 random(7);
  for (std::size_t size = 0; size < 200; ++size) {
    std::string bytes(size, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    EXPECT_EQ(Base64Decode(Base64(bytes, size % 2 == 0)), bytes);
  }
}

TEST(Envelope, LengthHasTheHighestByteFirst) {
  EXPECT_EQ(MakeEnvelope(0x80, "ab"), std::string("\x80\0\0\0\2ab", 7));
  EXPECT_EQ(MakeEnvelope(0, std::string(0x10203, 'x')).substr(0, 5), std::string("\0\0\1\2\3", 5));
  EXPECT_EQ(MakeEnvelope(0, std::string(0x1020304, 'x')).substr(0, 5),
            std::string("\0\1\2\3\4", 5));
  for (const std::size_t size :
       {std::size_t{0x102}, std::size_t{0x10203}, std::size_t{0x1020304}}) {
    const std::string whole = MakeEnvelope(0, std::string(size, 'x'));
    const EnvelopeRead read = ReadSingleEnvelope(whole);
    ASSERT_TRUE(read.message) << read.problem;
    EXPECT_EQ(read.message->size(), size);
  }
}

TEST(Envelope, OneMessageAndNothingElse) {
  EXPECT_EQ(ReadSingleEnvelope(MakeEnvelope(0, "abc")).message, "abc");
  const EnvelopeRead empty = ReadSingleEnvelope(MakeEnvelope(0, ""));
  ASSERT_TRUE(empty.message);
  EXPECT_EQ(*empty.message, "");
  const std::string two = MakeEnvelope(0, "a") + MakeEnvelope(0, "b");
  const std::string huge("\0\xFF\xFF\xFF\xFFz", 6);
  const std::string more("\0\1\0\0\1z", 6);  // by its highest byte alone
  for (const std::string& bad :
       {std::string(), std::string("\0\0\0\0", 4), MakeEnvelope(0, "abc").substr(0, 7), two, huge,
        more, MakeEnvelope(2, "{}"), MakeEnvelope(0x80, "")}) {
    EXPECT_FALSE(ReadSingleEnvelope(bad).message);
    EXPECT_FALSE(ReadSingleEnvelope(bad).problem.empty());
  }
  EXPECT_TRUE(ReadSingleEnvelope(MakeEnvelope(1, "x")).compressed);
}

// The grpc-timeout of the gRPC protocol: at most eight digits and one unit.
TEST(Timeouts, GrpcUnits) {
  using std::chrono::nanoseconds;
  EXPECT_EQ(ParseGrpcTimeout("1H"), nanoseconds(3'600'000'000'000));
  EXPECT_EQ(ParseGrpcTimeout("2M"), nanoseconds(120'000'000'000));
  EXPECT_EQ(ParseGrpcTimeout("3S"), nanoseconds(3'000'000'000));
  EXPECT_EQ(ParseGrpcTimeout("4m"), nanoseconds(4'000'000));
  EXPECT_EQ(ParseGrpcTimeout("5u"), nanoseconds(5'000));
  EXPECT_EQ(ParseGrpcTimeout("6n"), nanoseconds(6));
  EXPECT_EQ(ParseGrpcTimeout("99999999H"), std::chrono::hours(87600));  // held at ten years
  EXPECT_EQ(ParseGrpcTimeout("99999999M"), std::chrono::hours(87600));
  for (const std::string_view bad :
       {"", "S", "1", "1s", "-1S", "+1S", "1.5S", "123456789S", " 1S", "1S "}) {
    EXPECT_EQ(ParseGrpcTimeout(bad), std::nullopt) << bad;
  }
  EXPECT_EQ(ParseConnectTimeout("9999999999"), std::chrono::milliseconds(9'999'999'999));
  for (const std::string_view bad : {"", "-1", "1.0", "10000000000", "1e3", "0x10"}) {
    EXPECT_EQ(ParseConnectTimeout(bad), std::nullopt) << bad;
  }
}

// conventions.md 1, "Code to HTTP".
TEST(Codes, HttpStatusAndName) {
  const std::pair<int, std::pair<int, std::string_view>> rows[] = {
      {0, {200, "ok"}},
      {1, {499, "canceled"}},
      {3, {400, "invalid_argument"}},
      {4, {504, "deadline_exceeded"}},
      {5, {404, "not_found"}},
      {6, {409, "already_exists"}},
      {7, {403, "permission_denied"}},
      {8, {429, "resource_exhausted"}},
      {9, {400, "failed_precondition"}},
      {10, {409, "aborted"}},
      {12, {501, "unimplemented"}},
      {14, {503, "unavailable"}},
      {16, {401, "unauthenticated"}},
      {17, {500, "unknown"}},
      {-1, {500, "unknown"}}};
  for (const auto& [code, expected] : rows) {
    EXPECT_EQ(HttpStatusOf(code), expected.first) << code;
    EXPECT_EQ(CodeName(code), expected.second) << code;
  }
}

// The gRPC protocol: visible ASCII stays, '%' and everything else is escaped byte by byte.
TEST(GrpcMessage, PercentEncoding) {
  EXPECT_EQ(EncodeGrpcMessage("a b~"), "a b~");
  EXPECT_EQ(EncodeGrpcMessage("100 %\r\n"), "100 %25%0D%0A");
  EXPECT_EQ(EncodeGrpcMessage("f\xC3\xBCr"), "f%C3%BCr");
}

TEST(JsonText, EscapesAndMendsUtf8) {
  EXPECT_EQ(JsonString("a\"\\\n\x7F"), "\"a\\\"\\\\\\u000A\\u007F\"");
  EXPECT_EQ(JsonString("\xF0\x9F\x94\xA7"), "\"\xF0\x9F\x94\xA7\"");
  // A lone continuation, an overlong slash, a surrogate, a character cut off at the end.
  EXPECT_EQ(Json::parse(JsonString("\x80|\xC0\xAF|\xED\xA0\x80|\xE2\x82")),
            "\uFFFD|\uFFFD\uFFFD|\uFFFD\uFFFD\uFFFD|\uFFFD\uFFFD");
}

TEST(RpcJson, UnknownFieldsAreRefused) {
  const auto& type = *v1::GetJobRequest::descriptor();
  ASSERT_TRUE(JsonToBytes(type, R"({"name":"jobs/1"})"));
  EXPECT_FALSE(JsonToBytes(type, R"({"nam":"jobs/1"})"));
  EXPECT_FALSE(JsonToBytes(type, R"({"name":1})"));
  EXPECT_FALSE(JsonToBytes(type, "[]"));
  EXPECT_FALSE(JsonToBytes(type, "{"));
  EXPECT_FALSE(JsonToBytes(type, R"({"name":"a"} x)"));
}

// What a client sends wrongly is his mistake; what the server would answer wrongly is its own.
TEST(RpcJson, WhoseMistakeItIs) {
  const auto& type = *v1::GetJobRequest::descriptor();
  const auto json = JsonToBytes(type, "[]");
  ASSERT_FALSE(json);
  EXPECT_EQ(json.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_NE(json.error().detail.find("rmlcell.v1.GetJobRequest"), std::string::npos);
  const Status bytes = CheckBytes(type, "\xFF\xFF");
  ASSERT_FALSE(bytes);
  EXPECT_EQ(bytes.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_TRUE(CheckBytes(type, ""));
  const auto answer = BytesToJson(type, "\xFF\xFF");
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kCellInternal);
  EXPECT_FALSE(BytesToJson(type, "")->id);  // has no such field
}

// A message that can be read and not be written has no JSON.
TEST(RpcJson, WhatHasNoJsonIsTheServersMistake) {
  google::rpc::Status rich;
  rich.add_details()->set_type_url("types.example/shop.Detail");
  rich.mutable_details(0)->set_value("f");
  const auto answer = BytesToJson(*google::rpc::Status::descriptor(), rich.SerializeAsString());
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kCellInternal);
  EXPECT_EQ(answer.error().detail, "an answer cannot be written as JSON");
}

// Nesting is limited by the reader, not by the stack.
TEST(RpcJson, DeepNestingIsRefused) {
  const auto& type = *v1::SubmitJobRequest::descriptor();
  EXPECT_FALSE(JsonToBytes(type, std::string(200'000, '[')));
  std::string objects;
  for (int i = 0; i < 100'000; ++i) objects += "{\"job\":";
  EXPECT_FALSE(JsonToBytes(type, objects));
}

// Of a watch of the cell the log goes along: its first message may have the number 0.
TEST(RpcJson, AnEventOfTheCellIsNamedWithItsLog) {
  v1::WatchCellResponse response;
  const auto& type = *v1::WatchCellResponse::descriptor();
  EXPECT_FALSE(BytesToJson(type, response.SerializeAsString())->id);
  response.set_log_id("0198c5b2-aa");
  EXPECT_EQ(BytesToJson(type, response.SerializeAsString())->id->Text(), "0.0198c5b2-aa");
  response.set_sequence(42);
  EXPECT_EQ(BytesToJson(type, response.SerializeAsString())->id->Text(), "42.0198c5b2-aa");
  const std::optional<EventId> id = EventId::Parse("42.0198c5b2-aa");
  ASSERT_TRUE(id);
  v1::WatchCellRequest request;
  ASSERT_TRUE(request.ParseFromString(
      *JsonToBytes(*v1::WatchCellRequest::descriptor(), R"({"logId":"other"})", id)));
  EXPECT_EQ(request.after_sequence(), 42);
  EXPECT_EQ(request.log_id(), "0198c5b2-aa");
  for (const char* bad : {"", ".a", "1.", "1.A", "1.a b", "1.a/", "1.a:", "1.a`", "1.a{", "-1",
                          "1 ", "1/", "1:", "01x", "1.a.b", "00000000000000000017"})
    EXPECT_FALSE(EventId::Parse(bad)) << bad;
  EXPECT_FALSE(EventId::Parse("1." + std::string(65, 'a')));
  EXPECT_TRUE(EventId::Parse("1." + std::string(64, 'a')));
  EXPECT_EQ(EventId::Parse("90.az09-")->Text(), "90.az09-");
}

TEST(RpcJson, SequencesGoInAndComeOut) {
  const auto& type = *v1::WatchJobRequest::descriptor();
  const Result<std::string> bytes =
      JsonToBytes(type, R"({"name":"jobs/1","afterSequence":"2"})", EventId{.sequence = 41});
  ASSERT_TRUE(bytes);
  v1::WatchJobRequest request;
  ASSERT_TRUE(request.ParseFromString(*bytes));
  EXPECT_EQ(request.after_sequence(), 41);
  // Has no such field.
  EXPECT_TRUE(JsonToBytes(*v1::GetJobRequest::descriptor(), "{}", EventId{.sequence = 41}));
  v1::WatchJobResponse response;
  response.set_sequence(42);
  const Result<JsonMessage> json =
      BytesToJson(*v1::WatchJobResponse::descriptor(), response.SerializeAsString());
  ASSERT_TRUE(json);
  EXPECT_EQ(json->id->Text(), "42");
  EXPECT_FALSE(BytesToJson(*v1::WatchJobResponse::descriptor(), "\xFF\xFF"));
}

RpcRoute WatchRoute(Wire wire) {
  RpcRoute route;
  route.method =
      v1::Job::descriptor()->file()->FindServiceByName("JobService")->FindMethodByName("WatchJob");
  route.wire = wire;
  return route;
}

// A stopping server ends streams with UNAVAILABLE: event clients are told to come back.
TEST(Events, LastEvents) {
  EventTexts texts;
  const auto codec = MakeCodec(WatchRoute(Wire::kEvents), texts);
  EXPECT_EQ(codec->End({}, {}), "event: end\ndata: {}\n\n");
  const std::string stopped = codec->End({.code = 14, .message = "stops", .details = {}}, {});
  EXPECT_NE(stopped.find("event: reconnect\ndata: {\"code\":\"unavailable\""), std::string::npos);
  EXPECT_TRUE(stopped.starts_with("retry: "));
  const std::string failed = codec->End({.code = 9, .message = "two\nlines", .details = {}}, {});
  EXPECT_EQ(
      failed,
      "event: error\ndata: {\"code\":\"failed_precondition\",\"message\":\"two\\u000Alines\"}\n\n");
}

// A browser that watches the cell is told of several events by one message, whatever it asked for;
// what else it asked for stays.
TEST(Events, TheCellIsAskedForSeveralEventsAtOnce) {
  EventTexts texts;
  RpcRoute route = WatchRoute(Wire::kEvents);
  v1::WatchJobRequest of_job;
  of_job.set_name("jobs/1");
  EXPECT_EQ(MakeCodec(route, texts)->Asked(of_job.SerializeAsString()), of_job.SerializeAsString());
  route.method = v1::WatchCellRequest::descriptor()
                     ->file()
                     ->FindServiceByName("CellService")
                     ->FindMethodByName("WatchCell");
  v1::WatchCellRequest asked;
  asked.set_after_sequence(7);
  v1::WatchCellRequest sent;
  ASSERT_TRUE(sent.ParseFromString(MakeCodec(route, texts)->Asked(asked.SerializeAsString())));
  EXPECT_TRUE(sent.batched());
  EXPECT_EQ(sent.after_sequence(), 7);
}

// The Connect protocol: an error and metadata stand beside each other in the last envelope.
TEST(ConnectStream, AnErrorAndTrailersStandTogether) {
  EventTexts texts;
  const auto codec = MakeCodec(WatchRoute(Wire::kConnectStreamJson), texts);
  const std::string end =
      codec->End({.code = 9, .message = "no", .details = {}}, {{"a", "1"}, {"b", "2"}});
  EXPECT_EQ(end[0], 2);
  EXPECT_EQ(Json::parse(end.substr(5)),
            Json::parse(R"({"error":{"code":"failed_precondition","message":"no"},)"
                        R"("metadata":{"a":["1"],"b":["2"]}})"));
}

// The Connect protocol: a stream that is refused before it begins is 200, and its only envelope the
// last one.
TEST(ConnectStream, ARefusalIsALastEnvelope) {
  EventTexts texts;
  for (const auto& [wire, type] :
       {std::pair(Wire::kConnectStreamJson, "application/connect+json"),
        std::pair(Wire::kConnectStreamProto, "application/connect+proto")}) {
    const HttpResponse refusal =
        MakeCodec(WatchRoute(wire), texts)
            ->Refusal({.status = {.code = 3, .message = "bad", .details = {}}, .headers = {}});
    EXPECT_EQ(refusal.status, 200);
    EXPECT_EQ(refusal.body[0], 2);
    EXPECT_EQ(Json::parse(refusal.body.substr(5)),
              Json::parse(R"({"error":{"code":"invalid_argument","message":"bad"}})"));
    EXPECT_EQ(refusal.headers.back(), HeaderList::value_type("Content-Type", type));
  }
}

TEST(ConnectStream, TrailersAreGrouped) {
  EventTexts texts;
  const auto codec = MakeCodec(WatchRoute(Wire::kConnectStreamJson), texts);
  const std::string end = codec->End({}, {{"a", "1"}, {"b", "2"}, {"a", "3"}});
  EXPECT_EQ(end[0], 2);
  EXPECT_EQ(Json::parse(end.substr(5)), Json::parse(R"({"metadata":{"a":["1","3"],"b":["2"]}})"));
}

// A status that has no details says nothing of any.
TEST(RpcJson, AnErrorWithoutDetails) {
  google::rpc::Status rich;
  rich.set_code(5);
  const RpcStatus status{.code = 5, .message = "none", .details = rich.SerializeAsString()};
  EXPECT_EQ(PlainErrorJson(status), R"({"code":"not_found","message":"none"})");
  EXPECT_EQ(ConnectErrorJson(status), PlainErrorJson(status));
}

// What a server tells that this one does not know is told as it came.
TEST(RpcJson, ADetailOfAnotherServer) {
  google::rpc::Status rich;
  google::protobuf::Any& detail = *rich.add_details();
  detail.set_type_url("types.example/shop.Detail");
  detail.set_value("f");
  google::protobuf::Any& other = *rich.add_details();
  other.set_type_url("types.example/shop.Other");
  other.set_value("\xFF");
  const RpcStatus status{.code = 5, .message = "none", .details = rich.SerializeAsString()};
  const std::string head = R"({"code":"not_found","message":"none","details":[)";
  EXPECT_EQ(PlainErrorJson(status), head +
                                        R"({"@type":"types.example/shop.Detail","value":"Zg=="},)"
                                        R"({"@type":"types.example/shop.Other","value":"/w=="}]})");
  EXPECT_EQ(ConnectErrorJson(status), head + R"({"type":"shop.Detail","value":"Zg"},)"
                                             R"({"type":"shop.Other","value":"/w"}]})");
  rich.mutable_details()->RemoveLast();
  const RpcStatus one{.code = 5, .message = "none", .details = rich.SerializeAsString()};
  EXPECT_EQ(ConnectErrorJson(one), head + R"({"type":"shop.Detail","value":"Zg"}]})");
}

// gRPC-Web: in the text form each piece has its padding, or nobody knows where the next one begins;
// of gRPC's binary metadata there is none.
TEST(GrpcWebForm, PaddingIsInTheTextAlone) {
  RpcRoute route;
  route.wire = Wire::kGrpcWebText;
  const Result<std::string> text = MakeGrpcWeb(route)->Message("");
  ASSERT_TRUE(text);
  EXPECT_EQ(*text, "AAAAAAA=");
  route.wire = Wire::kGrpcWeb;
  EXPECT_EQ(MakeGrpcWeb(route)->End({.code = 5, .message = "m", .details = "d"}, {}),
            MakeEnvelope(0x80,
                         "grpc-status: 5\r\ngrpc-message: m\r\n"
                         "grpc-status-details-bin: ZA\r\n"));
}

// A header may never end early, whatever text is put into it.
TEST(Head, ControlCharactersCannotSplitHeaders) {
  const HttpResponse response{
      .status = 200, .headers = {{"X-A", "1\r\nX-B: 2"}}, .body = {}, .length = {}};
  const std::string head = SerializeHead(response, Framing::kLength, 3, true);
  EXPECT_EQ(
      head,
      "HTTP/1.1 200 OK\r\nX-A: 1  X-B: 2\r\nContent-Length: 3\r\nConnection: keep-alive\r\n\r\n");
}

}  // namespace
}  // namespace rmlcell::web
