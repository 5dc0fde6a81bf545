#include "server/host/journal_writer.h"

#include <chrono>

namespace rmlcell::server {
namespace {

constexpr std::chrono::milliseconds kAgain{100};

}  // namespace

JournalWriter::JournalWriter(std::unique_ptr<Journal> journal)
    : journal_(std::move(journal)),
      recording_(RecordingFile::PathBeside(journal_->path())),
      thread_([this] { Run(); }) {}

JournalWriter::~JournalWriter() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  work_.notify_one();
  thread_.join();
}

void JournalWriter::Write(std::vector<v1::JournalEntry> entries, MachineRecorder::Fresh recorded,
                          std::function<void()> written) {
  {
    const std::lock_guard lock(mutex_);
    if (recorded.begins || !recorded.bytes.empty()) recorded_.push_back(std::move(recorded));
    waiting_.push_back({.entries = std::move(entries), .written = std::move(written)});
  }
  work_.notify_one();
}

void JournalWriter::Stored(std::int64_t fence, std::int64_t sequence) {
  {
    const std::lock_guard lock(mutex_);
    stored_ = {fence, sequence};
  }
  work_.notify_one();
}

std::optional<Error> JournalWriter::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

void JournalWriter::Run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    const auto work = [this] { return ending_ || !waiting_.empty() || stored_.has_value(); };
    work_.wait(lock, work);
    if (const auto stored = std::exchange(stored_, std::nullopt)) {
      lock.unlock();
      journal_->Stored(stored->first, stored->second);
      lock.lock();
    }
    if (waiting_.empty()) {
      if (ending_) return;
      continue;
    }
    // One wait for the disk for all that waits.
    std::vector<v1::JournalEntry> entries;
    std::vector<std::function<void()>> written;
    const std::size_t count = waiting_.size();
    for (const Batch& batch : waiting_) {
      entries.insert(entries.end(), batch.entries.begin(), batch.entries.end());
      written.push_back(batch.written);
    }
    const std::deque<MachineRecorder::Fresh> recorded = std::exchange(recorded_, {});
    lock.unlock();
    for (const MachineRecorder::Fresh& fresh : recorded) recording_.Add(fresh);
    const Status done = journal_->Write(entries);
    if (!done) recording_.Drop();  // the journal needs its room
    if (done) {
      for (const auto& tell : written) tell();
    }
    lock.lock();
    trouble_ = done ? std::nullopt : std::optional(done.error());
    if (done) {
      waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(count));
    } else if (ending_) {
      return;
    } else {
      work_.wait_for(lock, kAgain, [this] { return ending_; });
    }
  }
}

}  // namespace rmlcell::server
