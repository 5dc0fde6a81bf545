#include "engine/optimo/language/silence.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <string>
#include <utility>

namespace rmlcell::optimo {
namespace {

constexpr std::string_view kMark = "rmlcell:";
constexpr std::string_view kWholeFile = "in file";

// The numbers of one directive; empty when the comment is none.
struct Directive {
  std::vector<int> numbers;
  bool whole_file = false;
};

Directive ReadDirective(std::string_view comment) {
  Directive directive;
  std::size_t at = comment.find_first_not_of(" \t;");
  if (at == std::string_view::npos || comment.substr(at, kMark.size()) != kMark) return directive;
  at = comment.find_first_not_of(" \t", at + kMark.size());
  constexpr std::string_view kAllow = "allow";
  if (at == std::string_view::npos || comment.substr(at, kAllow.size()) != kAllow) return directive;
  const std::string_view rest = comment.substr(at + kAllow.size());
  directive.whole_file = rest.find(kWholeFile) != std::string_view::npos;
  int number = 0;
  for (const char c : rest) {  // up to the first word
    if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
      number = std::min(number * 10 + (c - '0'), 100'000);
      continue;
    }
    if (number > 0) directive.numbers.push_back(number);
    number = 0;
    if (c != ' ' && c != '\t' && c != ',') break;
  }
  if (number > 0) directive.numbers.push_back(number);
  return directive;
}

}  // namespace

void Silence(const ParsedProgram& program, std::vector<Diagnostic>& diagnostics) {
  std::set<int> everywhere;
  std::set<std::pair<int, int>> allowed;  // line, number
  int line = 1;
  std::size_t line_begin = 0;
  std::size_t statement = 0;
  const auto line_of = [&](std::size_t offset) {
    for (std::size_t end; (end = program.text.find('\n', line_begin)) < offset;
         line_begin = end + 1)
      ++line;
    return line;
  };
  for (const Comment& comment : program.comments) {
    const std::string_view text = program.text.substr(comment.begin, comment.end - comment.begin);
    if (text.find(kMark) == std::string_view::npos) continue;
    const Directive directive = ReadDirective(text);
    if (directive.whole_file) everywhere.insert(directive.numbers.begin(), directive.numbers.end());
    int target = line_of(comment.begin);
    const std::string_view before = program.text.substr(line_begin, comment.begin - line_begin);
    if (before.find_first_not_of(" \t") == std::string_view::npos) {
      while (statement < program.statements.size() &&
             program.statements[statement].begin < comment.begin)
        ++statement;
      if (statement == program.statements.size()) continue;
      target = line_of(program.statements[statement].begin);
    }
    for (const int number : directive.numbers) allowed.insert({target, number});
  }
  if (everywhere.empty() && allowed.empty()) return;
  std::erase_if(diagnostics, [&](const Diagnostic& d) {
    const int number = Lookup(d.code).number;
    return !IsError(d.severity) &&
           (everywhere.contains(number) || allowed.contains({d.where.line, number}));
  });
}

}  // namespace rmlcell::optimo
