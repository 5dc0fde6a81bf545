#include "engine/optimo/offline/transform.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "engine/optimo/language/checker.h"
#include "engine/optimo/language/program.h"
#include "engine/optimo/offline/literal_text.h"
#include "engine/optimo/offline/offset_path.h"
#include "engine/optimo/offline/program_frame.h"
#include "engine/optimo/offline/text_edits.h"

namespace rmlcell::optimo {
namespace {

constexpr int kTransformDecimals = 6;
constexpr double kStraightDown = 1e-9;  // of sin B: then A is free
constexpr int kFirstShiftVariable = 86;

std::optional<double> Literal(const ParsedProgram& program, std::uint32_t expression) {
  const ExprRange range = program.module.Range(expression);
  const Node op = program.module.nodes[range.first].op;
  if (range.count != 1 || (op != Node::kInteger && op != Node::kReal) ||
      program.module.nodes[range.first].name != kNoName) {
    return std::nullopt;
  }
  const NodePlace& place = program.node_places[range.first];
  return LiteralValue(program.text.substr(place.offset, place.length));
}

Fix NumberEdit(const ParsedProgram& program, std::uint32_t expression, double value) {
  const NodePlace& place = program.node_places[program.module.FirstNode(expression)];
  return {place.offset, static_cast<int>(place.length), TrimmedText(value, kTransformDecimals)};
}

Rewriting Finish(std::string_view text, std::vector<Fix> edits, Findings& findings) {
  Rewriting result;
  result.ok = findings.error_count() == 0;
  std::ranges::stable_sort(edits, {}, &Fix::byte_offset);
  if (result.ok) result.text = ApplyEdits(text, edits);
  result.diagnostics = findings.Take(text, {});
  return result;
}

// The angle equal to `angle` by whole turns that is nearest to `old`.
double Nearest(double angle, double old) {
  return angle + kTurn * std::round((old - angle) / kTurn);
}

}  // namespace

RigidMotion RigidMotion::Of(const motion::Vec3& translation, double rz, double ry, double rx) {
  return {translation, RotationColumns(rz, ry, rx)};
}

motion::Vec3 RigidMotion::Turn(const motion::Vec3& d) const {
  return columns[0] * d.x + columns[1] * d.y + columns[2] * d.z;
}

RigidMotion RigidMotion::Inverse() const {
  RigidMotion inverse;
  inverse.columns = {motion::Vec3{columns[0].x, columns[1].x, columns[2].x},
                     motion::Vec3{columns[0].y, columns[1].y, columns[2].y},
                     motion::Vec3{columns[0].z, columns[1].z, columns[2].z}};
  inverse.translation = -inverse.Turn(translation);
  return inverse;
}

HeadAngles TurnHead(const HeadAngles& old, const RigidMotion& motion) {
  const motion::Vec3 u = motion.Turn(ToolDirection(old.a, old.b));
  const double across = std::hypot(u.x, u.y);
  const double b = std::atan2(across, u.z);
  if (across < kStraightDown) {
    return {old.a + std::atan2(motion.columns[0].y, motion.columns[0].x), b};
  }
  const double a = std::atan2(u.x, -u.y);
  const HeadAngles one{Nearest(a, old.a), b}, twin{Nearest(a + kPi, old.a), -b};
  const auto distance = [&](const HeadAngles& angles) {
    return std::fabs(angles.a - old.a) + std::fabs(angles.b - old.b);
  };
  return distance(twin) < distance(one) ? twin : one;
}

Rewriting Transform(std::string_view text, const RigidMotion& motion) {
  Findings findings;
  std::vector<Fix> edits;
  const ParsedProgram program = Parse(text, findings);
  const Module& module = program.module;
  ProgramFrame frame;
  for (const Instruction& i : module.instructions) {
    if (i.op == Op::kSysdef && !frame.Set(program, i)) {
      findings.Add(ErrorCode::kTransformVariable, program.At(i),
                   "a rotation of SYSDEF is no plain number", "OPT-8.77");
    }
    if (i.op != Op::kMove) continue;
    for (std::uint32_t first = 0; first < (i.Has(kVia) ? 10U : 5U); first += 5) {
      std::array<std::optional<double>, 5> v;
      for (std::uint32_t n = 0; n < 5; ++n) v[n] = Literal(program, i.first_expression + first + n);
      if (std::ranges::any_of(v, [](const auto& value) { return !value.has_value(); })) {
        findings.Add(ErrorCode::kTransformVariable, program.At(i),
                     "a coordinate is no plain number", "OPT-8.77");
        break;
      }
      const motion::Vec3 point = motion.Move({*v[0], *v[1], *v[2]});
      // The head refers to the machine, the motion to the program's coordinates: turn there and
      // back.
      RigidMotion in_machine;
      for (std::size_t c = 0; c < 3; ++c) {
        const motion::Vec3 axis = c == 0   ? motion::Vec3{1, 0, 0}
                                  : c == 1 ? motion::Vec3{0, 1, 0}
                                           : motion::Vec3{0, 0, 1};
        in_machine.columns[c] =
            frame.DirectionToMachine(motion.Turn(frame.DirectionToProgram(axis)));
      }
      const HeadAngles head = TurnHead({*v[3], *v[4]}, in_machine);
      const std::array<double, 5> values = {point.x, point.y, point.z, head.a, head.b};
      for (std::uint32_t n = 0; n < 5; ++n) {
        edits.push_back(NumberEdit(program, i.first_expression + first + n, values[n]));
      }
    }
  }
  return Finish(text, std::move(edits), findings);
}

Rewriting Shift(std::string_view text, const std::array<double, 6>& offset) {
  Findings findings;
  std::vector<Fix> edits;
  ParsedProgram program = Parse(text, findings);
  Findings names;  // whether the rest of the program is right does not matter here
  Check(program, names);
  bool found = false;
  for (const Instruction& i : program.module.instructions) {
    if (i.op != Op::kLet) continue;
    const ExprNode& target = program.module.Value(i, 0)[0];
    const int at = target.index - kFirstShiftVariable;
    if (target.op != Node::kVariable || target.group != VariableGroup::kVr || at < 0 || at > 5)
      continue;
    const std::optional<double> value = Literal(program, i.first_expression + 1);
    if (!value) continue;
    found = true;
    const double shift = offset[static_cast<std::size_t>(at)];
    if (shift != 0.0) edits.push_back(NumberEdit(program, i.first_expression + 1, *value + shift));
  }
  if (!found && findings.error_count() == 0) {
    findings.Add(ErrorCode::kShiftNothing, {}, "no plain number is assigned to VR[86] to VR[91]",
                 "OPT-8.75");
  }
  return Finish(text, std::move(edits), findings);
}

}  // namespace rmlcell::optimo
