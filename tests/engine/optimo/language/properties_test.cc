// Properties over random valid programs; a failure names the seed that replays it.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <utility>

#include "engine/optimo/language/formatter.h"
#include "engine/optimo/language/printer.h"
#include "tests/engine/optimo/language/compile_text.h"
#include "tests/engine/optimo/language/random_program.h"

namespace rmlcell::optimo {
namespace {

constexpr std::uint32_t kProgramSeeds = 400;

void DumpExpression(const Module& module, Expression expression, std::ostream& out) {
  const auto name = [&](std::uint16_t n) {
    return n == kNoName ? NameKey{0} : module.names.at(n).key;
  };
  for (const ExprNode& node : expression) {
    out << ' ' << static_cast<int>(node.op) << ':' << static_cast<int>(node.group) << ':'
        << static_cast<int>(node.index) << ':' << name(node.name) << ':' << name(node.index_name)
        << ':' << std::hexfloat << node.number;
  }
  out << ';';
}

// All that a tree holds, one instruction a line, written without the printer. Names by what they
// are called: their numbers depend on the order of the text.
std::string Dump(const Module& module) {
  std::ostringstream out;
  for (const Instruction& i : module.instructions) {
    for (const std::uint16_t label : module.Labels(i)) out << label << ' ';
    out << static_cast<int>(i.op) << ' ' << static_cast<int>(i.choice) << ' ' << i.attributes << ' '
        << i.numbers[0] << ' ' << i.numbers[1] << ' ' << i.step;
    if (i.op == Op::kDeclare) out << ' ' << module.names.at(i.name).key;
    if (i.op == Op::kIgnored) out << ' ' << module.texts.at(i.name);
    for (std::uint16_t t = 0; t < i.target_count; ++t)
      out << " >" << module.targets.at(i.first_target + t);
    for (std::uint32_t e = 0; e < module.ExpressionCount(i); ++e)
      DumpExpression(module, module.expression(i.first_expression + e), out);
    out << '\n';
  }
  for (const std::uint16_t label : module.end_labels) out << label << ' ';
  return out.str();
}

Module ParseGood(const std::string& text) {
  Findings findings;
  ParsedProgram program = Parse(text, findings);
  EXPECT_EQ(findings.error_count(), 0U) << text;
  return std::move(program.module);
}

// OPT-1.05, OPT-1.06, OPT-B.69
TEST(Properties, CompileDecompileCompileIsIdentity) {
  for (std::uint32_t seed = 1; seed <= kProgramSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::string text = RandomProgram(seed).Make(40);
    const Compilation compiled = MustCompile(text);
    ASSERT_TRUE(compiled.ok) << text;
    const Result<std::string> source = ObjectToSource(compiled.object);
    ASSERT_TRUE(source) << source.error().detail;
    const Compilation again = MustCompile(*source);
    ASSERT_EQ(again.object, compiled.object) << *source;
    ASSERT_EQ(Decompile(again.module), *source);
  }
}

// The tree of a text is the tree of what is printed of it. OPT-B.35, OPT-B.39, OPT-B.40, OPT-B.41
TEST(Properties, ParsePrintParseIsIdentity) {
  for (std::uint32_t seed = 1; seed <= kProgramSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Module module = ParseGood(RandomProgram(seed).Make(40));
    const std::string printed = Decompile(module);
    ASSERT_EQ(Dump(ParseGood(printed)), Dump(module)) << printed;
    ASSERT_EQ(Decompile(ParseGood(printed)), printed);
  }
}

// The places of nodes that were not kept are found again, statement by statement. OPT-B.35,
// OPT-2.43
TEST(Properties, PlacesOfNodesAreFoundAgain) {
  for (std::uint32_t seed = 1; seed <= kProgramSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::string text = RandomProgram(seed).Make(40);
    Findings findings;
    const ParsedProgram kept = Parse(text, findings, Places::kNodes);
    const ParsedProgram bare = Parse(text, findings, Places::kStatements);
    ASSERT_TRUE(bare.node_places.empty());
    ASSERT_EQ(kept.node_places.size(), bare.module.nodes.size());
    std::size_t node = 0;
    for (const Instruction& instruction : bare.module.instructions) {
      for (const NodePlace& place : bare.NodePlacesOf(instruction)) {
        ASSERT_EQ(place.offset, kept.node_places[node].offset) << node;
        ASSERT_EQ(place.length, kept.node_places[node].length) << node;
        ++node;
      }
    }
    ASSERT_EQ(node, kept.node_places.size());
    node = 0;
    for (const Instruction& instruction : kept.module.instructions) {
      for (const NodePlace& place : kept.NodePlacesOf(instruction))
        ASSERT_EQ(place.offset, kept.node_places[node++].offset);
    }
    ASSERT_EQ(node, kept.node_places.size());
  }
}

// How deep parentheses stand inside each other in a text, and whether it divides outside of them.
std::pair<int, bool> NestingOf(const std::string& text) {
  int depth = 0, deepest = 0;
  bool divides = false;
  for (const char c : text) {
    depth += c == '(' ? 1 : c == ')' ? -1 : 0;
    deepest = std::max(deepest, depth);
    divides = divides || (c == '/' && depth == 0);
  }
  return {deepest, divides};
}

// OPT-B.40, OPT-B.85: the nesting of an expression is that of its text; TCP puts a division into
// parentheses.
TEST(Properties, PrintedNestingIsThatOfTheText) {
  int deepest = 0;
  for (std::uint32_t seed = 1; seed <= kProgramSeeds; ++seed) {
    const Module module = ParseGood(RandomProgram(seed).Make(20));
    for (std::uint32_t e = 0; e < module.expression_ends.size(); ++e) {
      std::string text;
      PrintExpression(module, module.expression(e), text);
      const auto [nesting, divides] = NestingOf(text);
      ASSERT_EQ(PrintedNesting(module.expression(e), false), nesting) << text;
      ASSERT_EQ(PrintedNesting(module.expression(e), true), nesting + (divides ? 1 : 0)) << text;
      deepest = std::max(deepest, nesting);
    }
  }
  EXPECT_GE(deepest, 3);
}

// OPT-B.40
TEST(Properties, FormattingIsIdempotentAndChangesNothing) {
  for (std::uint32_t seed = 1; seed <= kProgramSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::string text = RandomProgram(seed).Make(40);
    const std::string formatted = Format(text).text;
    ASSERT_EQ(Format(formatted).text, formatted);
    ASSERT_EQ(MustCompile(formatted).object, MustCompile(text).object) << formatted;
  }
}

// Cutting a good program anywhere gives findings, never a crash, and errors stay near the cut.
TEST(Properties, EveryPrefixIsAnswered) {
  const std::string text = RandomProgram(7).Make(30);
  for (std::size_t length = 0; length < text.size(); ++length) {
    const Compilation compiled = Compile(std::string_view(text).substr(0, length), "", {});
    std::uint64_t errors = 0;
    for (const Diagnostic& d : compiled.diagnostics) errors += IsError(d.severity) ? 1 : 0;
    EXPECT_LE(errors, 2U) << length;
  }
}

// One wrong byte costs at most a few errors: no cascades. OPT-1.33
TEST(Properties, OneWrongByteCostsFewErrors) {
  const std::string text = RandomProgram(11).Make(60);
  for (std::size_t at = 0; at < text.size(); at += 3) {
    for (const char wrong : {'(', ')', '#', ',', '\n'}) {
      std::string damaged = text;
      damaged[at] = wrong;
      std::uint64_t errors = 0;
      for (const Diagnostic& d : Compile(damaged, "", {}).diagnostics) {
        errors += IsError(d.severity) && d.code != ErrorCode::kNameUndeclared ? 1 : 0;
      }
      EXPECT_LE(errors, 3U) << "byte " << at << " as " << wrong;
    }
  }
}

}  // namespace
}  // namespace rmlcell::optimo
