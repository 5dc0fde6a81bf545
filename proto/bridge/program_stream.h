#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "engine/machine/bytes.h"
#include "proto/bridge/nameless_file.h"

namespace rmlcell::bridge {

// The file of a program that runs while it is read: of a pipe what has come is run before the rest
// does. What was read goes into a nameless file, as in SpooledBytes: it is read more than once.
class ProgramStream final : public machine::BytesKeeper {
 public:
  // So much of it is read before anything is known of it.
  static constexpr std::size_t kBeginning = std::size_t{1} << 15;

  struct Opened {
    machine::Bytes bytes{};                         // at least the beginning
    std::shared_ptr<const ProgramStream> stream{};  // null: that is all
  };
  // `before_wait` is called where nothing has come yet: what was told so far should be seen.
  // Errors: CellFileUnreadable; CellTooLarge above `limit` bytes, where that is seen at once.
  static Result<Opened> Open(const std::string& path, std::int64_t limit,
                             std::function<void()> before_wait);

  ~ProgramStream() override;
  ProgramStream(const ProgramStream&) = delete;
  ProgramStream& operator=(const ProgramStream&) = delete;

  // Errors: those of Open, where they came later: then it ended there.
  const Status& status() const { return status_; }

  void Release() const override;
  std::string_view ReadOn(std::string_view known, std::size_t size) const override;
  bool IsWhole(std::string_view known) const override { return over_ && known.size() == size_; }

 private:
  ProgramStream(int file, std::string path, std::int64_t limit, std::function<void()> before_wait);
  // Where they stay. False: there is no room.
  bool Keep(std::string_view beginning);
  void ReadMore() const;

  const int file_;
  const std::string path_;
  const std::int64_t limit_;
  const std::function<void()> before_wait_;
  OpenFile kept_;
  void* begin_ = nullptr;
  // Who reads the bytes does not change the program, only how much of it is known.
  mutable std::size_t size_ = 0;
  mutable bool over_ = false;
  mutable Status status_;
};

}  // namespace rmlcell::bridge
