#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "storage/store.h"

// What every Store has to do, as tests over its interface alone. A store joins by a test program
// that links the conformance_*.cc files and makes an instance:
//
//   INSTANTIATE_TEST_SUITE_P(Sqlite, StoreConformance, testing::Values(StoreKind{"Sqlite", Make}),
//   Name);
namespace rmlcell::storage {

// How long a test waits for something that must come; only a failing test waits that long.
inline constexpr std::chrono::seconds kPatience{60};

// True as soon as `holds` does, false when it does not within kPatience.
template <class Condition>
bool Eventually(Condition holds) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!holds()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

// A clock that stands still until it is moved. Thread-safe.
class TestClock {
 public:
  WallTime Now() const { return WallTime(std::chrono::microseconds(now_us_.load())); }
  void Advance(std::chrono::milliseconds by) {
    now_us_ += std::chrono::duration_cast<std::chrono::microseconds>(by).count();
  }

 private:
  std::atomic<std::int64_t> now_us_{1'700'000'000'000'000};
};

// One store with an empty database of its own, which goes with it.
class StoreBed {
 public:
  virtual ~StoreBed() = default;
  virtual Store& store() = 0;
  virtual void Reopen() = 0;  // closes it and opens it again
  // Another store over the same database, as a second server has it; of a kind of which only one is
  // open at a time that one itself.
  virtual Store& other() { return store(); }
  TestClock& clock() { return clock_; }

 private:
  TestClock clock_;
};

struct StoreKind {
  std::string name;
  std::function<std::unique_ptr<StoreBed>()> make;
};
inline std::string NameOfKind(const testing::TestParamInfo<StoreKind>& info) {
  return info.param.name;
}

// The value; an error ends the test.
template <class T>
T Must(Result<T> result) {
  if (!result) {
    throw std::runtime_error(CodeText(result.error().code) + ": " + result.error().detail);
  }
  return *std::move(result);
}
inline void Must(const Status& status) {
  if (!status) {
    throw std::runtime_error(CodeText(status.error().code) + ": " + status.error().detail);
  }
}

// The code of an error; nothing when all went well.
template <class T>
std::optional<ErrorCode> CodeOf(const Result<T>& result) {
  return result ? std::nullopt : std::optional(result.error().code);
}
inline std::optional<ErrorCode> CodeOf(const Status& status) {
  return status ? std::nullopt : std::optional(status.error().code);
}

class StoreConformance : public testing::TestWithParam<StoreKind> {
 protected:
  Store& store() { return bed_->store(); }
  Store& other() { return bed_->other(); }
  TestClock& clock() { return bed_->clock(); }
  void Reopen() { bed_->Reopen(); }

  MachineRecord PutMachine(const std::string& id);

  // One program into one slot, whatever is there.
  ProgramSummary PutProgram(const std::string& machine, int slot, const std::string& object);

  // A queued job; its request id is made by the store.
  JobRecord Submit(const std::string& kind = "SIMULATE", const std::string& machine = "optimo-1");

  // The oldest queued job of the kind. There must be one.
  LeasedJob Acquire(const std::string& worker = "w1", const std::string& kind = "SIMULATE");

  JobRecord Finish(const Lease& lease, JobState state = JobState::kSucceeded);

  // Every event of the job, read in small pages.
  std::vector<EventRecord> EventsOf(std::int64_t job);

 private:
  std::unique_ptr<StoreBed> bed_ = GetParam().make();
};

inline std::vector<std::int64_t> IdsOf(const std::vector<JobRecord>& jobs) {
  std::vector<std::int64_t> ids;
  for (const JobRecord& job : jobs) ids.push_back(job.id);
  return ids;
}

inline constexpr std::chrono::milliseconds kLease{10'000};

inline LossPolicy PolicyOfTests() {
  return {.outcome = {.state = JobState::kFailed,
                      .code = ErrorCode::kCellWorkerDied,
                      .detail = "it died",
                      .program = 12,
                      .step = 34},
          .requeued = {{.kind = "requeued", .payload = "r"}},
          .ended = {{.kind = "ended", .payload = "e"}},
          .interrupted = {{.kind = "interrupted", .payload = "i"}},
          .cancelled = {{.kind = "cancelled", .payload = "c"}}};
}

// "w7".
std::string Numbered(std::string_view prefix, std::int64_t number);

// The kinds of the events, in order.
std::vector<std::string> KindsOf(const std::vector<EventRecord>& events);

// Sequence numbers 1, 2, 3 ... and growing positions.
void ExpectWithoutGap(const std::vector<EventRecord>& events);

// `size` bytes that look like nothing, the same for the same seed.
std::string Noise(std::size_t size, std::uint64_t seed);
// `size` bytes of text that compresses as toolpaths do.
std::string PlotText(std::size_t size);

}  // namespace rmlcell::storage
