#include "engine/optimo/language/checker.h"

#include <bitset>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "engine/optimo/language/fixes.h"
#include "engine/optimo/language/typing.h"

namespace rmlcell::optimo {
namespace {

struct Range {
  double min, max;
  std::string_view text;
  std::string_view rule;
  bool above_min = false;  // the minimum itself is outside
};
constexpr double kNoMax = std::numeric_limits<double>::infinity();
constexpr Range kPercent{0.0, 100.0, "0 to 100", "OPT-2.35"};
constexpr Range kSpeedAbove0{0.0, 100.0, "above 0 to 100", "OPT-3.08", true};
constexpr Range kSeconds{0.0, kNoMax, "0 or more seconds", "OPT-3.45"};
constexpr Range kProgram{1.0, 99.0, "1 to 99", "OPT-7.06"};
constexpr Range kErrorNumber{1.0, 9999.0, "1 to 9999", "OPT-3.61"};

class Checker {
 public:
  // `program` may be null: then findings have no place.
  Checker(Module& module, ParsedProgram* program, Findings& findings)
      : module_(module),
        program_(program),
        findings_(findings),
        typing_(module, program, findings) {}

  void Run() {
    std::uint32_t step = 0;
    for (Instruction& instruction : module_.instructions) {
      const bool counts = instruction.op != Op::kDeclare && !IsBrokenDeclare(instruction);
      instruction.step = counts ? ++step : 0;
      if (instruction.op == Op::kInvalid) continue;
      typing_.BeginStep(instruction);
      const std::uint64_t errors = findings_.error_count();
      CheckInstruction(instruction);
      if (program_ != nullptr && findings_.error_count() != errors) MarkFaulty(instruction);
      instruction.reads_machine = typing_.reads_machine();
    }
    module_.step_count = step;
    CheckLabels();
  }

 private:
  // A DECLARE that could not be parsed is no step either; the parser gave it none.
  bool IsBrokenDeclare(const Instruction& i) const { return i.op == Op::kInvalid && i.step == 0; }
  void MarkFaulty(const Instruction& i) {
    program_->faulty.push_back(static_cast<std::uint32_t>(&i - module_.instructions.data()));
  }

  void CheckInstruction(Instruction& i);
  void CheckWorkdef(const Instruction& i);
  void CheckAssign(const Instruction& i);
  void CheckFunction(Instruction& i);
  void CheckLet(const Instruction& i);
  void CheckAttributes(const Instruction& i);
  void CheckLabels();

  bool Numeric(const Instruction& i, int position) {
    return typing_.Type(i.first_expression + static_cast<std::uint32_t>(position),
                        Wanted::kNumeric);
  }
  void AllNumeric(const Instruction& i) {
    for (int v = 0; v < i.value_count; ++v) Numeric(i, v);
  }
  void Arguments(const Instruction& i) {
    for (std::uint32_t v = 1; v < i.value_count; ++v)
      typing_.Type(i.first_expression + v, Wanted::kAny);
  }
  void InRange(const Instruction& i, int position, const Range& range,
               ErrorCode code = ErrorCode::kLiteralRange) {
    if (Numeric(i, position))
      LiteralInRange(i.first_expression + static_cast<std::uint32_t>(position), range, code);
  }
  // A literal, or the name of one; computed values are the control's business (OPT-B.36).
  bool LiteralInRange(std::uint32_t expression, const Range& range, ErrorCode code) {
    const Expression nodes = module_.expression(expression);
    if (nodes.size() != 1 || nodes[0].op == Node::kVariable) return true;
    const auto value = static_cast<double>(nodes[0].number);
    const bool above = range.above_min ? value > range.min : value >= range.min;
    if (above && value <= range.max) return true;
    findings_.Add(code, typing_.PlaceOfNode(module_.FirstNode(expression)),
                  "the value must be " + Told("allowed", range.text), range.rule);
    return false;
  }
  void Warn(ErrorCode code, Detail detail, std::string_view rule) {
    findings_.Add(code, typing_.PlaceOfStatement(), std::move(detail), rule);
  }

  Module& module_;
  ParsedProgram* program_;
  Findings& findings_;
  Typing typing_;
};

void Checker::CheckInstruction(Instruction& i) {
  switch (i.op) {
    case Op::kMove:
    case Op::kSysdef:
    case Op::kTcp:
    case Op::kGotoTable:
      AllNumeric(i);
      break;
    case Op::kPath:
      if (i.value_count > 0) Numeric(i, 0);
      break;
    case Op::kSpeed:
    case Op::kAccel:
    case Op::kOversh:
      InRange(i, 0, kPercent);
      break;
    case Op::kDelay:
      InRange(i, 0, kSeconds);
      break;
    case Op::kSeterr:
      InRange(i, 0, kErrorNumber);
      break;
    case Op::kTimer:
      if (i.value_count > 0) InRange(i, 0, kSeconds);
      break;
    case Op::kIf:
    case Op::kWait:
      typing_.Type(i.first_expression, Wanted::kAny);
      break;
    case Op::kWorkdef:
      CheckWorkdef(i);
      break;
    case Op::kGo:
      InRange(i, 0, kProgram);
      break;
    case Op::kCall:
      InRange(i, 0, kProgram);
      Arguments(i);
      break;
    case Op::kFunction:
      CheckFunction(i);
      break;
    case Op::kLet:
      CheckLet(i);
      break;
    case Op::kAssign:
      CheckAssign(i);
      break;
    case Op::kDeclare:
      typing_.Declare(i);
      break;
    case Op::kDefine:
      typing_.Define(i);
      break;
    case Op::kTask:
      if (i.numbers[0] != 1) Warn(ErrorCode::kWordIgnored, "only TASK 1 has a meaning", "OPT-W.44");
      break;
    case Op::kIgnored: {
      const std::string& text = module_.texts[i.name];
      Warn(ErrorCode::kWordIgnored, Told("word", text.substr(0, text.find(' '))) + " has no effect",
           "OPT-E.7023");
      break;
    }
    default:
      break;
  }
  CheckAttributes(i);
}

// OPT-3.06, OPT-3.08
void Checker::CheckWorkdef(const Instruction& i) {
  // REAL numbers are truncated (OPT-3.07): all below 64 are good.
  constexpr Range kSchedule{1.0, 0x1.fffffep5, "1 to 63", "OPT-3.06"};
  if (i.numbers[0] == 1) {
    InRange(i, 0, kSpeedAbove0);
    InRange(i, 1, {0.0, 100.0, "0 to 100", "OPT-3.08"});
    InRange(i, 2, {0.0, kNoMax, "0 or more seconds", "OPT-3.08"});
    InRange(i, 3, {0.0, 100.0, "0 to 100", "OPT-3.08"});
    if (i.value_count == 5) InRange(i, 4, kSchedule, ErrorCode::kScheduleRange);
  } else if (i.numbers[0] == 2) {
    InRange(i, 0, kSchedule, ErrorCode::kScheduleRange);
  }
}

// A number or the name of one. OPT-9.01
void Checker::CheckFunction(Instruction& i) {
  const bool typed = Numeric(i, 0);
  Arguments(i);
  if (!typed) return;
  const Expression number = module_.Value(i, 0);
  if (number[0].op != Node::kInteger) {
    findings_.Add(ErrorCode::kFunctionNumber,
                  typing_.PlaceOfNode(module_.FirstNode(i.first_expression)),
                  "FUNCTION takes a number or a declared constant", "OPT-9.01");
    return;
  }
  if (LiteralInRange(i.first_expression, {1.0, 99.0, "1 to 99", "OPT-9.01"},
                     ErrorCode::kLiteralRange)) {
    i.numbers[0] = static_cast<std::uint16_t>(number[0].number);
  }
}

// OPT-7.92, OPT-7.93
void Checker::CheckLet(const Instruction& i) {
  const bool known = typing_.ResolveTarget(i.first_expression);
  const ValueType type = module_.Value(i, 0)[0].type;
  const Wanted wanted = !known                        ? Wanted::kAny
                        : type == ValueType::kLogical ? Wanted::kLogical
                                                      : Wanted::kNumeric;
  typing_.Type(i.first_expression + 1, wanted);
}

// OPT-7.102, OPT-7.103
void Checker::CheckAssign(const Instruction& i) {
  const bool known = typing_.ResolveTarget(i.first_expression);
  const bool typed = Numeric(i, 1);
  const int width = i.numbers[0];
  if (width < 1 || width > kAssignWidthMax) {
    return Warn(ErrorCode::kLiteralRange, "ASSIGN writes 1 to 16 places", "OPT-7.102");
  }
  const std::size_t value_at = module_.FirstNode(i.first_expression + 1);
  const float value = module_.nodes[value_at].number;  // of a variable 0
  if (typed && (value < 0.0F || value >= static_cast<float>(1 << width))) {
    findings_.AddAs(Severity::kCompile, ErrorCode::kAssignGroup, typing_.PlaceOfNode(value_at),
                    "the value does not fit into " + Told("places", width) + " places",
                    "OPT-7.103");
  }
  if (!known) return;
  const ExprNode& target = module_.Value(i, 0)[0];
  if (target.type != ValueType::kLogical) {
    findings_.Add(ErrorCode::kTypeMismatch,
                  typing_.PlaceOfNode(module_.FirstNode(i.first_expression)),
                  "ASSIGN writes logical outputs or variables", "OPT-7.102");
  } else if (target.index + width - 1 >
             (target.group == VariableGroup::kPar ? kParameterCount - 1 : kVariableIndexMax)) {
    findings_.AddAs(Severity::kCompile, ErrorCode::kAssignGroup, typing_.PlaceOfStatement(),
                    "the group runs past the last index", "OPT-7.103");
  }
}

void Checker::CheckAttributes(const Instruction& i) {
  if (i.attributes == 0) return;
  std::uint32_t at = i.first_expression + i.value_count;
  if (i.Has(kVia)) {
    for (int v = 0; v < 5; ++v) typing_.Type(at++, Wanted::kNumeric);
  }
  if (i.Has(kStart)) typing_.Type(at++, Wanted::kAny);
  if (i.Has(kEnd)) typing_.Type(at++, Wanted::kAny);
  if (i.Has(kTime)) {
    if (typing_.Type(at, Wanted::kNumeric)) {
      LiteralInRange(at, {0.0, kNoMax, "0 or more seconds", "OPT-2.54"}, ErrorCode::kLiteralRange);
    }
    if (i.op == Op::kWork) Warn(ErrorCode::kWordIgnored, "/TIME of WORK has no effect", "OPT-3.38");
  }
  if (!i.Has(kInf)) return;
  std::vector<Fix> fixes;
  if (program_ != nullptr) {
    if (const auto fix = AttributeRemoval(*program_, i, Word::kInf)) fixes.push_back(*fix);
  }
  findings_.Add(ErrorCode::kWordIgnored, typing_.PlaceOfStatement(), "/INF has no effect",
                "OPT-2.61", std::move(fixes));
}

// Jumps to nowhere are errors only when they are taken. OPT-7.16
void Checker::CheckLabels() {
  std::bitset<10000> known;
  for (const std::uint16_t label : module_.labels) known.set(label);
  for (const std::uint16_t label : module_.end_labels) known.set(label);
  std::vector<std::uint16_t> missing;
  for (const Instruction& i : module_.instructions) {
    const auto targets = std::span(module_.targets).subspan(i.first_target, i.target_count);
    for (const std::uint16_t label : targets) {
      if (known.test(label)) continue;
      known.set(label);  // once for an instruction
      missing.push_back(label);
      typing_.BeginStep(i);
      Warn(ErrorCode::kLabelMissing, "no sequence number " + Told("label", label), "OPT-7.16");
    }
    for (const std::uint16_t label : missing) known.reset(label);
    missing.clear();
  }
}

}  // namespace

void Check(ParsedProgram& program, Findings& findings) {
  Checker(program.module, &program, findings).Run();
}

void CheckModule(Module& module, Findings& findings) { Checker(module, nullptr, findings).Run(); }

}  // namespace rmlcell::optimo
