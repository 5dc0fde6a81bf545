#include "engine/optimo/offline/listing.h"

#include <gtest/gtest.h>

#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

// OPT-8.73, OPT-6.02: the first seven lines of the manual's table of steps.
TEST(Listing, NumbersLinesAndSteps) {
  const std::string text =
      "DECLARE XAXIS = VR[0]\nDECLARE YAXIS = VR[1]\nDECLARE ZAXIS = VR[2]\nDECLARE RAPID = "
      "VR[64]\n"
      "DECLARE APPROACH = VR[69]\nDECLARE FEED = VR[74]\nXAXIS = 500.0\n20 SPEED RAPID\n";
  const std::string list = List(MustCompile(text).module);
  EXPECT_NE(list.find("    1     0       DECLARE XAXIS = VR[0]\n"), std::string::npos);
  EXPECT_NE(list.find("    7     1       LET XAXIS = 500.0\n"), std::string::npos);
  EXPECT_NE(list.find("    8     2  20   SPEED RAPID\n"), std::string::npos);
}

// OPT-8.73, OPT-1.27: a lone number has a line and no step.
TEST(Listing, LoneNumbersAreNoSteps) {
  EXPECT_EQ(List(MustCompile("15\n16 SPEED 5\n17\n").module),
            "    1     0  15\n    2     1  16   SPEED 5\n    3     0  17\n");
}

// OPT-8.73: columns of five, that wider numbers push on.
TEST(Listing, ColumnsHaveFivePlaces) {
  std::string text;
  for (int n = 0; n < 100'001; ++n) text += "STOP\n";
  const Compilation compiled = Compile(text, "", {.object_limit = 0, .advice = false});
  const std::string list = List(compiled.module);
  EXPECT_TRUE(list.starts_with("    1     1       STOP\n"));
  EXPECT_NE(list.find("\n 9999  9999       STOP\n"), std::string::npos);
  EXPECT_NE(list.find("\n99999 99999       STOP\n"), std::string::npos);
  EXPECT_TRUE(list.ends_with("\n100001 100001       STOP\n"));
}

}  // namespace
}  // namespace rmlcell::optimo
