// Lines a second from source to tree, to checked tree, to object and to formatted text, for
// programs of 1,000, 100,000 and 1,000,000 lines, whether the cost per line stays flat, and the
// peak of memory per line. With --rs274 the equivalent G-code is read by LinuxCNC's interpreter in
// the same rounds, for a ratio: PROGRAM is called with the name of the file; rs274_ratio.sh brings
// one. Run by hand:
//   optimo_language_bench [--rounds N] [--rs274 PROGRAM]
// Prints one JSON object a line.
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "engine/optimo/language/checker.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/formatter.h"
#include "engine/optimo/offline/convert.h"

namespace rmlcell::optimo {
namespace {

double Seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

// Processor time, of this process or of those that it waited for: other work on the machine then
// disturbs less.
double Now(int whose = RUSAGE_SELF) {
  rusage usage{};
  getrusage(whose, &usage);
  return Seconds(usage.ru_utime) + Seconds(usage.ru_stime);
}

double Median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

std::string Number(int thousandths) {
  char room[32];
  std::snprintf(room, sizeof room, "%d.%03d", thousandths / 1000, thousandths % 1000);
  return room;
}

// A contour as a CAD system writes it: eight moves, a speed and an assignment in ten lines.
std::string Program(int lines) {
  std::string text = "COORD ABSOL\nPATH LIN\n";
  for (int n = 2; n < lines; ++n) {
    const int k = n * 37 % 1'000'000;
    if (n % 10 == 3) {
      text += "SPEED " + std::to_string(5 + n % 10) + ".\n";
    } else if (n % 10 == 7) {
      text += "VR[" + std::to_string(n % 26) + "] = VR[1] + " + Number(k) + " ; row\n";
    } else {
      text += "MOVE (" + Number(k) + ", " + Number(k / 2) + ", -" + Number(k / 3) +
              ", 0., 1.5708) /FLY\n";
    }
  }
  return text;
}

// The same figures in G-code.
std::string Gcode(int lines) {
  std::string text = "G21 G90 G64\nF1000.\n";
  for (int n = 2; n < lines; ++n) {
    const int k = n * 37 % 1'000'000;
    if (n % 10 == 3) {
      text += "F" + std::to_string(500 + n % 10) + ".\n";
    } else if (n % 10 == 7) {
      text += "#" + std::to_string(1 + n % 26) + " = [#1 + " + Number(k) + "] (row)\n";
    } else {
      text += "G1 X" + Number(k) + " Y" + Number(k / 2) + " Z-" + Number(k / 3) + " A0. B1.5708\n";
    }
  }
  return text + "M2\n";
}

long PeakKilobytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

double Measure(const std::function<void()>& work, int whose = RUSAGE_SELF) {
  const double start = Now(whose);
  work();
  return Now(whose) - start;
}

// What the figures depend on: the machine, and what else it was doing.
void PrintMachine(const char* when) {
  std::string model = "unknown";
  std::ifstream processors("/proc/cpuinfo");
  for (std::string line; std::getline(processors, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    model = line.substr(line.find(':') + 2);
    break;
  }
  double load[3] = {};
  getloadavg(load, 3);
  std::printf("{\"%s\":{\"processor\":\"%s\",\"cores\":%ld,\"load\":[%.2f,%.2f,%.2f]}}\n", when,
              model.c_str(), sysconf(_SC_NPROCESSORS_ONLN), load[0], load[1], load[2]);
  std::fflush(stdout);
}

// LinuxCNC's interpreter on the equivalent G-code.
class Rival {
 public:
  // An empty program: there is none.
  explicit Rival(std::string program) : program_(std::move(program)) {
    if (!present()) return;
    std::ofstream(kLong) << Gcode(kLines);
    std::ofstream(kShort) << Gcode(2);
  }
  bool present() const { return !program_.empty(); }

  // Seconds a line, without what the program takes to start and to end. Zero: it failed.
  double SecondsPerLine() const {
    const double whole = Read(kLong), empty = Read(kShort);
    return whole <= 0.0 || empty <= 0.0 ? 0.0 : (whole - empty) / kLines;
  }

 private:
  static constexpr int kLines = 100'000;
  static constexpr const char* kLong = "/tmp/optimo_language_bench.ngc";
  static constexpr const char* kShort = "/tmp/optimo_language_bench_empty.ngc";

  double Read(const char* file) const {
    const std::string command = program_ + " " + file + " > /dev/null 2>&1";
    int status = 0;
    const double time = Measure([&] { status = std::system(command.c_str()); }, RUSAGE_CHILDREN);
    return status == 0 ? time : 0.0;
  }

  std::string program_;
};

struct Stage {
  const char* name;
  std::function<bool(const std::string&)> run;  // false: it did not do its work
};

std::vector<Stage> Stages() {
  const CompileOptions plain{.object_limit = 0, .advice = false};
  return {
      {"parse",
       [](const std::string& text) {
         Findings findings;
         return Parse(text, findings, Places::kStatements).module.instructions.size() > 100;
       }},
      {"check",
       [](const std::string& text) {
         Findings findings;
         ParsedProgram program = Parse(text, findings, Places::kStatements);
         Check(program, findings);
         return findings.error_count() == 0;
       }},
      {"compile", [plain](const std::string& text) { return Compile(text, "", plain).ok; }},
      {"format", [](const std::string& text) { return Format(text).changed; }},
      {"convert",
       [](const std::string& text) {
         return Convert(text, Direction::kToInch).text.size() > text.size() / 2;
       }},
  };
}

using Times = std::vector<double>;  // seconds a line, one for each round

void PrintStage(const char* name, const std::vector<int>& sizes, const std::vector<Times>& times,
                const Times& rival) {
  double least = 1e9, most = 0.0;
  std::printf("{\"stage\":\"%s\"", name);
  for (std::size_t s = 0; s < sizes.size(); ++s) {
    const double median = Median(times[s]);
    // Flatness by the best round: what disturbs a round makes it dearer, never cheaper.
    const auto [best, worst] = std::ranges::minmax_element(times[s]);
    least = std::min(least, *best);
    most = std::max(most, *best);
    std::printf(
        ",\"%d_lines\":{\"ns_per_line\":%.1f,\"least\":%.1f,\"most\":%.1f,\"lines_per_s\":%.0f}",
        sizes[s], median * 1e9, *best * 1e9, *worst * 1e9, 1.0 / median);
  }
  std::printf(",\"best_dearest_over_cheapest\":%.3f", most / least);
  if (!rival.empty()) {
    // Round by round: what slows one down slows the other down.
    Times ratios;
    for (std::size_t round = 0; round < rival.size(); ++round)
      ratios.push_back(rival[round] / times[1][round]);
    const auto [worst, best] = std::ranges::minmax_element(ratios);
    std::printf(",\"times_as_fast_as_rs274\":{\"median\":%.2f,\"least\":%.2f,\"most\":%.2f}",
                Median(ratios), *worst, *best);
  }
  std::printf("}\n");
}

int Run(int rounds, const Rival& rival) {
  const std::vector<int> sizes = {1'000, 100'000, 1'000'000};
  const std::vector<Stage> stages = Stages();
  std::vector<std::string> texts;
  for (const int size : sizes) texts.push_back(Program(size));
  std::vector<std::vector<Times>> times(stages.size(), std::vector<Times>(sizes.size()));
  Times rival_times;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t s = 0; s < sizes.size(); ++s) {
      // As many lines at each size, so that the short programs are measured as well as the long.
      const int repeats = s == 0 ? 200 : s == 1 ? 4 : 1;
      for (std::size_t stage = 0; stage < stages.size(); ++stage) {
        bool good = true;
        const double time = Measure([&] {
          for (int n = 0; n < repeats; ++n) good = stages[stage].run(texts[s]) && good;
        });
        if (!good) {
          std::fprintf(stderr, "%s did not do its work\n", stages[stage].name);
          return 1;
        }
        times[stage][s].push_back(time / repeats / sizes[s]);
      }
      if (s == 1 && rival.present()) {
        rival_times.push_back(rival.SecondsPerLine());
        if (rival_times.back() <= 0.0) {
          std::fprintf(stderr, "rs274 did not do its work\n");
          return 1;
        }
      }
    }
  }
  if (rival.present()) {
    const auto [least, most] = std::ranges::minmax_element(rival_times);
    std::printf("{\"rs274\":{\"ns_per_line\":%.1f,\"least\":%.1f,\"most\":%.1f}}\n",
                Median(rival_times) * 1e9, *least * 1e9, *most * 1e9);
  }
  for (std::size_t stage = 0; stage < stages.size(); ++stage)
    PrintStage(stages[stage].name, sizes, times[stage], rival_times);
  return 0;
}

// In a process of its own for each size: the peak is that of one compilation.
int Memory() {
  for (const int size : {100'000, 1'000'000}) {
    std::fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
      const std::string text = Program(size);
      const long before = PeakKilobytes();
      const Compilation compiled = Compile(text, "", {.object_limit = 0, .advice = false});
      const long after = PeakKilobytes();
      std::printf(
          "{\"lines\":%d,\"source_bytes_per_line\":%.1f,\"object_bytes_per_line\":%.1f,"
          "\"peak_bytes_per_line\":%.1f}\n",
          size, static_cast<double>(text.size()) / size,
          static_cast<double>(compiled.object.size()) / size,
          static_cast<double>(after - before) * 1024.0 / size);
      std::fflush(stdout);
      _exit(compiled.ok ? 0 : 1);
    }
    int status = 0;
    if (child < 0 || waitpid(child, &status, 0) < 0 || status != 0) return 1;
  }
  return 0;
}

}  // namespace
}  // namespace rmlcell::optimo

int main(int argc, char** argv) {
  int rounds = 5;
  std::string rs274;
  for (int n = 1; n + 1 < argc; n += 2) {
    if (std::strcmp(argv[n], "--rounds") == 0) rounds = std::max(1, std::atoi(argv[n + 1]));
    if (std::strcmp(argv[n], "--rs274") == 0) rs274 = argv[n + 1];
  }
  rmlcell::optimo::PrintMachine("before");
  int failed = rmlcell::optimo::Memory();
  if (failed == 0) failed = rmlcell::optimo::Run(rounds, rmlcell::optimo::Rival(rs274));
  rmlcell::optimo::PrintMachine("after");
  return failed;
}
