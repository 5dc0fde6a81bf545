#include "engine/optimo/offline/translate.h"

#include <gtest/gtest.h>

#include "engine/optimo/offline/house_programs.h"
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

// OPT-2.04: an inch source that is being written has its own findings, and one that says what it
// is; a move of 0.5 is no short one, because it is 12.7 mm.
TEST(Translate, InchSourcesAreLookedAt) {
  const std::string text =
      "SPEED 101\nMOVE (1.,2.,3.,0.,0.)/FLY\nMOVE (1.5,2.,3.,0.,0.)/FLY\nMOVE (9.,2.,3.,0.,0.)\n";
  for (const bool advice : {true, false}) {
    const machine::Translation looked =
        TranslateOptimo({"a.SI", text}, {.advice = advice, .unconverted = true});
    EXPECT_FALSE(looked.ok);
    ASSERT_EQ(looked.diagnostics.size(), advice ? 2U : 1U);
    EXPECT_EQ(looked.diagnostics.back().code, ErrorCode::kLiteralRange);
    EXPECT_EQ(looked.diagnostics.back().where.line, 1);
    EXPECT_EQ(looked.diagnostics[0].code,
              advice ? ErrorCode::kSourceIsInch : ErrorCode::kLiteralRange);
    for (const Diagnostic& finding : looked.diagnostics) EXPECT_EQ(finding.file, "a.SI");
  }
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

// OPT-1.08, OPT-E.7031: an object that is put as one has the same limit, and none when that is 0.
TEST(Translate, ObjectsHaveTheLimitOfObjects) {
  const std::string object = MustCompile("SPEED 5\nSPEED 6\n").object;
  const auto size = static_cast<std::uint32_t>(object.size());
  EXPECT_TRUE(TranslateOptimo({"44.O", object}, {}, size).ok);
  EXPECT_TRUE(TranslateOptimo({"44.O", object}, {}, 0).ok);
  const machine::Translation refused = TranslateOptimo({"44.O", object}, {}, size - 1);
  EXPECT_FALSE(refused.ok);
  EXPECT_TRUE(refused.object.empty());
  ASSERT_EQ(refused.diagnostics.size(), 1U);
  EXPECT_EQ(refused.diagnostics[0].code, ErrorCode::kObjectTooLong);
  EXPECT_EQ(refused.diagnostics[0].file, "44.O");
  EXPECT_TRUE(TranslateOptimo({"a.S", "SPEED 5\nSPEED 6\n"}, {}, size).ok);
  EXPECT_FALSE(TranslateOptimo({"a.S", "SPEED 5\nSPEED 6\n"}, {}, size - 1).ok);
}

// OPT-1.04, OPT-6.01: what is counted of a program, the same of its source and its object, which
// has none.
TEST(Translate, CountsWhatAProgramHas) {
  const std::string text = "DECLARE X = VR[1]\nDECLARE Y = VR[2]\n10\n20 X = Y ; c\nSPEED 5\n30\n";
  const std::string object = MustCompile(text).object;
  const auto figures = [](const machine::Translation& translation) {
    std::vector<std::pair<std::string, double>> counted;
    for (const auto& figure : translation.figures) counted.emplace_back(figure.name, figure.value);
    return counted;
  };
  std::vector<std::pair<std::string, double>> expected = {
      {"steps", 2.0},
      {"source_bytes", static_cast<double>(text.size())},
      {"object_bytes", static_cast<double>(object.size())},
      {"sequence_numbers", 3.0},
      {"names", 2.0}};
  EXPECT_EQ(figures(TranslateOptimo({"a.S", text}, {})), expected);
  expected[1].second = 0.0;
  EXPECT_EQ(figures(TranslateOptimo({"a.O", object}, {})), expected);
  EXPECT_TRUE(figures(TranslateOptimo({"a.S", "SPEED 101\n"}, {})).empty());
}

// OPT-8.72: an extension is what stands behind the last point, in any case.
TEST(Translate, OtherNamesAreToldByTheirBytes) {
  const std::string object = MustCompile("SPEED 5\n").object;
  EXPECT_EQ(FormOfFile("a.SO", "SPEED 5\n"), FileForm::kMetricSource);
  EXPECT_EQ(FormOfFile("a.SO", object), FileForm::kObject);
  EXPECT_EQ(FormOfFile("S", object), FileForm::kObject);
  EXPECT_EQ(FormOfFile("o", "LMR"), FileForm::kMetricSource);
  EXPECT_EQ(FormOfFile("o", "LMR\x01"), FileForm::kObject);
  EXPECT_EQ(FormOfFile("a.o", ""), FileForm::kObject);
  EXPECT_EQ(FormOfFile("a.S", object), FileForm::kMetricSource);
  EXPECT_EQ(FormOfFile(".si", ""), FileForm::kInchSource);
}

TEST(Translate, AnEmptyFileIsNoProgram) {
  const machine::Translation empty = TranslateOptimo({"a.S", ""}, {});
  EXPECT_FALSE(empty.ok);
  EXPECT_EQ(empty.diagnostics.at(0).code, ErrorCode::kCellEmptyProgram);
}

// OPT-10.17, OPT-E.7413
TEST(Translate, NumbersUpToSevenAreReserved) {
  for (const int slot : {1, 5, 7}) {
    const std::vector<Diagnostic> found = CheckProgramNumber(slot, "DELAY 1\n");
    ASSERT_EQ(found.size(), 1U) << slot;
    EXPECT_EQ(Lookup(found[0].code).number, 7413);
    EXPECT_EQ(found[0].severity, Severity::kWarning);
    EXPECT_EQ(found[0].rule, "OPT-10.17");
    EXPECT_EQ(found[0].program, slot);
  }
  EXPECT_TRUE(CheckProgramNumber(0, "").empty());
  EXPECT_TRUE(CheckProgramNumber(8, "").empty());
  EXPECT_TRUE(CheckProgramNumber(99, "").empty());
}

// OPT-10.12, OPT-B.82 to OPT-B.84, OPT-10.17: the product's own programs stand in 1, 2, 4 and 90,
// and are no intrusion there, to the byte; nor is each in the place of another one.
TEST(Translate, TheOwnProgramsMayHaveReservedNumbers) {
  std::vector<int> slots;
  for (const machine::SpecialProgram& program : HousePrograms()) {
    slots.push_back(program.slot);
    const std::string source(program.source);
    EXPECT_EQ(program.file_name, std::to_string(program.slot) + ".S");
    EXPECT_TRUE(IsHouseProgram(program.slot, source)) << program.slot;
    EXPECT_TRUE(CheckProgramNumber(program.slot, source).empty()) << program.slot;
    EXPECT_FALSE(IsHouseProgram(program.slot, source + " ")) << program.slot;
    EXPECT_EQ(CheckProgramNumber(program.slot, source + " ").empty(), program.slot == 90);
    EXPECT_EQ(CheckProgramNumber(5, source).size(), 1U) << program.slot;
    EXPECT_TRUE(TranslateOptimo({std::string(program.file_name), source}, {}).ok) << program.slot;
  }
  EXPECT_EQ(slots, (std::vector<int>{1, 2, 4, 90}));
}

}  // namespace
}  // namespace rmlcell::optimo
