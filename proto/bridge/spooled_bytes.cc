#include "proto/bridge/spooled_bytes.h"

#include <sys/mman.h>

#include <algorithm>
#include <utility>

#include "engine/core/check.h"
#include "proto/bridge/files.h"

namespace rmlcell::bridge {
namespace {

constexpr std::size_t kInMemoryMax = std::size_t{1} << 20;

// A file of our own, mapped: nobody else can change or shorten it.
class Mapped final : public machine::BytesKeeper {
 public:
  Mapped(void* begin, std::size_t size) : begin_(begin), size_(size) {}
  Mapped(const Mapped&) = delete;
  Mapped& operator=(const Mapped&) = delete;
  ~Mapped() override { ::munmap(begin_, size_); }

  void Release() const override { ::madvise(begin_, size_, MADV_DONTNEED); }

 private:
  void* begin_;
  std::size_t size_;
};

}  // namespace

void SpooledBytes::append(std::string_view bytes) {
  while (!bytes.empty()) {
    if (held_.size() >= kInMemoryMax && !in_memory_ && !Spool()) TakeBack();
    const std::size_t room = in_memory_ ? bytes.size() : kInMemoryMax - held_.size();
    held_.append(bytes.substr(0, room));
    bytes.remove_prefix(std::min(room, bytes.size()));
  }
}

// What is held, to the end of the file.
bool SpooledBytes::Spool() {
  if (file_ == nullptr) file_ = NamelessFile();
  if (file_ == nullptr || std::fwrite(held_.data(), 1, held_.size(), file_.get()) != held_.size() ||
      std::fflush(file_.get()) != 0)
    return false;
  spooled_ += static_cast<std::int64_t>(held_.size());
  held_.clear();
  return true;
}

// No room: all of it into memory again.
void SpooledBytes::TakeBack() {
  in_memory_ = true;
  if (spooled_ > 0) {
    std::string all(static_cast<std::size_t>(spooled_), '\0');
    std::rewind(file_.get());
    RMLCELL_CHECK(std::fread(all.data(), 1, all.size(), file_.get()) == all.size());
    held_.insert(0, all);
    spooled_ = 0;
  }
  file_.reset();
}

Result<std::string> SpooledBytes::Part(std::int64_t offset, std::size_t most) const {
  if (offset >= size()) return std::string();
  if (offset >= spooled_) return held_.substr(static_cast<std::size_t>(offset - spooled_), most);
  std::string part(std::min(most, static_cast<std::size_t>(spooled_ - offset)), '\0');
  const ssize_t read = ::pread(::fileno(file_.get()), part.data(), part.size(), offset);
  if (read == static_cast<ssize_t>(part.size())) return part;
  return Error{ErrorCode::kCellFileUnreadable, "a file of the temporary folder", {}};
}

machine::Bytes SpooledBytes::Finish() {
  if (spooled_ > 0 && !held_.empty() && !Spool()) TakeBack();
  if (spooled_ > 0) {
    const auto size = static_cast<std::size_t>(spooled_);
    void* begin = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, ::fileno(file_.get()), 0);
    if (begin != MAP_FAILED) {
      file_.reset();
      spooled_ = 0;
      return {std::make_shared<const Mapped>(begin, size), {static_cast<const char*>(begin), size}};
    }
    TakeBack();
  }
  return machine::Bytes::Of(std::exchange(held_, {}));
}

Result<machine::Bytes> ReadProgram(const std::string& path, std::int64_t limit) {
  SpooledBytes program;
  const Status read = ReadParts(path, limit, [&](std::string_view part) { program.append(part); });
  if (!read) return read.error();
  return program.Finish();
}

}  // namespace rmlcell::bridge
