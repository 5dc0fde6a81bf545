// What CONVERT takes the numbers of each variable for, as a hover says it.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "engine/optimo/editing/variable_facts.h"

namespace rmlcell::optimo::editing {
namespace {

std::size_t TimesIn(const std::string& text, std::string_view words) {
  std::size_t times = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1))
    ++times;
  return times;
}

// OPT-8.30: VR 0-2, 5-7, 10-12, 15-17, 20-22, 80-88, 92-94 are lengths; OPT-8.31: VR 3-4, 8-9,
// 13-14, 18-19, 23-24, 89-91, 95-97 are angles.
TEST(UnitsTold, AVariableIsALengthOrAnAngleOrNeither) {
  const std::set<int> lengths = {0,  1,  2,  5,  6,  7,  10, 11, 12, 15, 16, 17, 20, 21,
                                 22, 80, 81, 82, 83, 84, 85, 86, 87, 88, 92, 93, 94};
  const std::set<int> angles = {3, 4, 8, 9, 13, 14, 18, 19, 23, 24, 89, 90, 91, 95, 96, 97};
  for (int index = 0; index <= 99; ++index) {
    const std::string facts = VariableFacts({VariableGroup::kVr, static_cast<std::uint8_t>(index)});
    EXPECT_EQ(TimesIn(facts, "CONVERT"), lengths.count(index) + angles.count(index)) << index;
    EXPECT_EQ(TimesIn(facts, "for lengths (OPT-8.30)."), lengths.count(index)) << index;
    EXPECT_EQ(TimesIn(facts, "for angles (OPT-8.30)."), angles.count(index)) << index;
    const std::string whole = VariableFacts({VariableGroup::kVi, static_cast<std::uint8_t>(index)});
    EXPECT_EQ(TimesIn(whole, "CONVERT"), 0U) << index;
  }
}

}  // namespace
}  // namespace rmlcell::optimo::editing
