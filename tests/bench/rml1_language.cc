// RML-1 text to checked, positioned moves, beside the bare scan of the same bytes into records of a
// letter and at most three whole numbers (the shared numscan_limit.cpp, "own, records"), which
// checks nothing and moves nothing. Goal I1: at least 0.35 of the scan, the median of the ratios of
// the rounds, no round below 0.7 of that. Scan and reading alternate, processor time counts. What a
// check and a run of the same text take is told beside. The text is a walk of short lines in four
// forms (rml1_texts.h), in which no line is as long as another. Run by hand:
//   rml1_language_bench [--rounds N] [--moves N] [--rs274 PROGRAM]
// With --rs274 LinuxCNC's interpreter reads the walk of the sets in G-code in the same rounds, for
// the other half of the goal: at least 40 times as many moves a second. PROGRAM is called with the
// name of the file; rs274_ratio.sh brings one. Ends with 1 when a goal is missed.
#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/bench/rml1_reading.h"
#include "tests/bench/rml1_texts.h"

namespace rmlcell::bench {
namespace {

constexpr double kGoal = 0.35;
constexpr double kRivalGoal = 40.0;
constexpr double kLeastOfGoal = 0.7;
constexpr double kZ0 = -2000.0;  // of the machine: places of Z count from its zero

double ProcessorSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double SecondsOf(const std::function<void()>& work) {
  const double start = ProcessorSeconds();
  work();
  return ProcessorSeconds() - start;
}

double Median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

// The limit. What it finds is kept, as a reader would.
struct Record {
  char name = 0;
  int count = 0;
  int values[3] = {};
};
double Scan(std::string_view text, std::vector<Record>& records) {
  records.clear();
  double sum = 0.0;  // of the numbers of records with three
  const char* p = text.data();
  const char* const end = p + text.size();
  while (p < end) {
    const char name = *p++;
    if (name == ';' || name == '\n') continue;
    Record record;
    record.name = name;
    while (p < end && record.count < 3) {
      const bool negative = *p == '-';
      p += negative ? 1 : 0;
      unsigned digit = static_cast<unsigned>(static_cast<unsigned char>(*p)) - '0';
      if (digit > 9) break;
      unsigned value = digit;
      ++p;
      while ((digit = static_cast<unsigned>(static_cast<unsigned char>(*p)) - '0') < 10) {
        value = value * 10 + digit;
        ++p;
      }
      const int whole = static_cast<int>(value);
      record.values[record.count++] = negative ? -whole : whole;
      if (*p != ',') break;
      ++p;
    }
    if (record.count == 3) sum += record.values[0] + record.values[1] + record.values[2];
    records.push_back(record);
  }
  return sum;
}

double SecondsOfChildren() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// LinuxCNC's interpreter. An empty program: there is none.
class Rival {
 public:
  Rival(std::string program, int moves) : program_(std::move(program)), moves_(moves) {
    if (!present()) return;
    std::ofstream(kLong) << Rml1Walk("gcode").Text(moves);
    std::ofstream(kShort) << Rml1Walk("gcode").Text(0);
  }
  bool present() const { return !program_.empty(); }

  // Seconds a move, without what the program takes to start and to end. Zero: it failed.
  double SecondsPerMove() const {
    const double all = Read(kLong), none = Read(kShort);
    return all > 0.0 && none > 0.0 ? (all - none) / moves_ : 0.0;
  }

 private:
  static constexpr const char* kLong = "/tmp/rml1_language_bench.ngc";
  static constexpr const char* kShort = "/tmp/rml1_language_bench_empty.ngc";

  double Read(const char* file) const {
    const double start = SecondsOfChildren();
    const std::string command = program_ + " " + file + " > /dev/null 2>&1";
    return std::system(command.c_str()) == 0 ? SecondsOfChildren() - start : 0.0;
  }

  std::string program_;
  int moves_;
};

struct Form {
  std::string name;
  std::string text;
  std::vector<double> scan, read, check, run, ratio;
};

// False: the two did not find the same.
bool Round(const machine::Parameters& parameters, const rml1::Profile& profile, Form& form,
           std::vector<Record>& records) {
  double scanned = 0.0;
  Places read;
  form.scan.push_back(SecondsOf([&] { scanned = Scan(form.text, records); }));
  form.read.push_back(SecondsOf([&] { read = ReadPlaces(profile, form.text); }));
  form.check.push_back(SecondsOf([&] { CheckText(parameters, form.text); }));
  form.run.push_back(SecondsOf([&] { RunText(parameters, form.text); }));
  form.ratio.push_back(form.scan.back() / form.read.back());
  const bool same =
      form.name != "sets" || std::abs(scanned + kZ0 * read.moves - read.sum) <= std::abs(kZ0);
  if (!same) std::fprintf(stderr, "%.1f scanned, %.1f read\n", scanned, read.sum);
  return same && read.moves > 0;
}

// True: it reaches the goal.
bool Print(const Form& form, int moves) {
  const auto nanoseconds = [moves](const std::vector<double>& seconds) {
    return Median(seconds) / moves * 1e9;
  };
  const double median = Median(form.ratio);
  const double least = *std::ranges::min_element(form.ratio);
  const bool reached = median >= kGoal && least >= kLeastOfGoal * kGoal;
  std::printf(
      "{\"form\":\"%s\",\"bytes_per_move\":%.1f,\"ns_per_move\":{\"scan\":%.1f,\"read\":%.1f,"
      "\"check\":%.1f,\"run\":%.1f},\"of_the_scan\":{\"median\":%.3f,\"least\":%.3f,\"goal\":%.2f,"
      "\"reached\":%s}}\n",
      form.name.c_str(), static_cast<double>(form.text.size()) / moves, nanoseconds(form.scan),
      nanoseconds(form.read), nanoseconds(form.check), nanoseconds(form.run), median, least, kGoal,
      reached ? "true" : "false");
  return reached;
}

bool PrintRival(const std::vector<double>& ratios, double seconds_per_move) {
  const double median = Median(ratios);
  const double least = *std::ranges::min_element(ratios);
  const bool reached = median >= kRivalGoal && least >= kLeastOfGoal * kRivalGoal;
  std::printf(
      "{\"rs274\":{\"ns_per_move\":%.1f,\"times_as_fast\":{\"median\":%.1f,\"least\":%.1f,"
      "\"goal\":%.0f,\"reached\":%s}}}\n",
      seconds_per_move * 1e9, median, least, kRivalGoal, reached ? "true" : "false");
  return reached;
}

int Main(int rounds, int moves, const std::string& program) {
  const Result<machine::Parameters> parameters = WideMachine();
  if (!parameters) return 2;
  const Result<rml1::Profile> profile = rml1::MakeProfile(*parameters);
  if (!profile) return 2;
  std::vector<Form> forms;
  for (const char* name : {"sets", "pairs", "list", "steps"}) {
    forms.push_back({.name = name, .text = Rml1Walk(name).Text(moves)});
  }
  std::vector<Record> records;
  const Rival rival(program, moves);
  std::vector<double> rival_times, rival_ratios;
  for (int round = 0; round < rounds; ++round) {
    for (Form& form : forms) {
      if (!Round(*parameters, *profile, form, records)) return 1;
    }
    if (!rival.present()) continue;
    rival_times.push_back(rival.SecondsPerMove());
    rival_ratios.push_back(rival_times.back() * moves / forms.front().read.back());
  }
  double load[3] = {};
  getloadavg(load, 3);
  std::printf("{\"load\":%.2f,\"rounds\":%d,\"moves\":%d}\n", load[0], rounds, moves);
  bool reached = true;
  for (const Form& form : forms) reached = Print(form, moves) && reached;
  if (rival.present()) reached = PrintRival(rival_ratios, Median(rival_times)) && reached;
  return reached ? 0 : 1;
}

}  // namespace
}  // namespace rmlcell::bench

int main(int argc, char** argv) {
  int rounds = 7;
  int moves = 200'000;
  std::string rs274;
  for (int n = 1; n + 1 < argc; n += 2) {
    if (std::strcmp(argv[n], "--rounds") == 0) rounds = std::max(5, std::atoi(argv[n + 1]));
    if (std::strcmp(argv[n], "--rs274") == 0) rs274 = argv[n + 1];
    if (std::strcmp(argv[n], "--moves") == 0) moves = std::max(1000, std::atoi(argv[n + 1]));
  }
  return rmlcell::bench::Main(rounds, moves, rs274);
}
