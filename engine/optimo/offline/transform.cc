#include "engine/optimo/offline/transform.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "engine/optimo/language/checker.h"
#include "engine/optimo/language/evaluate.h"
#include "engine/optimo/language/program.h"
#include "engine/optimo/offline/literal_text.h"
#include "engine/optimo/offline/offset_path.h"
#include "engine/optimo/offline/program_frame.h"
#include "engine/optimo/offline/text_edits.h"

namespace rmlcell::optimo {
namespace {

constexpr int kTransformDecimals = 6;
constexpr double kAboutZ = 1e-9;  // of a rotation, how far it moves Z
// Of the rotation about Z: decides between half a turn to the left and one to the right, which
// rounding would decide otherwise.
constexpr double kTieShare = 1e-3;
// Of sin B: below, six decimals of B do not say where A is, and what it turned by says nothing.
constexpr double kNearlyDown = 0.01;
constexpr int kFirstShiftVariable = 86;

// New numbers in place of plain ones.
struct NumberEdits {
  const ParsedProgram& program;
  Findings& findings;
  std::vector<Fix> edits{};

  void Put(const Instruction& i, std::uint32_t expression, double value) {
    if (!(std::fabs(value) <= kRealMax)) {  // NaN, too
      findings.Add(ErrorCode::kLiteralRange, program.At(i),
                   "a number would become larger than the control can hold", "OPT-7.62");
      return;
    }
    const NumberPlace place = PlaceOfNumber(program, program.module.FirstNode(expression));
    edits.push_back({place.offset, static_cast<int>(place.length),
                     TrimmedText(place.Written(value), kTransformDecimals)});
  }
};

Rewriting Finish(std::string_view text, std::vector<Fix> edits, Findings& findings) {
  Rewriting result;
  result.ok = findings.error_count() == 0;
  std::ranges::stable_sort(edits, {}, &Fix::byte_offset);
  if (result.ok) result.text = ApplyEdits(text, edits);
  result.diagnostics = findings.Take(text, {});
  result.diagnostics_dropped = findings.dropped();
  return result;
}

}  // namespace

motion::HeadAngles TurnHead(const motion::HeadAngles& old, const motion::Rotation& turn,
                            std::optional<double> swing) {
  const double about_z = std::atan2(turn(1, 0), turn(0, 0));
  const double to = old.a_rad + (swing ? *swing : kTieShare * about_z);
  const auto [one, twin, a_is_free] =
      motion::SolutionsOf(turn * motion::ToolDirection(old.a_rad, old.b_rad), to);
  if (a_is_free) return {old.a_rad + about_z, one.b_rad};
  if (swing) return std::abs(twin.a_rad - to) < std::abs(one.a_rad - to) ? twin : one;
  const motion::MachineVector axis = turn.col(2);
  if (motion::LengthOf(motion::PlanOf(axis)) < kAboutZ && axis.z() > 0.0)
    return old.b_rad < 0.0 ? twin : one;
  return motion::DistanceOf(twin, old) < motion::DistanceOf(one, old) ? twin : one;
}

Rewriting Transform(std::string_view text, const motion::RigidMotion& motion) {
  Findings findings;
  const ParsedProgram program = Parse(text, findings);
  NumberEdits edits{program, findings};
  const Module& module = program.module;
  ProgramFrame frame;
  const ProgramFrame machine;
  bool robot = false;
  std::optional<double> swing;  // of A, at the move before
  for (const Instruction& i : module.instructions) {
    if (i.op == Op::kCoord) robot = i.choice == static_cast<std::uint8_t>(CoordType::kRobot);
    if (i.op == Op::kSysdef && !frame.Set(program, i)) {
      findings.Add(ErrorCode::kTransformVariable, program.At(i),
                   "a rotation of SYSDEF is no plain number", "OPT-8.77");
    }
    if (i.op != Op::kMove) continue;
    for (std::uint32_t first = 0; first < (i.Has(kVia) ? 10U : 5U); first += 5) {
      std::array<std::optional<double>, 5> v;
      for (std::uint32_t n = 0; n < 5; ++n)
        v[n] = PlainNumber(program, i.first_expression + first + n);
      if (std::ranges::any_of(v, [](const auto& value) { return !value.has_value(); })) {
        findings.Add(ErrorCode::kTransformVariable, program.At(i),
                     "a coordinate is no plain number", "OPT-8.77");
        break;
      }
      const motion::ProgramVector point = motion * motion::ProgramVector(*v[0], *v[1], *v[2]);
      // The head refers to the machine, the motion to the coordinates of the MOVE: turn there and
      // back. SYSDEF does not act on ROBOT (OPT-7.33).
      const ProgramFrame& in = robot ? machine : frame;
      const motion::Rotation& turned = in.rotation();
      const motion::Rotation in_machine = turned * motion.linear() * turned.transpose();
      const motion::HeadAngles head = TurnHead({*v[3], *v[4]}, in_machine, swing);
      if (std::fabs(std::sin(*v[4])) > kNearlyDown && std::fabs(std::sin(head.b_rad)) > kNearlyDown)
        swing = head.a_rad - *v[3];
      const std::array<double, 5> values = {point.x(), point.y(), point.z(), head.a_rad,
                                            head.b_rad};
      for (std::uint32_t n = 0; n < 5; ++n) {
        edits.Put(i, i.first_expression + first + n, values[n]);
      }
    }
  }
  return Finish(text, std::move(edits.edits), findings);
}

Rewriting Shift(std::string_view text, const std::array<double, 6>& offset) {
  Findings findings;
  ParsedProgram program = Parse(text, findings);
  NumberEdits edits{program, findings};
  Findings names;  // whether the rest of the program is right does not matter here
  Check(program, names);
  bool found = false;
  for (const Instruction& i : program.module.instructions) {
    if (i.op != Op::kLet) continue;
    const ExprNode& target = program.module.Value(i, 0)[0];
    const int at = target.index - kFirstShiftVariable;
    if (target.op != Node::kVariable || target.group != VariableGroup::kVr || at < 0 || at > 5)
      continue;
    const std::optional<double> value = PlainNumber(program, i.first_expression + 1);
    if (!value) continue;
    found = true;
    const double shift = offset[static_cast<std::size_t>(at)];
    if (shift != 0.0) edits.Put(i, i.first_expression + 1, *value + shift);
  }
  if (!found && findings.error_count() == 0) {
    findings.Add(ErrorCode::kShiftNothing, {}, "no plain number is assigned to VR[86] to VR[91]",
                 "OPT-8.75");
  }
  return Finish(text, std::move(edits.edits), findings);
}

}  // namespace rmlcell::optimo
