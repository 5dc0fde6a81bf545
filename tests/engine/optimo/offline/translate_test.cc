#include "engine/optimo/offline/translate.h"

#include <gtest/gtest.h>

#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

// OPT-8.72
TEST(Translate, TheExtensionTellsTheForm) {
  EXPECT_EQ(FormOfFile("a.S", ""), FileForm::kMetricSource);
  EXPECT_EQ(FormOfFile("a.si", ""), FileForm::kInchSource);
  EXPECT_EQ(FormOfFile("a.CMP", ""), FileForm::kMetricSource);
  EXPECT_EQ(FormOfFile("44.o", ""), FileForm::kObject);
  EXPECT_EQ(FormOfFile("", MustCompile("SPEED 5\n").object), FileForm::kObject);
  EXPECT_EQ(FormOfFile("", "SPEED 5\n"), FileForm::kMetricSource);
}

// OPT-1.04, OPT-1.33
TEST(Translate, SourcesAreCompiled) {
  const machine::Translation good = TranslateOptimo({"a.S", "SPEED 5\nSPEED 6\n"}, {});
  EXPECT_TRUE(good.ok);
  EXPECT_EQ(good.object, MustCompile("SPEED 5\nSPEED 6\n").object);
  EXPECT_EQ(good.figures.at(0).name, "steps");
  EXPECT_EQ(good.figures.at(0).value, 2.0);
  const machine::Translation bad = TranslateOptimo({"a.S", "SPEED 101\n"}, {});
  EXPECT_FALSE(bad.ok);
  EXPECT_TRUE(bad.object.empty());
  EXPECT_EQ(bad.diagnostics.at(0).file, "a.S");
}

// OPT-2.04, OPT-1.08
TEST(Translate, InchAndTooLongAreRefused) {
  EXPECT_EQ(TranslateOptimo({"a.SI", "SPEED 5\n"}, {}).diagnostics.at(0).code,
            ErrorCode::kSourceIsInch);
  EXPECT_EQ(TranslateOptimo({"a.S", "SPEED 5\n"}, {}, 10).diagnostics.at(0).code,
            ErrorCode::kObjectTooLong);
}

// OPT-B.71
TEST(Translate, ObjectsAreCheckedAndTakenAsTheyAre) {
  const std::string object = MustCompile("SPEED 5\n").object;
  const machine::Translation taken = TranslateOptimo({"44.O", object}, {});
  EXPECT_TRUE(taken.ok);
  EXPECT_EQ(taken.object, object);
  const machine::Translation damaged = TranslateOptimo({"44.O", object.substr(1)}, {});
  EXPECT_FALSE(damaged.ok);
  EXPECT_EQ(damaged.diagnostics.at(0).code, ErrorCode::kObjectCorrupt);
}

TEST(Translate, AnEmptyFileIsNoProgram) {
  const machine::Translation empty = TranslateOptimo({"a.S", ""}, {});
  EXPECT_FALSE(empty.ok);
  EXPECT_EQ(empty.diagnostics.at(0).code, ErrorCode::kCellEmptyProgram);
}

// OPT-10.17, OPT-E.7413
TEST(Translate, NumbersUpToSevenAreReserved) {
  for (const int slot : {1, 5, 7}) {
    const std::vector<Diagnostic> found = CheckProgramNumber(slot);
    ASSERT_EQ(found.size(), 1U) << slot;
    EXPECT_EQ(Lookup(found[0].code).number, 7413);
    EXPECT_EQ(found[0].severity, Severity::kWarning);
    EXPECT_EQ(found[0].rule, "OPT-10.17");
  }
  EXPECT_TRUE(CheckProgramNumber(8).empty());
  EXPECT_TRUE(CheckProgramNumber(99).empty());
}

}  // namespace
}  // namespace rmlcell::optimo
