// Where a text begins and ends, whatever stands around it in memory.
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/optimo/editing/allowance.h"
#include "engine/optimo/editing/optimo_editing.h"
#include "engine/optimo/editing/program_index.h"
#include "engine/optimo/language/program.h"

namespace rmlcell::optimo {
namespace {

struct NobodyAround final : machine::Surroundings {
  const std::string& uri() const override { return uri_; }
  std::vector<machine::NumberedFile> Programs() const override { return {}; }
  std::optional<machine::NumberedSource> Read(const machine::NumberedFile&) const override {
    return std::nullopt;
  }
  std::string ScheduleNote(int) const override { return {}; }
  std::string ProcessNote(int, int) const override { return {}; }

  std::string uri_ = "file:///work/12.S";
};

machine::Suggestions OfferedIn(std::string_view text, std::size_t offset) {
  return OptimoEditing().Look(text)->Complete(offset, NobodyAround());
}
bool Offers(const machine::Suggestions& offered, std::string_view label) {
  return std::ranges::find(offered.list, label, &machine::Suggestion::label) != offered.list.end();
}
Diagnostic AdviceAt(std::int64_t offset) {
  Diagnostic finding{.code = ErrorCode::kPracticeAdvice, .severity = Severity::kAdvice};
  finding.where.byte_offset = offset;
  return finding;
}

TEST(TextEdges, AWordBeginsWithItsText) {
  const std::string_view text = std::string_view("XSPE").substr(1);
  const machine::Suggestions offered = OfferedIn(text, 3);
  EXPECT_EQ(offered.typed, (machine::TextSpan{0, 3}));
  EXPECT_TRUE(Offers(offered, "SPEED"));
}

// OPT-7.45: a name may have each digit.
TEST(TextEdges, ANineIsAPartOfAName) {
  const machine::Suggestions offered = OfferedIn("DECLARE A9 = 1\nVR[0] =A9", 24);
  EXPECT_EQ(offered.typed, (machine::TextSpan{22, 24}));
  ASSERT_EQ(offered.list.size(), 1U);
  EXPECT_EQ(offered.list[0].label, "A9");
}

// What stands behind it is no part of the statement that begins.
TEST(TextEdges, BeforeTheFirstStatementEachMayBegin) {
  EXPECT_TRUE(Offers(OfferedIn("\nGOTO 10\n10 STOP\n", 0), "MOVE"));
  EXPECT_TRUE(Offers(OfferedIn("GOTO 10\n10 STOP\n", 0), "MOVE"));
  EXPECT_FALSE(Offers(OfferedIn("GOTO 10\n10 STOP\n", 5), "MOVE"));
}

// Behind the row that the finding is of, up to the blanks at its end.
TEST(TextEdges, AnAllowanceStandsAtTheEndOfItsRow) {
  const auto at = [](std::string_view text, std::int64_t offset) {
    const auto fix = editing::Allowance(text, AdviceAt(offset));
    return fix ? fix->byte_offset : -1;
  };
  EXPECT_EQ(at(std::string_view("SPEED 5;").substr(0, 7), 7), 7);
  EXPECT_EQ(at(std::string_view("  \t\nSTOP\n").substr(3), 0), 0);  // an empty row
  EXPECT_EQ(at(" \t\nSTOP\n", 1), 0);
  EXPECT_EQ(at("STOP\n\nSTOP\n", 5), 5);
  EXPECT_EQ(at("STOP \t\r\nSTOP\n", 0), 4);
  EXPECT_EQ(at("STOP\nSTOP", 5), 9);
  EXPECT_EQ(at("; rmlcell: allowed", 0), -1);
  // Comments of other rows do not count, and one at the begin of its own does.
  EXPECT_EQ(at("STOP ; note\nSPEED 5\n", 12), 19);
  EXPECT_EQ(at("STOP\n; x", 0), 4);
  EXPECT_EQ(at("STOP\nSPEED 5\nSTOP ; x", 5), 12);
  EXPECT_EQ(at("SPEED 5\nSTOP ; x\n", 6), 7);
  EXPECT_EQ(at("STOP\n; x", 7), -1);
  EXPECT_EQ(at("  \nSTOP\n", 0), 0);
  // A comment that says something else takes no number, whatever it ends with, nor does a directive
  // behind which something is written.
  EXPECT_EQ(at("SPEED 5 ; part 7", 0), -1);
  EXPECT_EQ(at("SPEED 5 ; rmlcell: allow 7413 here", 0), -1);
  EXPECT_EQ(at("SPEED 5 ; rmlcell: allow 7413", 0), 29);
}

// A jump to the end of the program, where nothing follows: nor does what memory held before.
TEST(TextEdges, BehindTheLastNumberStandsNothing) {
  for (const std::string rest : {"", "\n901", "\n901\n902", "\n901\n902\n903"}) {
    const std::string text = "GOTO 900\nSTOP\n900" + rest;
    const std::string longer(text + "\nSPEED 5\nSPEED 6\nSPEED 7\nSPEED 8\n");
    OptimoEditing().Look(longer).reset();
    const auto note = OptimoEditing().Look(text)->Hover(5, NobodyAround());
    ASSERT_TRUE(note);
    EXPECT_EQ(note->text.find('`'), std::string::npos) << note->text;
    EXPECT_NE(note->text.find("end"), std::string::npos) << note->text;
  }
  const std::string text = "GOTO 900\nSTOP\n900\n901\nSPEED 5\nSPEED 6\n";
  const auto note = OptimoEditing().Look(text)->Hover(5, NobodyAround());
  ASSERT_TRUE(note);
  EXPECT_NE(note->text.find("`SPEED 5`"), std::string::npos) << note->text;
  EXPECT_EQ(note->text.find("SPEED 6"), std::string::npos) << note->text;
}

using editing::ProgramIndex;
using editing::UseKind;

TEST(TextEdges, ALabelLeadsToTheStepBehindIt) {
  const ProgramIndex first("10 SPEED 5\nGOTO 10\n");
  EXPECT_EQ(first.StepOfLabel(*first.FindLabel(10)), 1U);
  { const ProgramIndex before("STOP\nSTOP\nSTOP\nSTOP\n"); }
  const ProgramIndex last("STOP\nSTOP\n900\n");
  EXPECT_EQ(last.StepOfLabel(*last.FindLabel(900)), 3U);  // its end
}

// OPT-3.01: ON and OFF of a WORK are its own.
TEST(TextEdges, AWorkIsOnOrOffByItsOwnWords) {
  const std::string stops = "STOP\nSTOP\nSTOP\nSTOP\n";
  {
    const std::string longer = stops + "WORK 1,0 /ON /OFF\n";
    const ProgramIndex before(longer);
  }
  const std::string text = stops + "WORK 1,0\n";
  const ProgramIndex index(text);
  ASSERT_EQ(index.processes().size(), 1U);
  EXPECT_FALSE(index.processes()[0].on);
  EXPECT_FALSE(index.processes()[0].off);
}

// A number that can be no label is none at the end either.
TEST(TextEdges, AnOutlineEndsWithItsProgram) {
  { const ProgramIndex before("STOP\nSTOP\nSTOP\n10\n"); }
  const std::string text = "STOP\nSTOP\nSTOP\n99999\n";
  EXPECT_EQ(OptimoEditing().Look(text)->Outline().size(), 3U);
}

TEST(TextEdges, AStatementEndsWithItsLastToken) {
  const ProgramIndex index("SPEED 5   ; slow\nMOVE (1,2,3,0,0)  \n10 STOP\n");
  ASSERT_EQ(index.statements().size(), 3U);
  EXPECT_EQ(index.TextOf(index.statements()[0]), "SPEED 5");
  EXPECT_EQ(index.TextOf(index.statements()[1]), "MOVE (1,2,3,0,0)");
  EXPECT_EQ(index.TextOf(index.statements()[2]), "STOP");
  // One of a number alone has nothing behind it.
  const ProgramIndex lone("STOP\n9000\n");
  ASSERT_EQ(lone.statements().size(), 2U);
  EXPECT_EQ(lone.statements()[1].body, 9U);
  EXPECT_EQ(lone.statements()[1].end, 9U);
}

// What stands behind such a word is not looked at, and is of its statement all the same.
TEST(TextEdges, ARestOfALineBelongsToItsStatement) {
  const ProgramIndex index("CONT\nENABLE  all of it  ; slow\nSTOP\n");
  ASSERT_EQ(index.statements().size(), 3U);
  EXPECT_EQ(index.TextOf(index.statements()[0]), "CONT");
  EXPECT_EQ(index.TextOf(index.statements()[1]), "ENABLE  all of it");
}

// OPT-2.54: of a statement that is being written its attribute may come first.
TEST(TextEdges, ATimeBeginsWithItsSlash) {
  const ProgramIndex index("/TIME (2.5, 900)\n900 STOP\n");
  ASSERT_FALSE(index.uses().empty());
  EXPECT_TRUE(std::ranges::any_of(index.uses(), [](const editing::Use& use) {
    return use.kind == UseKind::kJump && use.number == 900;
  }));
}

// OPT-7.17: the list ends with its parenthesis.
TEST(TextEdges, BehindAListOfJumpsNoNumberJumps) {
  const ProgramIndex index("GOTO VI[1] (10), 20\nGOTO VI[1] ((1), 30)\n10 STOP\n");
  std::vector<int> jumps;
  for (const editing::Use& use : index.uses()) {
    if (use.kind == UseKind::kJump) jumps.push_back(use.number);
  }
  EXPECT_EQ(jumps, (std::vector<int>{10, 30}));
}

TEST(TextEdges, AWholeNumberStandsAlone) {
  const auto whole = [](std::string_view text) {
    const ProgramIndex index(text);
    return index.declarations().empty() ? std::optional<std::uint32_t>(0)
                                        : index.declarations()[0].whole;
  };
  EXPECT_EQ(whole("DECLARE A = 44"), 44U);
  EXPECT_EQ(whole("DECLARE A = 44 X"), std::nullopt);
  EXPECT_EQ(whole("DECLARE A = 44 + 1"), std::nullopt);
  EXPECT_EQ(whole("DECLARE A = -44"), std::nullopt);
}

// As much as there is of a program at most, in memory that costs nothing until it is written to.
TEST(TextEdges, AGibibyteOfTextIsAProgram) {
  constexpr std::string_view kHead = "STOP\n;";
  const std::size_t room = kSourceBytesMax + 1;
  void* const memory = ::mmap(nullptr, room, PROT_READ | PROT_WRITE,
                              MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  std::ranges::copy(kHead, static_cast<char*>(memory));
  const std::string_view text(static_cast<const char*>(memory), room);
  EXPECT_EQ(ProgramIndex(text.substr(1)).statements().size(), 1U);
  EXPECT_EQ(ProgramIndex(text).statements().size(), 0U);
  ::munmap(memory, room);
}

}  // namespace
}  // namespace rmlcell::optimo
