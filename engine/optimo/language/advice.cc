#include "engine/optimo/language/advice.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/optimo/language/constant_advice.h"
#include "engine/optimo/language/flow_advice.h"
#include "engine/optimo/language/units_of_variables.h"

namespace rmlcell::optimo {
namespace {

// OPT-7.104, OPT-7.105: variables of Amada's programs and of the system.
bool IsReserved(Variable v) {
  switch (v.group) {
    case VariableGroup::kVr:
      return (v.index >= 43 && v.index <= 59) || v.index >= 98;
    case VariableGroup::kVi:
      return v.index >= 70;
    case VariableGroup::kVl:
      return v.index >= 80;
    default:
      return false;
  }
}

// OPT-7.106: outputs that a part program may switch are gas 8 and 9, sensor 11, 16 and those
// above 31.
bool IsSystemOutput(int index) {
  return index <= 31 && index != 8 && index != 9 && index != 11 && index != 16;
}

class Adviser {
 public:
  Adviser(const ParsedProgram& program, Findings& findings)
      : program_(program), module_(program.module), findings_(findings) {}

  void Run() {
    for (const Instruction& i : module_.instructions) {
      switch (i.op) {
        case Op::kLet:
          AdviseTarget(i, 1);
          break;
        case Op::kAssign:
          if (i.numbers[0] <= kAssignWidthMax) AdviseTarget(i, i.numbers[0]);  // else an error
          break;
        case Op::kSysdef:
          AdviseSysdef(i);
          break;
        case Op::kTcp:
          AdviseTcp(i);
          break;
        case Op::kFunction:
          AdviseRotaryTable(i);
          break;
        case Op::kTask:
          if (i.numbers[0] == 1 && std::exchange(entry_seen_, true)) {
            findings_.AddAs(Severity::kWarning, ErrorCode::kPracticeAdvice, program_.At(i),
                            "TASK 1 stands above already, and the program begins there",
                            "OPT-9.12");
          }
          break;
        default:
          break;
      }
    }
  }

 private:
  void Warn(const Instruction& i, ErrorCode code, Detail detail, std::string_view rule) {
    findings_.Add(code, program_.At(i), std::move(detail), rule);
  }

  void AdviseTarget(const Instruction& i, int width) {
    const ExprNode& target = module_.Value(i, 0)[0];
    if (target.op != Node::kVariable || IsReadOnly(target.variable()) || !HasIndex(target)) return;
    for (int index = target.index; index < std::min(target.index + width, kVariableIndexMax + 1);
         ++index) {
      if (!IsReserved({target.group, static_cast<std::uint8_t>(index)})) continue;
      Warn(i, ErrorCode::kReservedVariable,
           ToldVariable({target.group, static_cast<std::uint8_t>(index)}) +
               " belongs to Amada's programs or to the system",
           target.group == VariableGroup::kVr ? "OPT-7.104" : "OPT-7.105");
      break;
    }
    if (target.group != VariableGroup::kOl) return;
    for (int output = target.index; output < target.index + width; ++output) {
      if (!IsSystemOutput(output)) continue;
      Warn(i, ErrorCode::kSystemOutput,
           "OL[" + Told("output", output) + "] is used by the system" +
               (output == 2 ? ", except on an EFA-51 laser" : ""),
           "OPT-7.106");
      return;
    }
  }

  // A name that is no index has an error of its own, and no variable is known.
  bool HasIndex(const ExprNode& variable) const {
    if (variable.index_name == kNoName) return true;
    const DeclaredName& name = module_.names[variable.index_name];
    return name.declared && name.value.op == Node::kInteger && name.value.number == variable.index;
  }

  // The value of a literal or constant; nothing when it is computed.
  std::optional<double> Known(const Instruction& i, int position) const {
    const Expression value = module_.Value(i, position);
    if (value.size() != 1 || value[0].op == Node::kVariable || value[0].op == Node::kName)
      return std::nullopt;
    return static_cast<double>(value[0].number);
  }

  void AdviseSysdef(const Instruction& i) {
    if (i.value_count == 0) return;
    for (int v = 0; v < 6; ++v) {
      if (Known(i, v) != 0.0) return;
    }
    const Place at = program_.At(i);
    const std::string_view statement = program_.text.substr(static_cast<std::size_t>(at.offset),
                                                            static_cast<std::size_t>(at.length));
    std::vector<Fix> fixes;
    // Over several lines there may be comments in it, which no fix takes away.
    if (statement.find('\n') == std::string_view::npos)
      fixes.push_back({at.offset, at.length, "SYSDEF"});
    findings_.Add(ErrorCode::kSysdefAllZero, at,
                  "SYSDEF with six zeros; SYSDEF alone cancels the offset", "OPT-7.37",
                  std::move(fixes));
  }

  void AdviseTcp(const Instruction& i) {
    std::optional<double> v[6];
    for (int p = 0; p < 6; ++p) {
      v[p] = Known(i, p);
      if (!v[p]) return;
    }
    const bool equal_xy = v[0] == v[3] && v[1] == v[4];
    if (*v[0] != 0.0 || *v[1] != 0.0 || *v[3] != 0.0 || *v[4] != 0.0) {
      Warn(i, ErrorCode::kTcpOffAxis, "X and Y of TCP are zero on the Optimo", "OPT-4.70");
    }
    if (equal_xy && v[2] == v[5])
      Warn(i, ErrorCode::kTcpAxisUndefined, "both points of TCP are equal", "OPT-4.71");
    if (*v[2] < *v[5])
      Warn(i, ErrorCode::kTcpReversed, "Z0 is below Z1: jog directions are reversed", "OPT-4.55");
  }

  // CONVERT would have changed the numbers that are assigned to a variable with a unit. OPT-8.78
  void AdviseRotaryTable(const Instruction& i) {
    if (i.numbers[0] != 99) return;
    for (int v = 1; v < i.value_count; ++v) {
      for (const ExprNode& node : module_.Value(i, v)) {
        if (node.op != Node::kVariable || UnitOf(node.variable()) == Unit::kNone) continue;
        Warn(i, ErrorCode::kPracticeAdvice,
             "FUNCTION 99 takes degrees; use a variable without unit, VR[26] to VR[42]",
             "OPT-8.78");
        return;
      }
    }
  }

  const ParsedProgram& program_;
  const Module& module_;
  Findings& findings_;
  bool entry_seen_ = false;  // TASK 1
};

}  // namespace

void Advise(const ParsedProgram& program, const StartModes& start, Findings& findings) {
  Adviser(program, findings).Run();
  if (findings.error_count() == 0) AdviseOnConstants(program, findings);
  AdviseOnFlow(program, start, findings);
}

}  // namespace rmlcell::optimo
