#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace rmlcell::rml1 {

// Bytes of a stream that somebody reads from the front, with the places where they stand.
class ByteSpan {
 public:
  // `offset` of the first byte in the stream.
  ByteSpan(std::string_view bytes, std::int64_t offset)
      : begin_(bytes.data()), at_(begin_), end_(begin_ + bytes.size()), offset_(offset) {}

  bool empty() const { return at_ == end_; }
  // Precondition of the first: not empty; of the second: a byte was read.
  unsigned char front() const { return static_cast<unsigned char>(*at_); }
  unsigned char last() const { return static_cast<unsigned char>(at_[-1]); }
  std::int64_t offset() const { return offset_ + (at_ - begin_); }  // of front()
  std::size_t read() const { return static_cast<std::size_t>(at_ - begin_); }

  const char* at() const { return at_; }
  const char* end() const { return end_; }
  void Skip() { ++at_; }
  void SkipTo(const char* at) { at_ = at; }  // within the bytes

 private:
  const char* begin_;
  const char* at_;
  const char* end_;
  std::int64_t offset_;
};

}  // namespace rmlcell::rml1
