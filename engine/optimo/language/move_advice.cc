#include "engine/optimo/language/move_advice.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "engine/optimo/language/fixes.h"

namespace rmlcell::optimo {
namespace {

// OPT-5.46, in percent of machine speed.
constexpr float kRapidMax = 70.0F, kApproachMax = 10.0F, kCuttingMin = 5.0F, kCuttingMax = 15.0F,
                kLeavingMax = 20.0F;
constexpr double kHoleTiltMax_rad = 30.0 * kRadPerDegree;  // OPT-5.48

Detail SpeedText(float speed) {
  const auto percent = static_cast<double>(speed);
  return "SPEED " + Told("speed", percent, "%", ShortestText(percent));
}

}  // namespace

void MoveAdviser::Warn(const Instruction& i, ErrorCode code, Detail detail, std::string_view rule) {
  findings_.AddAs(Severity::kWarning, code, p_.At(i), std::move(detail), rule);
}

void MoveAdviser::Note(const Instruction& i, ErrorCode code, Detail detail, std::string_view rule) {
  findings_.AddAs(Severity::kAdvice, code, p_.At(i), std::move(detail), rule);
}

void MoveAdviser::Advise(std::uint32_t at, const FlowState& state) {
  const Instruction& i = module_.instructions[at];
  AdvisePath(i, state);
  AdviseSpeed(at, state);
  AdviseFly(at, state);
  AdviseShortFly(at, state);
  AdviseHole(i, state);
  if (const auto coord = state.modes.coord()) placed_.push_back({at, *coord});
}

void MoveAdviser::AdvisePath(const Instruction& i, const FlowState& state) {
  const Modes& modes = state.modes;
  if (modes.IsRobotContour()) {
    Warn(i, ErrorCode::kPathNeedsAbsol, "COORD ROBOT has PATH PTP only; this MOVE will fail",
         "OPT-2.08");
  } else if (modes.MayBeRobotContour()) {
    Warn(i, ErrorCode::kPathNeedsAbsol,
         "on one path this MOVE is in COORD ROBOT with a PATH other than PTP, and will fail",
         "OPT-2.08");
  } else if (start_.coord == CoordType::kRobot && modes.IsDefaultCoord() && modes.IsContour() &&
             !std::exchange(default_coord_told_, true)) {
    Note(i, ErrorCode::kPathNeedsAbsol,
         "no COORD was set: by default that is ROBOT, which has PATH PTP only, unless the program "
         "runs as a FUNCTION",
         "OPT-2.09");
  }
  const bool arc = modes.MayBe(PathType::kCir), hole = modes.MayBe(PathType::kHole);
  if ((arc || hole) && !i.Has(kVia) && !modes.IsRobotContour()) {
    const auto path = modes.path();
    const bool always = path == PathType::kCir || path == PathType::kHole;
    Warn(i, ErrorCode::kViaMissing,
         std::string(always ? "" : "on one path the PATH is CIR or HOLE: ") +
             "CIR and HOLE without /VIA move in a straight line",
         arc ? "OPT-2.21" : "OPT-2.29");
  }
  if (!state.BeamIsOn()) return;
  if (modes.path() == PathType::kPtp) {
    Warn(i, ErrorCode::kPracticeAdvice,
         "a contour in PATH PTP with the beam on: its speed is not controlled", "OPT-5.45");
  } else if (start_.path == PathType::kPtp && modes.IsDefaultPath() &&
             !std::exchange(default_path_told_, true)) {
    Note(i, ErrorCode::kPracticeAdvice,
         "a contour with the beam on, and no PATH was set: by default that is PTP, of which the "
         "speed is not controlled",
         "OPT-5.45");
  }
}

void MoveAdviser::AdviseSpeed(std::uint32_t at, const FlowState& state) {
  const Instruction& i = module_.instructions[at];
  const bool fresh = state.beam.Is(BeamThere::kFresh), ramp = state.beam.Is(BeamThere::kFreshRamp);
  if ((fresh || ramp) && state.modes.IsContour() && !i.Has(kStart)) {
    Note(i, ErrorCode::kPracticeAdvice,
         fresh ? "the beam was switched on without a dwell to pierce"
               : "WORKDEF 1 has a delay of 0: the beam was switched on without a dwell to pierce",
         fresh ? "OPT-3.20" : "OPT-3.21");
  }
  const auto known = state.speed.known();
  if (!known) return;
  const float speed = *known;
  if (speed == 0.0F) {
    const auto from = state.target.known(), target = LiteralTarget(module_, i);
    if (!i.Has(kTime) && from && target && Distance_mm(*from, *target) > 0.0)
      Warn(i, ErrorCode::kNoMotion, "SPEED is 0: this MOVE will fail", "OPT-B.22");
    return;
  }
  const bool before_on =
      at + 1 < module_.instructions.size() && module_.instructions[at + 1].op == Op::kWork &&
      module_.instructions[at + 1].Has(kOn) && module_.instructions[at + 1].numbers[0] != 2;
  if (state.BeamIsOn()) {
    if (speed > kCuttingMax || speed < kCuttingMin) {
      Warn(i, ErrorCode::kPracticeAdvice,
           SpeedText(speed) + " with the beam on; cutting takes 5 to 15 %", "OPT-5.46");
    }
  } else if (speed > kRapidMax) {
    Warn(i, ErrorCode::kPracticeAdvice, SpeedText(speed) + "; rapid moves take at most 70 %",
         "OPT-5.46");
  } else if (before_on && speed > kApproachMax) {
    Note(i, ErrorCode::kPracticeAdvice,
         SpeedText(speed) + " to the pierce point; the approach takes 10 %", "OPT-5.46");
  } else if (state.beam.Is(BeamThere::kJustOff) && speed > kLeavingMax) {
    Note(i, ErrorCode::kPracticeAdvice,
         SpeedText(speed) + " away from the part; leaving takes at most 20 %", "OPT-5.46");
  }
}

std::vector<Fix> MoveAdviser::RemoveAttribute(const Instruction& i, Word word) const {
  if (const auto fix = AttributeRemoval(p_, i, word)) return {*fix};
  return {};
}

void MoveAdviser::AdviseFly(std::uint32_t at, const FlowState& state) {
  const Instruction& i = module_.instructions[at];
  if (!i.Has(kFly)) return;
  const std::uint8_t ahead = chain_.Behind(at);
  Detail detail;
  std::string_view rule;
  if (state.modes.path() == PathType::kHole) {
    detail = "/FLY on a hole move";
    rule = "OPT-2.53";
  } else if (ahead == (kMotionAhead | kHoleAhead)) {
    detail = "/FLY on the move to a hole";
    rule = "OPT-2.53";
  } else if (ahead == kStopAhead) {
    const std::uint32_t stop = chain_.StopBehind(at);
    if (stop >= module_.instructions.size() || module_.instructions[stop].op == Op::kEndtask) {
      detail = "/FLY on the last MOVE of the program: the machine stops at the target";
      rule = "OPT-2.47";
    } else {
      const Instruction& cause = module_.instructions[stop];
      rule = cause.op == Op::kGo || cause.op == Op::kCall ? "OPT-2.47" : "OPT-2.48";
      const Detail where =
          Told("instruction", Describe(cause.op).name) + " at step " + Told("step", cause.step);
      detail = "/FLY, but " + where + " needs standstill";
      const auto coord = state.modes.coord();
      if (cause.op == Op::kCoord && coord && *coord != static_cast<CoordType>(cause.choice)) {
        return findings_.AddAs(
            Severity::kWarning, ErrorCode::kFlyBeforeCoord, p_.At(i),
            "/FLY before the change of coordinates at step " + Told("step", cause.step), "OPT-2.45",
            RemoveAttribute(i, Word::kFly));
      }
    }
  }
  if (detail.empty()) return;
  findings_.AddAs(Severity::kWarning, ErrorCode::kFlyAdvice, p_.At(i), std::move(detail), rule,
                  RemoveAttribute(i, Word::kFly));
}

// OPT-2.51, OPT-2.52
void MoveAdviser::AdviseShortFly(std::uint32_t at, const FlowState& state) {
  const Instruction& i = module_.instructions[at];
  if (!i.Has(kFly)) {
    const auto short_fly = state.short_fly.known();
    if (!short_fly) return;
    const Instruction& before = module_.instructions[*short_fly];
    return Warn(before, ErrorCode::kShortFly,
                "/FLY on a move shorter than 1 mm, and the next move stops", "OPT-2.51");
  }
  const auto from = state.target.known(), target = LiteralTarget(module_, i);
  const auto several = Choice<TinyMoves>::Bits({TinyMoves::kTwo, TinyMoves::kMore});
  if (!state.tiny_moves.IsAmong(several) || !from || !target) return;
  if (Distance_mm(*target, *from) < kTinyFly_mm) {
    Warn(i, ErrorCode::kShortFly, "/FLY on several moves in a row shorter than 0.01 mm",
         "OPT-2.52");
  }
}

// The angle between C to N and the tool axis u(A, B); program coordinates must not be turned.
// OPT-5.48
void MoveAdviser::AdviseHole(const Instruction& i, const FlowState& state) {
  const bool turned = !state.turned.Is(Turned::kNo);
  if (state.modes.path() != PathType::kHole || !i.Has(kVia) || turned) return;
  const auto centre = LiteralTarget(module_, i);
  const auto a_rad = LiteralValueOf(module_.Value(i, 3)),
             b_rad = LiteralValueOf(module_.Value(i, 4));
  if (!centre || !a_rad || !b_rad) return;
  motion::ProgramVector beside;
  for (int v = 0; v < 3; ++v) {
    const auto value = LiteralValueOf(module_.Via(i, v));
    if (!value) return;
    beside[v] = static_cast<double>(*value);
  }
  const motion::ProgramVector axis = beside - centre->from_origin();
  const double length = axis.norm();
  if (length == 0.0) return;
  const motion::MachineVector tool =
      motion::ToolDirection(static_cast<double>(*a_rad), static_cast<double>(*b_rad));
  const double cosine = axis.dot(tool) / length;
  const double angle = std::acos(std::fmin(1.0, std::fmax(-1.0, cosine)));
  if (angle <= kHoleTiltMax_rad) return;
  Warn(i, ErrorCode::kPracticeAdvice,
       "the axis of the hole is " +
           Told("angle", angle / kRadPerDegree, "deg",
                FixedText(angle / kRadPerDegree, 2) + " degrees") +
           " off the tool axis: a wrong normal point?",
       "OPT-5.48");
}

// OPT-7.109: with SYSDEF, ROBOT moves belong only to the first approach and the last retract, of
// the program and of each of its subroutines. What stands behind the program's own end is no part
// of it, but a GOSUB stands for the moves that it leads to.
void MoveAdviser::AdviseRobotMoves(const FlowGraph& graph, const std::vector<bool>& to_absol) {
  const auto sets_offset = [](const Instruction& i) {
    return i.op == Op::kSysdef && i.value_count > 0;
  };
  if (std::ranges::none_of(module_.instructions, sets_offset)) return;
  for (std::uint32_t at = 0; at < graph.size(); ++at) {
    if (module_.instructions[at].op != Op::kGosub) continue;
    const auto called = graph.Called(at);
    if (called && to_absol[*called]) placed_.push_back({at, CoordType::kAbsol});
  }
  std::ranges::sort(placed_, {}, &Placed::at);
  const std::vector<bool> main = graph.ReachOnLevel(graph.entry());
  // Which part each belongs to: 0 the program itself, else up to which RETURN or ENDTASK it goes.
  std::vector<std::uint32_t> part(graph.size());
  std::uint32_t ends = 1;
  for (std::uint32_t at = 0; at < graph.size(); ++at) {
    part[at] = main[at] ? 0 : ends;
    const Op op = module_.instructions[at].op;
    if (op == Op::kReturn || op == Op::kEndtask) ++ends;
  }
  std::vector<std::uint32_t> first(ends + 1U, kNoIndex), last(ends + 1U);  // ABSOL, of each part
  for (const Placed& move : placed_) {
    if (move.coord != CoordType::kAbsol) continue;
    const std::uint32_t of = part[move.at];
    if (first[of] == kNoIndex) first[of] = move.at;
    last[of] = move.at;
  }
  for (const Placed& move : placed_) {
    const std::uint32_t of = part[move.at];
    if (move.coord != CoordType::kRobot || first[of] == kNoIndex) continue;
    if (move.at < first[of] || move.at > last[of]) continue;
    Warn(module_.instructions[move.at], ErrorCode::kPracticeAdvice,
         "a ROBOT move between ABSOL moves is not shifted by SYSDEF", "OPT-7.109");
  }
}

}  // namespace rmlcell::optimo
