#include "engine/optimo/offline/compensate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/core/number_text.h"
#include "engine/motion/geometry/path.h"
#include "engine/optimo/language/program.h"
#include "engine/optimo/offline/cutter_directive.h"
#include "engine/optimo/offline/gouge.h"
#include "engine/optimo/offline/literal_text.h"
#include "engine/optimo/offline/offset_path.h"
#include "engine/optimo/offline/program_frame.h"
#include "engine/optimo/offline/text_edits.h"
#include "engine/optimo/offline/translate.h"

namespace rmlcell::optimo {
namespace {

constexpr int kCompensateDecimals = 5;  // OPT-8.11

class Compensator {
 public:
  Compensator(const ParsedProgram& program, Findings& findings)
      : p_(program), module_(program.module), findings_(findings) {}

  // Directives and statements in the order of the text.
  std::vector<Fix> Run() {
    std::size_t comment = 0;
    for (std::size_t s = 0; s < module_.instructions.size(); ++s) {
      for (; comment < p_.comments.size() && p_.comments[comment].begin < p_.statements[s].begin;
           ++comment) {
        Obey(p_.comments[comment]);
      }
      Pass(module_.instructions[s]);
    }
    for (; comment < p_.comments.size(); ++comment) Obey(p_.comments[comment]);
    FinishChain();
    std::ranges::stable_sort(edits_, {}, &Fix::byte_offset);
    return std::move(edits_);
  }

 private:
  struct HolePath {                            // the last PATH HOLE
    const Instruction* instruction = nullptr;  // until its first MOVE
    std::optional<double> radius{};            // mm, as it is cut
  };

  void Obey(const Comment& comment);
  void SetAmount(const CutterDirective& directive, const Place& place);
  void SetSide(CutSide side, const Place& place);
  void Pass(const Instruction& i);
  void PassMove(const Instruction& i);
  void PassWork(const Instruction& i);
  void PassSysdef(const Instruction& i);
  void TurnTool();
  std::optional<ProgramVector> EndOf(const Instruction& i) const;
  void CompensateHole(const Instruction& move);
  void AddLeg(const Instruction& i);
  void FinishChain();
  void LookForGouges(const std::vector<OffsetLeg>& moved);
  void Rewrite(const Instruction& i, const OffsetLeg& moved);
  void RewriteNumber(std::uint32_t node, double value);
  std::optional<ProgramVector> Point(std::uint32_t first_expression) const;

  bool Wanted() const { return beam_ && amount_ && side_ != CutSide::kNone; }
  bool Active() const { return Wanted() && path_ != PathType::kPtp; }
  double SignedOffset() const { return side_ == CutSide::kLeft ? *amount_ : -*amount_; }
  void Report(ErrorCode code, const Instruction& i, Detail detail, std::string_view rule) {
    findings_.Add(code, p_.At(i), std::move(detail), rule);
  }

  const ParsedProgram& p_;
  const Module& module_;
  Findings& findings_;
  std::vector<Fix> edits_;
  std::optional<double> amount_;
  CutSide side_ = CutSide::kNone;
  PathType path_ = PathType::kPtp;
  CoordType coord_ = CoordType::kAbsol;
  bool beam_ = false;
  bool hole_advice_given_ = false;
  HolePath hole_;
  ProgramFrame frame_;
  std::optional<ProgramVector> at_;              // where the tip is, as far as it is known
  std::optional<double> head_a_at_, head_b_at_;  // rad
  ProgramVector tool_at_{0.0, 0.0, 1.0};
  std::vector<Leg> chain_;
  std::vector<const Instruction*> chain_moves_;
  double chain_offset_ = 0.0;
};

void Compensator::Obey(const Comment& comment) {
  const std::optional<CutterDirective> directive = ReadCutterDirective(p_, comment);
  if (!directive) return;
  const Place place{comment.begin, static_cast<int>(comment.end - comment.begin), 0};
  switch (directive->kind) {
    case CutterDirective::Kind::kSide:
      return SetSide(directive->side, place);
    case CutterDirective::Kind::kDiameter:
    case CutterDirective::Kind::kRadius:
      return SetAmount(*directive, place);
    case CutterDirective::Kind::kUnknown:
      break;
  }
  findings_.Add(ErrorCode::kCompDirective, place, "unknown directive", "OPT-8.05");
}

void Compensator::SetAmount(const CutterDirective& directive, const Place& place) {
  if (!directive.amount || !(*directive.amount >= 0.0) || !std::isfinite(*directive.amount)) {
    findings_.Add(ErrorCode::kCompDirective, place, "the amount is no number of at least 0",
                  "OPT-8.05");
    return;
  }
  const bool diameter = directive.kind == CutterDirective::Kind::kDiameter;
  const double amount = *directive.amount * (diameter ? 0.5 : 1.0);
  if (beam_ && amount_ != amount) {
    findings_.Add(ErrorCode::kCompChangeActive, place, "the amount changes while the beam is on",
                  "OPT-8.09");
  }
  amount_ = amount;
}

void Compensator::SetSide(CutSide side, const Place& place) {
  if (beam_ && side_ != side) {
    findings_.Add(ErrorCode::kCompChangeActive, place, "the side changes while the beam is on",
                  "OPT-8.09");
  }
  side_ = side;
}

void Compensator::Pass(const Instruction& i) {
  switch (i.op) {
    case Op::kPath:
      path_ = static_cast<PathType>(i.choice);
      if (path_ == PathType::kHole) hole_ = {&i, PlainNumber(p_, i.first_expression)};
      if (path_ == PathType::kPtp || path_ == PathType::kHole) FinishChain();
      break;
    case Op::kCoord:
      if (coord_ != static_cast<CoordType>(i.choice)) FinishChain();
      coord_ = static_cast<CoordType>(i.choice);
      break;
    case Op::kSysdef:
      PassSysdef(i);
      break;
    case Op::kZero:  // it moves, to where the machine says
      head_a_at_.reset();
      head_b_at_.reset();
      [[fallthrough]];
    case Op::kTcp:
      FinishChain();
      at_.reset();
      break;
    case Op::kWork:
      PassWork(i);
      break;
    case Op::kMove:
      PassMove(i);
      break;
    case Op::kGoto:
    case Op::kGotoTable:
    case Op::kGosub:
    case Op::kIf:
    case Op::kCall:
    case Op::kGo:
    case Op::kFunction:
    case Op::kReturn:
      if (Active()) {
        Report(ErrorCode::kCompFlow, i,
               "the path is followed from top to bottom, not along jumps and calls", "OPT-8.22");
      }
      break;
    default:
      break;
  }
}

// The head stays where it is: its point gets other coordinates, and its direction, too.
void Compensator::PassSysdef(const Instruction& i) {
  FinishChain();
  const std::optional<motion::MachinePoint> in_machine =
      at_ ? frame_.PointToMachine(motion::ProgramPoint::FromOrigin(*at_)) : std::nullopt;
  if (!frame_.Set(p_, i)) {
    Report(ErrorCode::kCompSysdef, i, "a rotation of SYSDEF is no number; it is taken as 0",
           "OPT-8.23");
  }
  at_.reset();
  const auto in_program = in_machine ? frame_.PointToProgram(*in_machine) : std::nullopt;
  if (in_program) at_ = in_program->from_origin();
  TurnTool();
}

void Compensator::TurnTool() {
  if (head_a_at_ && head_b_at_)
    tool_at_ = frame_.DirectionToProgram(motion::ToolDirection(*head_a_at_, *head_b_at_));
}

void Compensator::PassWork(const Instruction& i) {
  if (i.Has(kOff)) {
    FinishChain();
    beam_ = false;  // any OFF, OPT-8.07
    return;
  }
  if (i.numbers[0] == 2) return;
  beam_ = true;  // a second ON on the way leaves the corner a corner
  if (side_ != CutSide::kNone && !amount_) {
    Report(ErrorCode::kCompIncomplete, i, "a side is set, but no amount; nothing is compensated",
           "OPT-8.10");
  }
}

std::optional<ProgramVector> Compensator::Point(std::uint32_t first) const {
  const auto x = PlainNumber(p_, first), y = PlainNumber(p_, first + 1),
             z = PlainNumber(p_, first + 2);
  if (!x || !y || !z) return std::nullopt;
  return ProgramVector{*x, *y, *z};
}

void Compensator::PassMove(const Instruction& i) {
  if (path_ == PathType::kHole && hole_.instruction != nullptr) CompensateHole(i);
  if (path_ == PathType::kHole) hole_.instruction = nullptr;
  if (Active() && coord_ == CoordType::kRobot) {
    return Report(ErrorCode::kCompRobot, i, "a MOVE in COORD ROBOT cannot be compensated",
                  "OPT-8.21");
  }
  if (Active() && path_ != PathType::kHole) {
    AddLeg(i);
  } else {
    FinishChain();
    at_ = EndOf(i);
  }
  head_a_at_ = PlainNumber(p_, i.first_expression + 3);
  head_b_at_ = PlainNumber(p_, i.first_expression + 4);
  TurnTool();
}

// Where the tip is after a move, as programmed, in the coordinates of the program.
std::optional<ProgramVector> Compensator::EndOf(const Instruction& i) const {
  if (coord_ == CoordType::kRobot) return std::nullopt;
  const std::optional<ProgramVector> target = Point(i.first_expression);
  if (path_ != PathType::kHole || !i.Has(kVia)) return target;
  const std::optional<ProgramVector> beside = Point(i.first_expression + 5);
  if (!target || !beside || !at_ || !hole_.radius) return std::nullopt;
  return HoleEnd(*at_, *target, *beside, *hole_.radius);
}

// Left enlarges a hole although the motion runs counter-clockwise. OPT-8.12 to 8.14, OPT-B.91
void Compensator::CompensateHole(const Instruction& move) {
  const Instruction& path = *hole_.instruction;
  if (!Wanted()) return;
  const std::optional<double> radius = hole_.radius;
  if (!radius)
    return Report(ErrorCode::kCompVariable, path, "the radius is no plain number", "OPT-8.20");
  const double compensated = *radius + SignedOffset();
  if (compensated <= 0.0)
    return Report(ErrorCode::kCompHole, path, "the hole is not larger than the beam", "OPT-8.14");
  hole_.radius = compensated;
  RewriteNumber(module_.FirstNode(path.first_expression), compensated);
  if (!std::exchange(hole_advice_given_, true)) {
    findings_.AddAs(
        Severity::kAdvice, ErrorCode::kPracticeAdvice, p_.At(move),
        "at holes left means larger and right smaller, although the machine runs counter-clockwise",
        "OPT-B.91");
  }
}

void Compensator::AddLeg(const Instruction& i) {
  std::array<std::optional<double>, 10> values;
  const std::uint32_t count = i.Has(kVia) ? 10 : 5;
  bool plain = true;
  for (std::uint32_t v = 0; v < count; ++v) {
    values[v] = PlainNumber(p_, i.first_expression + v);
    plain = plain && values[v].has_value();
  }
  if (!plain || !at_) {
    Report(ErrorCode::kCompVariable, i,
           plain ? "the point where this move starts is not known as numbers"
                 : "a coordinate is no plain number",
           "OPT-8.20");
    at_ = plain ? std::optional<ProgramVector>({*values[0], *values[1], *values[2]}) : std::nullopt;
    return;
  }
  Leg leg;
  leg.from = *at_;
  leg.to = {*values[0], *values[1], *values[2]};
  leg.tool_from = tool_at_;
  leg.tool_to = frame_.DirectionToProgram(motion::ToolDirection(*values[3], *values[4]));
  leg.tool_via = leg.tool_to;
  if (path_ == PathType::kCir && i.Has(kVia)) {
    leg.via = ProgramVector{*values[5], *values[6], *values[7]};
    const auto arc = motion::PathPiece::ArcThrough({leg.from}, *leg.via, {leg.to});
    if (!arc) Report(ErrorCode::kArcUndefined, i, arc.error().detail, "OPT-E.7305");
  }
  Prepare(leg);
  if (leg.via) {
    // The machine ignores the angles of the via point: the head turns evenly along the arc
    // (OPT-2.20). Only where the angles at the start are not known, those written there count.
    const double share = ShareAtVia(leg);
    const auto on_the_way = [&](const std::optional<double>& from, double to, double via) {
      return from ? *from + share * (to - *from) : via;
    };
    leg.tool_via = frame_.DirectionToProgram(
        motion::ToolDirection(on_the_way(head_a_at_, *values[3], *values[8]),
                              on_the_way(head_b_at_, *values[4], *values[9])));
  }
  chain_offset_ = SignedOffset();
  chain_.push_back(leg);
  chain_moves_.push_back(&i);
  at_ = leg.to;
}

void Compensator::FinishChain() {
  if (chain_.empty()) return;
  std::size_t failed{};
  const Result<std::vector<OffsetLeg>> moved = OffsetChain(chain_, chain_offset_, failed);
  if (!moved) {
    Report(moved.error().code, *chain_moves_[failed], moved.error().detail, "OPT-8.19");
  } else {
    for (std::size_t k = 0; k < chain_.size(); ++k) Rewrite(*chain_moves_[k], (*moved)[k]);
    LookForGouges(*moved);
  }
  chain_.clear();
  chain_moves_.clear();
}

Detail GougeText(const Gouge& gouge, double radius) {
  if (gouge.kind != Gouge::Kind::kTooNear)
    return "the move is shorter than the compensation at its corners needs";
  if (!(gouge.distance > 0.0)) return "the compensated path crosses the contour";
  const double depth = radius - gouge.distance;
  return "the compensated path comes within " +
         Told("distance", gouge.distance, "mm", FixedText(gouge.distance, 3)) +
         " mm of the contour, and the beam has a radius of " +
         Told("radius", radius, "mm", TrimmedText(radius, kCompensateDecimals)) + " mm: it cuts " +
         Told("depth", depth, "mm", FixedText(depth, 3)) + " mm into the part";
}

void Compensator::LookForGouges(const std::vector<OffsetLeg>& moved) {
  const GougeSearch search = FindGouges(chain_, moved, chain_offset_);
  if (search.unchecked_from) {
    findings_.AddAs(
        Severity::kAdvice, ErrorCode::kCompGouge, p_.At(*chain_moves_[*search.unchecked_from]),
        "not checked from step " + Told("first", chain_moves_[*search.unchecked_from]->step) +
            " to " + Told("last", chain_moves_.back()->step) +
            ": the contour is too long to be looked through",
        "OPT-8.19");
  }
  for (const Gouge& gouge : search.found) {
    Report(ErrorCode::kCompGouge, *chain_moves_[gouge.leg],
           GougeText(gouge, std::fabs(chain_offset_)), "OPT-8.19");
  }
}

void Compensator::Rewrite(const Instruction& i, const OffsetLeg& moved) {
  const std::uint32_t count = i.Has(kVia) ? 10 : 5;
  for (std::uint32_t v = 0; v < count; ++v) {
    double value = *PlainNumber(p_, i.first_expression + v);
    const ProgramVector* point = v < 3                          ? &moved.to
                                 : v >= 5 && v < 8 && moved.via ? &*moved.via
                                                                : nullptr;
    if (point != nullptr) value = v % 5 == 0 ? point->x() : v % 5 == 1 ? point->y() : point->z();
    RewriteNumber(module_.FirstNode(i.first_expression + v), value);
  }
}

void Compensator::RewriteNumber(std::uint32_t node, double value) {
  const NumberPlace place = PlaceOfNumber(p_, node);
  edits_.push_back({place.offset, static_cast<int>(place.length),
                    FixedText(place.Written(value), kCompensateDecimals)});
}

}  // namespace

Compensation Compensate(std::string_view text, const std::optional<FileNames>& names, bool inch) {
  Compensation result;
  Findings findings;
  std::vector<Fix> edits;
  if (inch || (names && FormOfFile(names->input, {}) == FileForm::kInchSource)) {
    findings.Add(ErrorCode::kCompNotMetric, {}, "convert the source to metric first", "OPT-8.01");
  } else {
    const ParsedProgram program = Parse(text, findings);
    if (findings.error_count() == 0) edits = Compensator(program, findings).Run();
  }
  result.ok = findings.error_count() == 0;
  if (result.ok) {
    if (names) {
      result.text =
          "; File " + names->output + " Created From File " + names->input + " - " + names->date;
      result.text += LineEndOf(text);
    }
    result.text += ApplyEdits(text, edits);
  }
  result.diagnostics = findings.Take(text, names ? names->input : "");
  result.diagnostics_dropped = findings.dropped();
  return result;
}

}  // namespace rmlcell::optimo
