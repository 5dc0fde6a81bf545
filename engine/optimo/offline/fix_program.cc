#include "engine/optimo/offline/fix_program.h"

#include <algorithm>
#include <utility>

#include "engine/core/text_fixes.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/offline/translate.h"

namespace rmlcell::optimo {
namespace {

// Each round repairs all that do not touch each other, of the first thousand findings: a text that
// needs more was not written by hand.
constexpr int kRoundsMax = 64;

std::size_t ErrorCount(const machine::Translation& translation) {
  return static_cast<std::size_t>(std::ranges::count_if(
      translation.diagnostics, [](const Diagnostic& found) { return IsError(found.severity); }));
}

// A name that nobody declared may follow from another error: it is put right when no other is left.
bool IsUnknownName(const Diagnostic& found) {
  return found.code == ErrorCode::kNameUndeclared && found.rule == "OPT-7.50";
}

bool OnlyNamesAreWrong(const machine::Translation& translation) {
  if (!translation.diagnostics_dropped.empty()) return false;
  return std::ranges::all_of(translation.diagnostics, [](const Diagnostic& found) {
    return !IsError(found.severity) || IsUnknownName(found);
  });
}

std::vector<Diagnostic> WithoutNames(std::vector<Diagnostic> found) {
  for (Diagnostic& one : found) {
    if (IsUnknownName(one)) one.fixes.clear();
  }
  return found;
}

// Advice on an inch source would take its numbers for millimetres.
machine::Translation CheckForm(const machine::SourceFile& file) {
  Compilation compiled = Compile(file.bytes, file.name, {.object_limit = 0, .advice = false});
  machine::Translation form;
  form.diagnostics = std::move(compiled.diagnostics);
  form.diagnostics_dropped = compiled.diagnostics_dropped;
  return form;
}

}  // namespace

RepairedText FixProgram(const machine::SourceFile& file, const ProgramCheck& check) {
  const bool inch = FormOfFile(file.name, file.bytes) == FileForm::kInchSource;
  const ProgramCheck look = inch ? ProgramCheck(CheckForm) : check;
  RepairedText fixing{.text = std::string(file.bytes), .fixed = {}, .left = {}};
  fixing.left = look({file.name, fixing.text});
  for (int round = 0; round < kRoundsMax; ++round) {
    std::vector<Diagnostic> found = WithoutNames(fixing.left.diagnostics);
    std::vector<std::size_t> chosen = RepairableFindings(fixing.text, found);
    const bool names = chosen.empty() && OnlyNamesAreWrong(fixing.left);
    if (names) {
      found = fixing.left.diagnostics;
      chosen = RepairableFindings(fixing.text, found);
    }
    std::string text = ApplyFixes(fixing.text, found);
    if (text == fixing.text) break;
    machine::Translation after = look({file.name, text});
    if (ErrorCount(after) > ErrorCount(fixing.left)) break;
    if (names && !OnlyNamesAreWrong(after)) break;  // they were other names
    for (const std::size_t d : chosen) fixing.fixed.push_back(found[d]);
    fixing.text = std::move(text);
    fixing.left = std::move(after);
  }
  if (inch) fixing.left = check({file.name, fixing.text});
  return fixing;
}

Status CheckIsText(std::string_view name, std::string_view bytes) {
  if (FormOfFile(name, bytes) == FileForm::kObject) {
    return Error{ErrorCode::kCellBadText, Told("file", name) + " is an object, not a source", {}};
  }
  // Comments may hold any other byte.
  const std::size_t zero = bytes.find('\0');
  if (zero == std::string_view::npos) return {};
  return Error{ErrorCode::kCellBadText,
               Told("file", name) + " is no text: byte " + Told("byte", zero) + " is zero",
               {}};
}

}  // namespace rmlcell::optimo
