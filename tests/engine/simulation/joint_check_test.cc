#include "engine/simulation/run/joint_check.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/families/families.h"
#include "tests/engine/simulation/verdict_text.h"

namespace rmlcell::simulation {
namespace {

const machine::MachineFamily& TheOptimo() { return *families::FindFamily("optimo"); }

// A file as a check gets it; `slot` as its name tells it.
JointProgram File(const std::string& text, int slot = 0) {
  const machine::Parameters parameters(TheOptimo().parameters());
  machine::Translation made =
      TheOptimo().Translate({.name = "test.S", .bytes = text}, parameters, {.source = true});
  EXPECT_TRUE(made.ok) << text;
  return {
      .program = {.slot = slot, .translation = std::make_shared<const machine::Translation>(made)}};
}

std::vector<JointProgram> Checked(std::vector<JointProgram> files) {
  const machine::Parameters parameters(TheOptimo().parameters());
  EXPECT_TRUE(CheckTogether(TheOptimo(), parameters, files, {}).ok());
  return files;
}

// X goes to 3000 mm (optimo.md 11.4): 4000 is outside.
const std::string kOutside = "COORD ABSOL\nPATH LIN\nMOVE (4000.,0.,0.,0.,0.)\n";
const std::string kInside = "COORD ABSOL\nPATH LIN\nMOVE (400.,0.,0.,0.,0.)\n";

TEST(CheckTogether, ProgramsCallEachOtherAndEachGetsItsOwnFindings) {
  const auto files = Checked({File("CALL 44\n", 45), File(kOutside, 44)});
  EXPECT_TRUE(files[0].motion.findings.empty());
  ASSERT_EQ(files[1].motion.findings.size(), 1u);
  EXPECT_EQ(files[1].motion.findings[0].step, 3);
  EXPECT_TRUE(files[0].motion.cut_short.empty());
}

// 1203 motions of two files leave the travel: a thousand are told, and the others counted.
TEST(CheckTogether, FindingsWithoutRoomAreCountedWithTheirFile) {
  const auto beyond = [](int moves) {
    std::string text = "COORD ROBOT\n";
    for (int k = 0; k < moves; ++k)
      text += k % 2 == 0 ? "MOVE (4000.,0.,0.,0.,0.)\n" : "MOVE (4100.,0.,0.,0.,0.)\n";
    return text;
  };
  const auto files = Checked({File(beyond(601), 1), File(beyond(602), 2)});
  EXPECT_EQ(files[0].motion.findings.size(), 601u);
  EXPECT_EQ(files[0].motion.findings_dropped.count(), 0u);
  EXPECT_EQ(files[1].motion.findings.size(), 399u);
  EXPECT_EQ(files[1].motion.findings_dropped.count(), 203u);
}

// Its run leaves the travel in 44, and so it is no good, either; 44 has it with its place.
TEST(CheckTogether, WhoCallsAProgramThatFailsFailsWithIt) {
  const auto judged = [](const std::string& called) {
    auto files = Checked({File("CALL 44\n", 45), File(called, 44), File(kInside, 46)});
    std::vector<std::string> said;
    for (JointProgram& file : files) {
      CheckedProgram check{.family = &TheOptimo(),
                           .slot = file.program.slot,
                           .translation = {.ok = true},
                           .motion = file.motion};
      said.push_back(TextOf(JudgeCheck(check)));
    }
    return said;
  };
  const auto travel = judged("SYSDEF\n" + kOutside);
  EXPECT_EQ(travel[0].substr(0, 14), "BAD; OPT-E7301");
  EXPECT_TRUE(travel[0].ends_with(", in program 44")) << travel[0];
  EXPECT_EQ(travel[1].substr(0, 14), "BAD; OPT-E7301");
  EXPECT_TRUE(travel[1].ends_with(" @4")) << travel[1];
  EXPECT_EQ(travel[2], "GOOD");
  // If no SYSDEF is in force before: of both.
  const auto perhaps = judged(kOutside);
  EXPECT_EQ(perhaps[0].substr(0, 19), "DOUBTFUL; OPT-E7301");
  EXPECT_EQ(perhaps[1].substr(0, 19), "DOUBTFUL; OPT-E7301");
  // An error that ends the run, told once.
  const auto divided = judged("VI[1] = 0\nVI[2] = 5 / VI[1]\n");
  EXPECT_EQ(divided[0].substr(0, 4), "BAD;");
  EXPECT_TRUE(divided[0].ends_with(", in program 44")) << divided[0];
  EXPECT_EQ(std::ranges::count(divided[0], ';'), 1) << divided[0];
  EXPECT_EQ(divided[1].substr(0, 4), "BAD;");
}

// Files without a number take the free slots, in their order, and are checked all the same.
TEST(CheckTogether, FilesWithoutANumberTakeFreeSlots) {
  const auto files = Checked({File(kInside), File(kInside, 1), File(kOutside)});
  EXPECT_EQ(files[0].program.slot, 2);
  EXPECT_EQ(files[1].program.slot, 1);
  EXPECT_EQ(files[2].program.slot, 3);
  EXPECT_TRUE(files[0].motion.findings.empty());
  EXPECT_EQ(files[2].motion.findings.size(), 1u);
}

// Both are 44.S: who calls 44 gets the first, and the second is checked alone, with the others.
TEST(CheckTogether, TheSecondOfOneSlotIsCheckedInItsPlace) {
  const auto files = Checked(
      {File("CALL 44\n", 45), File(kInside, 44), File(kOutside, 44), File("CALL 45\n", 44)});
  EXPECT_TRUE(files[0].motion.findings.empty());
  EXPECT_TRUE(files[1].motion.findings.empty());
  EXPECT_EQ(files[2].program.slot, 44);
  EXPECT_EQ(files[2].motion.findings.size(), 1u);
  // It calls 45, and that calls it: the check ends at the first bound, and says so here alone.
  EXPECT_EQ(files[3].motion.cut_short.count(44), 1u);
  EXPECT_TRUE(files[0].motion.cut_short.empty());
}

// The 100th file without a number finds no slot free: it is checked in the place of the first.
TEST(CheckTogether, MoreFilesThanSlotsAreAllChecked) {
  std::vector<JointProgram> files;
  for (int n = 0; n < 99; ++n) files.push_back(File(kInside));
  files.push_back(File(kOutside));
  const auto checked = Checked(files);
  EXPECT_EQ(checked[98].program.slot, 99);
  EXPECT_EQ(checked[99].program.slot, 1);
  EXPECT_EQ(checked[99].motion.findings.size(), 1u);
  EXPECT_TRUE(checked[0].motion.findings.empty());
}

}  // namespace
}  // namespace rmlcell::simulation
