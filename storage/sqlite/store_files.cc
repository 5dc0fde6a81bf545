#include "storage/sqlite/store_files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

namespace rmlcell::storage::sqlite {
namespace {

constexpr mode_t kPrivateFile = 0600;
constexpr mode_t kPrivateDirectory = 0700;

Error FileError(const std::string& what, const std::string& path, int error) {
  return Error{ErrorCode::kCellStoreFailed,
               what + " " + path + ": " + std::generic_category().message(error),
               {}};
}

class File {
 public:
  File(const std::string& path, int flags, mode_t mode = 0)
      : number_(open(path.c_str(), flags | O_CLOEXEC, mode)) {}
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() {
    if (is_open()) close(number_);
  }
  bool is_open() const { return number_ != -1; }
  int number() const { return number_; }
  int Release() { return std::exchange(number_, -1); }

 private:
  int number_;
};

// A new name is on the disk only when its directory is.
Status SyncDirectory(const std::filesystem::path& directory) {
  const File file(directory.empty() ? "." : directory.string(), O_RDONLY | O_DIRECTORY);
  if (!file.is_open() || fsync(file.number()) != 0) {
    return FileError("cannot sync directory", directory.string(), errno);
  }
  return {};
}

Status MakeDirectory(const std::filesystem::path& directory) {
  if (directory.empty()) return {};
  std::error_code ignored;
  if (std::filesystem::is_directory(directory, ignored)) return {};
  if (const Status above = MakeDirectory(directory.parent_path()); !above) return above.error();
  if (mkdir(directory.c_str(), kPrivateDirectory) != 0 && errno != EEXIST) {
    return FileError("cannot make directory", directory.string(), errno);
  }
  if (!std::filesystem::is_directory(directory, ignored)) {
    return FileError("cannot make directory", directory.string(), ENOTDIR);
  }
  return SyncDirectory(directory.parent_path());
}

std::string HolderOf(int file) {
  std::array<char, 24> text{};
  const ssize_t size = pread(file, text.data(), text.size() - 1, 0);
  std::string holder(text.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  holder.erase(std::min(holder.find('\n'), holder.size()));
  return holder;
}

}  // namespace

Result<StoreLock> StoreLock::Take(const std::string& path) {
  File file(path, O_RDWR | O_CREAT, kPrivateFile);
  if (!file.is_open()) return FileError("cannot open lock file", path, errno);
  if (flock(file.number(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return FileError("cannot lock", path, errno);
    const std::string holder = HolderOf(file.number());
    return Error{ErrorCode::kCellStoreBusy,
                 path + " is held by " + (holder.empty() ? "another process" : "process " + holder),
                 {}};
  }
  // For the message above only: the lock is what counts, so a disk too full for it is no reason to
  // stop.
  const std::string self = std::to_string(getpid()) + "\n";
  [[maybe_unused]] const int cut = ftruncate(file.number(), 0);
  [[maybe_unused]] const ssize_t told = pwrite(file.number(), self.data(), self.size(), 0);
  return StoreLock(file.Release());
}

StoreLock::StoreLock(StoreLock&& other) noexcept : file_(std::exchange(other.file_, -1)) {}

StoreLock::~StoreLock() {
  if (file_ != -1) close(file_);
}

Status MakeDirectoryOf(const std::string& path) {
  return MakeDirectory(std::filesystem::path(path).parent_path());
}

Status MakePrivateFile(const std::string& path) {
  const File made(path, O_RDWR | O_CREAT | O_EXCL, kPrivateFile);
  if (made.is_open()) return SyncDirectory(std::filesystem::path(path).parent_path());
  const File file(path, O_RDWR, kPrivateFile);
  if (!file.is_open()) return FileError("cannot open", path, errno);
  struct stat facts {};
  if (fstat(file.number(), &facts) != 0) return FileError("cannot read", path, errno);
  if (!S_ISREG(facts.st_mode)) {
    return Error{ErrorCode::kCellStoreFailed, path + " is not a regular file", {}};
  }
  const bool others_may_read_it = (facts.st_mode & 0077) != 0;
  if (others_may_read_it && fchmod(file.number(), kPrivateFile) != 0) {
    return FileError("cannot set the mode of", path, errno);
  }
  return {};
}

}  // namespace rmlcell::storage::sqlite
