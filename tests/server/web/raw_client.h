#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace rmlcell::web::testing {

struct RawResponse {
  int status = 0;                              // 0: nothing came
  std::map<std::string, std::string> headers;  // lower-case names
  std::string body;
  bool complete = false;  // the body ended as it should

  std::string Header(const std::string& name) const {
    const auto found = headers.find(name);
    return found == headers.end() ? std::string() : found->second;
  }
};

// A socket and just enough HTTP to look at every byte. Reads give up after a minute.
class RawClient {
 public:
  explicit RawClient(int port, int receive_buffer_bytes = 0);
  RawClient();  // not connected yet
  ~RawClient();
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  // Opens nothing more. Closed when there is nobody.
  void Connect(int port);
  // False when the other side has closed.
  bool Send(std::string_view bytes);
  void HalfClose();
  // Ends the connection with a reset, as a process that is killed may do.
  void Reset();
  void Close();

  // A whole response; for HEAD there is no body.
  RawResponse Read(bool head = false);
  // The status line and headers alone; the body follows with ReadUntil.
  RawResponse ReadHead();
  // Everything up to and with `mark`; what came, without it, when the connection ends before.
  std::string ReadUntil(std::string_view mark);
  // True when the other side closed and nothing is left to be read.
  bool AtEnd();
  // True as soon as there is something to read, an end included; false when nothing came in this
  // time.
  bool AnswersWithin(std::chrono::milliseconds time);

 private:
  bool Fill();
  std::optional<std::string> Take(std::size_t size);
  int socket_;
  std::string buffer_;
};

// "POST /path HTTP/1.1" with Host, Content-Length and these further header lines.
std::string Post(std::string_view path, std::string_view content_type, std::string_view body,
                 std::string_view headers = {});
std::string Get(std::string_view target, std::string_view headers = {});

// One request on a connection of its own.
RawResponse Exchange(int port, std::string_view request);

}  // namespace rmlcell::web::testing
