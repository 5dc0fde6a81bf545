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

}  // namespace
}  // namespace rmlcell::optimo
