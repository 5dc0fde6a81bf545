#include <gtest/gtest.h>

#include "engine/optimo/language/program.h"
#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

// Every limit on both sides.
TEST(Parser, NestingHasALimit) {
  const auto nested = [](int depth) {
    return "VR[0] = " + std::string(static_cast<std::size_t>(depth), '(') + "1." +
           std::string(static_cast<std::size_t>(depth), ')') + "\n";
  };
  EXPECT_TRUE(FindingsOf(nested(kNestingMax)).empty());
  EXPECT_EQ(FindingsOf(nested(kNestingMax + 1)), (std::vector<int>{7003}));
}

// A chain of any length is no nesting.
TEST(Parser, LongChainsAreFine) {
  std::string text = "VR[0] = 1.";
  for (int i = 0; i < 20'000; ++i) text += "+1.";
  EXPECT_TRUE(Compile(text + "\n", "", {.object_limit = 0}).ok);
}

// Operands that wait for their operator are bounded, too: 1+(1+(1+ ...
TEST(Parser, PendingOperandsAreBounded) {
  std::string open, close;
  for (int i = 0; i < 150; ++i) {
    open += "1.-(";
    close += ")";
  }
  EXPECT_EQ(FindingsOf("VR[0] = " + open + "1." + close + "\n"), (std::vector<int>{7003}));
}

// Comments and statements keep their places.
TEST(Parser, KeepsPlaces) {
  const std::string text = "; one\n10 SPEED 20 ; two\n";
  Findings findings;
  const ParsedProgram program = Parse(text, findings);
  ASSERT_EQ(program.comments.size(), 2U);
  EXPECT_EQ(
      text.substr(program.comments[1].begin, program.comments[1].end - program.comments[1].begin),
      "; two");
  ASSERT_EQ(program.statements.size(), 1U);
  EXPECT_EQ(text.substr(program.statements[0].begin,
                        program.statements[0].end - program.statements[0].begin),
            "SPEED 20");
  EXPECT_EQ(program.label_places.at(0).offset, 6U);
}

// OPT-1.25: the message shows the first place.
TEST(Parser, DuplicateNumbersShowTheFirstLine) {
  const Compilation compiled = Compile("SPEED 5\n10 SPEED 5\n\n10 SPEED 6\n", "", {});
  ASSERT_EQ(compiled.diagnostics.size(), 1U);
  EXPECT_EQ(compiled.diagnostics[0].where.line, 4);
  EXPECT_NE(compiled.diagnostics[0].detail.find("line 2"), std::string::npos);
}

// A wrong statement is a step, so that the steps behind it keep their numbers.
TEST(Parser, WrongStatementsCountAsSteps) {
  const Compilation compiled = Compile("SPEED\nDECLARE 2X = VR[1]\nSPEED 101\n", "", {});
  ASSERT_EQ(compiled.diagnostics.size(), 3U);
  EXPECT_EQ(compiled.diagnostics[0].step, 1);
  EXPECT_EQ(compiled.diagnostics[2].step, 2);
}

// OPT-1.33: a fault in the values of a statement is told once, and nothing about their number.
TEST(Parser, AFaultInAListIsToldOnce) {
  for (const std::string list : {"(1.,)", "(,1.)", "(1. 2.)", "(1.", "((1.)"}) {
    for (const std::string before :
         {"MOVE ", "MOVE (1.,2.,3.,0.,0.) /VIA ", "MOVE (1.,2.,3.,0.,0.) /START ", "SYSDEF ",
          "TCP ", "PATH HOLE ", "WORKDEF 1,0 ", "WORKDEF 2,0,", "CALL 45 ", "FUNCTION 45 ",
          "TIMER "}) {
      EXPECT_EQ(FindingsOf(before + list + "\nSTOP\n").size(), 1U) << before << list;
    }
  }
}

// OPT-7.45, OPT-1.32: names have letters and digits; what is wrong is the other character.
TEST(Parser, ABadCharacterInANameIsWhatIsReported) {
  struct Row {
    std::string_view text;
    int column;
  };
  for (const Row& row : {Row{"X_1 = 5.\n", 2}, Row{"10 LENGTH_X = 5.\n", 10},
                         Row{"LET X_1 = 5.\n", 6}, Row{"DECLARE X_1 = VR[1]\n", 10},
                         Row{"VR_1 = 5.\n", 3}, Row{"VR[0] = X_1\n", 10}, Row{"SPED# 5\n", 5}}) {
    const Compilation compiled = Compile(row.text, "", {.advice = false});
    ASSERT_EQ(compiled.diagnostics.size(), 1U) << row.text;
    const Diagnostic& found = compiled.diagnostics[0];
    EXPECT_EQ(found.code, ErrorCode::kBadCharacter) << row.text;
    EXPECT_EQ(found.where.line, 1) << row.text;
    EXPECT_EQ(found.where.column, row.column) << row.text;
    EXPECT_EQ(found.where.length, 1) << row.text;
  }
}

}  // namespace
}  // namespace rmlcell::optimo
