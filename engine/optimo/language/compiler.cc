#include "engine/optimo/language/compiler.h"

#include <utility>

#include "engine/optimo/language/advice.h"
#include "engine/optimo/language/checker.h"
#include "engine/optimo/language/printer.h"
#include "engine/optimo/language/silence.h"
#include "engine/optimo/language/source_map.h"

namespace rmlcell::optimo {

Compilation Compile(std::string_view text, std::string_view file, const CompileOptions& options) {
  Compilation result;
  Findings findings(options.diagnostics_max);
  ParsedProgram program;
  if (options.inch) {
    findings.Add(ErrorCode::kSourceIsInch, {}, "convert the inch source to metric first",
                 "OPT-2.04");
  } else {
    program = Parse(text, findings, Places::kStatements);
    Check(program, findings);
    if (options.advice) Advise(program, options.start, findings);
    if (options.advice && options.further_advice && findings.error_count() == 0)
      options.further_advice(program, findings);
    if (findings.error_count() == 0) {
      result.object = EncodeObject(program.module);
      if (options.object_limit > 0 && result.object.size() > options.object_limit) {
        findings.Add(ErrorCode::kObjectTooLong, {},
                     "the object has " + ToldSize("bytes", result.object.size()) +
                         " bytes; at most " + ToldSize("limit", options.object_limit) +
                         " fit; split the program and CALL its parts",
                     "OPT-1.08");
        result.object.clear();
      }
    }
  }
  result.ok = findings.error_count() == 0;
  result.diagnostics = findings.Take(text, file);
  result.diagnostics_dropped = findings.dropped();
  std::vector<AllowedFinding> allowed =
      Silence(program,
              {.tell_idle = options.advice && result.ok && result.diagnostics_dropped.empty(),
               .with_contours = options.further_advice != nullptr,
               .file = file},
              result.diagnostics);
  if (options.source && result.ok) {
    result.step_lines = LinesOfSteps(program);
    result.allowed = std::move(allowed);
  }
  result.module = std::move(program.module);
  return result;
}

std::string Decompile(const Module& module) {
  std::string out;
  const auto lone = [&out](std::uint16_t label) { out += std::to_string(label) + '\n'; };
  for (const Instruction& instruction : module.instructions) {
    const auto labels = module.Labels(instruction);
    for (std::size_t l = 0; l + 1 < labels.size(); ++l) lone(labels[l]);
    PrintLabelColumns(labels.empty() ? kNoLabel : labels.back(), out);
    PrintStatement(module, instruction, out);
    out += '\n';
  }
  for (const std::uint16_t label : module.end_labels) lone(label);
  if (out.empty()) out = '\n';  // a file without a byte is refused as a program
  return out;
}

Result<std::string> ObjectToSource(std::string_view object) {
  const Result<Module> module = DecodeObject(object);
  if (!module) return module.error();
  return Decompile(*module);
}

}  // namespace rmlcell::optimo
