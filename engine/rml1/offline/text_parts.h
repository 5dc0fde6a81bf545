#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "engine/rml1/offline/byte_sink.h"

namespace rmlcell::rml1 {

// Text on its way to a sink, which gets it in parts of some size: memory is that of one of them.
class TextParts {
 public:
  static constexpr std::size_t kPart = std::size_t{64} << 10;

  explicit TextParts(ByteSink sink) : sink_(std::move(sink)) {}

  void Add(std::string_view text) {
    size_ += text.size();
    waiting_ += text;
    if (waiting_.size() >= kPart) HandOver();
  }
  // What still waits; at the end.
  void HandOver() {
    sink_(waiting_);
    waiting_.clear();
  }
  std::size_t size() const { return size_; }  // of all that was added

 private:
  ByteSink sink_;
  std::string waiting_;
  std::size_t size_ = 0;
};

}  // namespace rmlcell::rml1
