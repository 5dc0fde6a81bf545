// What the embedded store does where memory is short.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <future>
#include <memory>
#include <new>
#include <optional>

#include "storage/content.h"
#include "tests/storage/sqlite_bed.h"

namespace {

// So many bytes at once, or more, are not to be had in this program; 0: all are.
std::atomic<std::size_t> g_too_many_bytes = 0;

}  // namespace

// Not inlined: a compiler that sees both of them takes them for a mismatch.
[[gnu::noinline]] void* operator new(std::size_t size) {
  const std::size_t too_many = g_too_many_bytes;
  void* const block = too_many != 0 && size >= too_many ? nullptr : std::malloc(size);
  if (block == nullptr) throw std::bad_alloc();
  return block;
}
[[gnu::noinline]] void operator delete(void* pointer) noexcept { std::free(pointer); }
[[gnu::noinline]] void operator delete(void* pointer, std::size_t) noexcept { std::free(pointer); }

namespace rmlcell::storage {
namespace {

class ShortMemory {
 public:
  explicit ShortMemory(std::size_t too_many_bytes) { g_too_many_bytes = too_many_bytes; }
  ~ShortMemory() { g_too_many_bytes = 0; }
  ShortMemory(const ShortMemory&) = delete;
  ShortMemory& operator=(const ShortMemory&) = delete;
};

// store.h, errors everywhere: the end of a job whose product finds no room on its way fails as a
// whole and is told so, the job is still its holder's, and the same end is good later.
TEST(SqliteMemory, AnEndThatFindsNoRoomIsToldAndMayComeAgain) {
  SqliteBed bed;
  Store& store = bed.store();
  Must(store.SubmitAndWait({.kind = "CHECK"}));
  const Lease lease = Must(store.Acquire("w", {"CHECK"}, kLease, {}))->lease;
  const std::string large = Noise(kChunkBytes + 1, 1);
  const auto end =
      std::make_shared<const JobEnd>(JobEnd{.artifacts = {{.name = "large", .bytes = large}}});
  const auto finish = [&]() -> std::optional<ErrorCode> {
    const auto ended = std::make_shared<std::promise<std::optional<ErrorCode>>>();
    auto answer = ended->get_future();
    store.SendFinish(lease, end, {},
                     [ended](const Result<FinishedJob>& job) { ended->set_value(CodeOf(job)); });
    if (answer.wait_for(kPatience) != std::future_status::ready) return ErrorCode::kCellInternal;
    return answer.get();
  };
  {
    const ShortMemory short_memory(kChunkBytes);  // a part is compressed into more than it has
    EXPECT_EQ(finish(), ErrorCode::kCellStoreFailed);
  }
  EXPECT_EQ(Must(store.GetJob(lease.job)).state, JobState::kRunning);
  EXPECT_EQ(finish(), std::nullopt);
  EXPECT_EQ(Must(store.GetJob(lease.job)).state, JobState::kSucceeded);
  EXPECT_TRUE(Must(store.ReadArtifact(lease.job, "large")) == large);
}

}  // namespace
}  // namespace rmlcell::storage
