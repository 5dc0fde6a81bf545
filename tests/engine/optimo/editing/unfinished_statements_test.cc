// A statement that is being typed takes nothing along into the next one.
#include <gtest/gtest.h>

#include <string>

#include "engine/optimo/editing/program_index.h"

namespace rmlcell::optimo::editing {
namespace {

std::string JumpsOf(std::string_view text) {
  const ProgramIndex index(text);
  std::string out;
  for (const Use& use : index.uses())
    if (use.kind == UseKind::kJump) out += std::string(index.TextOf(use)) + ";";
  return out;
}

TEST(UnfinishedStatements, AnOpenParenthesisEndsWithItsStatement) {
  EXPECT_EQ(JumpsOf("MOVE (1,2,3,0,0) /TIME (2.5\nMOVE (1, 20, 30, 0, 0)"), "");
  EXPECT_EQ(JumpsOf("TIMER (2.5\nWORKDEF 1,0 (6, 80, 1, 95)"), "");
  EXPECT_EQ(JumpsOf("GOTO VI[2] (20\nMOVE (1, 30, 40, 0, 0)"), "20;");
  EXPECT_EQ(JumpsOf("SPEED (5\nGOTO VI[2] (20, 30)"), "20;30;");
  EXPECT_EQ(JumpsOf("SPEED (5\nTIMER (2., 900)"), "900;");
}

}  // namespace
}  // namespace rmlcell::optimo::editing
