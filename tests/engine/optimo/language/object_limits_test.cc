#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/engine/optimo/language/compile_text.h"

// How many names, ignored lines and sequence numbers of a table an object can hold: names and lines
// have numbers of 16 bits, of which the last means none. What fits comes back from the object.
namespace rmlcell::optimo::object_limits {
namespace {

constexpr int kMost = 65535;

Compilation CompileLong(const std::string& text) {
  return Compile(text, "", {.object_limit = 0, .advice = false});
}

std::string Repeated(const std::string& line, int count) {
  std::string text;
  for (int n = 0; n < count; ++n) text += line;
  return text;
}

void ExpectFits(const std::string& text) {
  const Compilation compiled = CompileLong(text);
  ASSERT_TRUE(compiled.ok) << compiled.diagnostics.at(0).detail;
  const Result<Module> module = DecodeObject(compiled.object);
  ASSERT_TRUE(module) << module.error().detail;
  EXPECT_EQ(EncodeObject(*module), compiled.object);
}

// OPT-B.69, OPT-E.7031
TEST(ObjectLimits, IgnoredLines) {
  ExpectFits(Repeated("CONT X\n", kMost));
  Compilation all = Compile(Repeated("CONT X\n", kMost + 2), "",
                            {.object_limit = 0, .advice = false, .diagnostics_max = 200'000});
  std::erase_if(all.diagnostics, [](const Diagnostic& one) { return !IsError(one.severity); });
  ASSERT_EQ(all.diagnostics.size(), 2U);
  EXPECT_EQ(Lookup(all.diagnostics[0].code).number, 7031);
  EXPECT_EQ(all.diagnostics[0].where.line, kMost + 1);
  EXPECT_EQ(all.diagnostics[0].step, kMost + 1);
}

// OPT-E.7023: that a line has no effect is told of the one that there is no room for, too, by its
// word.
TEST(ObjectLimits, AnIgnoredLineWithoutRoom) {
  const Compilation all = Compile("CONT X\nEXTERN Y\n" + Repeated("CONT X\n", kMost - 1), "",
                                  {.object_limit = 0, .advice = false, .diagnostics_max = 200'000});
  const auto told = [&](int line) {
    std::string found;
    for (const Diagnostic& one : all.diagnostics) {
      if (one.where.line == line && one.code == ErrorCode::kWordIgnored) found += one.detail;
    }
    return found;
  };
  EXPECT_EQ(told(2), "EXTERN has no effect");
  EXPECT_EQ(told(kMost), "CONT has no effect");
  EXPECT_EQ(told(kMost + 1), "CONT has no effect");
}

// OPT-B.69, OPT-E.7031: told once.
TEST(ObjectLimits, Names) {
  const auto names = [](int count) {
    std::string text;
    for (int n = 0; n < count; ++n) text += "DECLARE N" + std::to_string(n) + " = VR[1]\n";
    return text;
  };
  ExpectFits(names(kMost));
  const Compilation more = CompileLong(names(kMost + 3));
  EXPECT_FALSE(more.ok);
  EXPECT_EQ(std::ranges::count(more.diagnostics, ErrorCode::kObjectTooLong, &Diagnostic::code), 1);
  const auto found =
      std::ranges::find(more.diagnostics, ErrorCode::kObjectTooLong, &Diagnostic::code);
  EXPECT_EQ(found->where.line, kMost + 1);
  EXPECT_EQ(found->where.column, 9);
  EXPECT_EQ(found->where.length, 6);
  // None of those behind is taken for another one that is declared.
  EXPECT_EQ(std::ranges::count(more.diagnostics, ErrorCode::kNameDuplicate, &Diagnostic::code), 0);
  // Nor is it told where a name without room is used.
  const Compilation used = CompileLong(names(kMost + 1) +
                                       "DECLARE N0 = VR[1]\nN65535 = 5.\n"
                                       "VR[2] = N65535\n");
  EXPECT_EQ(std::ranges::count(used.diagnostics, ErrorCode::kObjectTooLong, &Diagnostic::code), 1);
  EXPECT_EQ(std::ranges::count(used.diagnostics, ErrorCode::kNameUndeclared, &Diagnostic::code), 0);
  // OPT-7.49: what stands behind them is told as ever.
  EXPECT_EQ(std::ranges::count(used.diagnostics, ErrorCode::kNameDuplicate, &Diagnostic::code), 1);
  // OPT-7.91: a mistyped DECLARE of what is no name takes none.
  const Compilation mistyped = CompileLong(names(kMost) + "DECLRE 5 = 3\n");
  ASSERT_EQ(mistyped.diagnostics.size(), 1U);
  EXPECT_EQ(mistyped.diagnostics[0].code, ErrorCode::kNameUndeclared);
}

// OPT-7.17, OPT-B.69: the table of a computed GOTO, as long as an object within OBJECT_LIMIT can
// be, and almost as long as a statement.
TEST(ObjectLimits, SequenceNumbersOfATable) {
  const auto table = [](int count) {
    return "10 GOTO VR[2] (10" + Repeated(",10", count - 1) + ")\n";
  };
  const Compilation standard = Compile(table(16'000), "", {.advice = false});
  ASSERT_TRUE(standard.ok);
  EXPECT_TRUE(DecodeObject(standard.object));
  ExpectFits(table(49'990));
  // A statement has at most 100,000 parts: six before its first number here, then two for each.
  const std::string head = "10 STOP\nGOTO VR[2] (10", full = head + Repeated(",10", 49'996);
  ExpectFits(full + ")\n");
  EXPECT_FALSE(CompileLong("11 " + full.substr(8) + ")\n").ok);
  const Compilation more = CompileLong(table(50'001));
  ASSERT_EQ(more.diagnostics.size(), 1U);
  EXPECT_EQ(Lookup(more.diagnostics[0].code).number, 7003);
}

// OPT-1.23: every sequence number there is, all of them before one instruction.
TEST(ObjectLimits, SequenceNumbersOfOneInstruction) {
  std::string text;
  for (int number = 0; number <= 9999; ++number) text += std::to_string(number) + "\n";
  ExpectFits(text + "STOP\n");
  ExpectFits("STOP\n" + text);
}

}  // namespace
}  // namespace rmlcell::optimo::object_limits
