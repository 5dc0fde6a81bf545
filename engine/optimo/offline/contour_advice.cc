#include "engine/optimo/offline/contour_advice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/number_text.h"
#include "engine/core/units.h"

namespace rmlcell::optimo {
namespace {

// No object of 34,000 bytes has as many records; what is longer is not worth the time.
constexpr std::size_t kInstructionsMax = 40'000;
constexpr double kSharp_rad = 60.0 * kRadPerDegree;      // OPT-2.62
constexpr double kNearStraightDown_rad = kRadPerDegree;  // OPT-E.7319
constexpr double kSwingMax_rad = 30.0 * kRadPerDegree;
constexpr double kCostMin = 0.01;  // share of the wanted speed: less is not worth a word

using motion::MoveCommand;
using motion::PathPiece;
using motion::TipPose;

// The literal or constant that a value is.
std::optional<double> Known(Expression value) {
  if (value.size() != 1 || value[0].op == Node::kVariable || value[0].op == Node::kName)
    return std::nullopt;
  return static_cast<double>(value[0].number);
}

Detail ToldAngle(double rad) {
  const double deg = rad / kRadPerDegree;
  return Told("angle", deg, "deg", FixedText(deg, 1) + " degrees");
}

class ContourAdviser {
 public:
  ContourAdviser(const ParsedProgram& program, const ContourMachine& machine, Findings& findings)
      : p_(program), module_(program.module), machine_(machine), findings_(findings) {
    for (const std::uint16_t target : module_.targets) jumped_to_.insert(target);
  }

  void Run() {
    for (std::size_t at = 0; at < module_.instructions.size(); ++at) {
      const Instruction& i = module_.instructions[at];
      for (const std::uint16_t label : module_.Labels(i)) {
        if (jumped_to_.contains(label)) Forget();
      }
      Pass(i);
    }
    FinishChain();
  }

 private:
  struct ChainMove {
    const Instruction* instruction;
    MoveCommand command;
    bool beam;
  };

  void Pass(const Instruction& i);
  void PassMove(const Instruction& i);
  std::optional<PathPiece> PieceTo(const Instruction& i, const TipPose& target) const;
  void AdviseHead(const Instruction& i, const TipPose& target);
  void FinishChain();
  void AdviseCorner(const ChainMove& before, const ChainMove& after,
                    const motion::CornerReport& corner);

  // Something else may come here from elsewhere. A chain ends with the next move: nothing is known
  // of where that one starts.
  void Forget() {
    at_.reset();
    path_.reset();
    coord_.reset();
    speed_ = accel_ = oversh_ = std::nullopt;
    beam_ = false;
  }

  const ParsedProgram& p_;
  const Module& module_;
  const ContourMachine& machine_;
  Findings& findings_;
  std::set<std::uint16_t> jumped_to_;
  std::optional<PathType> path_;  // at the start a machine parameter
  std::optional<CoordType> coord_;
  std::optional<double> speed_ = 70.0, accel_ = 100.0, oversh_ = 100.0;  // OPT-2.10
  bool beam_ = false;                                                    // known to be on
  std::optional<TipPose> at_;
  std::vector<ChainMove> chain_;
};

void ContourAdviser::Pass(const Instruction& i) {
  switch (i.op) {
    case Op::kDeclare:
      return;
    case Op::kMove:
      return PassMove(i);
    case Op::kPath:
      path_ = static_cast<PathType>(i.choice);
      return;
    case Op::kSpeed:
      speed_ = Known(module_.Value(i, 0));
      break;
    case Op::kAccel:
      accel_ = Known(module_.Value(i, 0));
      break;
    case Op::kOversh:
      oversh_ = Known(module_.Value(i, 0));
      break;
    case Op::kCoord:
      FinishChain();
      coord_ = static_cast<CoordType>(i.choice);
      return;
    case Op::kSysdef:
    case Op::kTcp:
    case Op::kZero:
      FinishChain();
      at_.reset();
      return;
    case Op::kWork:
      if (i.Has(kStart) || i.Has(kEnd) || i.Has(kTime) || (i.numbers[0] == 1 && i.Has(kOn)))
        FinishChain();  // a wait, or a dwell
      if (i.numbers[0] != 2 || i.Has(kOff)) beam_ = i.Has(kOn);
      return;
    case Op::kGoto:
    case Op::kGotoTable:
    case Op::kGosub:
    case Op::kReturn:
    case Op::kFunction:
    case Op::kCall:
    case Op::kGo:
    case Op::kEndtask:
      return Forget();
    default:
      break;
  }
  if (i.reads_machine || Describe(i.op).fly != FlyClass::kTransparent) FinishChain();
}

// Lines and arcs; nothing for a hole, or an arc through points that make none.
std::optional<PathPiece> ContourAdviser::PieceTo(const Instruction& i,
                                                 const TipPose& target) const {
  if (path_ != PathType::kCir || !i.Has(kVia)) return PathPiece::Line(*at_, target);
  motion::MachinePoint via;
  for (int v = 0; v < 3; ++v) {
    const auto value = Known(module_.Via(i, v));
    if (!value) return std::nullopt;
    via[v] = *value;
  }
  const auto arc = PathPiece::ArcThrough(*at_, via, target);
  if (!arc) return std::nullopt;
  return arc->path;
}

void ContourAdviser::PassMove(const Instruction& i) {
  std::array<double, 5> v{};
  bool plain = coord_ == CoordType::kAbsol && path_ && path_ != PathType::kHole;
  for (int n = 0; n < 5 && plain; ++n) {
    const auto value = Known(module_.Value(i, n));
    plain = value.has_value();
    v[static_cast<std::size_t>(n)] = value.value_or(0.0);
  }
  if (i.Has(kStart)) FinishChain();
  if (!plain) {
    FinishChain();
    at_.reset();
    return;
  }
  const TipPose target{{v[0], v[1], v[2]}, v[3], v[4]};
  const std::optional<PathPiece> piece = at_ ? PieceTo(i, target) : std::nullopt;
  if (piece && path_ != PathType::kPtp && piece->tip_length_mm() > 0.0) AdviseHead(i, target);
  const bool timed = speed_ && accel_ && oversh_;
  if (!piece || !timed) {
    FinishChain();
  } else if (piece->length() > 0.0) {  // on the spot it adds nothing, as in the planner
    const bool tip = path_ == PathType::kPtp;
    chain_.push_back(
        {&i,
         {.kind = tip ? MoveCommand::Kind::kPointToPointTip : MoveCommand::Kind::kContour,
          .path = *piece,
          .head = motion::GantryHead{.length_mm = machine_.head_length_mm},
          .speed_fraction = *speed_ / 100.0,
          .acceleration_fraction = *accel_ / 100.0,
          .overshoot_fraction = *oversh_ / 100.0,
          .fly = i.Has(kFly),
          .tag = chain_.size()},
         beam_});
  }
  if (!i.Has(kFly)) FinishChain();
  at_ = target;
  if (i.Has(kEnd) || i.Has(kTime) || i.Has(kNext)) {  // it may end elsewhere
    FinishChain();
    at_.reset();
  }
}

void ContourAdviser::AdviseHead(const Instruction& i, const TipPose& target) {
  const double swing = std::fabs(target.a_rad - at_->a_rad);
  const bool crosses = (at_->b_rad < 0.0) != (target.b_rad < 0.0);
  const double nearest = crosses ? 0.0 : std::min(std::fabs(at_->b_rad), std::fabs(target.b_rad));
  if (swing <= kSwingMax_rad || nearest >= kNearStraightDown_rad) return;
  findings_.Add(ErrorCode::kHeadSingular, p_.At(i),
                "A turns by " + ToldAngle(swing) + " while the head passes straight down",
                "OPT-E.7319");
}

// Plans the chain as the control would, and looks at its corners.
void ContourAdviser::FinishChain() {
  const std::vector<ChainMove> chain = std::exchange(chain_, {});
  if (chain.size() < 2) return;
  motion::Planner planner(machine_.limits);
  const auto drain = [&] {
    while (const auto item = planner.Next()) {
      const auto* done = std::get_if<motion::PlannedMotion>(&*item);
      if (done == nullptr || !done->ends_move || done->tag + 1 >= chain.size()) continue;
      AdviseCorner(chain[done->tag], chain[done->tag + 1], done->corner);
    }
  };
  for (const ChainMove& move : chain) {
    if (!planner.Append(move.command)) break;  // it fails when it runs: 7307
    drain();
  }
  planner.Stop();
  drain();
}

void ContourAdviser::AdviseCorner(const ChainMove& before, const ChainMove& after,
                                  const motion::CornerReport& corner) {
  if (!motion::IsBlend(corner.passage)) return;
  const PathPiece& in = before.command.path;
  const PathPiece& out = after.command.path;
  const motion::MachineVector a = in.Tangent(in.length()), b = out.Tangent(0.0);
  const double turn = std::atan2(a.cross(b).norm(), a.dot(b));
  if (turn > kSharp_rad && before.beam && after.beam) {
    findings_.Add(
        ErrorCode::kFlySharp, p_.At(*before.instruction),
        "the contour turns by " + ToldAngle(turn) + "; the path stays " +
            Told("distance", corner.deviation_mm, "mm", FixedText(corner.deviation_mm, 3)) +
            " mm away from the corner",
        "OPT-2.62");
  }
  const double cost = corner.wanted_speed - corner.speed;
  if (corner.passage == motion::Passage::kBlendCapped && cost > kCostMin * corner.wanted_speed) {
    findings_.AddAs(
        Severity::kAdvice, ErrorCode::kFlyCapped, p_.At(*before.instruction),
        "a short neighbour makes the blend tighter: " +
            Told("speed", corner.speed, "mm/s", FixedText(corner.speed, 1)) +
            " mm/s in its middle instead of " +
            Told("wanted", corner.wanted_speed, "mm/s", FixedText(corner.wanted_speed, 1)),
        "OPT-E.7318");
  }
}

}  // namespace

ContourMachine ContourMachine::Standard() {
  ContourMachine machine;
  machine.limits.axes = {.speed = {500.0, 500.0, 500.0, kTurn, kTurn},
                         .acceleration = {2000.0, 2000.0, 2000.0, 20.0, 20.0},
                         .jerk = {40'000.0, 40'000.0, 40'000.0, 400.0, 400.0},
                         .travel_min = {-600.0, -600.0, -1300.0, -12.6, -2.4},
                         .travel_max = {3600.0, 3100.0, 1100.0, 12.6, 2.4}};
  return machine;
}

void AdviseOnContours(const ParsedProgram& program, const ContourMachine& machine,
                      Findings& findings) {
  if (program.module.instructions.size() > kInstructionsMax) return;
  ContourAdviser(program, machine, findings).Run();
}

std::function<void(const ParsedProgram&, Findings&)> ContourAdvice(const ContourMachine& machine) {
  return [machine](const ParsedProgram& program, Findings& findings) {
    AdviseOnContours(program, machine, findings);
  };
}

}  // namespace rmlcell::optimo
