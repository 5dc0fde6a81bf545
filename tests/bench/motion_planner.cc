// How many segments a second the planner takes, against a bare two-pass loop in the same run
// (rounds interleaved, medians), and whether cost and memory stay flat with the length of the
// program. Run by hand:
//   motion_planner_bench [--flat | --tail]
// --tail: how long one more segment takes, taken and given out, on every path: the least of some
// rounds for each segment, since other work on the machine is not the planner's. Prints one JSON
// object a line.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <limits>
#include <string>
#include <vector>

#include "engine/motion/profile/speed_passes.h"
#include "tests/bench/motion_paths.h"

namespace rmlcell::motion {
namespace {

// Processor time of this process: other work on the machine then disturbs less.
double Now() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double PlanRate(const std::vector<MoveCommand>& chain, const MachineLimits& machine, double& sum) {
  const double begin = Now();
  Planner planner(machine);
  const auto drain = [&] {
    while (const PlannedItem* item = planner.NextInPlace()) {
      sum += std::get<PlannedMotion>(*item).speed.duration_s();
    }
  };
  for (const MoveCommand& move : chain) {
    if (planner.Append(move)) drain();
  }
  planner.Stop();
  drain();
  return static_cast<double>(chain.size()) / (Now() - begin);
}

// What any jerk-limited look-ahead must at least do: corner speed from the angle, forward and
// backward pass, duration of every span.
double BareRate(const std::vector<MoveCommand>& chain, double& sum) {
  const double begin = Now();
  const PathLimits limits{30.0, 2000.0, 40000.0};
  std::vector<double> speed(chain.size() + 1, 0.0);
  const auto reachable = [&](double from, double length, double cap) {
    if (cap <= from || RampLength(from, cap, limits) <= length) return cap;
    return std::min(cap, Reach(from, length, limits));
  };
  for (std::size_t k = 0; k + 1 < chain.size(); ++k) {
    const MachineVector in = chain[k].path.to().point - chain[k].path.from().point;
    const MachineVector out = chain[k + 1].path.to().point - chain[k + 1].path.from().point;
    const double cosine = in.dot(out) / std::sqrt(in.dot(in) * out.dot(out));
    const double corner = 30.0 * std::sqrt(std::max(0.0, 0.5 * (1.0 + cosine)));
    speed[k + 1] = reachable(speed[k], chain[k].path.length(), corner);
  }
  for (std::size_t k = chain.size(); k-- > 0;) {
    speed[k] = reachable(speed[k + 1], chain[k].path.length(), speed[k]);
    sum += SpeedProfile::Span(chain[k].path.length(), speed[k], speed[k + 1], limits).duration_s();
  }
  return static_cast<double>(chain.size()) / (Now() - begin);
}

long PeakMemory_KiB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

void Rates() {
  constexpr int kSegments = 50'000;
  constexpr int kRounds = 7;
  const std::vector<MoveCommand> three = Contour(kSegments, false);
  const std::vector<MoveCommand> five = Contour(kSegments, true);
  MachineLimits trapezoid = StandardMachine();
  trapezoid.tip_jerk_mm_s3 = std::numeric_limits<double>::infinity();
  std::vector<double> bare, jerk, flat, axes;
  double sum = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    bare.push_back(BareRate(three, sum));
    jerk.push_back(PlanRate(three, StandardMachine(), sum));
    flat.push_back(PlanRate(three, trapezoid, sum));
    axes.push_back(PlanRate(five, StandardMachine(), sum));
  }
  std::printf(
      "{\"bare_per_s\": %.0f, \"jerk_3axis_per_s\": %.0f, \"trapezoid_3axis_per_s\": %.0f, "
      "\"five_axis_per_s\": %.0f, \"jerk_to_bare\": %.3f, \"rounds\": %d, \"sum\": %.9g}\n",
      Median(bare), Median(jerk), Median(flat), Median(axes), Median(jerk) / Median(bare), kRounds,
      sum);
}

// The same loop of the contour again and again, without keeping it.
void Flat() {
  const std::vector<MoveCommand> loop = Contour(600, false);
  for (const int segments : {1'000, 10'000, 100'000, 1'000'000, 10'000'000}) {
    Planner planner(StandardMachine());
    const double begin = Now();
    double sum = 0.0;
    for (int k = 0; k < segments; ++k) {
      if (!planner.Append(loop[static_cast<std::size_t>(k) % loop.size()])) return;
      while (const PlannedItem* item = planner.NextInPlace()) {
        sum += std::get<PlannedMotion>(*item).speed.duration_s();
      }
    }
    std::printf(
        "{\"segments\": %d, \"ns_per_segment\": %.1f, \"peak_KiB\": %ld, \"starved\": %llu}\n",
        segments, 1e9 * (Now() - begin) / segments, PeakMemory_KiB(),
        static_cast<unsigned long long>(planner.lookahead_starved()));
    std::fflush(stdout);
  }
}

// Microseconds of one more segment, each the least over the rounds.
std::vector<double> EachSegment(const std::vector<MoveCommand>& chain,
                                const MachineLimits& machine) {
  using Clock = std::chrono::steady_clock;
  constexpr int kTailRounds = 5;
  std::vector<double> least(chain.size(), HUGE_VAL);
  double sum = 0.0;
  for (int round = 0; round < kTailRounds; ++round) {
    Planner planner(machine);
    for (std::size_t k = 0; k < chain.size(); ++k) {
      const Clock::time_point begin = Clock::now();
      if (!planner.Append(chain[k])) return {};
      while (const PlannedItem* item = planner.NextInPlace()) {
        sum += std::get<PlannedMotion>(*item).speed.duration_s();
      }
      const std::chrono::duration<double, std::micro> took = Clock::now() - begin;
      least[k] = std::min(least[k], took.count());
    }
  }
  return sum > 0.0 ? least : std::vector<double>{};
}

// The machine stands behind each 31st move: what waits for more to come is all done with that one.
std::vector<MoveCommand> WithStops(std::vector<MoveCommand> chain) {
  constexpr std::size_t kEach = 31;
  for (std::size_t k = kEach - 1; k < chain.size(); k += kEach) chain[k].fly = false;
  return chain;
}

void Tail() {
  constexpr int kSegments = 20'000;
  MachineLimits trapezoid = WalkMachine();
  trapezoid.tip_jerk_mm_s3 = std::numeric_limits<double>::infinity();
  const auto print = [](const char* path, const std::vector<MoveCommand>& chain,
                        const MachineLimits& machine) {
    std::vector<double> us = EachSegment(chain, machine);
    if (us.empty()) return;
    double sum = 0.0;
    for (const double each : us) sum += each;
    std::sort(us.begin(), us.end());
    const auto at = [&](double share) {
      return us[static_cast<std::size_t>(share * static_cast<double>(us.size() - 1))];
    };
    std::printf(
        "{\"path\": \"%s\", \"mean_us\": %.2f, \"p50_us\": %.2f, \"p99_us\": %.2f, \"p99.9_us\": "
        "%.2f, \"most_us\": %.2f}\n",
        path, sum / static_cast<double>(us.size()), at(0.5), at(0.99), at(0.999), us.back());
    std::fflush(stdout);
  };
  std::vector<MoveCommand> zigzag = Polyline(Legs(kSegments, 2.0, 0.5 * kPi, true), 0.3);
  zigzag.back().fly = true;
  print("cruise", Contour(kSegments, false), StandardMachine());
  print("walk", Walk(kSegments, false), WalkMachine());
  print("walk trapezoid", Walk(kSegments, false), trapezoid);
  print("ramps", Contour(kSegments, false, 0.3), StandardMachine());
  print("zigzag", zigzag, StandardMachine());
  print("five axes", Contour(kSegments, true), StandardMachine());
  print("five axes walk", Walk(kSegments, true), WalkMachine());
  print("walk, stops", WithStops(Walk(kSegments, false)), WalkMachine());
  print("ramps, stops", WithStops(Contour(kSegments, false, 0.3)), StandardMachine());
  print("five axes walk, stops", WithStops(Walk(kSegments, true)), WalkMachine());
}

}  // namespace
}  // namespace rmlcell::motion

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], "--flat") == 0) {
    rmlcell::motion::Flat();
  } else if (argc > 1 && std::strcmp(argv[1], "--tail") == 0) {
    rmlcell::motion::Tail();
  } else {
    rmlcell::motion::Rates();
  }
}
