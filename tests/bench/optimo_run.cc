// A loop of seven operations in an Optimo program beside the same loop in Lua 5.4, by processor
// time: rounds alternate, each ratio is of one round, and the median counts. Of Lua, a process, the
// start-up is taken off; of ours only the run is measured, its observer wants nothing. Then what a
// call with two arguments costs that makes one move. Run by hand:
//   optimo_run_bench [ROUNDS]
// Ends with 1 when the goal is missed in the median or in any round by too much; without lua5.4
// (Debian package of that name) it says so and tells its own figures alone.
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "tests/bench/optimo_programs.h"

namespace rmlcell::bench {
namespace {

constexpr double kGoal = 0.8;       // times as many rounds in a second as Lua
constexpr double kEachRound = 0.7;  // of the goal, in every round
constexpr int kLoopRounds = 4'000'000;
constexpr int kCalls = 10'000;
constexpr const char* kLuaFile = "/tmp/optimo_run_bench.lua";

double Median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

double Seconds(int whose) {
  rusage usage{};
  getrusage(whose, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// Below zero: it failed.
double NsOfOurs(const char* what, int rounds) {
  OptimoProgram program(what, rounds);
  const double start = Seconds(RUSAGE_SELF);
  const bool over = program.RunToEnd();
  return over ? (Seconds(RUSAGE_SELF) - start) * 1e9 / rounds : -1.0;
}

// Below zero: there is none.
double SecondsOfLua(int rounds) {
  std::ofstream(kLuaFile) << "local i,s=0.0,0.0 while i<" << rounds
                          << " do s=s+i*3.5-i/7.0 i=i+1 end\n";
  const double start = Seconds(RUSAGE_CHILDREN);
  const int status = std::system((std::string("lua5.4 ") + kLuaFile).c_str());
  return status == 0 ? Seconds(RUSAGE_CHILDREN) - start : -1.0;
}

double NsOfLua() {
  const double all = SecondsOfLua(kLoopRounds), started = SecondsOfLua(1);
  return all < 0.0 || started < 0.0 ? -1.0 : (all - started) * 1e9 / kLoopRounds;
}

int Run(int rounds) {
  const bool has_lua = std::system("lua5.4 -v > /dev/null 2>&1") == 0;
  std::vector<double> loop, call, lua, ratios;
  for (int n = 0; n < rounds; ++n) {
    loop.push_back(NsOfOurs("loop", kLoopRounds));
    if (has_lua) lua.push_back(NsOfLua());
    call.push_back(NsOfOurs("call", kCalls));
    if (loop.back() <= 0.0 || call.back() <= 0.0 || (has_lua && lua.back() <= 0.0)) {
      std::fprintf(stderr, "one of them did not do its work\n");
      return 1;
    }
    if (has_lua) ratios.push_back(lua.back() / loop.back());
  }
  double load[3] = {};
  getloadavg(load, 3);
  std::printf("load %.2f\nloop %.1f ns a round\ncall and move %.0f ns\n", load[0], Median(loop),
              Median(call));
  if (!has_lua) {
    std::printf("no lua5.4: nothing to compare with\n");
    return 0;
  }
  const double median = Median(ratios), least = *std::ranges::min_element(ratios);
  const bool reached = median >= kGoal && least >= kEachRound * kGoal;
  std::printf("lua5.4 %.1f ns a round\nloop over lua5.4 %.2f, least %.2f   goal: at least %.2f%s\n",
              Median(lua), median, least, kGoal, reached ? "" : "   MISSED");
  return reached ? 0 : 1;
}

}  // namespace
}  // namespace rmlcell::bench

int main(int argc, char** argv) {
  return rmlcell::bench::Run(argc > 1 ? std::max(5, std::atoi(argv[1])) : 7);
}
