// Runs every program of tests/conformance/optimo/*.S through the compiler. A file holds several
// programs:
//
//   ;=== what it shows            begins a program; "(advice)" at the end: with advice
//   ; OPT-1.19 OPT-1.20           the rules that its expectations come from
//   SPEED 20 slow   ; expect 7003 the findings of this line, by number, and no others
//   ; expect-end 7002             findings at the end of the program's text
//
// A program without errors must also survive decompiling and formatting.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/formatter.h"

namespace rmlcell::optimo {
namespace {

struct PartProgram {
  std::string title;
  bool advice = false;
  std::string text;
  std::map<int, std::vector<int>> expected;  // by line of the program
  std::vector<int> expected_at_end;
};

std::vector<int> NumbersBehind(const std::string& line, const std::string& mark) {
  std::vector<int> numbers;
  const std::size_t at = line.find(mark);
  if (at == std::string::npos) return numbers;
  std::istringstream in(line.substr(at + mark.size()));
  for (int number = 0; in >> number;) numbers.push_back(number);
  return numbers;
}

std::vector<PartProgram> ReadPrograms(const std::filesystem::path& path) {
  std::vector<PartProgram> programs;
  std::ifstream file(path);
  int line_number = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(";=== ")) {
      PartProgram& program = programs.emplace_back();
      program.title = line.substr(5);
      program.advice = line.ends_with("(advice)");
      line_number = 0;
      continue;
    }
    if (programs.empty()) continue;
    PartProgram& program = programs.back();
    ++line_number;
    for (const int number : NumbersBehind(line, "expect-end "))
      program.expected_at_end.push_back(number);
    if (const auto numbers = NumbersBehind(line, "expect "); !numbers.empty())
      program.expected[line_number] = numbers;
    program.text += line + "\n";
  }
  return programs;
}

std::string Describe(const std::vector<Diagnostic>& diagnostics, const std::string& text) {
  std::string out;
  for (const Diagnostic& d : diagnostics) out += FormatDiagnostic(d, text) + "\n";
  return out;
}

// The rule is an ID and the text is none; the numbers and words in the text have names of letters.
void ExpectWellTold(const Diagnostic& d) {
  EXPECT_TRUE(d.rule.empty() || d.rule.starts_with("OPT-")) << d.rule;
  EXPECT_FALSE(d.detail.starts_with("OPT-")) << d.detail;
  for (const Argument& argument : d.detail.arguments()) {
    EXPECT_TRUE(std::ranges::all_of(argument.name, [](char c) {
      return (c >= 'a' && c <= 'z') || c == '_';
    })) << argument.name;
  }
}

void ExpectFindings(const PartProgram& program) {
  const Compilation compiled = Compile(program.text, "", {.advice = program.advice});
  const int lines = static_cast<int>(std::count(program.text.begin(), program.text.end(), '\n'));
  std::map<int, std::vector<int>> found;
  std::vector<int> found_at_end;
  for (const Diagnostic& d : compiled.diagnostics) {
    const int number = Lookup(d.code).number;
    const bool at_end = !program.expected_at_end.empty() && d.code == ErrorCode::kUnexpectedEnd;
    (at_end ? found_at_end : found[d.where.line]).push_back(number);
    EXPECT_GE(d.where.line, 1);
    EXPECT_LE(d.where.line, lines + 1);
    EXPECT_GE(d.where.column, 1);
    ExpectWellTold(d);
  }
  std::map<int, std::vector<int>> expected = program.expected;
  for (auto* map : {&expected, &found}) {
    for (auto& [line, numbers] : *map) std::ranges::sort(numbers);
  }
  EXPECT_EQ(found, expected) << Describe(compiled.diagnostics, program.text);
  EXPECT_EQ(found_at_end, program.expected_at_end);
  if (!compiled.ok) return;

  const Result<std::string> source = ObjectToSource(compiled.object);
  ASSERT_TRUE(source) << source.error().detail;
  const Compilation again = Compile(*source, "", {.advice = false});
  EXPECT_EQ(again.object, compiled.object) << *source;
  EXPECT_EQ(Decompile(again.module), *source);
  const std::string formatted = Format(program.text).text;
  EXPECT_EQ(Compile(formatted, "", {}).object, compiled.object) << formatted;
  EXPECT_EQ(Format(formatted).text, formatted);
}

TEST(OptimoPrograms, FindingsAreThoseOnTheLines) {
  const std::filesystem::path folder =
      std::filesystem::path(RMLCELL_SOURCE_DIR) / "tests/conformance/optimo";
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".S") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  std::size_t count = 0;
  for (const auto& file : files) {
    for (const PartProgram& program : ReadPrograms(file)) {
      SCOPED_TRACE(file.filename().string() + ": " + program.title);
      ExpectFindings(program);
      ++count;
    }
  }
  EXPECT_GE(count, 80U);
}

}  // namespace
}  // namespace rmlcell::optimo
