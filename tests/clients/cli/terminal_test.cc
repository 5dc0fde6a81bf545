#include "clients/cli/terminal.h"

#include <gtest/gtest.h>

#include <cmath>

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
  EXPECT_EQ(Table({{"job", "state", "title"}, {"1", "succeeded", "B\xC3\xBCgel"}, {"1234", "", "x"}}),
            "job   state      title\n"
            "1     succeeded  B\xC3\xBCgel\n"
            "1234             x\n");
  EXPECT_EQ(Table({{"\xC3\xBC", "b"}, {"cc", "d\n"}}), "\xC3\xBC   b\ncc  d\\x0A\n");
  EXPECT_EQ(Table({}), "");
}

TEST(Terminal, FixedHasSoManyDecimals) {
  EXPECT_EQ(Fixed(1.25, 3), "1.250");
  EXPECT_EQ(Fixed(-0.5, 1), "-0.5");
  EXPECT_EQ(Fixed(12.0, 0), "12");
}

}  // namespace
}  // namespace rmlcell::cli
