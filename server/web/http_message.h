#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// HTTP/1 requests and responses as plain values, without any network library: what the connection
// reads and writes, and what everything behind it works on. All functions here are pure.
namespace rmlcell::web {

// In the order of the wire. Names of requests are lower case; a name may occur more than once.
using HeaderList = std::vector<std::pair<std::string, std::string>>;

struct HttpRequest {
  std::string method;  // "POST", as sent
  std::string path;    // still percent-encoded: "/v1/jobs/17/artifacts/report"
  std::string query;   // after the '?', still percent-encoded
  std::string host;    // Host header, or the authority of an absolute target
  int version = 11;    // 10 or 11
  HeaderList headers;
  std::string body;
  std::string peer;  // "127.0.0.1:40312"

  // The first header of this (lower-case) name, or an empty view: an empty header says nothing
  // either.
  std::string_view Header(std::string_view name) const;
  std::size_t CountOf(std::string_view name) const;
};

// "http://host:port/path?query" or "/path?query" into the parts of a request.
void SetTarget(std::string_view target, HttpRequest& request);

struct HttpResponse {
  int status = 200;
  HeaderList headers;
  std::string body;
  std::optional<std::size_t> length;  // of a body that follows in pieces, when it is known before
};

// How the end of a body is told.
enum class Framing {
  kLength,   // Content-Length
  kChunked,  // HTTP/1.1 streams
  kClose,    // HTTP/1.0 streams: the connection ends
  kNone,     // 204, 304: no body and no length
};

// Status line and headers up to the empty line. Characters that could end a header early are
// replaced by blanks, whatever they came from. `length` counts for Framing::kLength only: with HEAD
// it is the length that GET would have.
std::string SerializeHead(const HttpResponse& response, Framing framing, std::size_t length,
                          bool keep_alive);

std::string_view ReasonPhrase(int status);

// "%2F" becomes "/"; nothing on a malformed escape. `plus_is_blank` as in query strings.
std::optional<std::string> PercentDecode(std::string_view text, bool plus_is_blank);

// The value of a parameter of a query string, decoded; nothing when it is absent. `ok` false:
// malformed.
struct QueryValue {
  bool ok = true;
  std::optional<std::string> value;
};
QueryValue QueryParameter(std::string_view query, std::string_view name);

// "application/json; charset=utf-8" is "application/json", in lower case.
std::string MediaType(std::string_view content_type);

// True when an Accept header names this type itself; "*/*" does not count.
bool Accepts(std::string_view accept, std::string_view media_type);

// RFC 9110 If-None-Match: a list of entity tags or "*"; weak tags match as well. `etag` has no
// quotes.
bool EtagMatches(std::string_view if_none_match, std::string_view etag);

// Content-Disposition with an ASCII name for old clients and the full one for the others.
std::string ContentDisposition(std::string_view kind, std::string_view file_name);

// Now, in the form of the Date header. RFC 9110 5.6.7
std::string HttpDate();

// What stands before a chunk of a body. RFC 9112 7.1
std::string ChunkHead(std::size_t size);

inline constexpr std::string_view kBlanks = " \t";  // of header fields

}  // namespace rmlcell::web
