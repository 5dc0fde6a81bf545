#include "proto/bridge/program_stream.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "proto/bridge/spooled_bytes.h"

namespace rmlcell::bridge {
namespace {

constexpr std::size_t kPart = std::size_t{1} << 14;

Error Unreadable(const std::string& path) {
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(path, ignored);  // it opens all the same
  return {ErrorCode::kCellFileUnreadable, is_folder ? path + " is a directory" : path, {}};
}

Error TooLarge(const std::string& path, std::int64_t limit) {
  return {
      ErrorCode::kCellTooLarge, path + " is larger than " + std::to_string(limit) + " bytes", {}};
}

// 0: its end. Below 0: it cannot be read.
ssize_t ReadPart(int file, char* to, std::size_t most) {
  for (;;) {
    const ssize_t read = ::read(file, to, most);
    if (read >= 0 || errno != EINTR) return read;
  }
}

}  // namespace

ProgramStream::ProgramStream(int file, std::string path, std::int64_t limit,
                             std::function<void()> before_wait)
    : file_(file), path_(std::move(path)), limit_(limit), before_wait_(std::move(before_wait)) {}

ProgramStream::~ProgramStream() {
  if (begin_ != nullptr) ::munmap(begin_, static_cast<std::size_t>(limit_));
  ::close(file_);
}

Result<ProgramStream::Opened> ProgramStream::Open(const std::string& path, std::int64_t limit,
                                                  std::function<void()> before_wait) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file == -1) return Unreadable(path);
  const std::shared_ptr<ProgramStream> stream(
      new ProgramStream(file, path, limit, std::move(before_wait)));
  SpooledBytes whole;
  std::string beginning(kBeginning, '\0');
  std::size_t size = 0;
  const auto read_to = [&](std::size_t end) -> Result<bool> {  // false: it ends before
    while (size < end) {
      const ssize_t read = ReadPart(file, beginning.data() + size, end - size);
      if (read < 0) return Unreadable(path);
      if (read == 0) return false;
      size += static_cast<std::size_t>(read);
    }
    return true;
  };
  const Result<bool> goes_on = read_to(kBeginning);
  if (!goes_on) return goes_on.error();
  beginning.resize(size);
  if (static_cast<std::int64_t>(size) > limit) return TooLarge(path, limit);
  if (!*goes_on) return Opened{.bytes = machine::Bytes::Of(std::move(beginning))};
  if (stream->Keep(beginning)) {
    const machine::Bytes bytes(stream, {static_cast<const char*>(stream->begin_), size});
    return Opened{.bytes = bytes, .stream = stream};
  }
  // No room for a file: as any other program.
  whole.append(beginning);
  std::array<char, kPart> part{};
  for (ssize_t read = 0; (read = ReadPart(file, part.data(), part.size())) != 0;) {
    if (read < 0) return Unreadable(path);
    whole.append({part.data(), static_cast<std::size_t>(read)});
    if (whole.size() > limit) return TooLarge(path, limit);
  }
  return Opened{.bytes = whole.Finish()};
}

// Mapped for all that may come: what lies there stays where it is.
bool ProgramStream::Keep(std::string_view beginning) {
  kept_ = NamelessFile();
  if (kept_ == nullptr) return false;
  if (::write(::fileno(kept_.get()), beginning.data(), beginning.size()) !=
      static_cast<ssize_t>(beginning.size()))
    return false;
  void* begin = ::mmap(nullptr, static_cast<std::size_t>(limit_), PROT_READ, MAP_SHARED,
                       ::fileno(kept_.get()), 0);
  if (begin == MAP_FAILED) return false;
  begin_ = begin;
  size_ = beginning.size();
  return true;
}

void ProgramStream::Release() const {
  ::madvise(begin_, static_cast<std::size_t>(limit_), MADV_DONTNEED);
}

std::string_view ProgramStream::ReadOn(std::string_view /*known*/, std::size_t size) const {
  while (size_ < size && !over_) ReadMore();
  return {static_cast<const char*>(begin_), size_};
}

void ProgramStream::ReadMore() const {
  pollfd ready{.fd = file_, .events = POLLIN, .revents = 0};
  if (before_wait_ && ::poll(&ready, 1, 0) == 0) before_wait_();
  std::array<char, kPart> part{};
  const ssize_t read = ReadPart(file_, part.data(), part.size());
  const auto count = static_cast<std::size_t>(std::max<ssize_t>(read, 0));
  const bool too_large = static_cast<std::int64_t>(size_ + count) > limit_;
  const bool kept =
      read > 0 && !too_large && ::write(::fileno(kept_.get()), part.data(), count) == read;
  if (kept) {
    size_ += count;
    return;
  }
  over_ = true;
  if (read < 0) {
    status_ = Unreadable(path_);
  } else if (too_large) {
    status_ = TooLarge(path_, limit_);
  } else if (read > 0) {
    status_ = Error{ErrorCode::kCellFileUnwritable, "the temporary folder is full", {}};
  }
}

}  // namespace rmlcell::bridge
