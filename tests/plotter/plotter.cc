#include "tests/plotter/plotter.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "engine/core/number_text.h"
#include "engine/machine/observer.h"
#include "engine/machine/run.h"
#include "engine/machine/shape.h"

namespace rmlcell::plotter {
namespace {

using machine::InputKind, machine::OutcomeKind, machine::Parameters, machine::RunPhase;

constexpr double kSpeed_mm_s = 200.0;
constexpr int kTable = OwnErrorTable("PLT");
constexpr ErrorCode kSyntax = OwnError(kTable, 0);
constexpr ErrorCode kNoPen = OwnError(kTable, 1);
constexpr ErrorCode kOffThePaper = OwnError(kTable, 2);
constexpr CatalogueEntry kErrors[] = {
    {kSyntax, OwnErrorFamily(kTable), 1, "PlotterSyntax", Severity::kCompile,
     "a line that is no command", "write SP, PU, PD or WT with its numbers"},
    {kNoPen, OwnErrorFamily(kTable), 2, "PlotterNoPen", Severity::kProgram, "drawing without a pen",
     "take a pen with SP first"},
    {kOffThePaper, OwnErrorFamily(kTable), 3, "PlotterOffThePaper", Severity::kProgram,
     "a motion leaves the paper", "draw it smaller, or take larger paper (SIZE)"},
};

struct Command {
  std::string name;  // "PD"
  double x = 0.0;    // mm; s of WT, the number of the pen of SP
  double y = 0.0;
  int line = 0;
};

bool ReadLine(const std::string& text, Command& command) {
  if (text.size() < 4) return false;
  command.name = text.substr(0, 2);
  std::istringstream numbers(text.substr(2));
  const bool moves = command.name == "PU" || command.name == "PD";
  char comma = ',';
  numbers >> command.x;
  if (moves) numbers >> comma >> command.y;
  if (numbers.fail() || comma != ',' || numbers.peek() != EOF) return false;
  return moves || (command.name == "SP" && command.x >= 0.0 && command.x <= 8.0) ||
         (command.name == "WT" && command.x >= 0.0);
}
std::vector<Command> Read(std::string_view text, std::vector<Diagnostic>& findings) {
  std::vector<Command> commands;
  std::istringstream lines{std::string(text)};
  std::string words;
  for (int line = 1; std::getline(lines, words); ++line) {
    Command command{.name = {}, .line = line};
    if (words.empty()) continue;
    if (ReadLine(words, command)) {
      commands.push_back(command);
      continue;
    }
    Diagnostic wrong{
        .code = kSyntax, .severity = Severity::kCompile, .where = {.line = line, .column = 1}};
    wrong.detail = "no command: " + words.substr(0, 20);
    findings.push_back(std::move(wrong));
  }
  return commands;
}

motion::MachineLimits Limits(const Parameters& parameters) {
  motion::MachineLimits limits;
  limits.tip_speed_mm_s = kSpeed_mm_s;
  limits.settling_s = 0.0;
  limits.axes.speed.fill(kSpeed_mm_s);
  limits.axes.acceleration.fill(2000.0);
  limits.axes.jerk.fill(40'000.0);
  limits.axes.travel_max.fill(parameters.Number("SIZE"));
  return limits;
}

// All that changes while a program runs: a copy is a snapshot.
struct State final : machine::RunSnapshot {
  SimTime now{0};
  SimTime busy_until{0};  // of the command on its way
  std::size_t next = 0;   // command
  std::size_t input = 0;
  int pen = 0;
  motion::MachinePoint at;
  double override_percent = 100.0;
  bool hold = false;
  RunPhase phase = RunPhase::kRunning;
  machine::Outcome outcome;
};
class PlotterRun final : public machine::Run {
 public:
  PlotterRun(machine::RunSetup setup, machine::RunObserver& observer)
      : setup_(std::move(setup)), observer_(observer) {
    std::vector<Diagnostic> findings;  // it was stored, so there are none
    commands_ = Read(*setup_.programs.at(setup_.main_program).object, findings);
    s_.override_percent = setup_.override_percent;
  }

  RunPhase Advance(SimTime until) override {
    while (s_.phase != RunPhase::kFinished) {
      const bool halted = s_.phase == RunPhase::kHalted;
      const SimTime free = halted ? SimTime::max() : s_.busy_until;
      const SimTime input = s_.input < setup_.inputs.size()
                                ? std::max(setup_.inputs[s_.input].at, s_.now)
                                : SimTime::max();
      if (input <= std::min(until, free)) {
        s_.now = input;
        Apply(setup_.inputs[s_.input++]);
      } else if (halted || until <= free) {
        if (!halted) s_.now = std::max(s_.now, until);
        return s_.phase;
      } else {
        s_.now = std::max(s_.now, free);
        Next();
      }
    }
    return s_.phase;
  }

  void Apply(const machine::InputChange& input) override {
    if (input.kind == InputKind::kOverride) s_.override_percent = input.value;
    if (input.kind == InputKind::kHold || input.kind == InputKind::kStop) s_.hold = true;
    if (input.kind != InputKind::kStart || s_.phase != RunPhase::kHalted) return;
    s_.hold = false;
    s_.phase = RunPhase::kRunning;
    observer_.OnResume(s_.now, place());
  }

  void End(OutcomeKind kind, ErrorCode code) override {
    s_.phase = RunPhase::kFinished;
    s_.outcome = {.kind = kind, .place = place()};
    if (kind != OutcomeKind::kCompleted) s_.outcome.code = code;
  }

  machine::RunState state() const override {
    machine::RunState now{.time = s_.now, .phase = s_.phase, .place = place(), .tip = {s_.at}};
    now.axes = {s_.at};
    now.override_percent = s_.override_percent;
    return now;
  }
  const machine::Outcome& outcome() const override { return s_.outcome; }
  std::uint64_t steps_executed() const override { return s_.next; }
  std::unique_ptr<machine::RunSnapshot> Save() const override {
    return std::make_unique<State>(s_);
  }
  void Restore(const machine::RunSnapshot& snapshot) override {
    s_ = static_cast<const State&>(snapshot);
  }

 private:
  machine::Place place() const {
    return {.program = setup_.main_program,
            .step = static_cast<int>(s_.next),
            .line = s_.next == 0 ? 0 : commands_[s_.next - 1].line};
  }

  void Next() {
    if (s_.hold) {
      s_.phase = RunPhase::kHalted;
      return observer_.OnHalt({.at = s_.now, .place = place(), .why = "HOLD"});
    }
    if (s_.next == commands_.size()) return End(OutcomeKind::kCompleted, {});
    const Command& command = commands_[s_.next++];
    observer_.OnStep(s_.now, place(), command.name);
    if (command.name == "SP") {
      s_.pen = static_cast<int>(command.x);
    } else if (command.name == "WT") {
      s_.busy_until = s_.now + FromSeconds(command.x);
      observer_.OnWait({.start = s_.now, .end = s_.busy_until, .place = place()});
    } else if (command.name == "PD" && s_.pen == 0) {
      Fail(kNoPen, "PD without a pen");
    } else {
      Go(command.name == "PD", {command.x, command.y, 0.0});
    }
  }

  void Fail(ErrorCode code, std::string detail) {
    observer_.OnDiagnostic(s_.now, {.code = code,
                                    .severity = Severity::kProgram,
                                    .detail = detail,
                                    .where = {.line = place().line},
                                    .program = place().program,
                                    .step = place().step});
    End(OutcomeKind::kFailed, code);
    s_.outcome.detail = std::move(detail);
  }

  void Go(bool draws, const motion::MachinePoint& to) {
    for (const int axis : {0, 1}) {
      const double excess = std::max(-to[axis], to[axis] - setup_.parameters.Number("SIZE"));
      if (excess <= 0.0) continue;
      observer_.OnViolation({.at = s_.now,
                             .place = place(),
                             .axis = axis,
                             .excess = excess,
                             .at_target = true,
                             .axes = {to},
                             .tip = {to}});
      return Fail(kOffThePaper, std::string(1, "XY"[axis]) + " by " + ShortestText(excess) + " mm");
    }
    motion::Planner planner(Limits(setup_.parameters));
    const Status good = planner.Append({.path = motion::PathPiece::Line({s_.at}, {to}),
                                        .head = motion::MillHead{},
                                        .speed_fraction = s_.override_percent / 100.0});
    if (!good) return End(OutcomeKind::kFailed, good.error().code);
    planner.Stop();
    while (const auto item = planner.Next()) {
      const auto& motion = std::get<motion::PlannedMotion>(*item);
      const SimTime start = std::max(s_.now, s_.busy_until);
      s_.busy_until = start + FromSeconds(motion.duration_s());
      observer_.OnMotion({.start = start,
                          .end = s_.busy_until,
                          .place = place(),
                          .use = draws ? machine::MotionUse::kCut : machine::MotionUse::kTravel,
                          .motion = &motion,
                          .travelled = motion.path.length(),
                          .programmed_mm_s = kSpeed_mm_s});
    }
    s_.at = to;
    observer_.OnMove({.at = s_.busy_until,
                      .place = place(),
                      .tip = {to},
                      .axes = {to},
                      .program_point = motion::ProgramPoint::AsMachine(to),
                      .feed_mm_s = kSpeed_mm_s,
                      .path = draws ? "PD" : "PU"});
  }

  machine::RunSetup setup_;
  machine::RunObserver& observer_;
  std::vector<Command> commands_;
  State s_;
};

constexpr machine::ParameterInfo kParameters[] = {
    {"SIZE", "mm", 300.0, 10.0, 3000.0, {}, "width and height of the paper", {}}};
constexpr ErrorCode kOfMotion[] = {kOffThePaper};
constexpr machine::FamilyInfo kInfo{.id = "plotter",
                                    .title = "Pen plotter",
                                    .extensions = ".PLT",
                                    .axes = "X Y",
                                    .checked_by_running = true,
                                    .hold_in_remote = true,
                                    .override_max_percent = 120.0,
                                    .travel_left = kOffThePaper,
                                    .check = {.of_motion = kOfMotion}};
class Family final : public machine::MachineFamily {
 public:
  const machine::FamilyInfo& info() const override { return kInfo; }
  std::span<const machine::ParameterInfo> parameters() const override { return kParameters; }
  machine::MachineShape Shape(const Parameters& parameters) const override {
    machine::MachineShape shape;
    for (const double corner : {0.0, parameters.Number("SIZE")})
      shape.travel.Add(motion::MachinePoint{corner, corner, 0.0});
    shape.limits = Limits(parameters);
    return shape;
  }
  machine::Translation Translate(const machine::SourceFile& file, const Parameters&,
                                 const machine::CheckOptions&) const override {
    machine::Translation made;
    const std::size_t steps = Read(file.bytes, made.diagnostics).size();
    for (Diagnostic& finding : made.diagnostics) finding.file = file.name;
    made.ok = made.diagnostics.empty();
    made.as_it_came = true;
    made.figures.push_back({"steps", "", static_cast<double>(steps)});
    return made;
  }
  Result<std::unique_ptr<machine::Run>> NewRun(machine::RunSetup setup,
                                               machine::RunObserver& observer) const override {
    return std::unique_ptr<machine::Run>(std::make_unique<PlotterRun>(std::move(setup), observer));
  }
};

}  // namespace

ErrorTable Errors() { return {.prefix = "PLT", .rows = kErrors}; }
const machine::MachineFamily& PlotterFamily() {
  static const Family family;
  return family;
}

}  // namespace rmlcell::plotter
