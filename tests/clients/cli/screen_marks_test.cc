// How the buttons of the handbox look that are held or lit, and what a terminal without room is
// told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <string>
#include <vector>

#include "clients/cli/handbox_screen.h"

namespace rmlcell::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string AllMarkedLines(const HandboxView& view) {
  const std::vector<std::string> lines = HandboxLines(view);
  return std::accumulate(lines.begin(), lines.end(), std::string());
}

// LIVE-7.11
TEST(ScreenMarks, AButtonThatIsHeldOrLitIsReversed) {
  HandboxView view;
  const std::string plain = AllMarkedLines(view);
  EXPECT_THAT(plain, HasSubstr("\x1b[1mx\x1b[0m X+   "));
  EXPECT_THAT(plain, HasSubstr("\x1b[1mR\x1b[0m ROB  "));
  view.down = {"X+"};
  view.panel.add_lamps("ROB");
  const std::string marked = AllMarkedLines(view);
  EXPECT_THAT(marked, HasSubstr("\x1b[1mx\x1b[0m>\x1b[7mX+   \x1b[0m"));
  EXPECT_THAT(marked, HasSubstr("\x1b[1mR\x1b[0m*\x1b[7mROB  \x1b[0m"));
  EXPECT_THAT(marked, HasSubstr("\x1b[1mX\x1b[0m X-   "));
}

// OPT-4.01: twenty characters, whatever is shown of them.
TEST(ScreenMarks, TheFrameOfTheDisplayStandsStill) {
  HandboxView view;
  view.marks = false;
  for (const std::string display : {"", "P=45", "12345678901234567890"}) {
    view.panel.set_display(display);
    const std::string line = HandboxLines(view).at(3);
    EXPECT_EQ(line.substr(0, 26), "  | " + display + std::string(20 - display.size(), ' ') + " |");
    EXPECT_EQ(line.substr(26), "    pressed  by nobody");
  }
}

// What came of the last key here goes before what the handbox shows of an earlier one.
TEST(ScreenMarks, OneNoteStandsBelowTheButtons) {
  HandboxView view;
  view.marks = false;
  const auto note = [&view] { return HandboxLines(view).at(22); };
  EXPECT_EQ(note(), "  ");
  view.note = "REC: no";
  EXPECT_EQ(note(), "  REC: no");
  view.panel.set_message_code("OPT-E12");
  EXPECT_EQ(note(), "  REC: no");
  view.note.clear();
  EXPECT_EQ(note(), "  OPT-E12");
}

// A letter of another language is as wide as any other: eighty of them are a line.
TEST(ScreenMarks, ALineHasEightyLettersOfAnyLanguage) {
  HandboxView view;
  view.marks = false;
  std::string letters;
  for (int k = 0; k < 78; ++k) letters += "ü";
  view.note = letters + "üü";
  EXPECT_EQ(HandboxLines(view).at(22), "  " + letters);
}

TEST(ScreenMarks, ATerminalWithoutRoomIsToldWhatFits) {
  HandboxView view;
  view.rows = 3;
  view.columns = 10;
  EXPECT_THAT(HandboxLines(view), ElementsAre("too small:", "needs 80 x", "Space STOP"));
  view.columns = 1;
  EXPECT_THAT(HandboxLines(view), ElementsAre("t", "n", "S"));
  view.columns = 0;
  EXPECT_THAT(HandboxLines(view), ElementsAre("", "", ""));
  view.columns = 80;
  view.rows = 1;
  EXPECT_THAT(HandboxLines(view), ElementsAre("too small: 80 x 1"));
  view.rows = 0;
  EXPECT_THAT(HandboxLines(view), IsEmpty());
  view.rows = 23;
  EXPECT_EQ(HandboxLines(view).back(), "q quits");
}

}  // namespace
}  // namespace rmlcell::cli
