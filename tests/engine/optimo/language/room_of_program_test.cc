// The room that is made beforehand: what the worker counts against the memory of a job.
#include <gtest/gtest.h>

#include <string>

#include "engine/optimo/language/program.h"

namespace rmlcell::optimo::room_of_program {
namespace {

TEST(RoomOfProgram, AsManyInstructionsAsLines) {
  for (const int lines : {0, 1, 30}) {
    std::string text;
    for (int line = 0; line < lines; ++line) text += "STOP\n";
    Findings none;
    const ParsedProgram parsed = Parse(text + "STOP", none);
    const auto count = static_cast<std::size_t>(lines) + 1;
    EXPECT_EQ(parsed.statements.size(), count);
    EXPECT_EQ(parsed.statements.capacity(), count);
    EXPECT_EQ(parsed.module.instructions.capacity(), count);
  }
}

TEST(RoomOfProgram, HasABoundForATextThatIsMostlyLineEnds) {
  Findings none;
  const ParsedProgram parsed = Parse(std::string(9'000'000, '\n') + "STOP", none);
  EXPECT_EQ(parsed.statements.size(), 1U);
  EXPECT_LE(parsed.statements.capacity(), std::size_t{1} << 23);
  EXPECT_LE(parsed.module.instructions.capacity(), std::size_t{1} << 23);
}

}  // namespace
}  // namespace rmlcell::optimo::room_of_program
