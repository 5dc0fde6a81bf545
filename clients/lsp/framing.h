#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

// The base protocol of the language server protocol: header lines, an empty line, a body of
// Content-Length bytes.
namespace rmlcell::lsp {

// Content-Length and Content-Type take less than a hundred bytes; more is no header.
inline constexpr std::size_t kHeaderBytesMax = 4096;
// A program of 64 MiB, each byte of which may take two in JSON; bounds the memory for one message.
inline constexpr std::size_t kMessageBytesMax = std::size_t{128} << 20;

// A body, or what was wrong with the bytes that stood in its place.
struct Frame {
  std::string body{};
  std::string problem{};  // empty: there is a body
};

// Cuts a stream into bodies, however the bytes arrive. After something that is no header it looks
// for the next "Content-Length:", so that one broken message does not cost the session.
class MessageReader {
 public:
  // Appends what is complete.
  void Feed(std::string_view bytes, std::vector<Frame>& to);

 private:
  void FeedHeader(std::string_view& bytes, std::vector<Frame>& to);
  void FeedBody(std::string_view& bytes, std::vector<Frame>& to);
  void Seek(std::string_view& bytes);
  void EndHeader(std::vector<Frame>& to);
  void Lose(std::string problem, std::vector<Frame>& to);

  enum class State { kHeader, kBody, kLost };
  State state_ = State::kHeader;
  std::string header_;
  std::string body_;
  std::size_t wanted_ = 0;   // bytes of the body
  std::size_t matched_ = 0;  // of the mark that is looked for
};

// A message as it goes out.
std::string Framed(std::string_view body);

}  // namespace rmlcell::lsp
