// A WORKDEF that is refused says which of its values it is refused for, and that value. OPT-3.04
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::workdef_words {
namespace {

TEST(WorkdefWords, EachValueIsNamed) {
  const std::pair<std::string, std::string> rows[] = {
      {"VR[3],60.,3.,90.", "speed of WORKDEF is -3"},
      {"VR[2],60.,3.,90.", "speed of WORKDEF is 101"},
      {"10.,VR[3],3.,90.", "power of WORKDEF is -3"},
      {"10.,VR[2],3.,90.", "power of WORKDEF is 101"},
      {"10.,60.,VR[3],90.", "delay of WORKDEF is -3"},
      {"10.,60.,3.,VR[3]", "peak of WORKDEF is -3"},
      {"10.,60.,3.,VR[2]", "peak of WORKDEF is 101"},
  };
  for (const auto& [values, detail] : rows) {
    const Ran ran = RunText("VR[2] = 101\nVR[3] = -3\nWORKDEF 1,1 (" + values + ")\n");
    EXPECT_EQ(CodeOf(ran), 7205) << values;
    EXPECT_EQ(ran.outcome.detail, detail) << values;
  }
}

}  // namespace
}  // namespace rmlcell::optimo::testing::workdef_words
