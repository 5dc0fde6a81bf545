// RML1-7.07, RML1-9.06: whatever comes, memory stays bounded, nothing hangs, and the run completes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>
#include <random>

#include "engine/rml1/rml1_family.h"
#include "tests/engine/rml1/run_support.h"

namespace {

// The bytes that this program has allocated and not freed, and the highest that ever was.
std::size_t g_allocated = 0;
std::size_t g_highest = 0;
std::size_t g_allocations = 0;

constexpr std::size_t kHeader = 16;  // keeps the alignment of malloc

}  // namespace

void* operator new(std::size_t size) {
  void* block = std::malloc(size + kHeader);
  if (block == nullptr) std::abort();
  *static_cast<std::size_t*>(block) = size;
  g_allocated += size;
  ++g_allocations;
  g_highest = std::max(g_highest, g_allocated);
  return static_cast<char*>(block) + kHeader;
}
void operator delete(void* pointer) noexcept {
  if (pointer == nullptr) return;
  void* block = static_cast<char*>(pointer) - kHeader;
  g_allocated -= *static_cast<std::size_t*>(block);
  std::free(block);
}
void operator delete(void* pointer, std::size_t) noexcept { operator delete(pointer); }

namespace rmlcell::rml1 {
namespace {

// With sanitizers a tenth of the size says as much.
#ifdef RMLCELL_SANITIZED
constexpr std::size_t kHuge = 10'000'000;
constexpr std::size_t kLarge = 200'000;
#else
constexpr std::size_t kHuge = 100'000'000;
constexpr std::size_t kLarge = 2'000'000;
#endif

// Error log, buffer and state; far below one byte for each byte of a stream.
constexpr std::size_t kRoom = 16'000'000;

// Runs a stream to its end and returns what it needed beyond the stream itself.
std::size_t MemoryFor(std::string stream, const machine::Parameters& parameters) {
  machine::RunSetup setup = SetupOf(parameters, std::move(stream));
  setup.budget = {.steps = 0, .virtual_time = SimTime::zero()};
  machine::RunObserver silent;
  const std::size_t before = g_allocated;
  g_highest = before;
  const auto run = Rml1Family().NewRun(std::move(setup), silent).value();
  for (;;) {
    const machine::RunPhase phase = run->Advance(kForever);
    if (phase == machine::RunPhase::kFinished) break;
    if (phase == machine::RunPhase::kRunning) continue;
    run->Apply({.at = run->state().time, .kind = machine::InputKind::kStart});
  }
  EXPECT_EQ(run->outcome().kind, machine::OutcomeKind::kCompleted);
  return g_highest - before;
}

TEST(HostileStreams, HundredMegabytesOfOneByte) {
  EXPECT_LT(MemoryFor(std::string(kHuge, '5'), ParametersOf("t1")), kRoom);
}

// Whoever drives a run hears of it often, however much of a stream takes no time.
TEST(HostileStreams, AdvanceReturnsNowAndThen) {
  TestRun run(ParametersOf("t1"), std::string(3 << 20, ';'));
  EXPECT_EQ(run->Advance(kForever), machine::RunPhase::kRunning);
  EXPECT_GT(run->state().progress, 0.3);
  EXPECT_LT(run->state().progress, 0.4);
  EXPECT_EQ(run->state().time, SimTime::zero());
  EXPECT_EQ(run.AdvanceToEnd(), machine::RunPhase::kFinished);
}

// Nonsense in the middle of a chain: the motion behind it is looked for over several calls, and
// what comes of it is the same. A STOP that comes meanwhile finds the tool where it is.
TEST(HostileStreams, LooksForTheNextMotionOverSeveralCalls) {
  const std::string nonsense(std::size_t{3} << 20, ';');
  TestRun plain(ParametersOf("t1"), "!MC0;VS10;PD1000,0;PD2000,0;");
  plain.AdvanceToEnd();
  TestRun far(ParametersOf("t1"), "!MC0;VS10;PD1000,0;" + nonsense + "PD2000,0;");
  int calls = 0;
  while (far->Advance(kForever) == machine::RunPhase::kRunning) ++calls;
  EXPECT_GE(calls, 4);
  EXPECT_EQ(far.seen().text(), plain.seen().text());

  TestRun stopped(ParametersOf("t1"), "!MC0;VS10;PD1000,0;" + nonsense + "PD2000,0;");
  do {
    ASSERT_EQ(stopped->Advance(kForever), machine::RunPhase::kRunning);
  } while (stopped.seen().moves().size() < 2);
  EXPECT_DOUBLE_EQ(stopped->state().tip_speed_mm_s, 10.0);
  stopped.Press(machine::InputKind::kStop);
  ASSERT_EQ(stopped.AdvanceToEnd(), machine::RunPhase::kHalted);
  EXPECT_NEAR(stopped->state().tip.tip.x(), 10.25, 1e-9);  // 10 mm/s take 0.25 mm to brake
}

// RML1-9.06, motion.md 5.5: a million lines of one chain need no more than ten thousand do, and a
// key on the way makes no difference.
TEST(HostileStreams, AMillionLinesOfOneChainAreFlat) {
  const auto lines = [](std::size_t count) {
    std::string stream = "!MC0;VS60;PD";
    for (std::size_t k = 0; k < count; ++k) {
      stream +=
          std::to_string(5000 + k % 200 * 10) + "," + std::to_string(k / 200 % 300 * 10) + ",";
    }
    stream.back() = ';';
    return stream;
  };
  const std::size_t few = MemoryFor(lines(10'000), ParametersOf("t1"));
  const std::size_t many = MemoryFor(lines(kLarge / 2), ParametersOf("t1"));
  EXPECT_LT(few, kRoom);
  EXPECT_LE(many, few + 100'000);
}

TEST(HostileStreams, MuchOfAnyByte) {
  machine::Parameters all = ParametersOf("t1a");
  ASSERT_TRUE(all.Set("SEQUENCES", "ALL").ok());
  for (int byte = 0; byte < 256; ++byte) {
    const std::string run(kLarge / 64, static_cast<char>(byte));
    EXPECT_LT(MemoryFor(run, all), kRoom) << byte;
    EXPECT_LT(MemoryFor("!ZE X1" + run, all), kRoom) << byte;
    EXPECT_LT(MemoryFor("PU1,2," + run, all), kRoom) << byte;
    EXPECT_LT(MemoryFor("\x1b.T1" + run, all), kRoom) << byte;
  }
}

TEST(HostileStreams, EndlessNumbersAndLists) {
  const machine::Parameters t1 = ParametersOf("t1");
  EXPECT_LT(MemoryFor("PU" + std::string(kLarge, '9') + ",1;", t1), kRoom);
  EXPECT_LT(MemoryFor("PU0." + std::string(kLarge, '1') + ",1;", t1), kRoom);
  EXPECT_LT(MemoryFor("!DW" + std::string(kLarge, '0') + "7;", t1), kRoom);
  std::string list = "Z";
  while (list.size() < kLarge) list += "1,2,3,";
  EXPECT_LT(MemoryFor(list, t1), kRoom);
  std::string groups = "!ZE ";
  while (groups.size() < kLarge) groups += "X1:Y2:";
  EXPECT_LT(MemoryFor(groups, t1), kRoom);
  std::string pauses;
  while (pauses.size() < kLarge) pauses += "!NR;PU5,5;\x1b.B";
  EXPECT_LT(MemoryFor(pauses, t1), kRoom);
}

// Random bytes, and random bytes of the language's own alphabet, with every option on.
TEST(HostileStreams, RandomBytes) {
  constexpr std::string_view kAlphabet =
      "PUADRINFDHIMRVWZ@^!DWMCNRPZRCVZZMZOZZZEXYZA0123456789.,;:+- \r\n\t\x1b.KMT$";
  machine::Parameters all = ParametersOf("t1a");
  for (const auto& [name, word] :
       {std::pair{"SEQUENCES", "ALL"}, {"OVER_AREA", "PAUSE"}, {"SKIP", "VPANEL"}}) {
    ASSERT_TRUE(all.Set(name, std::string_view(word)).ok());
  }
  std::mt19937 random(99);
  for (int round = 0; round < 40; ++round) {
    std::string stream;
    while (stream.size() < kLarge / 20) {
      stream += round % 2 == 0 ? static_cast<char>(random() % 256)
                               : kAlphabet[random() % kAlphabet.size()];
    }
    EXPECT_LT(MemoryFor(stream, all), kRoom);
  }
}

// A long good program costs no allocation for each of its commands.
TEST(HostileStreams, GoodProgramsAllocateNothingPerCommand) {
  std::string stream = "PA;!PZ-10,200;";
  for (int i = 0; i < 50'000; ++i) {
    stream.append("V").append(std::to_string(1 + i % 9)).append(";Z");
    stream.append(std::to_string(i % 9999)).append(",").append(std::to_string(i % 7777));
    stream.append(",-").append(std::to_string(i % 99)).append(";PU;");
  }
  machine::RunObserver silent;
  const auto run =
      Rml1Family().NewRun(SetupOf(ParametersOf("t1"), std::move(stream)), silent).value();
  const std::size_t before = g_allocations;
  while (run->Advance(kForever) == machine::RunPhase::kRunning) {
  }
  EXPECT_EQ(run->steps_executed(), 150'002U);
  EXPECT_LT(g_allocations - before, 100U);
}

}  // namespace
}  // namespace rmlcell::rml1
