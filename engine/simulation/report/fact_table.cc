#include "engine/simulation/report/fact_table.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "engine/core/letters.h"
#include "engine/families/families.h"

namespace rmlcell::simulation::facts {

Table::Table() {
  AddRun();
  AddTimes();
  AddWork();
  AddBeamTimes();
  AddContours();
  AddCorners();
  AddPositions();
  AddBoxes();
  AddAxes();
  AddFindings();
  AddProducts();
  for (const Row& row : rows_) keys_.push_back({row.key, row.unit, row.text});
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
  Add("machine_name", "",
      "name of a machine of one's own that is based on the profile; none: there is none",
      [](const RunReport& r) { return Line(r.machine.own_name); });
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
  worst(
      "slow_contour_max_percent", "%",
      "greatest share of a contour below 0.8 of its SPEED, first and last ramp left out where it comes to it",
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

namespace {

// Counts findings as often as they occurred.
std::string CountIf(const RunReport& report, bool (*wanted)(Severity)) {
  std::uint64_t count = 0;
  for (const Finding& finding : report.findings) {
    if (wanted(finding.diagnostic.severity)) count += finding.count;
  }
  return Count(count);
}

}  // namespace

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
      [](const RunReport& r) { return Count(r.findings_dropped.count()); });
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

}  // namespace rmlcell::simulation::facts
