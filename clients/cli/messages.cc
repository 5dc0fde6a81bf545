#include "clients/cli/messages.h"


#include <algorithm>
#include <tuple>

#include "clients/cli/terminal.h"
#include "engine/core/diagnostic.h"
#include "proto/bridge/encoding.h"
#include "proto/bridge/findings.h"

namespace rmlcell::cli {
namespace {

std::string PointText(const v1::Point& point) {
  return Fixed(point.x(), 3) + ", " + Fixed(point.y(), 3) + ", " + Fixed(point.z(), 3);
}

std::string PlaceText(const v1::SourcePlace& place) {
  std::string text;
  if (place.program() > 0) text += "program " + std::to_string(place.program());
  if (place.step() > 0) text += (text.empty() ? "step " : " step ") + std::to_string(place.step());
  if (place.line() > 0) text += (text.empty() ? "line " : " line ") + std::to_string(place.line());
  return text;
}

}  // namespace

std::string Json(const google::protobuf::Message& message) {
  return bridge::StableJson(message).value_or("{}");
}

std::string StateName(v1::Job::State state) {
  std::string name = v1::Job::State_Name(state);
  if (name.starts_with("STATE_")) name.erase(0, 6);
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

std::string FindingLine(const v1::Diagnostic& diagnostic) {
  std::string text = Visible(FormatDiagnostic(bridge::FromProto(diagnostic), {}));
  if (diagnostic.count() > 1) text += " (" + std::to_string(diagnostic.count()) + " times)";
  return text;
}

std::string OutcomeLine(const v1::Outcome& outcome) {
  const bool colour = ColourOnOutput();
  std::string text;
  switch (outcome.kind()) {
    case v1::Outcome::KIND_COMPLETED: text = Paint("completed", Colour::kGreen, colour); break;
    case v1::Outcome::KIND_STOPPED: text = Paint("stopped", Colour::kYellow, colour); break;
    case v1::Outcome::KIND_FAILED: text = Paint("failed", Colour::kRed, colour); break;
    case v1::Outcome::KIND_CANCELLED: text = Paint("cancelled", Colour::kYellow, colour); break;
    case v1::Outcome::KIND_BUDGET_EXCEEDED: text = Paint("budget exceeded", Colour::kRed, colour); break;
    default: text = "not ended";
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

// What a run did; a job that only checks has none of it.
void AddFigures(const v1::RunReport& report, Rows& rows) {
  const v1::WorkFigures& total = report.total();
  const v1::RunTimes& times = total.times();
  rows.emplace_back("cycle time", Duration(times.cycle_s()) +
                                      (report.timing() == "exact" ? "" : "  (" + report.timing() + ")"));
  std::string parts;
  const auto part = [&](const char* name, double seconds) {
    if (seconds > 0.0) parts += (parts.empty() ? "" : ", ") + std::string(name) + " " + Fixed(seconds, 3) + " s";
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
  rows.emplace_back("path", Fixed(total.path_length_mm(), 3) + " mm: cut " + Fixed(total.cut_length_mm(), 3) +
                                ", travel " + Fixed(total.travel_length_mm(), 3));
  if (report.family() == "optimo") {
    rows.emplace_back("beam", "on " + Fixed(total.beam_on_s(), 3) + " s, switched on " +
                                  std::to_string(total.beam_switches()) + " times, " +
                                  std::to_string(total.pierces()) + " pierces, " + Fixed(total.energy_j(), 0) + " J");
  } else {
    rows.emplace_back("plunges", std::to_string(total.plunges()));
  }
  rows.emplace_back("steps", std::to_string(total.steps()));
  rows.emplace_back("final tip", PointText(report.final_position().tip()));
  if (report.family() == "optimo") {
    rows.emplace_back("final column", PointText(report.final_position().column()) + "  A " +
                                          Fixed(report.final_position().a(), 6) + "  B " +
                                          Fixed(report.final_position().b(), 6));
  }
  if (report.has_tip_box()) {
    rows.emplace_back("tip box", PointText(report.tip_box().low()) + "  to  " + PointText(report.tip_box().high()));
  }
  // A map of Protocol Buffers has another order each time: by kind and number.
  const auto first = rows.insert(rows.end(), report.variables().begin(), report.variables().end());
  const auto order = [](const auto& row) { return std::tuple(row.first.substr(0, row.first.find('[')), row.first.size(), row.first); };
  std::ranges::sort(first, rows.end(), {}, order);
}

}  // namespace

std::string ReportText(const v1::RunReport& report) {
  Rows rows;
  rows.emplace_back("outcome", OutcomeLine(report.outcome()));
  if (report.has_total()) AddFigures(report, rows);
  std::string text;
  for (const auto& [name, value] : rows) {
    text += Paint(name + std::string(14 - std::min<std::size_t>(13, name.size()), ' '), Colour::kDim,
                  ColourOnOutput()) + value + "\n";
  }
  for (const v1::Diagnostic& diagnostic : report.diagnostics()) text += FindingLine(diagnostic) + "\n";
  if (report.diagnostics_dropped() > 0) {
    text += "and " + std::to_string(report.diagnostics_dropped()) + " more findings\n";
  }
  return text;
}

std::string EventLine(const v1::JobEvent& event) {
  std::string text = "#" + std::to_string(event.sequence());
  if (event.virtual_time_ns() > 0) text += "  " + Fixed(static_cast<double>(event.virtual_time_ns()) * 1e-9, 3) + " s";
  text += "  ";
  switch (event.what_case()) {
    case v1::JobEvent::kState: return text + StateName(event.state());
    case v1::JobEvent::kDiagnostic: return text + FindingLine(event.diagnostic());
    case v1::JobEvent::kMessage: return text + Visible(event.message());
    case v1::JobEvent::kHalted: return text + "halted: " + event.halted();
    case v1::JobEvent::kResumed: return text + "resumed";
    case v1::JobEvent::kSignal: {
      const v1::TraceRecord& signal = event.signal();
      std::string line = text + signal.text();
      if (signal.text() == "output") line += " " + std::to_string(signal.index());
      return line + " = " + Fixed(signal.value(), 0) +
             (signal.detail() != 0.0 ? " (" + Fixed(signal.detail(), 1) + ")" : "");
    }
    case v1::JobEvent::kMilestone: return text + event.milestone();
    case v1::JobEvent::kEnded: return text + "ended: " + OutcomeLine(event.ended());
    case v1::JobEvent::WHAT_NOT_SET: break;
  }
  return text;
}

}  // namespace rmlcell::cli
