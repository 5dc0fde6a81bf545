#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/machine/parameters.h"

namespace rmlcell::rml1::conformance {

// One row of rml1_examples.csv.
struct Example {
  std::string id;
  int number = 0;
  std::string tags;
  std::string input;  // escapes untouched
  std::string facts;

  std::string name() const { return id + " #" + std::to_string(number); }
};

std::vector<Example> LoadExamples(const std::string& csv_path);

// One table out of the specification itself, in the same form: what rml1_extract.py makes.
std::vector<Example> ExtractExamples(const std::string& spec_path);

// The input as a device gets it: bytes, and presses of the resume key between them.
struct Stroke {
  std::string bytes;
  bool resume = false;  // after the bytes
};
std::vector<Stroke> Unescape(std::string_view input);

// The conditions that the tags choose; profile T1 without any.
machine::Parameters ParametersFor(const Example& example);
bool ResumesOutsidePauses(const Example& example);  // {pause}: a panel that resumes at once

// What was seen of a device after an example. Points in work units, X Y Z A.
struct Observed {
  struct Event {
    enum class Kind { kMove, kSpin, kRpm, kStop, kDwell, kPause };
    Kind kind = Kind::kMove;
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;
    double a = 0.0;
    double feed = 0.0;
    int number = 0;  // rpm or ms

    bool operator==(const Event&) const = default;
  };
  std::vector<Event> trace;
  int err = 0;
  std::vector<int> log;
  std::size_t log_cleared_at = 0;  // entries in the log when H or IN cleared the register last
  int com = 0;
  std::vector<int> comlog;
  std::string mode;  // "abs"
  std::string tool;  // "up"
  double vs = 0.0;
  double vz = 0.0;
  double z0 = 0.0;
  double z1 = 0.0;
  double z2 = 0.0;
  int dwell_ms = 0;
  int rpm = 0;
  bool rotation = true;
  bool spindle_on = false;
  bool paused = false;
  std::optional<bool> pending;  // not known to every way of running
  Event at;                     // physical place
  Event logical;
  std::string esc_m;
  std::string esc_t;

  bool operator==(const Observed&) const = default;
};
std::string Print(const Observed::Event& event);
std::string Print(const std::vector<Observed::Event>& trace);

// What does not hold of the facts (rml1.md 0.1), the implied ones included; empty when all do.
std::vector<std::string> Violations(const Example& example, const Observed& observed);

}  // namespace rmlcell::rml1::conformance
