#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace rmlcell::machine {

// Where the bytes of a program lie: in memory, or where they can be read again.
class BytesKeeper {
 public:
  virtual ~BytesKeeper() = default;
  // Who reads is past a good part of the bytes: those need not stay in memory. They stay readable.
  virtual void Release() const {}
};

// A program as the machine keeps it: object bytes of an Optimo program, the raw stream of a mill.
// Never changed and shared, because a stream may be of hundreds of megabytes and several runs read
// it. Nothing, or bytes, of which there may be none.
class Bytes {
 public:
  Bytes() = default;
  Bytes(std::nullptr_t) {}  // NOLINT(google-explicit-constructor): nothing, as of a pointer
  Bytes(std::shared_ptr<const BytesKeeper> keeper, std::string_view bytes)
      : keeper_(std::move(keeper)), bytes_(bytes), given_(true) {}

  // In memory.
  static Bytes Of(std::string bytes);
  // Bytes that somebody else keeps, for as long as they are used here.
  static Bytes Borrowed(std::string_view bytes) { return {nullptr, bytes}; }

  explicit operator bool() const { return given_; }
  bool operator==(std::nullptr_t) const { return !given_; }
  std::string_view operator*() const { return bytes_; }
  const std::string_view* operator->() const { return &bytes_; }

  const BytesKeeper* keeper() const { return keeper_.get(); }  // may be null
  void Release() const {
    if (keeper_ != nullptr) keeper_->Release();
  }

 private:
  std::shared_ptr<const BytesKeeper> keeper_;
  std::string_view bytes_;
  bool given_ = false;
};

// So many bytes are read between two calls of Release.
inline constexpr std::size_t kReleaseEvery = std::size_t{1} << 18;

}  // namespace rmlcell::machine
