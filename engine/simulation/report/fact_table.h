#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/number_text.h"
#include "engine/simulation/report/facts.h"

namespace rmlcell::simulation::facts {

inline constexpr std::string_view kNone = "none";
inline constexpr int kDecimals = 6;  // lengths to 1e-6 mm, times to 1e-6 s: motion.md 8.2

inline std::string Real(double value) { return TrimmedText(value, kDecimals); }
inline std::string Count(std::uint64_t value) { return std::to_string(value); }
inline std::string Seconds(SimTime time) { return Real(ToSeconds(time)); }
inline std::string Share(double value, double limit) {
  return limit > 0.0 ? Real(value / limit) : std::string(kNone);
}
inline std::string Yes(bool value) { return value ? "yes" : "no"; }

// One line, whatever a program was called: a value never breaks the format.
inline std::string Line(std::string_view text) {
  if (text.empty()) return std::string(kNone);
  std::string line;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    line += byte < 0x20 || byte == 0x7F ? ' ' : c;
  }
  return line;
}

struct Row {
  std::string key;
  std::string unit;
  std::string text;
  std::function<std::string(const RunReport&)> value;
};

// The keys of the facts, and how each is read off a report.
class Table {
 public:
  using Get = std::function<std::string(const RunReport&)>;

  Table();

  const std::vector<Row>& rows() const { return rows_; }
  const std::vector<FactKey>& keys() const { return keys_; }

 private:
  void Add(std::string key, std::string unit, std::string text, Get value) {
    rows_.push_back({std::move(key), std::move(unit), std::move(text), std::move(value)});
  }
  void Time(std::string key, std::string text, SimTime TimeParts::*part) {
    Add(std::move(key), "s", std::move(text),
        [part](const RunReport& r) { return Seconds(r.total.time.*part); });
  }
  void Figure(std::string key, std::string unit, std::string text, double WorkFigures::*figure) {
    Add(std::move(key), std::move(unit), std::move(text),
        [figure](const RunReport& r) { return Real(r.total.*figure); });
  }
  void Counter(std::string key, std::string text, std::uint64_t WorkFigures::*figure) {
    Add(std::move(key), "", std::move(text),
        [figure](const RunReport& r) { return Count(r.total.*figure); });
  }

  void AddRun();
  void AddTimes();
  void AddWork();
  void AddBeamTimes();
  void AddContours();
  void AddCorners();
  void AddPositions();
  void AddPoint(const std::string& name, const std::string& unit, const std::string& text,
                std::function<motion::MachineVector(const RunReport&)> point);
  void AddBoxes();
  template <class Point>
  void AddBox(const std::string& name, const std::string& unit, const std::string& text,
              machine::BoxOf<Point> ScopeFigures::*box);
  void AddAxes();
  void AddAxis(std::string_view axis);
  void AddFindings();
  void AddProducts();

  std::vector<Row> rows_;
  std::vector<FactKey> keys_;
};

}  // namespace rmlcell::simulation::facts
