// The texts of HTTP: RFC 9110, RFC 9112, RFC 6266, and the percent-encoding of RFC 3986.
#include "server/web/http_message.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <map>
#include <string>
#include <string_view>

#include "engine/core/letters.h"
#include "server/web/rpc_status.h"

namespace rmlcell::web {
namespace {

TEST(HttpText, EveryHexDigitIsDecoded) {
  constexpr std::string_view kUpper = "0123456789ABCDEF";
  constexpr std::string_view kLower = "0123456789abcdef";
  for (unsigned byte = 0; byte < 256; ++byte) {
    for (const std::string_view digits : {kUpper, kLower}) {
      const std::string text = {'<', '%', digits[byte / 16], digits[byte % 16], '>'};
      EXPECT_EQ(PercentDecode(text, false), (std::string{'<', static_cast<char>(byte), '>'}))
          << text;
    }
  }
  // The neighbours of the digits, and escapes that the text ends in.
  for (const std::string text :
       {"%/0", "%:0", "%@0", "%G0", "%`0", "%g0", "%0/", "%0G", "%0g", "%", "%1", "a%2"}) {
    EXPECT_EQ(PercentDecode(text, false), std::nullopt) << text;
  }
  EXPECT_EQ(PercentDecode("a+b", true), "a b");
  EXPECT_EQ(PercentDecode("a+b", false), "a+b");
  EXPECT_EQ(PercentDecode("%20", true), " ");
  EXPECT_EQ(PercentDecode("", true), "");
}

TEST(HttpText, ParametersOfAQuery) {
  const auto value = [](std::string_view query, std::string_view name) {
    const QueryValue found = QueryParameter(query, name);
    EXPECT_TRUE(found.ok) << query;
    return found.value;
  };
  EXPECT_EQ(value("a=1&b=2&c=3", "a"), "1");
  EXPECT_EQ(value("a=1&b=2&c=3", "b"), "2");
  EXPECT_EQ(value("a=1&b=2&c=3", "c"), "3");
  EXPECT_EQ(value("a=1&a=2", "a"), "1");
  EXPECT_EQ(value("ab=1", "a"), std::nullopt);
  EXPECT_EQ(value("a", "a"), "");
  EXPECT_EQ(value("a=", "a"), "");
  EXPECT_EQ(value("a=b=c", "a"), "b=c");
  EXPECT_EQ(value("&&b=x+y", "b"), "x y");
  EXPECT_EQ(value("", "a"), std::nullopt);
  const QueryValue bad = QueryParameter("a=%4", "a");
  EXPECT_FALSE(bad.ok);
  EXPECT_FALSE(bad.value);
}

TEST(HttpText, TypesAndLists) {
  EXPECT_EQ(MediaType("Application/JSON; charset=utf-8"), "application/json");
  EXPECT_EQ(MediaType(" text/plain \t"), "text/plain");
  EXPECT_EQ(MediaType(""), "");
  EXPECT_TRUE(Accepts("text/html, text/event-stream;q=0.9", "text/event-stream"));
  EXPECT_TRUE(Accepts("TEXT/event-stream", "text/event-stream"));
  EXPECT_TRUE(Accepts("a/b,,text/event-stream,c/d", "text/event-stream"));
  EXPECT_TRUE(Accepts("text/html,text/event-stream", "text/event-stream"));
  for (const std::string_view other : {"", "*/*", "text/*", "text/event-streams", "text/html"}) {
    EXPECT_FALSE(Accepts(other, "text/event-stream")) << other;
  }
}

TEST(HttpText, BlanksAtBothEnds) {
  EXPECT_EQ(Trimmed(" \t a \t b \t ", kBlanks), "a \t b");
  EXPECT_EQ(Trimmed(" \t", kBlanks), "");
  EXPECT_EQ(Trimmed("a\n", kBlanks), "a\n");
}

TEST(HttpText, NamesOfFiles) {
  EXPECT_EQ(ContentDisposition("inline", "part-1_a.S"), "inline; filename=\"part-1_a.S\"");
  // Blanks, letters and what is not harmful stay in the old form.
  EXPECT_EQ(ContentDisposition("attachment", "a b~"), "attachment; filename=\"a b~\"");
  EXPECT_EQ(ContentDisposition("attachment", "AZaz09"), "attachment; filename=\"AZaz09\"");
  EXPECT_EQ(ContentDisposition("attachment", "M\xC3\xBC \"%\\/\x7F\x1F.S"),
            "attachment; filename=\"M__ ______.S\"; "
            "filename*=UTF-8''M%C3%BC%20%22%25%5C%2F%7F%1F.S");
}

// RFC 6266 and 8187: each byte as it is where that is safe, else "_" in the plain name and %XX in
// the other one, which is there only when it differs.
TEST(HttpText, EveryByteOfAFileName) {
  constexpr std::string_view kSafe =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_";
  for (int byte = 0; byte < 256; ++byte) {
    const char c = static_cast<char>(byte);
    const bool visible = byte >= 32 && byte <= 126 && std::string_view("\"\\%/").find(c) > 3;
    std::array<char, 4> hex{};
    std::snprintf(hex.data(), hex.size(), "%%%02X", static_cast<unsigned>(byte));
    const std::string plain(1, visible ? c : '_');
    const std::string encoded =
        kSafe.find(c) != std::string_view::npos ? std::string(1, c) : hex.data();
    const std::string alone = "inline; filename=\"" + plain + '"';
    EXPECT_EQ(ContentDisposition("inline", std::string(1, c)),
              visible ? alone : alone + "; filename*=UTF-8''" + encoded)
        << byte;
    EXPECT_EQ(ContentDisposition("inline", std::string("\xFF") + c),
              "inline; filename=\"_" + plain + "\"; filename*=UTF-8''%FF" + encoded)
        << byte;
  }
}

TEST(HttpText, SizesOfChunks) {
  EXPECT_EQ(ChunkHead(0), "0\r\n");
  EXPECT_EQ(ChunkHead(10), "a\r\n");
  EXPECT_EQ(ChunkHead(0x12abcdef), "12abcdef\r\n");
  EXPECT_EQ(ChunkHead(SIZE_MAX), "ffffffffffffffff\r\n");
}

TEST(HttpText, TargetsInBothForms) {
  struct Row {
    std::string target;
    std::string path;
    std::string query;
    std::string host;
  };
  const std::vector<Row> rows = {{"/a/b?c=d?e", "/a/b", "c=d?e", "header"},
                                 {"/a?", "/a", "", "header"},
                                 {"/", "/", "", "header"},
                                 {"", "/", "", "header"},
                                 {"?x=1", "/", "x=1", "header"},
                                 {"http://host:1/a?b", "/a", "b", "host:1"},
                                 {"https://host", "/", "", "host"},
                                 {"http://host?b", "/", "b", "host"}};
  for (const Row& row : rows) {
    HttpRequest request;
    request.host = "header";
    SetTarget(row.target, request);
    EXPECT_EQ(request.path, row.path) << row.target;
    EXPECT_EQ(request.query, row.query) << row.target;
    EXPECT_EQ(request.host, row.host) << row.target;
  }
}

TEST(HttpText, HeadersByNameAndCount) {
  HttpRequest request;
  request.headers = {{"a", "1"}, {"b", "2"}, {"a", "3"}};
  EXPECT_EQ(request.Header("a"), "1");
  EXPECT_EQ(request.Header("b"), "2");
  EXPECT_EQ(request.Header("c"), "");
  EXPECT_EQ(request.CountOf("a"), 2U);
  EXPECT_EQ(request.CountOf("b"), 1U);
  EXPECT_EQ(request.CountOf("c"), 0U);
}

TEST(HttpText, TheEndOfABodyIsToldInFourWays) {
  const HttpResponse response{.status = 204, .headers = {}, .body = {}, .length = {}};
  const std::string line = "HTTP/1.1 204 No Content\r\n";
  EXPECT_EQ(SerializeHead(response, Framing::kLength, 7, false),
            line + "Content-Length: 7\r\nConnection: close\r\n\r\n");
  EXPECT_EQ(SerializeHead(response, Framing::kChunked, 7, true),
            line + "Transfer-Encoding: chunked\r\nConnection: keep-alive\r\n\r\n");
  for (const Framing framing : {Framing::kClose, Framing::kNone}) {
    EXPECT_EQ(SerializeHead(response, framing, 7, false), line + "Connection: close\r\n\r\n");
  }
}

// RFC 9110 15, RFC 6585, and nginx's 499.
TEST(HttpText, EachStatusHasItsPhrase) {
  const std::map<int, std::string> phrases = {{100, "Continue"},
                                              {200, "OK"},
                                              {204, "No Content"},
                                              {304, "Not Modified"},
                                              {400, "Bad Request"},
                                              {401, "Unauthorized"},
                                              {403, "Forbidden"},
                                              {404, "Not Found"},
                                              {405, "Method Not Allowed"},
                                              {408, "Request Timeout"},
                                              {409, "Conflict"},
                                              {412, "Precondition Failed"},
                                              {413, "Content Too Large"},
                                              {415, "Unsupported Media Type"},
                                              {417, "Expectation Failed"},
                                              {429, "Too Many Requests"},
                                              {431, "Request Header Fields Too Large"},
                                              {499, "Client Closed Request"},
                                              {500, "Internal Server Error"},
                                              {501, "Not Implemented"},
                                              {503, "Service Unavailable"},
                                              {504, "Gateway Timeout"},
                                              {505, "HTTP Version Not Supported"}};
  for (int status = 100; status < 600; ++status) {
    const auto known = phrases.find(status);
    EXPECT_EQ(ReasonPhrase(status), known == phrases.end() ? "Status" : known->second) << status;
  }
}

// "Sun, 06 Nov 1994 08:49:37 GMT": RFC 9110 5.6.7.
TEST(HttpText, DatesHaveTheirForm) {
  const std::string date = HttpDate();
  ASSERT_EQ(date.size(), 29U);
  EXPECT_EQ(date.substr(3, 2), ", ");
  EXPECT_EQ(date.substr(25), " GMT");
  for (const std::size_t digit : {5U, 6U, 12U, 13U, 14U, 15U, 17U, 18U, 20U, 21U, 23U, 24U}) {
    EXPECT_TRUE(date[digit] >= '0' && date[digit] <= '9') << date;
  }
}

TEST(HttpText, DatesAreOfNow) {
  using std::chrono::system_clock;
  const std::time_t before = system_clock::to_time_t(system_clock::now());
  const std::string date = HttpDate();
  const std::time_t after = system_clock::to_time_t(system_clock::now());
  std::tm read{};
  ASSERT_NE(strptime(date.c_str(), "%a, %d %b %Y %H:%M:%S GMT", &read), nullptr) << date;
  const std::time_t told = timegm(&read);
  EXPECT_GE(told, before) << date;
  EXPECT_LE(told, after) << date;
}

// google/rpc/code.proto for those that conventions.md does not name; a number beyond the last is
// unknown.
TEST(Codes, TheOthers) {
  EXPECT_EQ(HttpStatusOf(2), 500);
  EXPECT_EQ(HttpStatusOf(11), 400);
  EXPECT_EQ(CodeName(11), "out_of_range");
  EXPECT_EQ(HttpStatusOf(13), 500);
  EXPECT_EQ(CodeName(13), "internal");
  EXPECT_EQ(HttpStatusOf(15), 500);
  EXPECT_EQ(CodeName(15), "data_loss");
  EXPECT_EQ(CodeName(2), "unknown");
}

// Unicode 15, table 3-7: the first and the last of each well-formed range stay, their neighbours
// are mended.
TEST(JsonText, EveryRangeOfUtf8) {
  for (const std::string_view good :
       {"\x7E", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xE0\xBF\xBF", "\xE1\x80\x80",
        "\xEC\xBF\xBF", "\xED\x80\x80", "\xED\x9F\xBF", "\xEE\x80\x80", "\xEF\xBF\xBF",
        "\xF0\x90\x80\x80", "\xF0\xBF\xBF\xBF", "\xF1\x80\x80\x80", "\xF3\xBF\xBF\xBF",
        "\xF4\x80\x80\x80", "\xF4\x8F\xBF\xBF"}) {
    EXPECT_EQ(JsonString(good), "\"" + std::string(good) + "\"");
  }
  const std::string mended = "\xEF\xBF\xBD";
  const auto times = [&](std::size_t count) {
    std::string out = "\"";
    for (std::size_t i = 0; i < count; ++i) out += mended;
    return out + "\"";
  };
  for (const std::string_view bad :
       {"\x80", "\xBF", "\xC0\x80", "\xC1\xBF", "\xC2", "\xDF\xC0", "\xE0\x9F\xBF", "\xED\xA0\x80",
        "\xEF\xBF\xC0", "\xEF\xC0\xBF", "\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80",
        "\xF0\x90\x80", "\xFF", "\xF0\x90\x80\xC0"}) {
    // Each byte that begins no character becomes one sign; a good tail of such bytes is none.
    EXPECT_EQ(JsonString(bad), times(bad.size())) << ::testing::PrintToString(std::string(bad));
  }
}

// A text that is cut within a character ends there, whatever lies behind it in memory.
TEST(JsonText, ACharacterThatIsCutIsMended) {
  const std::string_view euro = "\xE2\x82\xAC";
  EXPECT_EQ(JsonString(euro.substr(0, 2)), "\"\xEF\xBF\xBD\xEF\xBF\xBD\"");
  EXPECT_EQ(JsonString(euro.substr(0, 1)), "\"\xEF\xBF\xBD\"");
  EXPECT_EQ(JsonString(euro), "\"\xE2\x82\xAC\"");
}

TEST(JsonText, ControlCharactersAreEscaped) {
  EXPECT_EQ(JsonString(std::string("\0\x1F\x20\x7F", 4)), "\"\\u0000\\u001F \\u007F\"");
}

TEST(GrpcMessage, TheEndsOfWhatIsVisible) {
  EXPECT_EQ(EncodeGrpcMessage(std::string("\0\x1F\x20\x7E\x7F\x80\xFF", 7)), "%00%1F ~%7F%80%FF");
}

}  // namespace
}  // namespace rmlcell::web
