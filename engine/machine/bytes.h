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

  // Where the bytes still come while they are read, as from a pipe: waits until there are `size` of
  // them, or all. What was `known` stays where it is.
  virtual std::string_view ReadOn(std::string_view known, std::size_t /*size*/) const {
    return known;
  }
  virtual bool IsWhole(std::string_view /*known*/) const { return true; }
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

  // Of bytes that still come: until so many are known here, or all.
  void ReadOn(std::size_t size) {
    if (keeper_ != nullptr && bytes_.size() < size) bytes_ = keeper_->ReadOn(bytes_, size);
  }
  void ReadAll() { ReadOn(std::string_view::npos); }
  bool whole() const { return keeper_ == nullptr || keeper_->IsWhole(bytes_); }

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
