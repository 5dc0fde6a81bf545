#include "tests/engine/rml1/run_record.h"

#include <algorithm>
#include <sstream>

#include "engine/core/number_text.h"

namespace rmlcell::rml1 {
namespace {

std::string Coordinates(const machine::MoveDone& move) {
  std::ostringstream out;
  out << TrimmedText(move.program_point.x(), 3) << ',' << TrimmedText(move.program_point.y(), 3)
      << ',' << TrimmedText(move.program_point.z(), 3);
  if (move.rotary_a != 0.0) out << ',' << TrimmedText(move.rotary_a, 3);
  return out.str();
}

std::string_view NameOf(machine::WaitKind kind) {
  switch (kind) {
    case machine::WaitKind::kDwell:
      return "dwell ";
    case machine::WaitKind::kSpinUp:
      return "spindle wait ";
    case machine::WaitKind::kOperator:
      return "operator ";
    default:
      return "other wait ";
  }
}

}  // namespace

Figures ByName(const std::vector<machine::Figure>& figures) {
  Figures by_name;
  for (const machine::Figure& figure : figures) by_name[figure.name] = figure.value;
  return by_name;
}

void RunRecord::OnStep(SimTime at, const machine::Place& place, std::string_view instruction) {
  if (!keep_events) return;
  Add(at, "step " + std::to_string(place.step) + " " + std::string(instruction));
}

void RunRecord::OnMotion(const machine::MotionDone& motion) {
  if (!keep_events) return;
  motions_.push_back({.start_s = ToSeconds(motion.start),
                      .end_s = ToSeconds(motion.end),
                      .place = motion.place,
                      .use = motion.use,
                      .planned = *motion.motion,
                      .travelled = motion.travelled,
                      .programmed_mm_s = motion.programmed_mm_s});
}

void RunRecord::OnMove(const machine::MoveDone& move) {
  if (!keep_events) return;
  moves_.push_back(move);
  Add(move.at, "move " + Coordinates(move));
}

void RunRecord::OnSignal(const machine::SignalChange& change) {
  std::ostringstream out;
  if (change.signal == machine::Signal::kSpindleSpeed) {
    out << "rpm " << change.value;
  } else if (change.signal == machine::Signal::kSpindle && change.value != 0.0) {
    out << "spin " << change.detail;
  } else {
    EXPECT_EQ(change.detail, 0.0);  // a spindle that stands has no speed
    out << "stop";
  }
  Add(change.at, out.str());
}

void RunRecord::OnWait(const machine::Wait& wait) {
  Add(wait.end, std::string(NameOf(wait.kind)) + TrimmedText(ToSeconds(wait.end - wait.start), 6));
}

void RunRecord::OnHalt(const machine::Halt& halt) { Add(halt.at, "halt " + std::string(halt.why)); }

void RunRecord::OnResume(SimTime at, const machine::Place&) { Add(at, "resume"); }

void RunRecord::OnDiagnostic(SimTime at, const Diagnostic& diagnostic) {
  diagnostics_.push_back(diagnostic);
  Add(at, "diagnostic " + CodeText(diagnostic.code));
}

std::string RunRecord::CommandLog() const {
  std::string log;
  for (const Diagnostic& diagnostic : diagnostics_) {
    const int number = Lookup(diagnostic.code).number;
    if (number > 3) continue;
    if (!log.empty()) log += ',';
    log += std::to_string(number);
  }
  return log;
}

int RunRecord::CountOf(ErrorCode code) const {
  return static_cast<int>(
      std::ranges::count(diagnostics_, code, [](const Diagnostic& d) { return d.code; }));
}

void RunRecord::Add(SimTime at, const std::string& event) {
  if (!keep_events) return;
  text_.append(TrimmedText(ToSeconds(at), 6)).append(" ").append(event).append("\n");
  events_.push_back(event);
}

}  // namespace rmlcell::rml1
