// Our planner beside LinuxCNC's (tpmod.so), the same polylines under the same limits in the same
// run, rounds interleaved: lines taken a second, machine time of the plan, positions given a
// second. Started by motion_linuxcnc.sh, which provides the library. LinuxCNC 2.9 limits speed and
// acceleration, not jerk: our machine time is told for both kinds, the comparison is with
// trapezoids. Behind them the walk of the goals with a limit on jerk (P1, P2), taken and given out,
// beside tpAddLine and beside the bare loop of bare_plan.h.
//   motion_linuxcnc_bench LIBPEER.SO
// Prints one JSON object a line; ends with 1 when a goal is missed.
#include <dlfcn.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <limits>
#include <string>

#include "engine/motion/ride/trajectory.h"
#include "tests/bench/bare_plan.h"
#include "tests/bench/motion_paths.h"

namespace rmlcell::motion {
namespace {

constexpr int kRounds = 5;
constexpr double kSampleGoal = 20.0;  // P5
constexpr double kLineGoal = 4.0;     // P1, of tpAddLine
constexpr double kBareGoal = 0.25;    // P1 and P2, of the bare loop

double Now() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// The functions of linuxcnc_planner.c.
struct Peer {
  int (*open)(double cycle_s, double speed, double acceleration, double tolerance,
              const double* xyz) = nullptr;
  int (*add_line)(const double* xyz, double speed, double acceleration, int id) = nullptr;
  void (*run_cycle)(long period_ns) = nullptr;
  int (*done)() = nullptr;
  int (*full)() = nullptr;
  void (*position)(double* xyz) = nullptr;
};

template <class Function>
bool Find(void* library, const char* name, Function& function) {
  void* symbol = dlsym(library, name);
  // The one conversion from an object pointer that POSIX promises.
  function = reinterpret_cast<Function>(symbol);
  return symbol != nullptr;
}

struct Outcome {
  double lines_per_s = 0.0;  // taken and looked ahead over: what tpAddLine does
  double given_per_s = 0.0;  // and given out as timed motions, which the peer does as it runs
  double samples_per_s = 0.0;
  double machine_time_s = 0.0;
};

// `tolerance_mm` 0: no limit to how far a blend may leave the path.
Outcome RunPeer(const Peer& peer, const std::vector<MoveCommand>& chain,
                const MachineLimits& machine, double tolerance_mm, double* sum) {
  constexpr double kCycle_s = 0.001;
  const MachinePoint& start = chain.front().path.from().point;
  const double xyz[3] = {start.x(), start.y(), start.z()};
  if (peer.open(kCycle_s, machine.tip_speed_mm_s, machine.tip_acceleration_mm_s2, tolerance_mm,
                xyz) != 0) {
    return {};
  }
  double adding = 0.0;
  double running = 0.0;
  long cycles = 0;
  std::size_t next = 0;
  for (;;) {
    double begin = Now();
    while (next < chain.size() && peer.full() == 0) {
      const MachinePoint& to = chain[next].path.to().point;
      const double end[3] = {to.x(), to.y(), to.z()};
      const double speed = chain[next].speed_fraction * machine.tip_speed_mm_s;
      if (peer.add_line(end, speed, machine.tip_acceleration_mm_s2, static_cast<int>(next)) != 0) {
        return {};
      }
      ++next;
    }
    adding += Now() - begin;
    if (next == chain.size() && peer.done() != 0) break;
    begin = Now();
    for (int k = 0; k < 1000 && peer.done() == 0; ++k) {
      peer.run_cycle(1'000'000);
      double at[3];
      peer.position(at);
      *sum += at[0] + at[1] + at[2];
      ++cycles;
    }
    running += Now() - begin;
  }
  const double lines_per_s = static_cast<double>(chain.size()) / adding;
  return {lines_per_s, lines_per_s, static_cast<double>(cycles) / running,
          static_cast<double>(cycles) * kCycle_s};
}

// As the peer does it: as many lines as its queue takes, then their positions, in memory that both
// use again and again.
Outcome RunOurs(const std::vector<MoveCommand>& chain, const MachineLimits& machine, double* sum) {
  constexpr std::size_t kQueue = 2000;  // DEFAULT_TC_QUEUE_SIZE
  static std::vector<PlannedMotion> motions;
  Planner planner(machine);
  SampleTimes times(1000.0);
  std::uint64_t samples = 0;
  double adding = 0.0;
  double giving = 0.0;
  double sampling = 0.0;
  for (std::size_t next = 0; next < chain.size();) {
    double begin = Now();
    motions.clear();
    const std::size_t end = std::min(next + kQueue, chain.size());
    for (; next < end; ++next) {
      if (!planner.Append(chain[next])) return {};
    }
    if (end == chain.size()) planner.Stop();
    adding += Now() - begin;

    begin = Now();
    while (const PlannedItem* item = planner.NextInPlace()) {
      motions.push_back(std::get<PlannedMotion>(*item));
    }
    giving += Now() - begin;

    begin = Now();
    for (const PlannedMotion& motion : motions) {
      const double duration = motion.speed.duration_s();
      if (times.NextWithin(duration)) {
        const MotionView view(motion);
        times.Through(duration, [&](double, double t) {
          const MachinePoint tip = view.PoseAt(t).tip;
          *sum += tip.x() + tip.y() + tip.z();
          ++samples;
        });
      } else {
        times.Through(duration, [](double, double) {});
      }
    }
    sampling += Now() - begin;
  }
  const auto lines = static_cast<double>(chain.size());
  return {lines / adding, lines / (adding + giving), static_cast<double>(samples) / sampling,
          times.elapsed_s()};
}

// False: positions are not given as many times as fast as the goal asks for.
bool Compare(const Peer& peer, const char* name, const std::vector<MoveCommand>& chain) {
  MachineLimits trapezoid = StandardMachine();
  trapezoid.tip_jerk_mm_s3 = std::numeric_limits<double>::infinity();
  std::vector<double> lines[3], given[3], samples[3];
  double time[3] = {};
  double sum = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    const Outcome outcomes[3] = {RunPeer(peer, chain, StandardMachine(), 0.0, &sum),
                                 RunOurs(chain, trapezoid, &sum),
                                 RunOurs(chain, StandardMachine(), &sum)};
    for (int k = 0; k < 3; ++k) {
      lines[k].push_back(outcomes[k].lines_per_s);
      given[k].push_back(outcomes[k].given_per_s);
      samples[k].push_back(outcomes[k].samples_per_s);
      time[k] = outcomes[k].machine_time_s;
    }
  }
  std::printf(
      "{\"path\": \"%s\", \"lines\": %zu, \"peer_lines_per_s\": %.0f, \"lines_per_s\": %.0f, "
      "\"jerk_lines_per_s\": %.0f, \"line_ratio\": %.2f, \"given_ratio\": %.2f, "
      "\"peer_cycles_per_s\": %.0f, "
      "\"samples_per_s\": %.0f, \"sample_ratio\": %.2f, \"peer_time_s\": %.3f, \"time_s\": %.3f, "
      "\"jerk_time_s\": %.3f, \"sum\": %.6g}\n",
      name, chain.size(), Median(lines[0]), Median(lines[1]), Median(lines[2]),
      Median(lines[1]) / Median(lines[0]), Median(given[1]) / Median(lines[0]), Median(samples[0]),
      Median(samples[1]), Median(samples[1]) / Median(samples[0]), time[0], time[1], time[2], sum);
  std::fflush(stdout);
  return Median(samples[1]) >= kSampleGoal * Median(samples[0]);
}

// The walk: ours is all that a line costs until its motions are out. The peer has no limit on jerk,
// and with it no head: of five axes the bare loop alone is beside ours.
bool CompareWalk(const Peer& peer, bool head) {
  constexpr int kLines = 40'000;
  constexpr double kTolerance_mm = 0.01;
  const std::vector<MoveCommand> chain = Walk(kLines, head);
  bench::BarePlan bare(kLines, head ? 5 : 3);
  std::vector<double> rate, of_peer, of_bare;
  double sum = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    const double begin = Now();
    sum += bare.Run();
    const double bare_per_s = kLines / (Now() - begin);
    rate.push_back(RunOurs(chain, WalkMachine(), &sum).given_per_s);
    of_bare.push_back(rate.back() / bare_per_s);
    if (head) continue;
    const Outcome rival = RunPeer(peer, chain, WalkMachine(), kTolerance_mm, &sum);
    of_peer.push_back(rate.back() / rival.lines_per_s);
  }
  const double to_peer = head ? kLineGoal : Median(of_peer);
  std::printf(
      "{\"path\": \"walk, %d axes, jerk\", \"lines\": %d, \"lines_per_s\": %.0f, "
      "\"peer_ratio\": %.3f, \"peer_goal\": %.0f, \"bare_ratio\": %.4f, \"bare_goal\": %.2f, "
      "\"sum\": %.6g}\n",
      head ? 5 : 3, kLines, Median(rate), head ? 0.0 : to_peer, head ? 0.0 : kLineGoal,
      Median(of_bare), kBareGoal, sum);
  std::fflush(stdout);
  return to_peer >= kLineGoal && Median(of_bare) >= kBareGoal;
}

int Main(const char* library_path) {
  void* library = dlopen(library_path, RTLD_NOW | RTLD_GLOBAL);
  Peer peer;
  if (library == nullptr || !Find(library, "peer_open", peer.open) ||
      !Find(library, "peer_add_line", peer.add_line) ||
      !Find(library, "peer_run_cycle", peer.run_cycle) || !Find(library, "peer_done", peer.done) ||
      !Find(library, "peer_full", peer.full) || !Find(library, "peer_position", peer.position)) {
    std::fprintf(stderr, "motion_linuxcnc_bench: %s\n", dlerror());
    return 1;
  }
  bool reached = true;
  reached &= Compare(peer, "contour 2.5 mm, 30 mm/s", Contour(1200, false));
  reached &= Compare(peer, "contour 2.5 mm, 150 mm/s", Contour(3000, false, 0.3));
  reached &=
      Compare(peer, "square 40 mm, 40 mm/s", Polyline(Legs(400, 40.0, 0.5 * kPi, false), 0.08));
  reached &= Compare(peer, "polygon, 5 mm legs, 3 deg, 100 mm/s",
                     Polyline(Legs(2400, 5.0, 3.0 * kPi / 180.0, false), 0.2));
  reached &= Compare(peer, "long legs 300 mm, 90 deg, 350 mm/s",
                     Polyline(Legs(100, 300.0, 0.5 * kPi, true), 0.7));
  reached &= Compare(peer, "zigzag 2 mm, 90 deg, 150 mm/s",
                     Polyline(Legs(400, 2.0, 0.5 * kPi, true), 0.3));
  reached &= Compare(peer, "zigzag 4.3 mm, 140 deg, 125 mm/s",
                     Polyline(Legs(400, 4.3, 140.0 * kPi / 180.0, true), 0.25));
  reached &= CompareWalk(peer, false);
  reached &= CompareWalk(peer, true);
  return reached ? 0 : 1;
}

}  // namespace
}  // namespace rmlcell::motion

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: motion_linuxcnc_bench LIBPEER.SO (see motion_linuxcnc.sh)\n");
    return 2;
  }
  return rmlcell::motion::Main(argv[1]);
}
