#include "server/host/journal.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <utility>

#include "proto/recording/records.h"
#include "server/host/answered_requests.h"

namespace rmlcell::server {
namespace {

Error Failed(const std::string& path, int number) {
  return {ErrorCode::kCellJournal, path + ": " + std::strerror(number), {}};
}

// Whole, or an error number.
int WriteAll(int file, std::string_view bytes, std::int64_t at) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(file, bytes.data(), bytes.size(), at);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
    at += written;
  }
  return 0;
}

int SyncFolderOf(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return errno;
  const int failed = ::fsync(file) == 0 ? 0 : errno;
  ::close(file);
  return failed;
}

Result<std::string> ReadAll(const std::string& path, int file) {
  std::string bytes;
  std::array<char, 1 << 16> part{};
  for (;;) {
    const ssize_t read = ::pread(file, part.data(), part.size(), static_cast<off_t>(bytes.size()));
    if (read < 0 && errno == EINTR) continue;
    if (read < 0) return Failed(path, errno);
    if (read == 0) return bytes;
    bytes.append(part.data(), static_cast<std::size_t>(read));
  }
}

// The answers that somebody may still ask for. LIVE-3.27
std::vector<v1::JournalEntry> NewestAnswers(std::vector<v1::JournalEntry> entries) {
  if (entries.empty()) return {};
  const auto now = WallTime(std::chrono::microseconds(
      google::protobuf::util::TimeUtil::TimestampToMicroseconds(entries.back().time())));
  std::erase_if(entries, [now](const v1::JournalEntry& entry) {
    return !entry.has_answered() || !IsAskedFor(entry, now);
  });
  if (entries.size() > AnsweredRequests::kKept)
    entries.erase(entries.begin(), entries.end() - AnsweredRequests::kKept);
  return entries;
}

}  // namespace

std::string RecordsOf(const std::vector<v1::JournalEntry>& entries) {
  std::string records;
  for (const v1::JournalEntry& entry : entries)
    recording::AddRecord(entry.SerializeAsString(), records);
  return records;
}

ReadRecords ReadJournal(std::string_view bytes) {
  ReadRecords read;
  for (const std::string_view record : recording::ReadRecords(bytes).records) {
    v1::JournalEntry entry;
    if (!entry.ParseFromArray(record.data(), static_cast<int>(record.size()))) break;
    read.entries.push_back(std::move(entry));
    read.ends.push_back(record.data() + record.size() - bytes.data());
  }
  return read;
}

Result<Journal::Found> Journal::Open(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file < 0) return Failed(path, errno);
  std::unique_ptr<Journal> journal(new Journal(path, file, 0));
  const Result<std::string> bytes = ReadAll(path, file);
  if (!bytes) return bytes.error();
  ReadRecords read = ReadJournal(*bytes);
  for (std::size_t i = 0; i < read.entries.size(); ++i)
    journal->places_.push_back(PlaceOf(read.entries[i], read.ends[i]));
  journal->bytes_ = read.ends.empty() ? 0 : read.ends.back();
  const auto torn = static_cast<std::int64_t>(bytes->size()) - journal->bytes_;
  if (torn > 0 && ::ftruncate(file, journal->bytes_) != 0) return Failed(path, errno);
  if (const int failed = SyncFolderOf(path); failed != 0) return Failed(path, failed);
  return Found{
      .journal = std::move(journal), .entries = std::move(read.entries), .torn_bytes = torn};
}

Journal::~Journal() { ::close(file_); }

Status Journal::Write(const std::vector<v1::JournalEntry>& entries) {
  if (entries.empty()) return {};
  const std::string records = RecordsOf(entries);
  const auto more = static_cast<std::int64_t>(records.size());
  if (bytes_ + more > kBytesMax && bytes_ + more - BytesOfOldMarks() <= kBytesMax) {
    if (const Status made = DropOldMarks(); !made) return made.error();
  }
  if (bytes_ + more > kBytesMax)
    return Error{ErrorCode::kCellJournal, path_ + ": what the store has not taken fills it", {}};
  int failed = WriteAll(file_, records, bytes_);
  if (failed == 0 && ::fdatasync(file_) != 0) failed = errno;
  if (failed != 0) {
    // Half a record would hide those that come behind it.
    static_cast<void>(::ftruncate(file_, bytes_));
    return Failed(path_, failed);
  }
  for (const v1::JournalEntry& entry : entries) {
    bytes_ += recording::kRecordHeadBytes + static_cast<std::int64_t>(entry.ByteSizeLong());
    places_.push_back(PlaceOf(entry, bytes_));
  }
  return {};
}

Journal::Place Journal::PlaceOf(const v1::JournalEntry& entry, std::int64_t end) {
  return {.fence = entry.fence(), .sequence = entry.sequence(), .end = end, .kind = KindOf(entry)};
}

std::int64_t Journal::BytesOfOldMarks() const {
  std::vector<EntryKind> kinds;
  std::ranges::transform(places_, std::back_inserter(kinds), &Place::kind);
  const std::vector<bool> old = OldMarks(kinds);
  std::int64_t bytes = 0;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (old[i]) bytes += places_[i].end - (i > 0 ? places_[i - 1].end : 0);
  }
  return bytes;
}

Status Journal::DropOldMarks() {
  const Result<std::string> all = ReadAll(path_, file_);
  if (!all) return all.error();
  return Replace(WithoutOldMarks(ReadJournal(*all).entries));
}

Status Journal::Replace(const std::vector<v1::JournalEntry>& entries) {
  const std::string records = RecordsOf(entries);
  if (const Status done = Rewrite(records); !done) return done.error();
  const ReadRecords read = ReadJournal(records);
  places_.clear();
  for (std::size_t i = 0; i < read.entries.size(); ++i)
    places_.push_back(PlaceOf(read.entries[i], read.ends[i]));
  bytes_ = static_cast<std::int64_t>(records.size());
  return {};
}

void Journal::Stored(std::int64_t fence, std::int64_t sequence) {
  if (bytes_ <= kBytesKept) return;
  std::size_t gone = 0;
  while (gone < places_.size() &&
         (places_[gone].fence < fence ||
          (places_[gone].fence == fence && places_[gone].sequence <= sequence)))
    ++gone;
  if (gone == 0) return;
  const auto begin = static_cast<std::size_t>(places_[gone - 1].end);
  const Result<std::string> all = ReadAll(path_, file_);
  if (!all) return;
  const std::vector<v1::JournalEntry> asked_for =
      NewestAnswers(ReadJournal(std::string_view(*all).substr(0, begin)).entries);
  std::string records = RecordsOf(asked_for);
  const auto moved = static_cast<std::int64_t>(begin) - static_cast<std::int64_t>(records.size());
  records.append(*all, begin);
  if (!Rewrite(records)) return;
  places_.erase(places_.begin(), places_.begin() + static_cast<std::ptrdiff_t>(gone));
  for (Place& place : places_) place.end -= moved;
  std::vector<Place> kept;
  std::int64_t end = 0;
  for (const v1::JournalEntry& entry : asked_for) {
    end += recording::kRecordHeadBytes + static_cast<std::int64_t>(entry.ByteSizeLong());
    kept.push_back(PlaceOf(entry, end));
  }
  places_.insert(places_.begin(), kept.begin(), kept.end());
  bytes_ -= moved;
}

// Beside the old one, which stays until the new one is on the disk.
Status Journal::Rewrite(std::string_view records) {
  const std::string made = path_ + ".new";
  const int file = ::open(made.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file < 0) return Failed(made, errno);
  int failed = WriteAll(file, records, 0);
  if (failed == 0 && ::fdatasync(file) != 0) failed = errno;
  if (failed == 0 && ::rename(made.c_str(), path_.c_str()) != 0) failed = errno;
  if (failed != 0) {
    ::close(file);
    ::unlink(made.c_str());
    return Failed(made, failed);
  }
  static_cast<void>(SyncFolderOf(path_));
  ::close(std::exchange(file_, file));
  return {};
}

}  // namespace rmlcell::server
