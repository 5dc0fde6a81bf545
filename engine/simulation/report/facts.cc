#include "engine/simulation/report/facts.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <utility>

#include "engine/core/letters.h"
#include "engine/core/number_text.h"
#include "engine/families/families.h"

namespace rmlcell::simulation {
namespace {

using motion::MachineVector;

constexpr std::string_view kNone = "none";
constexpr std::array kCoordinates{"_x", "_y", "_z"};
constexpr int kDecimals = 6;  // lengths to 1e-6 mm, times to 1e-6 s: motion.md 8.2

std::string Real(double value) { return TrimmedText(value, kDecimals); }
std::string Count(std::uint64_t value) { return std::to_string(value); }
std::string Seconds(SimTime time) { return Real(ToSeconds(time)); }
std::string Share(double value, double limit) {
  return limit > 0.0 ? Real(value / limit) : std::string(kNone);
}
std::string Yes(bool value) { return value ? "yes" : "no"; }

// One line, whatever a program was called: a value never breaks the format.
std::string Line(std::string_view text) {
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

class Table {
 public:
  using Get = std::function<std::string(const RunReport&)>;

  Table() {
    AddRun();
    AddTimes();
    AddWork();
    AddBeamTimes();
    AddContours();
    AddCorners();
    AddPositions();
    AddBox("programmed", "", "points as the program wrote them", &ScopeFigures::programmed);
    AddBox("tip", "mm", "tip", &ScopeFigures::tip);
    AddBox("cut", "mm", "tip while it cut", &ScopeFigures::cut);
    AddBox("column", "mm", "column of a gantry, or the tip of a mill", &ScopeFigures::column);
    AddAxes();
    AddFindings();
    AddProducts();
    for (const Row& row : rows_) keys_.push_back({row.key, row.unit, row.text});
  }

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
                std::function<MachineVector(const RunReport&)> point);
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

const Table& TheTable() {
  static const Table table;
  return table;
}

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

void Table::AddRun() {
  Add("family", "", "machine family", [](const RunReport& r) { return Line(r.family); });
  Add("profile", "", "profile of the machine, such as srm-20; none: the family has no profiles",
      [](const RunReport& r) { return Line(r.machine.profile); });
  Add("profile_named", "", "no: nobody named it, and it is the family's own choice",
      [](const RunReport& r) { return Yes(r.machine.named); });
  Add("profile_changes", "", "machine parameters that differ from the profile, NAME=VALUE",
      [](const RunReport& r) {
        std::string text;
        for (const auto& change : r.machine.changes) text += change.name + '=' + change.value + ' ';
        return Line(Trimmed(text));
      });
  Add("profile_changed_by", "", "who changed them: a machine file, options, a machine of a server",
      [](const RunReport& r) { return Line(r.machine.changed_by); });
  Add("title", "", "name of the program", [](const RunReport& r) { return Line(r.title); });
  Add("inputs_hash", "", "fingerprint of everything the run depends on",
      [](const RunReport& r) { return Line(r.inputs_hash); });
  Add("engine_version", "", "version of the engine",
      [](const RunReport& r) { return Line(r.engine_version); });
  Add("changed_parameters", "", "machine parameters that differ from their defaults, NAME=VALUE",
      [](const RunReport& r) {
        std::string text;
        for (const auto& [name, value] : r.changed_parameters) text += name + '=' + value + ' ';
        return Line(Trimmed(text));
      });
  Add("outcome", "", "completed, stopped, failed, cancelled, budget_exceeded or running",
      [](const RunReport& r) {
        return r.finished ? std::string(OutcomeText(r.outcome.kind)) : "running";
      });
  Add("outcome_code", "", "error code that ended the run, such as OPT-E348",
      [](const RunReport& r) {
        return r.outcome.code ? CodeText(*r.outcome.code) : std::string(kNone);
      });
  Add("outcome_detail", "", "what was observed",
      [](const RunReport& r) { return Line(r.outcome.detail); });
  Add("outcome_program", "", "slot of the program where it ended; 0: a program without slot",
      [](const RunReport& r) { return std::to_string(r.outcome.place.program); });
  Add("outcome_step", "", "step where it ended; of a stream the number of the command",
      [](const RunReport& r) { return std::to_string(r.outcome.place.step); });
  Add("outcome_line", "", "line of the text, when known", [](const RunReport& r) {
    return r.outcome.place.line > 0 ? std::to_string(r.outcome.place.line) : std::string(kNone);
  });
  Add("verdict", "", "what the part will come out like: GOOD, DOUBTFUL, BAD or running",
      [](const RunReport& r) {
        return r.finished ? std::string(machine::VerdictText(r.judgement.verdict)) : "running";
      });
  Add("verdict_reasons", "", "how many rules spoke against it (docs/verdict.md)",
      [](const RunReport& r) { return Count(r.judgement.reasons.size()); });
  Add("verdict_codes", "", "their codes, most serious first", [](const RunReport& r) {
    std::string codes;
    for (const machine::Reason& reason : r.judgement.reasons)
      codes += (codes.empty() ? "" : " ") + CodeText(reason.code);
    return Line(codes);
  });
  Add("verdict_because", "", "what the most serious one says", [](const RunReport& r) {
    return r.judgement.reasons.empty() ? std::string(kNone)
                                       : Line(r.judgement.reasons.front().said);
  });
  Add("steps_executed", "", "steps that the machine carried out",
      [](const RunReport& r) { return Count(r.steps_executed); });
  Add("halts", "", "times that the run waited for a person",
      [](const RunReport& r) { return Count(r.halts); });
}

void Table::AddTimes() {
  Add("cycle_time_s", "s", "virtual time from start to end; the sum of the nine times below",
      [](const RunReport& r) { return Seconds(r.cycle_time); });
  Time("motion_time_s", "moving", &TimeParts::motion);
  Time("settling_time_s", "settling after motions", &TimeParts::settling);
  Time("dwell_time_s", "DELAY; W and !DW", &TimeParts::dwell);
  Time("pierce_time_s", "delay of WORK 1", &TimeParts::pierce);
  Time("condition_time_s", "waiting for inputs", &TimeParts::condition);
  Time("operator_time_s", "waiting for a person", &TimeParts::operator_wait);
  Time("spin_up_time_s", "waiting for the spindle", &TimeParts::spin_up);
  Time("load_time_s", "loading CALLed programs", &TimeParts::load);
  Time("standstill_time_s", "none of these", &TimeParts::standstill);
}

void Table::AddWork() {
  Figure("tip_path_mm", "mm", "way of the tip: cut and travel", &WorkFigures::tip_path_mm);
  Figure("cut_length_mm", "mm",
         "with the beam on; of a mill motions below the surface of the work, lifts left out",
         &WorkFigures::cut_mm);
  Figure("travel_length_mm", "mm", "the rest", &WorkFigures::travel_mm);
  Figure("plunge_length_mm", "mm", "plunges, part of the cut length", &WorkFigures::plunge_mm);
  Counter("plunges",
          "times that the tool went down below the surface; steps of one way down are one",
          &WorkFigures::plunges);
  Add("beam_on_s", "s", "time with the beam on",
      [](const RunReport& r) { return Seconds(r.total.beam_on); });
  Counter("beam_switches", "times that the beam went on", &WorkFigures::beam_switches);
  Counter("pierces", "times that the beam went on while standing, and stayed",
          &WorkFigures::pierces);
  Add("shutter_open_s", "s", "time with the shutter open",
      [](const RunReport& r) { return Seconds(r.total.shutter_open); });
  Add("energy_j", "J", "energy of the beam: of cuts and pierces",
      [](const RunReport& r) { return Real(r.total.energy_j()); });
  Figure("cut_energy_j", "J", "energy of motions with the beam on", &WorkFigures::cut_energy_j);
  Figure("pierce_energy_j", "J", "energy of the beam on a standing tip",
         &WorkFigures::pierce_energy_j);
  Add("energy_j_per_mm", "J/mm", "energy of cuts by cut length",
      [](const RunReport& r) { return Real(r.total.energy_j_per_mm()); });
  Add("energy_max_j_per_mm", "J/mm", "the same, of the step where it is highest",
      [](const RunReport& r) { return Real(r.total.energy_j_per_mm_max); });
  Add("feed_not_reached", "", "motions that never reached the feed rate asked for",
      [](const RunReport& r) { return Count(r.shortfall.moves); });
  const auto slow = [this](std::string key, std::string text,
                           std::uint64_t SpeedShortfall::*figure) {
    Add(std::move(key), "", std::move(text),
        [figure](const RunReport& r) { return Count(r.shortfall.*figure); });
  };
  slow("feed_held_by_axis", "of these, held back by an axis", &SpeedShortfall::by_axis);
  slow("feed_held_by_radius", "of these, held back by the radius of an arc",
       &SpeedShortfall::by_radius);
  slow("feed_held_by_length", "of these, shorter than their ramps", &SpeedShortfall::too_short);
  slow("feed_held_by_acceleration", "of these, held back by ACCEL, or by an axis that takes of it",
       &SpeedShortfall::by_acceleration);
}

// Keys by the upper bound of the class in percent, three digits.
void Table::AddBeamTimes() {
  const auto percent = [](int value) {
    std::string digits = std::to_string(value);
    return std::string(3 - std::min<std::size_t>(digits.size(), 3), '0') + digits;
  };
  Add("beam_on_standing_s", "s", "beam on while the tip stands",
      [](const RunReport& r) { return Seconds(r.beam.by_speed[0]); });
  constexpr int kClass_percent = 5;
  for (int k = 1; k < kSpeedBins; ++k) {
    Add("beam_on_speed_" + percent(k * kClass_percent) + "_s", "s",
        "beam on at up to " + std::to_string(k * kClass_percent) +
            " % of the highest tip speed, above the class before",
        [k](const RunReport& r) { return Seconds(r.beam.by_speed[static_cast<std::size_t>(k)]); });
  }
  for (int k = 0; k < kPowerBins; ++k) {
    Add("beam_on_power_" + percent((k + 1) * kClass_percent) + "_s", "s",
        "beam on at a power from " + std::to_string(k * kClass_percent) + " to " +
            std::to_string((k + 1) * kClass_percent) + " %",
        [k](const RunReport& r) { return Seconds(r.beam.by_power[static_cast<std::size_t>(k)]); });
  }
}

// How well the beam cuts, at the worst place: what the rules of docs/verdict.md look at.
void Table::AddContours() {
  Add("contours", "", "connected cuts: from the beam's going on to its going off",
      [](const RunReport& r) { return Count(r.cut_figures.contours); });
  Add("contour_time_max_s", "s", "longest time of the beam on in a contour",
      [](const RunReport& r) { return Seconds(r.cut_figures.longest); });
  Add("contour_energy_max_j", "J", "greatest energy of a contour, its piercing included",
      [](const RunReport& r) { return Real(r.cut_figures.energy_max_j); });
  const auto worst = [this](std::string key, std::string unit, std::string text,
                            Extreme CutFigures::*figure) {
    Add(std::move(key), std::move(unit), std::move(text),
        [figure](const RunReport& r) { return Real((r.cut_figures.*figure).value); });
  };
  worst("slow_contour_max_percent", "%",
        "greatest share of a contour below 0.8 of its SPEED, first and last ramp left out",
        &CutFigures::slow_percent);
  worst("hot_stretch_max_mm", "mm",
        "longest stretch of a contour with more than 1.5 times the energy by length of the process",
        &CutFigures::hot_mm);
  worst("weak_stretch_max_mm", "mm",
        "longest stretch of a contour with less than 0.8 of the energy by length of the process",
        &CutFigures::weak_mm);
  worst("ptp_cut_length_mm", "mm", "way with the beam on at a speed that no SPEED holds",
        &CutFigures::uncontrolled_mm);
  worst("standing_beam_max_s", "s",
        "longest time of the beam on a standing tip, with power, that is no piercing",
        &CutFigures::standing_s);
  Add("singular_swing_max_deg", "deg",
      "most that A turns on end in a contour within 1 degree of B = 0",
      [](const RunReport& r) { return Real(r.cut_figures.singular_rad.value / kRadPerDegree); });
  for (std::size_t i = 0; i < CutFigures{}.near_end.size(); ++i) {
    const std::string axis(1, "xyzab"[i]);
    const std::string unit = i < 3 ? "mm" : "rad";
    Add("near_end_" + axis + '_' + unit, unit,
        std::string("how far a contour goes into the last ") + (i < 3 ? "5 mm" : "degree") +
            " of the travel of " + "XYZAB"[i],
        [i](const RunReport& r) { return Real(r.cut_figures.near_end[i].value); });
  }
}

void Table::AddCorners() {
  const auto count = [this](std::string key, std::string text,
                            std::uint64_t CornerFigures::*figure) {
    Add(std::move(key), "", std::move(text),
        [figure](const RunReport& r) { return Count(r.corners.*figure); });
  };
  count("corners_stopped", "moves that ended in a stop", &CornerFigures::stops);
  count("corners_stopped_with_fly", "moves with /FLY that ended in a stop, without settling",
        &CornerFigures::stops_with_fly);
  count("corners_reversed", "moves with /FLY at a turn of more than 175 degrees: a stop",
        &CornerFigures::reversals);
  count("corners_through", "moves that went straight on, or through the vertex of a polyline",
        &CornerFigures::through);
  count("corners_blended", "corners passed on a curve at the speed asked for",
        &CornerFigures::blended);
  count("corners_capped", "corners passed slower: a short neighbour or an axis",
        &CornerFigures::capped);
  Add("corners_deviation_max_mm", "mm", "largest distance of the path from a target",
      [](const RunReport& r) { return Real(r.corners.deviation_mm_max); });
  Add("corners_deviation_at", "", "program/step of that target", [](const RunReport& r) {
    if (r.corners.deviation_mm_max <= 0.0) return std::string(kNone);
    const machine::Place& place = r.corners.deviation_place;
    return std::to_string(place.program) + '/' + std::to_string(place.step);
  });
  Add("lookahead_starved", "", "knots that the planner decided before it could see enough",
      [](const RunReport& r) { return Count(r.lookahead_starved); });
  const auto of_material = [](auto figure) {
    return [figure](const RunReport& r) {
      return r.milling ? figure(*r.milling) : std::string(kNone);
    };
  };
  Add("removed_volume_mm3", "mm3", "what a mill took off the block that it was given",
      of_material([](const MillingFigures& m) { return Real(m.removed_mm3); }));
  Add("gouges", "", "motions at travel speed through that block",
      of_material([](const MillingFigures& m) { return Count(m.gouges); }));
  Add("gouge_depth_mm", "mm", "depth of the deepest of them",
      of_material([](const MillingFigures& m) { return Real(m.gouge_depth_mm); }));
  Add("below_block_mm", "mm", "how far the tool went below that block",
      of_material([](const MillingFigures& m) { return Real(m.below_mm); }));
  Add("remaining_volume_mm3", "mm3", "what is left of that block",
      of_material([](const MillingFigures& m) { return Real(m.remaining_mm3); }));
  Add("deepest_cut_mm", "mm", "depth of the deepest place below the top of that block",
      of_material([](const MillingFigures& m) { return Real(m.deepest_cut_mm); }));
  Add("deepest_pass_mm", "mm", "most that one motion across took off that block in depth",
      of_material([](const MillingFigures& m) { return Real(m.deepest_pass_mm); }));
  Add("shank_depth_mm", "mm", "how deep shank or holder of the tool went into that block",
      of_material([](const MillingFigures& m) { return Real(m.shank_depth_mm); }));
  Add("beside_block_mm", "mm",
      "way in the work with the tool beside that block by more than its diameter",
      of_material([](const MillingFigures& m) { return Real(m.beside_mm); }));
  const auto of_target = [&](auto figure) {
    return of_material([figure](const MillingFigures& m) {
      return m.target ? Real(figure(*m.target)) : std::string(kNone);
    });
  };
  Add("target_left_mm", "mm", "highest of what stands above the target",
      of_target([](const TargetFigures& t) { return t.left_mm; }));
  Add("target_left_volume_mm3", "mm3", "volume of what stands above the target",
      of_target([](const TargetFigures& t) { return t.left_mm3; }));
  Add("target_deep_mm", "mm", "deepest of what is missing below the target",
      of_target([](const TargetFigures& t) { return t.deep_mm; }));
  Add("target_deep_volume_mm3", "mm3", "volume of what is missing below the target",
      of_target([](const TargetFigures& t) { return t.deep_mm3; }));
  Add("target_good_share", "", "area within the tolerance of the target, by what is compared",
      of_target([](const TargetFigures& t) { return t.good_percent / 100.0; }));
}

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

const MachineVector& VectorOf(const MachineVector& point) { return point; }
const MachineVector& VectorOf(const motion::ProgramPoint& point) { return point.from_origin(); }

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

// Counts findings as often as they occurred.
std::string CountIf(const RunReport& report, bool (*wanted)(Severity)) {
  std::uint64_t count = 0;
  for (const Finding& finding : report.findings) {
    if (wanted(finding.diagnostic.severity)) count += finding.count;
  }
  return Count(count);
}

void Table::AddFindings() {
  Add("errors", "", "errors during the run, as often as they occurred", [](const RunReport& r) {
    return CountIf(r, [](Severity s) { return s != Severity::kWarning && s != Severity::kAdvice; });
  });
  Add("warnings", "", "warnings during the run", [](const RunReport& r) {
    return CountIf(r, [](Severity s) { return s == Severity::kWarning; });
  });
  Add("advice", "", "advice during the run", [](const RunReport& r) {
    return CountIf(r, [](Severity s) { return s == Severity::kAdvice; });
  });
  Add("findings", "", "code@program/step of each finding, in order, xN when it occurred N times",
      [](const RunReport& r) {
        std::string text;
        for (const Finding& finding : r.findings) {
          const Diagnostic& d = finding.diagnostic;
          if (!text.empty()) text += ' ';
          text += CodeText(d.code) + '@' + std::to_string(d.program) + '/' + std::to_string(d.step);
          if (finding.count > 1) text += 'x' + std::to_string(finding.count);
        }
        return Line(text);
      });
  Add("violations", "", "axes of steps that leave their travel; 0: none does",
      [](const RunReport& r) { return Count(r.violations.size() + r.violations_dropped); });
  Add("violation_list", "", "axis@program/step:excess of each, mm or rad, in order",
      [](const RunReport& r) {
        std::string text;
        for (const AxisViolation& v : r.violations) {
          if (!text.empty()) text += ' ';
          text += v.axis + '@' + std::to_string(v.place.program) + '/' +
                  std::to_string(v.place.step) + ':' + Real(v.excess);
        }
        return Line(text);
      });
  Add("findings_dropped", "", "findings at other places, past the thousandth",
      [](const RunReport& r) { return Count(r.findings_dropped); });
}

void Table::AddProducts() {
  Add("trace_records", "", "records of the trace",
      [](const RunReport& r) { return Count(r.trace.records); });
  Add("trace_complete", "", "no: cut off at its budget",
      [](const RunReport& r) { return Yes(r.trace.complete); });
  Add("toolpath_points", "", "points of the toolpath",
      [](const RunReport& r) { return Count(r.toolpath.records); });
  Add("toolpath_bytes", "bytes", "size of the toolpath",
      [](const RunReport& r) { return Count(r.toolpath.bytes); });
  Add("toolpath_complete", "", "no: cut off at its budget",
      [](const RunReport& r) { return Yes(r.toolpath.complete); });
  Add("picture_elements", "", "lines and arcs of the picture",
      [](const RunReport& r) { return Count(r.picture.records); });
  Add("picture_exact", "", "no: drawn coarser, because the program is very long",
      [](const RunReport& r) { return Yes(r.picture.complete); });
}

}  // namespace

std::span<const FactKey> FactKeys() { return TheTable().keys(); }

std::vector<Fact> Facts(const RunReport& report) {
  std::vector<Fact> facts;
  for (const Row& row : TheTable().rows()) facts.push_back({row.key, row.value(report)});
  const auto add = [&](std::string_view figure, std::string value) {
    facts.push_back({report.family + '.' + std::string(figure), std::move(value)});
  };
  // Every figure that the family declares, so that a reader finds the same keys every time.
  std::map<std::string_view, double> left;
  for (const machine::Figure& figure : report.figures) left.emplace(figure.name, figure.value);
  if (const machine::MachineFamily* family = families::FindFamily(report.family)) {
    for (const machine::FigureInfo& info : family->figures()) {
      const auto known = left.find(info.name);
      add(info.name, known != left.end() ? Real(known->second) : std::string(kNone));
      if (known != left.end()) left.erase(known);
    }
  }
  for (const auto& [name, value] : left) add(name, Real(value));
  return facts;
}

std::string FactsText(const RunReport& report) {
  std::string text;
  for (const Fact& fact : Facts(report)) text += fact.key + ": " + fact.value + '\n';
  return text;
}

std::string FactsPage() {
  std::string page =
      "# Facts of a run\n\n"
      "`rmlcell simulate --facts` prints one `key: value` a line. Keys and units stand below and\n"
      "never change meaning; new keys may appear at any place, so look for the key and not for "
      "the\n"
      "line. Numbers have up to six decimals and a point, in every locale; `none` means that "
      "there\n"
      "is nothing to say. Points are in the frame of the machine unless the key says otherwise.\n\n"
      "This page is made from the table in `engine/simulation/report/facts.cc` and the figures of the\n"
      "machine families; a test compares it.\n\n"
      "| key | unit | meaning |\n| --- | --- | --- |\n";
  const auto row = [&page](std::string_view key, std::string_view unit, std::string_view text) {
    page += "| `";
    page += key;
    page += "` | ";
    page += unit;
    page += " | ";
    page += text;
    page += " |\n";
  };
  for (const FactKey& key : FactKeys()) row(key.key, key.unit, key.text);
  for (const machine::MachineFamily* family : families::Families()) {
    if (family->figures().empty()) continue;
    const machine::FamilyInfo& info = family->info();
    page += "\n## ";
    page += info.title;
    page += "\n\n| key | unit | meaning |\n| --- | --- | --- |\n";
    for (const machine::FigureInfo& figure : family->figures()) {
      row(std::string(info.id) + '.' + std::string(figure.name), figure.unit, figure.text);
    }
  }
  return page;
}

}  // namespace rmlcell::simulation
