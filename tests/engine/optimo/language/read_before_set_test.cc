#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "engine/optimo/language/formatter.h"
#include "tests/engine/optimo/language/compile_text.h"

// Advice that tells variables and neighbours apart, and sequence numbers in a formatted text.
namespace rmlcell::optimo {
namespace {

std::vector<std::string> AdvisedBy(const std::string& text, const std::string& rule) {
  std::vector<std::string> told;
  for (const Diagnostic& d : Compile(text, "", {.advice = true}).diagnostics) {
    if (d.rule == rule) told.push_back(d.detail);
  }
  return told;
}

// OPT-1.17: a variable of one group says nothing of those of another one, whatever their numbers.
TEST(ReadBeforeSet, GroupsAreApart) {
  const auto told = [](const std::string& text) { return AdvisedBy(text, "OPT-1.17").size(); };
  for (int index = 2; index <= 40; ++index) {
    const std::string n = "[" + std::to_string(index) + "]";
    const std::string m = "[" + std::to_string(100 - index) + "]";
    EXPECT_EQ(told("VI" + n + "=1\nVR[1]=VR" + m + "*2.\nVR" + m + "=1.\n"), 1U) << n;
    EXPECT_EQ(told("VL" + n + "=ON\nVI[1]=VI" + m + "+1\nVI" + m + "=1\n"), 1U) << n;
    EXPECT_EQ(told("VR" + n + "=1.\nVR[1]=VR" + n + "*2.\n"), 0U) << n;
    EXPECT_EQ(told("VI" + n + "=1\nVI[1]=VI" + n + "+1\n"), 0U) << n;
    EXPECT_EQ(told("VL" + n + "=ON\nVL[1]=VL" + n + "\n"), 0U) << n;
  }
}

// OPT-5.46: the approach is the MOVE right before the WORK that switches the beam on.
TEST(ReadBeforeSet, TheMoveBeforeTheBeam) {
  const auto approaches = [](const std::string& around) {
    const std::vector<std::string> told =
        AdvisedBy("COORD ABSOL\nPATH LIN\nWORKDEF 2,0 (5)\nSPEED 30.\n" + around, "OPT-5.46");
    return std::ranges::count_if(told, [](const std::string& detail) {
      return detail.find("to the pierce point") != std::string::npos;
    });
  };
  const std::string move = "MOVE (1,2,3,0,0)\n", slow = "SPEED 10.\n", on = "WORK 0,0/ON\n";
  EXPECT_EQ(approaches(move + on + "WORK 0,0/OFF\n"), 1);
  EXPECT_EQ(approaches(move + slow + on + "WORK 0,0/OFF\n"), 0);
  EXPECT_EQ(approaches(move + "WORK 2,0/ON\nWORK 2,0/OFF\n"), 0);
  EXPECT_EQ(approaches(move + "WORK 0,0/OFF\n"), 0);
  EXPECT_EQ(approaches("WORK 2,0/ON\n" + move + "WORK 2,0/OFF\n"), 0);
  EXPECT_EQ(approaches(slow + move + on + "WORK 0,0/OFF\n"), 0);
  EXPECT_EQ(approaches(move), 0);
}

// OPT-B.40: every sequence number stays where it leads, several in a row and those at the end, too.
TEST(ReadBeforeSet, SequenceNumbersOfAFormattedText) {
  for (const std::string text :
       {"10\n20\n30 delay 1.\ngoto 20\n", "10 \n20\n delay 1.\ngoto 10\n",
        "delay 1.\ngoto 40\n40\n50\n60\n", "10 20 delay 1.\n", "5\n; c\n6\n\n7 delay 2.\n8\n9\n"}) {
    const Compilation compiled = Compile(text, "", {.advice = false});
    if (!compiled.ok) continue;
    const std::string formatted = Format(text).text;
    EXPECT_EQ(MustCompile(formatted).object, compiled.object) << formatted;
    EXPECT_FALSE(Format(formatted).changed) << formatted;
    for (const std::string number :
         {"10", "20", "30", "40", "50", "60", "5\n", "6\n", "8\n", "9\n"}) {
      EXPECT_EQ(formatted.find(number) == std::string::npos, text.find(number) == std::string::npos)
          << number << " in " << formatted;
    }
  }
}

}  // namespace
}  // namespace rmlcell::optimo
