#include "server/host/recording_file.h"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>

namespace rmlcell::server {
namespace {

bool WriteAll(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

}  // namespace

RecordingFile::~RecordingFile() { Close(); }

void RecordingFile::Close() {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
}

void RecordingFile::Open(int how) {
  Close();
  file_ = ::open(path_.c_str(), how | O_WRONLY | O_APPEND | O_CLOEXEC, S_IRUSR | S_IWUSR);
  dropped_ = false;
}

void RecordingFile::Drop() {
  Close();
  ::unlink(path_.c_str());
  dropped_ = true;
}

void RecordingFile::Add(const MachineRecorder::Fresh& fresh) {
  if (fresh.begins) {
    Open(O_CREAT | O_TRUNC);
  } else if (file_ < 0 && !dropped_) {
    Open(0);
  }
  if (dropped_ || (file_ >= 0 && WriteAll(file_, fresh.bytes))) return;
  spdlog::warn("{}: {}; a run that is cut off has no report", path_, std::strerror(errno));
  Drop();
}

}  // namespace rmlcell::server
