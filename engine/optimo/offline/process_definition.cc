#include <cmath>
#include <utility>

#include "engine/optimo/language/printer.h"
#include "engine/optimo/offline/project.h"

namespace rmlcell::optimo {
namespace {

constexpr double kPercentMax = 100.0;
constexpr double kScheduleMax = 63.0;

class Checker {
 public:
  explicit Checker(const machine::ProcessDefinition& definition) : definition_(definition) {}

  std::vector<Diagnostic> Run() {
    const int kind = definition_.kind;
    if (kind < 0 || kind > 2 || definition_.process < 0 || definition_.process > 9) {
      Report(ErrorCode::kProcessNumber, "the kind is 0, 1 or 2, the process number 0 to 9",
             "OPT-3.02");
      return std::move(found_);
    }
    const std::size_t count = definition_.values.size();
    const bool fits = kind == 0 ? count == 0 : kind == 1 ? count == 4 || count == 5 : count == 1;
    if (!fits) {
      Report(ErrorCode::kArgumentCount, Told("values", count) + " values do not fit this kind",
             kind == 0   ? "OPT-3.03"
             : kind == 1 ? "OPT-3.04"
                         : "OPT-3.06");
      return std::move(found_);
    }
    if (kind == 1) {
      Range(0, 0.0, kPercentMax, "speed");
      if (definition_.values[0] == 0.0)
        Report(ErrorCode::kLiteralRange, "the speed must be above 0", "OPT-3.08");
      Range(1, 0.0, kPercentMax, "power");
      Range(2, 0.0, HUGE_VAL, "delay");
      Range(3, 0.0, kPercentMax, "peak");
    }
    if (count == 5) Schedule(definition_.values[4]);
    if (kind == 2) Schedule(definition_.values[0]);
    return std::move(found_);
  }

 private:
  void Range(std::size_t at, double min, double max, const char* what) {
    const double value = definition_.values[at];
    if (std::isfinite(value) && value >= min && value <= max) return;
    Report(ErrorCode::kLiteralRange, "the " + Told("name", what) + " is out of range", "OPT-3.08");
  }
  void Schedule(double number) {
    if (number >= 1.0 && std::trunc(number) <= kScheduleMax) return;
    Report(ErrorCode::kScheduleRange, "laser schedules go from 1 to 63", "OPT-3.06");
  }
  void Report(ErrorCode code, const Detail& detail, const char* rule) {
    found_.push_back({.code = code,
                      .severity = Lookup(code).severity,
                      .detail = "process definition " + Told("kind", definition_.kind) + "," +
                                Told("process", definition_.process) + ": " + detail,
                      .rule = rule,
                      .file = {},
                      .where = {},
                      .fixes = {}});
  }

  const machine::ProcessDefinition& definition_;
  std::vector<Diagnostic> found_;
};

}  // namespace

std::vector<Diagnostic> CheckProcess(const machine::ProcessDefinition& definition) {
  return Checker(definition).Run();
}

std::string WorkdefText(const machine::ProcessDefinition& definition) {
  std::string text =
      "WORKDEF " + std::to_string(definition.kind) + "," + std::to_string(definition.process);
  for (std::size_t v = 0; v < definition.values.size(); ++v) {
    text += v == 0 ? " (" : ", ";
    const bool schedule = definition.kind == 2 || v == 4;
    if (schedule) {
      text += std::to_string(static_cast<int>(definition.values[v]));
    } else {
      PrintReal(static_cast<float>(definition.values[v]), text);
    }
  }
  if (!definition.values.empty()) text += ")";
  return text;
}

}  // namespace rmlcell::optimo
