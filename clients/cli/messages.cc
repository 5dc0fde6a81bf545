#include "clients/cli/messages.h"

#include <algorithm>
#include <ctime>
#include <functional>
#include <tuple>

#include "clients/cli/findings_text.h"
#include "clients/cli/machine_log.h"
#include "clients/cli/terminal.h"
#include "clients/cli/verdict_text.h"
#include "engine/core/diagnostic.h"
#include "engine/core/letters.h"
#include "engine/families/families.h"
#include "engine/machine/shape.h"
#include "proto/bridge/encoding.h"
#include "proto/bridge/findings.h"
#include "rmlcell/v1/program.pb.h"

namespace rmlcell::cli {
namespace {

std::string PointText(const v1::Point& point) {
  return Fixed(point.x(), 3) + ", " + Fixed(point.y(), 3) + ", " + Fixed(point.z(), 3);
}

}  // namespace

std::string Json(const google::protobuf::Message& message) {
  return bridge::StableJson(message).value_or("{}");
}

void PrintJson(const google::protobuf::Message& message) {
  // What is not known here can only be the detail of an error, and such a message is short.
  if (!bridge::WriteStableJson(message, false, PrintRaw)) PrintRaw("{}");
  PrintRaw("\n");
}

std::string StateName(const v1::Job& job) {
  // No part, and nothing that went wrong: the page says the same.
  if (job.outcome().kind() == v1::Outcome::KIND_STOPPED) return "stopped";
  return StateName(job.state());
}

std::string StateName(v1::Job::State state) {
  std::string name = v1::Job::State_Name(state);
  if (name.starts_with("STATE_")) name.erase(0, 6);
  return LowerCase(name);
}

std::string AxisText(const v1::AxisValue& axis) {
  const bool turns = axis.unit() == v1::UNIT_RADIAN;
  return axis.axis() + " " + Fixed(axis.value(), turns ? 4 : 3) + (turns ? " rad" : " mm");
}

std::string When(const google::protobuf::Timestamp& time) {
  const std::time_t seconds = time.seconds();
  std::tm parts{};
  localtime_r(&seconds, &parts);
  char room[32];
  const std::size_t size = std::strftime(room, sizeof room, "%F %T", &parts);
  return {room, size};
}

std::string OutcomeLine(const v1::Outcome& outcome) {
  const bool colour = ColourOnOutput();
  std::string text;
  switch (outcome.kind()) {
    case v1::Outcome::KIND_COMPLETED:
      text = outcome.verdict() == v1::VERDICT_BAD ? "completed"
                                                  : Paint("completed", Colour::kGreen, colour);
      break;
    case v1::Outcome::KIND_STOPPED:
      text = Paint("stopped", Colour::kYellow, colour);
      break;
    case v1::Outcome::KIND_FAILED:
      text = Paint("failed", Colour::kRed, colour);
      break;
    case v1::Outcome::KIND_CANCELLED:
      text = Paint("cancelled", Colour::kYellow, colour);
      break;
    case v1::Outcome::KIND_BUDGET_EXCEEDED:
      text = Paint("budget exceeded", Colour::kRed, colour);
      break;
    case v1::Outcome::KIND_INTERRUPTED:
      text = Paint("interrupted", Colour::kRed, colour);
      break;
    default:
      text = "not ended";
  }
  if (!outcome.code().empty()) text += ", " + outcome.code();
  if (!outcome.message().empty()) text += ": " + Visible(outcome.message());
  const std::string place = PlaceText(outcome.place());
  if (!place.empty() && outcome.kind() != v1::Outcome::KIND_COMPLETED) text += " (" + place + ")";
  if (!outcome.advice().empty()) text += "; " + outcome.advice();
  return text;
}

namespace {

using Rows = std::vector<std::pair<std::string, std::string>>;

// Figures that follow each other with one name of a row share it. `value`: nothing for what there
// is none of.
template <class Value>
void AddFigureRows(const machine::MachineFamily& family, machine::FigureInfo::Where where,
                   Value value, Rows& rows) {
  std::string_view row;
  for (const machine::FigureInfo& info : family.figures()) {
    using enum machine::FigureInfo::Where;
    const bool in_both = info.where == kBoth && where != kCheckMachine;
    if (info.row.empty() || (info.where != where && !in_both)) continue;
    const std::optional<double> amount = value(info.name);
    if (!amount || (*amount == 0.0 && !info.when_zero)) continue;
    std::string said(info.said);
    said.replace(said.find('#'), 1, Fixed(*amount, info.unit.empty() ? 0 : 3));
    if (info.row == row) {
      rows.back().second += ", " + said;
    } else {
      rows.emplace_back(info.row, std::move(said));
      row = info.row;
    }
  }
}

std::string TextOf(const Rows& rows) {
  std::string text;
  for (const auto& [name, value] : rows) {
    text += Paint(name + std::string(14 - std::min<std::size_t>(13, name.size()), ' '),
                  Colour::kDim, ColourOnOutput()) +
            value + "\n";
  }
  return text;
}

constexpr int kListedMax = 5;  // of a list that the report has in full as JSON

std::string Percent(double share) { return Fixed(share * 100.0, 0) + " %"; }

void AddCorners(const v1::RunReport& report, Rows& rows) {
  const v1::CornerFigures& corners = report.corners();
  std::string text;
  const auto count = [&](std::int64_t number, const char* what) {
    if (number > 0) text += (text.empty() ? "" : ", ") + std::to_string(number) + " " + what;
  };
  count(corners.stopped(), "stops");
  count(corners.stopped_with_fly(), "stops with /FLY");
  count(corners.reversed(), "reversals with /FLY");
  count(corners.through(), "straight on");
  count(corners.blended(), "blended");
  count(corners.capped(), "blended slower");
  if (!text.empty()) rows.emplace_back("corners", text);
  if (corners.deviation_mm_max() > 0.0) {
    rows.emplace_back("", "deviation up to " + Fixed(corners.deviation_mm_max(), 3) + " mm at " +
                              PlaceText(corners.deviation_place()) + ", " +
                              PointText(corners.deviation_point()));
  }
  if (report.lookahead_starved() > 0) {
    rows.emplace_back(
        "", "look-ahead was too short " + std::to_string(report.lookahead_starved()) + " times");
  }
}

void AddSlowMoves(const v1::RunReport& report, Rows& rows) {
  const v1::SpeedShortfall& shortfall = report.shortfall();
  if (shortfall.moves() == 0) return;
  std::string causes;
  const auto cause = [&](std::int64_t number, const char* what) {
    if (number > 0)
      causes += (causes.empty() ? "" : ", ") + std::string(what) + " " + std::to_string(number);
  };
  cause(shortfall.by_axis(), "axis");
  cause(shortfall.by_radius(), "radius");
  cause(shortfall.too_short(), "too short");
  cause(shortfall.by_acceleration(), "acceleration");
  rows.emplace_back("too slow",
                    std::to_string(shortfall.moves()) + " moves below their SPEED: " + causes);
  int listed = 0;
  for (const v1::SlowMove& move : report.slow_moves()) {
    if (++listed > kListedMax) break;
    rows.emplace_back(
        "", PlaceText(move.place()) + ": " + Fixed(move.reached_mm_s(), 3) + " of " +
                Fixed(move.wanted_mm_s(), 3) + " mm/s, " +
                LowerCase(v1::SlowMove::Cause_Name(move.cause()).substr(6)) +
                (move.axis().empty() ? "" : " " + move.axis()) +
                (move.count() > 1 ? " (" + std::to_string(move.count()) + " times)" : ""));
  }
  const std::int64_t more = report.slow_moves_size() + report.slow_moves_dropped() - kListedMax;
  if (more > 0) rows.emplace_back("", "and " + std::to_string(more) + " more steps");
}

void AddPeaks(const v1::RunReport& report, Rows& rows) {
  std::string speeds;
  std::string accelerations;
  for (const v1::AxisFigures& axis : report.axes()) {
    if (axis.peak_speed() <= 0.0) continue;
    const auto add = [&](std::string& to, double value, double share) {
      to += (to.empty() ? "" : ", ") + axis.axis() + " " + Fixed(value, axis.rotary() ? 3 : 1);
      if (share > 0.0) to += " (" + Percent(share) + ")";
    };
    add(speeds, axis.peak_speed(), axis.peak_speed_share());
    add(accelerations, axis.peak_acceleration(), axis.peak_acceleration_share());
  }
  if (speeds.empty()) return;
  rows.emplace_back("peak speed", speeds);
  rows.emplace_back("peak accel.", accelerations);
}

// Those that take longest. The beam's row has their sum.
void AddContours(const v1::RunReport& report, Rows& rows) {
  if (report.contours().empty()) return;
  std::vector<const v1::Contour*> longest;
  for (const v1::Contour& contour : report.contours()) longest.push_back(&contour);
  std::ranges::stable_sort(longest, std::ranges::greater(), &v1::Contour::time_s);
  const std::int64_t all = report.contours_size() + report.contours_dropped();
  rows.emplace_back("contours", std::to_string(all) + (all > kListedMax ? ", the longest:" : ""));
  longest.resize(std::min<std::size_t>(longest.size(), kListedMax));
  for (const v1::Contour* contour : longest) {
    std::string text = PlaceText(contour->place()) + ": " + Fixed(contour->time_s(), 3) + " s, " +
                       Fixed(contour->length_mm(), 3) + " mm, " + Fixed(contour->energy_j(), 0) +
                       " J";
    if (contour->pierce_energy_j() > 0.0)
      text += ", " + Fixed(contour->pierce_energy_j(), 0) + " of them while it stands";
    if (contour->slow_length_mm() > 0.0)
      text += ", " + Fixed(contour->slow_length_mm(), 3) + " mm slow";
    rows.emplace_back("", std::move(text));
  }
}

void AddViolations(const v1::RunReport& report, Rows& rows) {
  const auto& violations = report.violations();
  if (violations.empty()) return;
  const std::int64_t all = violations.size() + report.violations_dropped();
  rows.emplace_back("travel", std::to_string(all) + (all == 1 ? " violation" : " violations"));
  int listed = 0;
  for (const v1::AxisViolation& violation : violations) {
    if (++listed > kListedMax) break;
    rows.emplace_back("", PlaceText(violation.place()) + ": " + violation.axis() + " by " +
                              Fixed(violation.excess(), 3) + (violation.rotary() ? " rad" : " mm") +
                              (violation.at_target() ? " at the target" : " on the way") + ", at " +
                              Fixed(violation.time_s(), 3) + " s");
  }
  if (all > kListedMax) rows.emplace_back("", "and " + std::to_string(all - kListedMax) + " more");
}

void AddTarget(const v1::TargetFigures& target, Rows& rows) {
  rows.emplace_back("target", Fixed(target.good_percent(), 2) + " % of " +
                                  Fixed(target.compared_mm2(), 1) + " mm2 within " +
                                  Fixed(target.tolerance_mm(), 3) + " mm");
  const auto tell = [&](const char* what, double most_mm, double volume_mm3, double x, double y) {
    if (!(most_mm > 0.0)) return;
    rows.emplace_back("", what + Fixed(most_mm, 3) + " mm at X " + Fixed(x, 3) + ", Y " +
                              Fixed(y, 3) + "; " + Fixed(volume_mm3, 3) + " mm3 in all");
  };
  tell("too deep by up to ", target.deep_mm(), target.deep_mm3(), target.deep_x_mm(),
       target.deep_y_mm());
  tell("too much left, up to ", target.left_mm(), target.left_mm3(), target.left_x_mm(),
       target.left_y_mm());
}

void AddMilling(const v1::RunReport& report, Rows& rows) {
  if (!report.has_milling()) return;
  const v1::MillingFigures& milling = report.milling();
  rows.emplace_back("material", Fixed(milling.removed_mm3(), 3) + " mm3 removed");
  if (milling.remaining_mm3() > 0.0) {
    rows.emplace_back("", Fixed(milling.remaining_mm3(), 3) + " mm3 left, the deepest cut " +
                              Fixed(milling.deepest_cut_mm(), 3) + " mm below the top");
  }
  if (milling.has_pass_place()) {
    rows.emplace_back("", "deepest pass " + Fixed(milling.deepest_pass_mm(), 3) + " mm at " +
                              PlaceText(milling.pass_place()));
  }
  if (milling.has_shank_place()) {
    rows.emplace_back("", "shank or holder " + Fixed(milling.shank_depth_mm(), 3) +
                              " mm in material at " + PlaceText(milling.shank_place()));
  }
  if (milling.gouges() > 0) {
    rows.emplace_back("", std::to_string(milling.gouges()) +
                              " motions at travel speed through material, up to " +
                              Fixed(milling.gouge_depth_mm(), 3) + " mm deep at " +
                              PlaceText(milling.gouge_place()) + ", at " +
                              Fixed(milling.gouge_time_s(), 3) + " s");
  }
  if (milling.has_target()) AddTarget(milling.target(), rows);
}

std::optional<double> FigureOf(const v1::RunReport& report, std::string_view name) {
  for (const v1::Figure& figure : report.figures()) {
    if (figure.name() == name) return figure.value();
  }
  return std::nullopt;
}

// What the family wants to be read of its own figures.
void AddFamilyFigures(const v1::RunReport& report, const machine::MachineFamily& family,
                      Rows& rows) {
  AddFigureRows(
      family, machine::FigureInfo::Where::kReport,
      [&](std::string_view name) { return FigureOf(report, name); }, rows);
}

// Which machine it is, and what of it is not as its profile has it.
template <class Message>
void AddMachine(const machine::MachineFamily& family, const Message& message, Rows& rows) {
  rows.emplace_back(
      "machine", Visible(machine::MachineTitle(family, message.profile(), message.profile_named(),
                                               message.machine_name())));
  machine::MachineUsed used{.changed_by = message.profile_changed_by()};
  for (const v1::ParameterChange& change : message.profile_changes())
    used.changes.push_back({change.name(), change.value(), change.of_profile(), change.source()});
  if (const std::string changes = used.ChangesText(); !changes.empty())
    rows.emplace_back("changed", Visible(changes));
}

// "  A 0.500000  B 0.250000".
std::string TurnedText(const v1::Position& position) {
  std::string text;
  for (const v1::AxisValue& turned : position.turned())
    text += "  " + turned.axis() + " " + Fixed(turned.value(), 6);
  return text;
}

// Where the tip ends and went: as the program counts, or the machine.
void AddPositions(const v1::RunReport& report, const machine::MachineShape& shape, Zero zero,
                  Rows& rows) {
  const bool from_work = report.has_work_origin() && zero == Zero::kWork;
  const v1::Point origin = from_work ? report.work_origin() : v1::Point();
  const auto text = [&origin](v1::Point point) {
    point.set_x(point.x() - origin.x());
    point.set_y(point.y() - origin.y());
    point.set_z(point.z() - origin.z());
    return PointText(point);
  };
  rows.emplace_back("final tip", text(report.final_position().tip()));
  if (shape.five_axis) {
    rows.emplace_back("final column", PointText(report.final_position().column()) +
                                          TurnedText(report.final_position()));
  }
  if (report.has_tip_box()) {
    rows.emplace_back("tip box",
                      text(report.tip_box().low()) + "  to  " + text(report.tip_box().high()));
  }
  if (!report.has_work_origin()) return;
  rows.emplace_back("work origin", PointText(report.work_origin()) +
                                       " on the machine; positions are from " +
                                       (from_work ? "the work origin" : "the zero of the machine"));
}

// What a run did; a job that only checks has none of it.
void AddFigures(const v1::RunReport& report, Zero zero, Rows& rows) {
  const machine::MachineFamily* family = families::FindFamily(report.family());
  const v1::WorkFigures& total = report.total();
  const v1::RunTimes& times = total.times();
  rows.emplace_back("cycle time", Duration(times.cycle_s()));
  std::string parts;
  const auto part = [&](const char* name, double seconds) {
    if (seconds > 0.0)
      parts += (parts.empty() ? "" : ", ") + std::string(name) + " " + Fixed(seconds, 3) + " s";
  };
  part("motion", times.motion_s());
  part("settling", times.settling_s());
  part("dwell", times.dwell_s());
  part("pierce", times.pierce_s());
  part("condition", times.condition_s());
  part("operator", times.operator_s());
  part("spin-up", times.spin_up_s());
  part("loading", times.load_s());
  part("standstill", times.standstill_s());
  if (!parts.empty()) rows.emplace_back("", parts);
  rows.emplace_back("path", Fixed(total.path_length_mm(), 3) + " mm: cut " +
                                Fixed(total.cut_length_mm(), 3) + ", travel " +
                                Fixed(total.travel_length_mm(), 3));
  const machine::MachineShape shape =
      family == nullptr ? machine::MachineShape()
                        : family->Shape(machine::Parameters(family->parameters()));
  if (shape.laser_watts > 0.0) {
    rows.emplace_back("beam", "on " + Fixed(total.beam_on_s(), 3) + " s, switched on " +
                                  std::to_string(total.beam_switches()) + " times, " +
                                  std::to_string(total.pierces()) + " pierces, " +
                                  Fixed(total.energy_j(), 0) + " J");
    if (total.energy_j_per_mm() > 0.0) {
      rows.emplace_back("", Fixed(total.energy_j_per_mm(), 3) + " J/mm, of a step at most " +
                                Fixed(total.energy_j_per_mm_max(), 3));
    }
  } else if (family != nullptr) {
    rows.emplace_back("plunges", std::to_string(total.plunges()));
  }
  AddContours(report, rows);
  if (family != nullptr) AddFamilyFigures(report, *family, rows);
  AddCorners(report, rows);
  AddSlowMoves(report, rows);
  AddPeaks(report, rows);
  AddMilling(report, rows);
  AddViolations(report, rows);
  rows.emplace_back("steps", std::to_string(total.steps()));
  AddPositions(report, shape, zero, rows);
  // By kind and number.
  const auto first = rows.end() - rows.begin();
  for (const v1::Variable& variable : report.variables())
    rows.emplace_back(variable.name(), variable.text());
  const auto order = [](const auto& row) {
    return std::tuple(row.first.substr(0, row.first.find('[')), row.first.size(), row.first);
  };
  std::ranges::sort(rows.begin() + first, rows.end(), {}, order);
}

}  // namespace

std::string ReportText(const v1::RunReport& report, Zero zero) {
  Rows rows;
  const v1::Outcome& outcome = report.outcome();
  if (outcome.verdict() != v1::VERDICT_UNSPECIFIED) {
    rows.emplace_back("verdict", VerdictText(outcome.verdict()));
    for (const v1::VerdictReason& reason : outcome.reasons())
      rows.emplace_back("", ReasonLine(reason));
  }
  rows.emplace_back("outcome", OutcomeLine(outcome));
  const machine::MachineFamily* family = families::FindFamily(report.family());
  if (family != nullptr && (report.has_total() || !report.profile().empty()))
    AddMachine(*family, report, rows);
  if (report.has_total()) AddFigures(report, zero, rows);
  if (!report.motion_check().empty())
    rows.emplace_back("motion", "checked " + report.motion_check());
  return TextOf(rows) + FindingsText(report);
}

std::string MachineRows(const machine::MachineFamily& family, const v1::Findings& found) {
  Rows rows;
  AddMachine(family, found, rows);
  return TextOf(rows);
}

std::string MachineRows(const machine::MachineFamily& family,
                        const v1::DiffProgramsResponse& diff) {
  Rows rows;
  AddMachine(family, diff, rows);
  return TextOf(rows);
}

std::string FigureRows(const machine::MachineFamily& family,
                       const std::vector<machine::Figure>& figures, Zero zero) {
  Rows rows;
  const auto value = [&](std::string_view name) -> std::optional<double> {
    const auto found = std::ranges::find(figures, name, &machine::Figure::name);
    return found == figures.end() ? std::nullopt : std::optional(found->value);
  };
  AddFigureRows(family, machine::FigureInfo::Where::kCheck, value, rows);
  if (zero == Zero::kMachine)
    AddFigureRows(family, machine::FigureInfo::Where::kCheckMachine, value, rows);
  return TextOf(rows);
}

std::string GatheredLine(const v1::GatheredFindings& gathered) {
  return "and " + std::to_string(gathered.count()) + " more " + gathered.code() +
         ExtentText(gathered.first().line(), gathered.last().line()) + ": " +
         Visible(gathered.message());
}

namespace {

// While a program runs nothing is judged: what is called advice now may make its verdict BAD.
std::string UnjudgedLine(const v1::Diagnostic& diagnostic) {
  std::string text = FindingLine(diagnostic);
  if (diagnostic.severity() != v1::SEVERITY_ADVICE ||
      diagnostic.verdict() != v1::VERDICT_UNSPECIFIED)
    return text;
  const std::string word = std::string(SeverityName(Severity::kAdvice)) + " ";
  const std::size_t at = text.find(word + diagnostic.code());
  return at == std::string::npos ? text : text.erase(at, word.size());
}

}  // namespace

std::string EventLine(const v1::JobEvent& event) {
  std::string text = "#" + std::to_string(event.sequence());
  if (event.virtual_time_ns() > 0)
    text += "  " + Fixed(static_cast<double>(event.virtual_time_ns()) * 1e-9, 3) + " s";
  text += "  ";
  switch (event.what_case()) {
    case v1::JobEvent::kState:
      return text + StateName(event.state());
    case v1::JobEvent::kDiagnostic:
      return text + UnjudgedLine(event.diagnostic());
    case v1::JobEvent::kGathered:
      return text + GatheredLine(event.gathered());
    case v1::JobEvent::kMessage:
      return text + Visible(event.message().text());
    case v1::JobEvent::kHalted:
      return text + "halted: " + Visible(event.halted().message());
    case v1::JobEvent::kResumed:
      return text + "resumed";
    case v1::JobEvent::kSignal: {
      const v1::Signal& signal = event.signal();
      std::string line = text + Visible(signal.name());
      if (signal.kind() == v1::SIGNAL_KIND_LOGICAL_OUTPUT)
        line += " " + std::to_string(signal.index());
      return line + " = " + Fixed(signal.value(), 0) +
             (signal.detail() != 0.0 ? " (" + Fixed(signal.detail(), 1) + ")" : "");
    }
    case v1::JobEvent::kProgramLoaded:
      return text + "program " + std::to_string(event.program_loaded().program());
    case v1::JobEvent::kExecutableMade:
      return text + "compiling program " + std::to_string(event.executable_made().program());
    case v1::JobEvent::kInputApplied:
      return text + Visible(event.input_applied().caller()) + ": " +
             InputText(event.input_applied().input());
    case v1::JobEvent::kRunBegun:
      return text + "run " + std::to_string(event.run_begun().run()) + " begins";
    case v1::JobEvent::kQueue:
      return text + (event.queue().held() ? "held back"
                                          : "priority " + std::to_string(event.queue().priority()));
    case v1::JobEvent::kEnded:
      text += "ended: " + OutcomeLine(event.ended());
      if (event.ended().verdict() == v1::VERDICT_UNSPECIFIED) return text;
      return text + "; verdict " + VerdictLine(event.ended().verdict(), event.ended().reasons());
    case v1::JobEvent::kProductsMade:
      return text + "report and pictures are made; verdict " +
             VerdictText(event.products_made().verdict());
    case v1::JobEvent::WHAT_NOT_SET:
      break;
  }
  return text;
}

}  // namespace rmlcell::cli
