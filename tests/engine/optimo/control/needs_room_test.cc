// What is looked for before a run begins: room for the executables that it makes, and its
// schedules; and what a condition that is none says. OPT-B.73
#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/linker.h"
#include "tests/engine/core/arguments_text.h"

namespace rmlcell::optimo::testing::needs_room {
namespace {

machine::Bytes ObjectOfText(const std::string& text) {
  return machine::Bytes::Of(Compile(text, "", {}).object);
}

// OPT-B.73: an executable that was made before takes its place, and so does another that no call
// asks for.
TEST(NeedsRoom, ExecutablesThatAreStoredTakeRoom) {
  std::map<int, machine::StoredProgram> memory;
  memory[1].object = ObjectOfText("CALL 2\nDELAY 1\n");
  memory[2].object = ObjectOfText("DELAY 2\n");
  memory[3].object = machine::Bytes::Of(std::string(2000, 'x'));
  memory[4].executable = machine::Bytes::Of(std::string(700, 'y'));
  const auto lookup = [&](int slot) -> std::optional<std::string_view> {
    return std::string_view(*memory.at(slot).object);
  };
  const std::string made_of_1 = EncodeExecutable(Link(1, lookup, {}).value());
  const std::string made_of_2 = EncodeExecutable(Link(2, lookup, {}).value());
  memory[2].executable = machine::Bytes::Of(made_of_2);
  const std::size_t full = memory[1].object->size() + memory[2].object->size() + 2000 + 700 +
                           made_of_1.size() + made_of_2.size();
  const auto check = [&](std::size_t bytes) {
    machine::Parameters parameters(OptimoFamily().parameters());
    EXPECT_TRUE(parameters.Set("CMOS_SIZE", static_cast<double>(bytes)));
    return OptimoFamily().CheckNeeds(memory, {}, parameters, 1);
  };
  EXPECT_TRUE(check(full));
  const Status short_of_one = check(full - 1);
  ASSERT_FALSE(short_of_one);
  EXPECT_EQ(short_of_one.error().code, ErrorCode::kCmosFull);
  EXPECT_EQ(short_of_one.error().detail, "no room for executable 101");
  EXPECT_EQ(ArgumentsText(short_of_one.error().detail), "executable=101");
}

// OPT-3.06, OPT-3.07: schedules that are numbers are looked for; what is computed shows in the run.
TEST(NeedsRoom, SchedulesThatAreComputedAreNotLookedFor) {
  const auto check = [](const std::string& text) {
    std::map<int, machine::StoredProgram> memory;
    memory[1].object = ObjectOfText(text);
    machine::Parameters few(OptimoFamily().parameters());
    EXPECT_TRUE(few.Set("SCHEDULES", 11.0));
    const Status all = OptimoFamily().CheckNeeds(memory, {{.number = 20}}, few, 1);
    return all ? std::string("all") : std::string(all.error().detail);
  };
  for (const std::string schedule : {"VR[1]", "VR[1] + 41", "41 + VR[1]", "41 - 1", "-VR[1]"}) {
    EXPECT_EQ(check("WORKDEF 2,1 (" + schedule + ")\n"), "all") << schedule;
    EXPECT_EQ(check("WORKDEF 1,1 (8.,75.,1.,50.," + schedule + ")\n"), "all") << schedule;
  }
  EXPECT_EQ(check("DELAY 1\nWORKDEF 2,1 (41)\n"), "laser schedule 41, of program 1, step 2");
  EXPECT_EQ(check("WORKDEF 2,1 (41)\nDELAY VR[2]\n"), "laser schedule 41, of program 1, step 1");
  EXPECT_EQ(check("WORKDEF 1,1 (8.,75.,1.,50.,42)\n"), "laser schedule 42, of program 1, step 1");
}

// A breakpoint's condition is named as it was given.
TEST(NeedsRoom, AConditionThatIsNoneIsNamed) {
  for (const std::string text : {"VI[1] > 2; VI[2]", "VI[1] > 2\n"}) {
    const Status refused = OptimoFamily().CheckBreakpoint({.at = {1, 1}, .condition = text});
    ASSERT_FALSE(refused) << text;
    EXPECT_EQ(refused.error().code, ErrorCode::kCellInvalidArgument);
    EXPECT_EQ(refused.error().detail,
              "the condition '" + text + "' is none: it is one expression, in one line");
    ASSERT_EQ(refused.error().detail.arguments().size(), 1U);
    EXPECT_EQ(refused.error().detail.arguments()[0], (Argument{"condition", text, ""}));
  }
}

}  // namespace
}  // namespace rmlcell::optimo::testing::needs_room
