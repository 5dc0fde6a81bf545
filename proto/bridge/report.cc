#include "proto/bridge/report.h"

#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "proto/bridge/findings.h"
#include "proto/bridge/inputs.h"
#include "rmlcell/v1/job.pb.h"
#include "rmlcell/v1/report.pb.h"

namespace rmlcell::bridge {
namespace {

v1::Point ToProto(const motion::MachinePoint& point) {
  v1::Point message;
  message.set_x(point.x());
  message.set_y(point.y());
  message.set_z(point.z());
  return message;
}

void SetPlace(const machine::Place& place, v1::SourcePlace& message) {
  message = bridge::ToProto(place);
}

v1::Point ToProto(const motion::ProgramPoint& point) { return ToProto(point.from_origin()); }

// The axes that turn of those of a family, "X Y Z A B": their values are a and b.
void AddTurned(std::string_view axes, double a, double b, v1::Unit unit,
               google::protobuf::RepeatedPtrField<v1::AxisValue>& turned) {
  for (const char axis : axes) {
    if (axis != 'A' && axis != 'B') continue;
    v1::AxisValue& value = *turned.Add();
    value.set_axis(std::string(1, axis));
    value.set_value(axis == 'A' ? a : b);
    value.set_unit(unit);
  }
}

// As a program writes them.
void AddProgrammed(const machine::FamilyInfo& family, double a, double b,
                   google::protobuf::RepeatedPtrField<v1::AxisValue>& turned) {
  AddTurned(family.axes, a, b, family.turns_in_degrees ? v1::UNIT_DEGREE : v1::UNIT_RADIAN, turned);
}

v1::Position PositionOf(const machine::FamilyInfo& family, const motion::TipPose& tip,
                        const motion::AxisPose& axes) {
  v1::Position message;
  *message.mutable_tip() = ToProto(tip.tip);
  *message.mutable_column() = ToProto(axes.column);
  AddTurned(family.axes, axes.a_rad, axes.b_rad, v1::UNIT_RADIAN, *message.mutable_turned());
  return message;
}

template <class Message, class Point>
void SetBox(const machine::BoxOf<Point>& box, v1::Box* (Message::*mutable_box)(), Message& report) {
  if (box.empty()) return;
  v1::Box& message = *(report.*mutable_box)();
  *message.mutable_low() = ToProto(box.min);
  *message.mutable_high() = ToProto(box.max);
}

v1::WorkFigures ToProto(const simulation::WorkFigures& figures) {
  v1::WorkFigures message;
  message.set_steps(static_cast<std::int64_t>(figures.steps));
  v1::RunTimes& times = *message.mutable_times();
  times.set_cycle_s(ToSeconds(figures.time.total()));
  times.set_motion_s(ToSeconds(figures.time.motion));
  times.set_settling_s(ToSeconds(figures.time.settling));
  times.set_dwell_s(ToSeconds(figures.time.dwell));
  times.set_pierce_s(ToSeconds(figures.time.pierce));
  times.set_condition_s(ToSeconds(figures.time.condition));
  times.set_operator_s(ToSeconds(figures.time.operator_wait));
  times.set_spin_up_s(ToSeconds(figures.time.spin_up));
  times.set_load_s(ToSeconds(figures.time.load));
  times.set_standstill_s(ToSeconds(figures.time.standstill));
  message.set_path_length_mm(figures.tip_path_mm);
  message.set_cut_length_mm(figures.cut_mm);
  message.set_travel_length_mm(figures.travel_mm);
  message.set_plunge_length_mm(figures.plunge_mm);
  message.set_beam_on_s(ToSeconds(figures.beam_on));
  message.set_beam_switches(static_cast<std::int64_t>(figures.beam_switches));
  message.set_pierces(static_cast<std::int64_t>(figures.pierces));
  message.set_plunges(static_cast<std::int64_t>(figures.plunges));
  message.set_energy_j(figures.energy_j());
  message.set_energy_j_per_mm(figures.energy_j_per_mm());
  message.set_energy_j_per_mm_max(figures.energy_j_per_mm_max);
  message.set_shutter_open_s(ToSeconds(figures.shutter_open));
  return message;
}

double ShareOf(double value, double limit) { return limit > 0.0 ? value / limit : 0.0; }

v1::AxisFigures ToProto(const simulation::AxisFigures& axis) {
  v1::AxisFigures message;
  message.set_axis(axis.name);
  message.set_rotary(axis.rotary);
  message.set_travel(axis.travel);
  message.set_minimum(axis.minimum);
  message.set_maximum(axis.maximum);
  message.set_peak_speed(axis.peak_speed);
  message.set_speed_limit(axis.speed_limit);
  message.set_peak_acceleration(axis.peak_acceleration);
  message.set_acceleration_limit(axis.acceleration_limit);
  message.set_reversals(static_cast<std::int64_t>(axis.reversals));
  message.set_peak_speed_share(ShareOf(axis.peak_speed, axis.speed_limit));
  message.set_peak_acceleration_share(ShareOf(axis.peak_acceleration, axis.acceleration_limit));
  message.set_peak_jerk(axis.peak_jerk);
  message.set_jerk_limit(axis.jerk_limit);
  return message;
}

v1::CornerFigures ToProto(const simulation::CornerFigures& corners) {
  v1::CornerFigures message;
  message.set_stopped(static_cast<std::int64_t>(corners.stops));
  message.set_stopped_with_fly(static_cast<std::int64_t>(corners.stops_with_fly));
  message.set_reversed(static_cast<std::int64_t>(corners.reversals));
  message.set_through(static_cast<std::int64_t>(corners.through));
  message.set_blended(static_cast<std::int64_t>(corners.blended));
  message.set_capped(static_cast<std::int64_t>(corners.capped));
  if (corners.deviation_mm_max > 0.0) {
    message.set_deviation_mm_max(corners.deviation_mm_max);
    SetPlace(corners.deviation_place, *message.mutable_deviation_place());
    *message.mutable_deviation_point() = ToProto(corners.deviation_point);
  }
  return message;
}

v1::SpeedShortfall ToProto(const simulation::SpeedShortfall& shortfall) {
  v1::SpeedShortfall message;
  message.set_moves(static_cast<std::int64_t>(shortfall.moves));
  message.set_by_axis(static_cast<std::int64_t>(shortfall.by_axis));
  message.set_by_radius(static_cast<std::int64_t>(shortfall.by_radius));
  message.set_too_short(static_cast<std::int64_t>(shortfall.too_short));
  message.set_by_acceleration(static_cast<std::int64_t>(shortfall.by_acceleration));
  SetPlace(shortfall.worst, *message.mutable_worst());
  message.set_wanted_mm_s(shortfall.wanted_mm_s);
  message.set_reached_mm_s(shortfall.reached_mm_s);
  return message;
}

v1::SlowMove::Cause CauseOf(simulation::SlowCause cause) {
  switch (cause) {
    case simulation::SlowCause::kAxis:
      return v1::SlowMove::CAUSE_AXIS;
    case simulation::SlowCause::kRadius:
      return v1::SlowMove::CAUSE_RADIUS;
    case simulation::SlowCause::kShort:
      return v1::SlowMove::CAUSE_SHORT;
    case simulation::SlowCause::kAcceleration:
      return v1::SlowMove::CAUSE_ACCELERATION;
  }
  return v1::SlowMove::CAUSE_UNSPECIFIED;
}

v1::SlowMove ToProto(const simulation::SlowMove& move) {
  v1::SlowMove message;
  SetPlace(move.place, *message.mutable_place());
  message.set_cause(CauseOf(move.cause));
  message.set_axis(move.axis);
  message.set_wanted_mm_s(move.wanted_mm_s);
  message.set_allowed_mm_s(move.allowed_mm_s);
  message.set_reached_mm_s(move.reached_mm_s);
  message.set_count(static_cast<std::int64_t>(move.count));
  return message;
}

// What the report has of the whole run and of each program alike.
template <class Message>
void SetScope(const simulation::ScopeFigures& scope, Message& message) {
  *message.mutable_corners() = ToProto(scope.corners);
  if (scope.shortfall.moves > 0) *message.mutable_shortfall() = ToProto(scope.shortfall);
  if (scope.total.beam_on > SimTime::zero()) {
    v1::BeamHistogram& beam = *message.mutable_beam();
    for (const SimTime time : scope.beam.by_speed) beam.add_by_speed_s(ToSeconds(time));
    for (const SimTime time : scope.beam.by_power) beam.add_by_power_s(ToSeconds(time));
  }
  SetBox(scope.programmed, &Message::mutable_program_box, message);
  SetBox(scope.tip, &Message::mutable_tip_box, message);
  SetBox(scope.cut, &Message::mutable_cut_box, message);
  SetBox(scope.column, &Message::mutable_column_box, message);
  *message.add_axes() = ToProto(scope.tip_figures);
  for (const simulation::AxisFigures& axis : scope.axes) *message.add_axes() = ToProto(axis);
}

v1::Contour ToProto(const simulation::Contour& contour) {
  v1::Contour message;
  SetPlace(contour.place, *message.mutable_place());
  message.set_begin_s(ToSeconds(contour.begin));
  message.set_time_s(ToSeconds(contour.time));
  message.set_length_mm(contour.length_mm);
  message.set_slow_length_mm(contour.slow_mm);
  message.set_energy_j(contour.energy_j());
  message.set_pierce_energy_j(contour.pierce_energy_j);
  return message;
}

v1::CutFigures ToProto(const simulation::CutFigures& cut) {
  v1::CutFigures message;
  message.set_contours(static_cast<std::int64_t>(cut.contours));
  message.set_time_s_max(ToSeconds(cut.longest));
  message.set_energy_j_max(cut.energy_max_j);
  const auto set = [&message](const simulation::Extreme& extreme,
                              v1::CutExtreme* (v1::CutFigures::*field)()) {
    if (!(extreme.value > 0.0)) return;
    v1::CutExtreme& made = *(message.*field)();
    made.set_value(extreme.value);
    SetPlace(extreme.place, *made.mutable_place());
  };
  set(cut.slow_percent, &v1::CutFigures::mutable_slow_percent);
  set(cut.hot_mm, &v1::CutFigures::mutable_hot_stretch_mm);
  set(cut.weak_mm, &v1::CutFigures::mutable_weak_stretch_mm);
  set(cut.uncontrolled_mm, &v1::CutFigures::mutable_ptp_mm);
  set(cut.standing_s, &v1::CutFigures::mutable_standing_s);
  set(cut.singular_rad, &v1::CutFigures::mutable_singular_rad);
  for (std::size_t i = 0; i < cut.near_end.size(); ++i) {
    const simulation::Extreme& extreme = cut.near_end[i];
    if (!(extreme.value > 0.0)) continue;
    v1::NearEnd& end = *message.add_near_ends();
    end.set_axis(std::string(1, "XYZAB"[i]));
    end.set_rotary(i >= 3);
    end.set_depth(extreme.value);
    SetPlace(extreme.place, *end.mutable_place());
  }
  return message;
}

void SetContours(const simulation::RunReport& report, v1::RunReport& message) {
  for (const simulation::Contour& contour : report.contours)
    *message.add_contours() = ToProto(contour);
  message.set_contours_dropped(static_cast<std::int64_t>(report.contours_dropped));
  if (report.cut_figures.contours > 0) *message.mutable_cut() = ToProto(report.cut_figures);
}

v1::AxisViolation ToProto(const machine::FamilyInfo& family,
                          const simulation::AxisViolation& violation) {
  v1::AxisViolation message;
  SetPlace(violation.place, *message.mutable_place());
  message.set_axis(violation.axis);
  message.set_rotary(violation.rotary);
  message.set_excess(violation.excess);
  message.set_at_target(violation.at_target);
  *message.mutable_position() = PositionOf(
      family, {.tip = violation.tip, .a_rad = violation.axes.a_rad, .b_rad = violation.axes.b_rad},
      violation.axes);
  message.set_time_s(ToSeconds(violation.first_at));
  message.set_count(static_cast<std::int64_t>(violation.count));
  return message;
}

v1::TraceRecord::Kind KindOf(simulation::TraceKind kind) {
  using simulation::TraceKind;
  switch (kind) {
    case TraceKind::kMove:
      return v1::TraceRecord::KIND_MOVE;
    case TraceKind::kSignal:
      return v1::TraceRecord::KIND_SIGNAL;
    case TraceKind::kWait:
      return v1::TraceRecord::KIND_WAIT;
    case TraceKind::kHalt:
      return v1::TraceRecord::KIND_HALT;
    case TraceKind::kResume:
      return v1::TraceRecord::KIND_RESUME;
    case TraceKind::kProgram:
      return v1::TraceRecord::KIND_PROGRAM;
    case TraceKind::kMessage:
      return v1::TraceRecord::KIND_MESSAGE;
    case TraceKind::kFinding:
      return v1::TraceRecord::KIND_FINDING;
    case TraceKind::kEnd:
      return v1::TraceRecord::KIND_END;
  }
  return v1::TraceRecord::KIND_UNSPECIFIED;
}

v1::ProductState ToProto(const simulation::ProductState& product) {
  v1::ProductState message;
  message.set_made(product.made);
  message.set_complete(product.complete);
  message.set_records(static_cast<std::int64_t>(product.records));
  message.set_dropped(static_cast<std::int64_t>(product.dropped));
  return message;
}

v1::TargetFigures ToProto(const simulation::TargetFigures& target) {
  v1::TargetFigures message;
  message.set_tolerance_mm(target.tolerance_mm);
  message.set_left_mm(target.left_mm);
  message.set_left_x_mm(target.left_at.x_mm);
  message.set_left_y_mm(target.left_at.y_mm);
  message.set_left_mm3(target.left_mm3);
  message.set_deep_mm(target.deep_mm);
  message.set_deep_x_mm(target.deep_at.x_mm);
  message.set_deep_y_mm(target.deep_at.y_mm);
  message.set_deep_mm3(target.deep_mm3);
  message.set_good_percent(target.good_percent);
  message.set_compared_mm2(target.compared_mm2);
  return message;
}

v1::MillingFigures ToProto(const simulation::MillingFigures& milling) {
  v1::MillingFigures figures;
  figures.set_removed_mm3(milling.removed_mm3);
  figures.set_gouges(static_cast<std::int64_t>(milling.gouges));
  figures.set_gouge_depth_mm(milling.gouge_depth_mm);
  if (milling.gouges > 0) SetPlace(milling.gouge_place, *figures.mutable_gouge_place());
  figures.set_gouge_time_s(ToSeconds(milling.gouge_at));
  figures.set_below_mm(milling.below_mm);
  if (milling.below_mm > 0.0) SetPlace(milling.below_place, *figures.mutable_below_place());
  figures.set_remaining_mm3(milling.remaining_mm3);
  figures.set_deepest_cut_mm(milling.deepest_cut_mm);
  figures.set_tool_diameter_mm(milling.tool_diameter_mm);
  figures.set_deepest_pass_mm(milling.deepest_pass_mm);
  if (milling.deepest_pass_mm > 0.0) SetPlace(milling.pass_place, *figures.mutable_pass_place());
  figures.set_shank_depth_mm(milling.shank_depth_mm);
  if (milling.shank_depth_mm > 0.0) SetPlace(milling.shank_place, *figures.mutable_shank_place());
  if (milling.target) *figures.mutable_target() = ToProto(*milling.target);
  return figures;
}

}  // namespace

v1::RunReport ToProto(const machine::FamilyInfo& family, const simulation::RunReport& report,
                      std::span<const machine::NamedVariable> variables) {
  v1::RunReport message;
  message.set_family(report.family);
  SetMachine(report.machine, message);
  message.set_title(report.title);
  *message.mutable_outcome() = ToProto(report.outcome, report.judgement);
  *message.mutable_total() = ToProto(report.total);
  *message.mutable_final_position() =
      PositionOf(family, report.final_position.tip, report.final_position.axes);
  if (report.work_origin) *message.mutable_work_origin() = ToProto(*report.work_origin);
  *message.mutable_final_program_point() = ToProto(report.final_position.program_point);
  AddProgrammed(family, report.final_position.program_a, report.final_position.program_b,
                *message.mutable_final_program_axes());
  message.set_shutter_open_s(ToSeconds(report.total.shutter_open));
  message.set_energy_j_per_mm_max(report.total.energy_j_per_mm_max);
  message.set_halts(static_cast<std::int64_t>(report.halts));
  SetScope(report, message);
  for (const auto& [slot, figures] : report.programs) {
    v1::ProgramFigures& program = *message.add_programs();
    program.set_program(slot);
    *program.mutable_figures() = ToProto(figures.total);
    SetScope(figures, program);
  }
  for (const simulation::StepFigures& step : report.steps) {
    v1::StepFigures& made = *message.add_steps();
    made.set_program(step.program);
    made.set_step(step.step);
    made.set_line(step.line);
    *made.mutable_figures() = ToProto(step.figures);
  }
  if (report.rest.steps > 0) *message.mutable_other_steps() = ToProto(report.rest);
  for (const simulation::Finding& finding : report.findings) {
    v1::Diagnostic& diagnostic = *message.add_diagnostics();
    diagnostic = ToProto(finding.diagnostic);
    diagnostic.set_count(static_cast<std::int64_t>(finding.count));
  }
  SetUntold(report.findings_dropped, message);
  for (const simulation::SlowMove& move : report.slow_moves)
    *message.add_slow_moves() = ToProto(move);
  message.set_slow_moves_dropped(static_cast<std::int64_t>(report.slow_moves_dropped));
  message.set_lookahead_starved(static_cast<std::int64_t>(report.lookahead_starved));
  message.set_collisions("not modelled");
  if (report.milling) *message.mutable_milling() = ToProto(*report.milling);
  SetContours(report, message);
  for (const simulation::AxisViolation& violation : report.violations) {
    *message.add_violations() = ToProto(family, violation);
  }
  message.set_violations_dropped(static_cast<std::int64_t>(report.violations_dropped));
  for (const machine::Figure& figure : report.figures) *message.add_figures() = ToProto(figure);
  for (const machine::NamedVariable& variable : variables)
    *message.add_variables() = ToProto(variable);
  for (const auto& [name, value] : report.changed_parameters)
    (*message.mutable_parameters())[name] = value;
  message.set_inputs_hash(report.inputs_hash);
  message.set_engine_version(report.engine_version);
  *message.mutable_trace() = ToProto(report.trace);
  *message.mutable_toolpath() = ToProto(report.toolpath);
  *message.mutable_picture() = ToProto(report.picture);
  return message;
}

void AddFindingsOfText(const std::vector<Diagnostic>& findings, const UntoldFindings& untold,
                       v1::RunReport& report) {
  const auto place_of = [](const v1::Diagnostic& finding) {
    const v1::SourcePlace& place = finding.place();
    return std::tuple(finding.code(), place.line(), place.column());
  };
  std::set<std::tuple<std::string, int, int>> found;
  for (const v1::Diagnostic& finding : report.diagnostics()) {
    if (finding.place().line() > 0) found.insert(place_of(finding));
  }
  for (const Diagnostic& finding : findings) {
    v1::Diagnostic message = ToProto(finding);
    if (!found.contains(place_of(message))) *report.add_diagnostics() = std::move(message);
  }
  std::set<std::string> counted;  // what the run makes of the text, too, it counts itself
  for (const v1::GatheredFindings& kind : report.gathered()) counted.insert(kind.code());
  for (const auto& [code, kind] : untold.kinds()) {
    if (counted.contains(CodeText(code))) continue;
    *report.add_gathered() = ToProto(kind);
    report.set_diagnostics_dropped(report.diagnostics_dropped() +
                                   static_cast<std::int64_t>(kind.count));
  }
}

v1::TraceRecord ToProto(const machine::FamilyInfo& family, const simulation::TraceRecord& record) {
  using simulation::TraceKind;
  v1::TraceRecord message;
  message.set_number(static_cast<std::int64_t>(record.number));
  message.set_kind(KindOf(record.kind));
  message.set_virtual_time_ns(record.at.count());
  SetPlace(record.place, *message.mutable_place());
  switch (record.kind) {
    case TraceKind::kMove:
      message.set_text(std::string(record.text));
      *message.mutable_point() = ToProto(record.program_point);
      AddProgrammed(family, record.program_a, record.program_b, *message.mutable_program_axes());
      *message.mutable_position() = PositionOf(family, record.tip, record.axes);
      message.set_feed_mm_s(record.feed_mm_s);
      break;
    case TraceKind::kSignal:
      message.set_text(std::string(simulation::SignalName(record.signal)));
      message.set_index(record.index);
      message.set_value(record.value);
      message.set_detail(record.detail);
      break;
    case TraceKind::kWait:
      message.set_text(std::string(simulation::WaitKindName(record.wait)));
      message.set_duration_ns(record.duration.count());
      break;
    case TraceKind::kProgram:
      message.set_text(std::string(record.text));
      message.set_index(record.index);
      break;
    case TraceKind::kFinding:
    case TraceKind::kEnd: {
      Diagnostic finding{.code = record.code.value_or(ErrorCode::kCellInternal),
                         .severity = record.severity,
                         .detail = std::string(record.text)};
      const v1::Diagnostic made = ToProto(finding);
      message.set_text(record.kind == TraceKind::kEnd
                           ? std::string(simulation::OutcomeText(record.outcome))
                           : made.message());
      if (record.code) message.set_code(made.code());
      if (record.kind == TraceKind::kFinding) message.set_severity(made.severity());
      break;
    }
    default:
      message.set_text(std::string(record.text));
  }
  return message;
}

v1::JobProgress ToProto(const machine::FamilyInfo& family, const machine::RunState& state,
                        std::uint64_t steps) {
  v1::JobProgress message;
  message.set_virtual_time_ns(state.time.count());
  message.set_steps(static_cast<std::int64_t>(steps));
  SetPlace(state.place, *message.mutable_place());
  message.set_instruction(std::string(state.instruction));
  *message.mutable_position() = PositionOf(family, state.tip, state.axes);
  if (state.work_origin) *message.mutable_work_tip() = ToProto(state.tip.tip - *state.work_origin);
  message.set_speed_mm_s(state.tip_speed_mm_s);
  message.set_override_percent(state.override_percent);
  message.set_tool_on(state.beam_on || state.spindle_on);
  message.set_held(state.phase == machine::RunPhase::kHalted);
  if (state.progress >= 0.0) message.set_progress(state.progress);
  return message;
}

}  // namespace rmlcell::bridge
