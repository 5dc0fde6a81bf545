#include "clients/cli/handbox_keys.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace rmlcell::cli {
namespace {

// LIVE-7.03
constexpr std::array<std::string_view, 67> kNames = {"START",
                                                     "STOP",
                                                     "HOLD",
                                                     "SHIFT",
                                                     "STEP",
                                                     "HOME",
                                                     "ZERO",
                                                     "NOTE",
                                                     "POINT",
                                                     "MINUS",
                                                     "DEL",
                                                     "MODE_LEFT",
                                                     "MODE_RIGHT",
                                                     "OVERRIDE_PLUS",
                                                     "JOG_ROB",
                                                     "JOG_ABS",
                                                     "JOG_TCP",
                                                     "X+",
                                                     "X-",
                                                     "Y+",
                                                     "Y-",
                                                     "Z+",
                                                     "Z-",
                                                     "A+",
                                                     "A-",
                                                     "B+",
                                                     "B-",
                                                     "C+",
                                                     "C-",
                                                     "MOD",
                                                     "REC",
                                                     "ERR",
                                                     "PREV",
                                                     "NEXT",
                                                     "ENT",
                                                     "JOB",
                                                     "TCP",
                                                     "DYN",
                                                     "PATH",
                                                     "WORK",
                                                     "DLY",
                                                     "MOV",
                                                     "OUT",
                                                     "DEB",
                                                     "CAL",
                                                     "PAR",
                                                     "DISP",
                                                     "F1",
                                                     "F2",
                                                     "F3",
                                                     "F4",
                                                     "F5",
                                                     "F6",
                                                     "F7",
                                                     "F8",
                                                     "0",
                                                     "1",
                                                     "2",
                                                     "3",
                                                     "4",
                                                     "5",
                                                     "6",
                                                     "7",
                                                     "8",
                                                     "9",
                                                     "OVERRIDE_MINUS",
                                                     "EMERGENCY_STOP"};

TEST(HandboxKeys, AreThoseOfAHandboxEachOnce) {
  std::set<std::string_view> known;
  for (const HandboxKey& key : AllHandboxKeys()) EXPECT_TRUE(known.insert(key.name).second);
  EXPECT_EQ(known, std::set<std::string_view>(kNames.begin(), kNames.end()));
}

// What moves as long as it is down is never taken for a tap, and nothing else is held.
TEST(HandboxKeys, JogKeysAndHomeAreHeld) {
  for (const HandboxKey& key : AllHandboxKeys()) {
    const bool jogs =
        key.name == "HOME" || (key.name.size() == 2 && (key.name[1] == '+' || key.name[1] == '-'));
    EXPECT_EQ(key.holding == Holding::kHeld, jogs) << key.name;
  }
}

TEST(HandboxKeys, HaveATypedKeyOfTheirOwn) {
  std::set<std::string_view> typed;
  for (const HandboxKey& key : AllHandboxKeys()) {
    EXPECT_TRUE(typed.insert(key.typed).second) << key.typed;
    EXPECT_EQ(HandboxKeyTyped(key.typed), &key) << key.name;
    EXPECT_NE(key.typed, "q");  // quits
    if (key.also.empty()) continue;
    EXPECT_TRUE(typed.insert(key.also).second) << key.also;
    EXPECT_EQ(HandboxKeyTyped(key.also), &key) << key.name;
  }
  EXPECT_EQ(HandboxKeyTyped(""), nullptr);
  EXPECT_EQ(HandboxKeyTyped("q"), nullptr);
}

// LIVE-7.11: a mouse reaches each, on all of its button, and on nothing else.
TEST(HandboxKeys, HaveAButtonOfTheirOwn) {
  std::map<std::pair<int, int>, std::string_view> taken;
  for (const HandboxKey& key : AllHandboxKeys()) {
    EXPECT_LT(key.row, kHandboxRows - 2) << key.name;
    EXPECT_LE(key.label.size(), static_cast<std::size_t>(key.cells * kHandboxCell - 5)) << key.name;
    for (int column = key.cell * kHandboxCell; column < (key.cell + key.cells) * kHandboxCell;
         ++column) {
      EXPECT_LT(column, kHandboxColumns) << key.name;
      EXPECT_TRUE(taken.try_emplace({key.row, column}, key.name).second) << key.name;
      EXPECT_EQ(HandboxKeyAt(key.row, column), &key);
    }
  }
  for (int row = -1; row <= kHandboxRows; ++row) {
    for (int column = -1; column <= kHandboxColumns; ++column)
      EXPECT_EQ(HandboxKeyAt(row, column) != nullptr, taken.contains({row, column}));
  }
}

}  // namespace
}  // namespace rmlcell::cli
