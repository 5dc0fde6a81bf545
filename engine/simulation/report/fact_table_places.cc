// Where the machine was: positions, boxes, axes.
#include <array>
#include <utility>

#include "engine/simulation/report/fact_table.h"

namespace rmlcell::simulation::facts {
namespace {

using motion::MachineVector;

constexpr std::array kCoordinates{"_x", "_y", "_z"};

std::string Unit(std::string_view unit) {
  std::string suffix(unit.empty() ? "" : "_");
  suffix += unit;
  return suffix;
}

// "_x" -> "X of the ".
std::string CoordinateName(std::string_view suffix) {
  std::string name(1, static_cast<char>(suffix.back() - 'a' + 'A'));
  name += " of the ";
  return name;
}

const MachineVector& VectorOf(const MachineVector& point) { return point; }
const MachineVector& VectorOf(const motion::ProgramPoint& point) { return point.from_origin(); }

}  // namespace

void Table::AddPoint(const std::string& name, const std::string& unit, const std::string& text,
                     std::function<MachineVector(const RunReport&)> point) {
  for (int i = 0; i < 3; ++i) {
    Add(name + kCoordinates[i] + Unit(unit), unit, CoordinateName(kCoordinates[i]) + text,
        [point, i](const RunReport& r) { return Real(point(r)[i]); });
  }
}

void Table::AddPositions() {
  AddPoint("final_tip", "mm", "tip at the end",
           [](const RunReport& r) { return r.final_position.tip.tip; });
  AddPoint("final_column", "mm", "column at the end, or the tip of a mill",
           [](const RunReport& r) { return r.final_position.axes.column; });
  Add("final_a_rad", "rad", "A at the end; of a mill the rotary axis",
      [](const RunReport& r) { return Real(r.final_position.axes.a_rad); });
  Add("final_b_rad", "rad", "B at the end",
      [](const RunReport& r) { return Real(r.final_position.axes.b_rad); });
  for (int i = 0; i < 3; ++i) {
    Add("work_origin" + std::string(kCoordinates[i]) + "_mm", "mm",
        CoordinateName(kCoordinates[i]) +
            "work origin of a mill, machine frame; Z where Z0 was before the program",
        [i](const RunReport& r) {
          return r.work_origin ? Real((*r.work_origin)[i]) : std::string(kNone);
        });
  }
  AddPoint("final_point", "", "last point as the program wrote it, in its own frame and units",
           [](const RunReport& r) { return r.final_position.program_point.from_origin(); });
}

template <class Point>
void Table::AddBox(const std::string& name, const std::string& unit, const std::string& text,
                   machine::BoxOf<Point> ScopeFigures::*box) {
  for (int i = 0; i < 3; ++i) {
    for (const bool low : {true, false}) {
      Add(name + kCoordinates[i] + (low ? "_min" : "_max") + Unit(unit), unit,
          (low ? "least " : "greatest ") + CoordinateName(kCoordinates[i]) + text,
          [box, low, i](const RunReport& r) {
            const machine::BoxOf<Point>& b = r.*box;
            if (b.empty()) return std::string(kNone);
            return Real(VectorOf(low ? b.min : b.max)[i]);
          });
    }
  }
}

void Table::AddBoxes() {
  AddBox("programmed", "", "points as the program wrote them", &ScopeFigures::programmed);
  AddBox("tip", "mm", "tip", &ScopeFigures::tip);
  AddBox("cut", "mm", "tip while it cut", &ScopeFigures::cut);
  AddBox("column", "mm", "column of a gantry, or the tip of a mill", &ScopeFigures::column);
}

void Table::AddAxis(std::string_view axis) {
  const bool rotary = axis == "A" || axis == "B";
  const std::string name(1, static_cast<char>(axis.front() - 'A' + 'a'));
  const std::string unit = rotary ? "rad" : "mm";
  const auto add = [&](std::string key, std::string key_unit, std::string text,
                       std::function<std::string(const AxisFigures&)> value) {
    Add(std::move(key), std::move(key_unit), std::move(text),
        [axis, value = std::move(value)](const RunReport& r) {
          for (const AxisFigures& figures : r.axes) {
            if (figures.name == axis) return value(figures);
          }
          return std::string(kNone);
        });
  };
  const std::string of = " of axis " + std::string(axis);
  if (rotary) {
    add("axis_" + name + "_min_rad", "rad", "least angle" + of,
        [](const AxisFigures& a) { return Real(a.minimum); });
    add("axis_" + name + "_max_rad", "rad", "greatest angle" + of,
        [](const AxisFigures& a) { return Real(a.maximum); });
  }
  add("axis_" + name + "_travel_" + unit, unit, "sum of the ways" + of,
      [](const AxisFigures& a) { return Real(a.travel); });
  add("axis_" + name + "_reversals", "", "changes of direction" + of,
      [](const AxisFigures& a) { return Count(a.reversals); });
  add("axis_" + name + "_peak_speed_" + unit + "_s", unit + "/s", "highest speed" + of,
      [](const AxisFigures& a) { return Real(a.peak_speed); });
  add("axis_" + name + "_peak_acceleration_" + unit + "_s2", unit + "/s2",
      "highest acceleration" + of, [](const AxisFigures& a) { return Real(a.peak_acceleration); });
  add("axis_" + name + "_peak_jerk_" + unit + "_s3", unit + "/s3", "highest jerk" + of,
      [](const AxisFigures& a) { return Real(a.peak_jerk); });
  add("axis_" + name + "_peak_speed_share", "", "highest speed by its limit" + of,
      [](const AxisFigures& a) { return Share(a.peak_speed, a.speed_limit); });
  add("axis_" + name + "_peak_acceleration_share", "", "highest acceleration by its limit" + of,
      [](const AxisFigures& a) { return Share(a.peak_acceleration, a.acceleration_limit); });
}

void Table::AddAxes() {
  Add("tip_peak_speed_mm_s", "mm/s", "highest speed of the tip",
      [](const RunReport& r) { return Real(r.tip_figures.peak_speed); });
  Add("tip_peak_acceleration_mm_s2", "mm/s2", "highest acceleration of the tip",
      [](const RunReport& r) { return Real(r.tip_figures.peak_acceleration); });
  Add("tip_peak_speed_share", "", "highest speed of the tip by its limit", [](const RunReport& r) {
    return Share(r.tip_figures.peak_speed, r.tip_figures.speed_limit);
  });
  Add("tip_peak_acceleration_share", "", "highest acceleration of the tip by its limit",
      [](const RunReport& r) {
        return Share(r.tip_figures.peak_acceleration, r.tip_figures.acceleration_limit);
      });
  for (const std::string_view axis : {"X", "Y", "Z", "A", "B"}) AddAxis(axis);
}

}  // namespace rmlcell::simulation::facts
