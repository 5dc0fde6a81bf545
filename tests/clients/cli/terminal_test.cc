#include "clients/cli/terminal.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>

#include "clients/cli/full_screen.h"
#include "tests/clients/cli/on_terminal.h"

namespace rmlcell::cli {
namespace {

// clients/cli/terminal.h: the larger units only where there are any.
TEST(Terminal, TellsDurationsInHoursMinutesAndSeconds) {
  EXPECT_EQ(Duration(0.0), "0.000 s");
  EXPECT_EQ(Duration(59.9994), "59.999 s");
  EXPECT_EQ(Duration(60.0), "1 min 0.000 s");
  EXPECT_EQ(Duration(61.5), "1 min 1.500 s");
  EXPECT_EQ(Duration(3599.0), "59 min 59.000 s");
  EXPECT_EQ(Duration(3600.0), "1 h 0 min 0.000 s");
  EXPECT_EQ(Duration(2 * 3600.0 + 3 * 60.0 + 4.25), "2 h 3 min 4.250 s");
  EXPECT_EQ(Duration(-1.0), "-");
  EXPECT_EQ(Duration(std::nan("")), "-");
}

TEST(Terminal, TellsSizesByThousands) {
  EXPECT_EQ(Bytes(0), "0 B");
  EXPECT_EQ(Bytes(999), "999 B");
  EXPECT_EQ(Bytes(1000), "1.0 kB");
  EXPECT_EQ(Bytes(1240), "1.2 kB");
  EXPECT_EQ(Bytes(999'000), "999.0 kB");
  EXPECT_EQ(Bytes(1'000'000), "1.0 MB");
  EXPECT_EQ(Bytes(2'500'000'000), "2500.0 MB");
}

// Foreign text must not steer the terminal.
TEST(Terminal, ShowsControlCharactersAsNumbers) {
  EXPECT_EQ(Visible("plain ~"), "plain ~");
  EXPECT_EQ(Visible("\x1B[2J\n\x7F\x1F"), "\\x1B[2J\\x0A\\x7F\\x1F");
  EXPECT_EQ(Visible("\xC3\xA4"), "\xC3\xA4");  // letters of other languages are text
}

TEST(Terminal, PaintsOnlyWhereItIsWanted) {
  EXPECT_EQ(Paint("a", Colour::kRed, false), "a");
  EXPECT_EQ(Paint("a", Colour::kPlain, true), "a");
  EXPECT_EQ(Paint("a", Colour::kRed, true), "\x1B[31ma\x1B[0m");
  EXPECT_EQ(Paint("a", Colour::kYellow, true), "\x1B[33ma\x1B[0m");
  EXPECT_EQ(Paint("a", Colour::kGreen, true), "\x1B[32ma\x1B[0m");
  EXPECT_EQ(Paint("a", Colour::kBold, true), "\x1B[1ma\x1B[0m");
  EXPECT_EQ(Paint("a", Colour::kDim, true), "\x1B[2ma\x1B[0m");
}

TEST(Terminal, TablesHaveColumnsAsWideAsTheyNeedToBe) {
  EXPECT_EQ(
      Table({{"job", "state", "title"}, {"1", "succeeded", "B\xC3\xBCgel"}, {"1234", "", "x"}}),
      "job   state      title\n"
      "1     succeeded  B\xC3\xBCgel\n"
      "1234             x\n");
  EXPECT_EQ(Table({{"\xC3\xBC", "b"}, {"cc", "d\n"}}), "\xC3\xBC   b\ncc  d\\x0A\n");
  EXPECT_EQ(Table({}), "");
}

// A title of 200 characters leaves the columns behind it where they can be seen.
TEST(Terminal, LongCellsAreCut) {
  const std::string sixty(60, 'x');
  EXPECT_EQ(Table({{sixty, "b"}}), sixty + "  b\n");
  EXPECT_EQ(Table({{sixty + "yz", "b"}}), sixty.substr(1) + "…  b\n");
  std::string umlauts;
  for (int k = 0; k < 61; ++k) umlauts += "ü";
  EXPECT_EQ(Table({{umlauts, "b"}}), umlauts.substr(0, 59 * 2) + "…  b\n");
}

// On a terminal of 40 characters the title gives way, down to 8 characters; nothing else does.
TEST(Terminal, TablesFitTheirTerminal) {
  const std::vector<std::vector<std::string>> rows = {
      {"JOB", "TITLE", "SUBMITTED"}, {"17", std::string(50, 'x'), "2026-11-24 00:30:11"}};
  // 3 + 2 + 2 + 19 leave 14.
  EXPECT_EQ(Table(rows, 40), "JOB  TITLE           SUBMITTED\n17   " + std::string(13, 'x') +
                                 "…  2026-11-24 00:30:11\n");
  EXPECT_EQ(Table(rows, 0), Table(rows, 76));  // 3 + 2 + 50 + 2 + 19
  EXPECT_NE(Table(rows, 75), Table(rows, 76));
  EXPECT_EQ(Table(rows, 1), Table(rows, 34));  // 3 + 2 + 8 + 2 + 19
  EXPECT_EQ(Table({{"JOB", "TITLE"}, {"1", "x"}}, 1), "JOB  TITLE\n1    x\n");
  EXPECT_EQ(Table({{"a"}, {std::string(50, 'x')}}, 10), "a\n" + std::string(50, 'x') + "\n");
}

TEST(Terminal, FixedHasSoManyDecimals) {
  EXPECT_EQ(Fixed(1.25, 3), "1.250");
  EXPECT_EQ(Fixed(-0.5, 1), "-0.5");
  EXPECT_EQ(Fixed(12.0, 0), "12");
}

std::string Repeated(const std::string& cell, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += cell;
  return text;
}

constexpr const char* kNewLine = "\r\x1B[K";  // over what stood there

TEST(Progress, TheBarHasTwentyEightCells) {
  const auto shown = [](double share) {
    ProgressLine line;
    const std::string text = OnErrors([&] { line.Show(share, "jobs/7"); });
    OnErrors([&] { line.Clear(); });
    return text;
  };
  const auto bar = [](int filled, const std::string& share) {
    return kNewLine + Repeated("█", filled) + Repeated("░", 28 - filled) + share + "  jobs/7";
  };
  EXPECT_EQ(shown(0.0), bar(0, " 0 %"));
  EXPECT_EQ(shown(0.25), bar(7, " 25 %"));
  EXPECT_EQ(shown(0.5), bar(14, " 50 %"));
  EXPECT_EQ(shown(0.99), bar(28, " 99 %"));
  EXPECT_EQ(shown(1.0), bar(28, " 100 %"));
}

// How far it is is not known: a mark goes from end to end and back.
TEST(Progress, TheMarkGoesToAndFro) {
  ProgressLine line;
  for (int turn = 0; turn < 110; ++turn) {
    const int phase = turn % 54;
    const int place = phase <= 27 ? phase : 54 - phase;
    EXPECT_EQ(OnErrors([&] { line.Show(-1.0, "x"); }),
              kNewLine + Repeated("░", place) + "█" + Repeated("░", 27 - place) + "  x")
        << turn;
  }
  OnErrors([&] { line.Clear(); });
}

TEST(Progress, WhatIsDrawnIsTakenAwayOnce) {
  EXPECT_EQ(OnErrors([] { ProgressLine().Clear(); }), "");
  const std::string all = OnErrors([&] {
    ProgressLine line;
    line.Show(1.0, "x");
    line.Clear();
    line.Clear();
  });
  EXPECT_EQ(all, kNewLine + Repeated("█", 28) + " 100 %  x" + kNewLine);
  EXPECT_EQ(OnErrors([] {
              ProgressLine line;
              line.Show(1.0, "x");
            }),
            all);  // its end takes it away, too
  EXPECT_EQ(OnErrors([] {
              ProgressLine line;
              line.Leave(1.0, "x");
            }),
            kNewLine + Repeated("█", 28) + " 100 %  x\n");
}

// https://no-color.org: set and not empty.
TEST(Colours, OnATerminalUnlessTheyAreNotWanted) {
  const auto complaint = [](const char* no_colour) {
    no_colour != nullptr ? ::setenv("NO_COLOR", no_colour, 1) : ::unsetenv("NO_COLOR");
    return OnErrors([] { Complain("x"); });
  };
  EXPECT_EQ(complaint(nullptr), "\x1B[31mrmlcell: \x1B[0mx\n");
  EXPECT_EQ(complaint(""), "\x1B[31mrmlcell: \x1B[0mx\n");
  EXPECT_EQ(complaint("1"), "rmlcell: x\n");
  ::unsetenv("NO_COLOR");
  const auto table = [] { PrintRaw(Table({{"a", "b"}, {"c", "d"}})); };
  EXPECT_EQ(OnTerminal(STDOUT_FILENO, stdout, table), "\x1B[1ma  b\x1B[0m\nc  d\n");
  EXPECT_EQ(OnTerminal(STDOUT_FILENO, stdout, [] { Print("x"); }), "x\n");
}

TEST(Terminal, BlueIsSixOfThePalette) {
  EXPECT_EQ(Paint("a", Colour::kBlue, true), "\x1B[36ma\x1B[0m");
}

// A whole screen needs a terminal to read from and one to write to.
TEST(FullScreenCheck, BothEndsAreATerminal) {
  const int kept = ::dup(STDIN_FILENO);
  const int nothing = ::open("/dev/null", O_RDONLY);
  ASSERT_GE(nothing, 0);
  Status both = Error{ErrorCode::kCellUsage, "not looked at", {}};
  Status output_alone;
  OnTerminal(STDOUT_FILENO, stdout, [&] {
    ::dup2(STDOUT_FILENO, STDIN_FILENO);
    both = FullScreen::Check();
    ::dup2(nothing, STDIN_FILENO);
    output_alone = FullScreen::Check();
  });
  ::dup2(kept, STDIN_FILENO);
  ::close(kept);
  ::close(nothing);
  EXPECT_TRUE(both.ok());
  ASSERT_FALSE(output_alone.ok());
  EXPECT_EQ(output_alone.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(output_alone.error().detail, "standard input and output are no terminal");
}

}  // namespace
}  // namespace rmlcell::cli
