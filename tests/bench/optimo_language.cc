// Lines a second from source to tree, to checked tree and to object, with --all to formatted and to
// converted text, too, for programs of 1,000, 100,000 and 1,000,000 lines, whether the cost per
// line stays flat, and the peak of memory per line. With --rs274 the equivalent G-code is read by
// LinuxCNC's interpreter in the same rounds, for a ratio: PROGRAM is called with the name of the
// file; rs274_ratio.sh brings one. Every program is read in fresh memory, as a process that reads
// one program has it: else the short ones would be spared the kernel's work for new pages, which
// the long ones cannot be. How much of the time that is, is told apart. Run by hand:
//   optimo_language_bench [--rounds N] [--rs274 PROGRAM] [--all]
//   optimo_language_bench --once STAGE LINES         one program once, to count instructions
// Prints one JSON object a line.
#include <malloc.h>
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
struct Usage {
  double seconds = 0.0;
  double kernel_seconds = 0.0;  // of these, nearly all for new pages
  long new_pages = 0;

  Usage operator-(const Usage& since) const {
    return {seconds - since.seconds, kernel_seconds - since.kernel_seconds,
            new_pages - since.new_pages};
  }
  Usage& operator+=(const Usage& other) {
    seconds += other.seconds;
    kernel_seconds += other.kernel_seconds;
    new_pages += other.new_pages;
    return *this;
  }
};
Usage Now(int whose = RUSAGE_SELF) {
  rusage usage{};
  getrusage(whose, &usage);
  return {Seconds(usage.ru_utime) + Seconds(usage.ru_stime), Seconds(usage.ru_stime),
          usage.ru_minflt};
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
  constexpr std::size_t kLineBytes = 50;  // all at once, or growing would count as peak memory
  std::string text;
  text.reserve(kLineBytes * static_cast<std::size_t>(lines));
  text += "COORD ABSOL\nPATH LIN\n";
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

Usage Measure(const std::function<void()>& work, int whose = RUSAGE_SELF) {
  const Usage start = Now(whose);
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
    const Usage usage = Measure([&] { status = std::system(command.c_str()); }, RUSAGE_CHILDREN);
    return status == 0 ? usage.seconds : 0.0;
  }

  std::string program_;
};

struct Stage {
  const char* name;
  bool has_rival;
  std::function<bool(const std::string&)> run;  // false: it did not do its work
};

std::vector<Stage> Stages() {
  const CompileOptions plain{.object_limit = 0, .advice = false};
  return {
      {"parse", true,
       [](const std::string& text) {
         Findings findings;
         return Parse(text, findings, Places::kStatements).module.instructions.size() > 100;
       }},
      {"check", true,
       [](const std::string& text) {
         Findings findings;
         ParsedProgram program = Parse(text, findings, Places::kStatements);
         Check(program, findings);
         return findings.error_count() == 0;
       }},
      {"compile", true, [plain](const std::string& text) { return Compile(text, "", plain).ok; }},
      {"format", false, [](const std::string& text) { return Format(text).changed; }},
      {"convert", false,
       [](const std::string& text) {
         return Convert(text, Direction::kToInch).text.size() > text.size() / 2;
       }},
  };
}

using Times = std::vector<double>;  // seconds a line, one for each round

// Of one stage at one size.
struct Series {
  Times times;
  Usage sum;
  double lines = 0.0;  // that the sum is of
};

void PrintStage(const Stage& stage, const std::vector<int>& sizes,
                const std::vector<Series>& series, const Times& rival) {
  Times medians, leasts;
  std::printf("{\"stage\":\"%s\"", stage.name);
  for (std::size_t s = 0; s < sizes.size(); ++s) {
    const auto& [times, sum, lines] = series[s];
    const auto [best, worst] = std::ranges::minmax_element(times);
    medians.push_back(Median(times));
    leasts.push_back(*best);
    std::printf(
        ",\"%d_lines\":{\"ns_per_line\":%.1f,\"least\":%.1f,\"most\":%.1f,\"lines_per_s\":%.0f,"
        "\"kernel_ns_per_line\":%.1f,\"new_pages_per_line\":%.4f}",
        sizes[s], medians.back() * 1e9, *best * 1e9, *worst * 1e9, 1.0 / medians.back(),
        sum.kernel_seconds / lines * 1e9, static_cast<double>(sum.new_pages) / lines);
  }
  const auto spread = [](const Times& of_sizes) {
    const auto [cheapest, dearest] = std::ranges::minmax_element(of_sizes);
    return *dearest / *cheapest;
  };
  // The least of a size is what other work on the machine disturbed least.
  std::printf(",\"dearest_over_cheapest\":{\"by_medians\":%.3f,\"by_leasts\":%.3f}",
              spread(medians), spread(leasts));
  if (stage.has_rival && !rival.empty()) {
    // Round by round: what slows one down slows the other down.
    Times ratios;
    for (std::size_t round = 0; round < rival.size(); ++round)
      ratios.push_back(rival[round] / series[1].times[round]);
    const auto [worst, best] = std::ranges::minmax_element(ratios);
    std::printf(",\"times_as_fast_as_rs274\":{\"median\":%.2f,\"least\":%.2f,\"most\":%.2f}",
                Median(ratios), *worst, *best);
  }
  std::printf("}\n");
}

// False: it did not do its work.
bool RunStage(const Stage& stage, const std::string& text, int lines, int repeats, Series& series) {
  Usage round;
  for (int n = 0; n < repeats; ++n) {
    malloc_trim(0);
    bool good = true;
    const Usage usage = Measure([&] { good = stage.run(text); });
    if (!good) {
      std::fprintf(stderr, "%s did not do its work\n", stage.name);
      return false;
    }
    round += usage;
  }
  series.times.push_back(round.seconds / repeats / lines);
  series.sum += round;
  series.lines += static_cast<double>(repeats) * lines;
  return true;
}

int Run(int rounds, const Rival& rival, bool all) {
  const std::vector<int> sizes = {1'000, 100'000, 1'000'000};
  const std::vector<int> repeats = {1'000, 10, 1};  // as many lines at each size
  std::vector<Stage> stages = Stages();
  if (!all) std::erase_if(stages, [](const Stage& stage) { return !stage.has_rival; });
  std::vector<std::string> texts;
  for (const int size : sizes) texts.push_back(Program(size));
  std::vector<std::vector<Series>> series(stages.size(), std::vector<Series>(sizes.size()));
  Times rival_times;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t stage = 0; stage < stages.size(); ++stage) {
      for (std::size_t s = 0; s < sizes.size(); ++s) {
        if (!RunStage(stages[stage], texts[s], sizes[s], repeats[s], series[stage][s])) return 1;
      }
    }
    if (!rival.present()) continue;
    rival_times.push_back(rival.SecondsPerLine());
    if (rival_times.back() <= 0.0) {
      std::fprintf(stderr, "rs274 did not do its work\n");
      return 1;
    }
  }
  if (rival.present()) {
    const auto [least, most] = std::ranges::minmax_element(rival_times);
    std::printf("{\"rs274\":{\"ns_per_line\":%.1f,\"least\":%.1f,\"most\":%.1f}}\n",
                Median(rival_times) * 1e9, *least * 1e9, *most * 1e9);
  }
  for (std::size_t stage = 0; stage < stages.size(); ++stage)
    PrintStage(stages[stage], sizes, series[stage], rival_times);
  return 0;
}

int Once(const std::string& name, int lines) {
  const std::string text = Program(lines);
  for (const Stage& stage : Stages()) {
    if (stage.name == name) return stage.run(text) ? 0 : 1;
  }
  std::fprintf(stderr, "no stage %s\n", name.c_str());
  return 2;
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
  if (argc == 4 && std::strcmp(argv[1], "--once") == 0)
    return rmlcell::optimo::Once(argv[2], std::max(1, std::atoi(argv[3])));
  int rounds = 5;
  std::string rs274;
  bool all = false;
  for (int n = 1; n < argc; ++n) {
    const bool last = n + 1 == argc;
    if (std::strcmp(argv[n], "--all") == 0) {
      all = true;
    } else if (!last && std::strcmp(argv[n], "--rounds") == 0) {
      rounds = std::max(1, std::atoi(argv[++n]));
    } else if (!last && std::strcmp(argv[n], "--rs274") == 0) {
      rs274 = argv[++n];
    } else {
      std::fprintf(stderr, "what is %s? See the head of optimo_language.cc\n", argv[n]);
      return 2;
    }
  }
  rmlcell::optimo::PrintMachine("before");
  int failed = rmlcell::optimo::Memory();
  if (failed == 0) failed = rmlcell::optimo::Run(rounds, rmlcell::optimo::Rival(rs274), all);
  rmlcell::optimo::PrintMachine("after");
  return failed;
}
