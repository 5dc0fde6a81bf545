#include "engine/optimo/control/break_condition.h"

#include <string>
#include <utility>

#include "engine/optimo/language/compiler.h"

namespace rmlcell::optimo {

// The compiler knows programs: one of which only the condition is ever looked at.
Result<Condition> ReadCondition(std::string_view text) {
  const auto refuse = [text](const Detail& why) {
    return Error{ErrorCode::kCellInvalidArgument,
                 "the condition '" + Told("condition", text) + "' is none: " + why,
                 {}};
  };
  if (text.find_first_of(";\r\n") != std::string_view::npos)
    return refuse("it is one expression, in one line");
  const std::string program = "IF " + std::string(text) + " THEN 10\n10 ENDTASK\n";
  Compilation compiled = Compile(program, "condition", {.advice = false});
  if (!compiled.ok) {
    for (const Diagnostic& finding : compiled.diagnostics) {
      if (IsError(finding.severity)) return refuse(Said(finding.code, finding.detail));
    }
    return refuse("it cannot be read");
  }
  const Instruction& branch = compiled.module.instructions.front();
  if (branch.op != Op::kIf || compiled.module.instructions.size() != 2)
    return refuse("it is one expression");
  const Expression expression = compiled.module.Value(branch, 0);
  Condition condition;
  condition.expression = {
      .first = static_cast<std::uint32_t>(expression.data() - compiled.module.nodes.data()),
      .count = static_cast<std::uint32_t>(expression.size())};
  Executable holder;
  holder.modules.push_back({.module = std::move(compiled.module)});
  condition.program = Load(std::move(holder));
  return condition;
}

}  // namespace rmlcell::optimo
