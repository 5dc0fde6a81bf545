#include "tests/bench/planner_calls.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "engine/motion/planner/planner.h"

namespace rmlcell::bench {
namespace {

struct Call {
  enum class Kind { kAppend, kMark, kStop };
  Kind kind = Kind::kAppend;
  motion::MoveCommand move{};
};
struct Calls {
  bool wanted = false;
  std::optional<motion::MachineLimits> limits{};
  std::vector<Call> calls{};
} kept;

void Keep(const motion::Planner& planner, const Call& call) {
  if (!kept.wanted) return;
  if (!kept.limits) kept.limits = planner.limits();
  kept.calls.push_back(call);
}

}  // namespace

// Who calls a method of the planner is given the first of a pair by the linker, and these by the
// second the method itself. The object is the first argument of a method.
Status KeptAppend(motion::Planner* planner, const motion::MoveCommand& move) asm(
    "__wrap__ZN7rmlcell6motion7Planner6AppendERKNS0_11MoveCommandE");
Status TrueAppend(motion::Planner* planner, const motion::MoveCommand& move) asm(
    "__real__ZN7rmlcell6motion7Planner6AppendERKNS0_11MoveCommandE");
void KeptMark(motion::Planner* planner,
              std::uint64_t tag) asm("__wrap__ZN7rmlcell6motion7Planner4MarkEm");
void TrueMark(motion::Planner* planner,
              std::uint64_t tag) asm("__real__ZN7rmlcell6motion7Planner4MarkEm");
void KeptStop(motion::Planner* planner) asm("__wrap__ZN7rmlcell6motion7Planner4StopEv");
void TrueStop(motion::Planner* planner) asm("__real__ZN7rmlcell6motion7Planner4StopEv");

Status KeptAppend(motion::Planner* planner, const motion::MoveCommand& move) {
  Keep(*planner, {.kind = Call::Kind::kAppend, .move = move});
  return TrueAppend(planner, move);
}
void KeptMark(motion::Planner* planner, std::uint64_t tag) {
  Keep(*planner, {.kind = Call::Kind::kMark});
  TrueMark(planner, tag);
}
void KeptStop(motion::Planner* planner) {
  Keep(*planner, {.kind = Call::Kind::kStop});
  TrueStop(planner);
}

void KeepPlannerCalls() { kept.wanted = true; }

namespace {

// Microseconds of each segment with what comes out behind it. Where the machine stops behind one,
// all that waits comes out at once: that is told apart, for no segment waits behind it.
struct Times {
  std::vector<double> segment_us;
  std::vector<double> stop_us;
};

void Ask(motion::Planner& planner, const Call& call) {
  switch (call.kind) {
    case Call::Kind::kAppend:
      (void)planner.Append(call.move);
      break;
    case Call::Kind::kMark:
      planner.Mark(call.move.tag);
      break;
    case Call::Kind::kStop:
      planner.Stop();
      break;
  }
  while (planner.NextInPlace() != nullptr) {
  }
}

Times LeastOfRounds() {
  using Clock = std::chrono::steady_clock;
  constexpr int kRounds = 5;
  std::vector<double> least(kept.calls.size(), HUGE_VAL);
  for (int round = 0; round < kRounds; ++round) {
    motion::Planner planner(*kept.limits);
    for (std::size_t k = 0; k < kept.calls.size(); ++k) {
      const Clock::time_point begin = Clock::now();
      Ask(planner, kept.calls[k]);
      const std::chrono::duration<double, std::micro> took = Clock::now() - begin;
      least[k] = std::min(least[k], took.count());
    }
  }
  Times times;
  for (std::size_t k = 0; k < least.size(); ++k) {
    const bool stands = kept.calls[k].kind == Call::Kind::kStop;
    (stands ? times.stop_us : times.segment_us).push_back(least[k]);
  }
  return times;
}

double At(std::vector<double>& values, double share) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

}  // namespace

bool PrintTail() {
  kept.wanted = false;
  if (!kept.limits) return false;
  Times times = LeastOfRounds();
  std::printf(
      "{\"segments\": %zu, \"p50_us\": %.2f, \"p99_us\": %.2f, \"p99.9_us\": %.2f, \"most_us\": "
      "%.2f, \"stops\": %zu, \"stop_most_us\": %.2f}\n",
      times.segment_us.size(), At(times.segment_us, 0.5), At(times.segment_us, 0.99),
      At(times.segment_us, 0.999), At(times.segment_us, 1.0), times.stop_us.size(),
      At(times.stop_us, 1.0));
  return true;
}

}  // namespace rmlcell::bench
