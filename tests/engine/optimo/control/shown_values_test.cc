#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "engine/optimo/machine/machine_state.h"
#include "tests/engine/optimo/control/run_text.h"

// How a run shows variables, and what it says of a TCP.
namespace rmlcell::optimo::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::string Shown(float value) {
  DataArea data;
  data.vr[99] = value;
  return ReadByName(data, "VR[99]")->text;
}

// OPT-B.39: the shortest decimal form with at least one decimal; an INTEGER without a point.
TEST(ShownValues, AreShortest) {
  EXPECT_EQ(Shown(1262.139005F), "1262.139");
  EXPECT_EQ(Shown(80.0F), "80.0");
  DataArea data;
  data.vi[5] = 5.0F;
  EXPECT_EQ(ReadByName(data, "VI[5]")->text, "5");
  EXPECT_EQ(Value("VR[0]=1262.139005\n", "VR[0]"), "1262.139");
}

// OPT-B.39: no exponent between 1E-4 and 1E7, one outside; either form reads back to the value.
TEST(ShownValues, ReadBackToTheSameValue) {
  std::uint32_t bits = 12345;
  int with_exponent = 0;
  int without = 0;
  for (int n = 0; n < 20'000; ++n) {
    bits = bits * 1664525U + 1013904223U;
    const auto value = std::bit_cast<float>(bits);
    if (!std::isnormal(value)) continue;
    const std::string text = Shown(value);
    EXPECT_EQ(std::strtof(text.c_str(), nullptr), value) << text;
    const std::size_t point = text.find('.');
    ASSERT_NE(point, std::string::npos) << text;
    EXPECT_TRUE(point + 1 < text.size() && text[point + 1] >= '0' && text[point + 1] <= '9')
        << text;
    const bool fixed = std::abs(value) >= 1e-4F && std::abs(value) <= 1e7F;
    EXPECT_EQ(text.find('E') == std::string::npos, fixed) << text;
    ++(fixed ? without : with_exponent);
  }
  EXPECT_GT(without, 1000);
  EXPECT_GT(with_exponent, 1000);
}

// A name is that of a group of either case and a number from 0 to 99; anything else is no variable.
TEST(ShownValues, NamesOfVariables) {
  DataArea data;
  data.vl[1] = true;
  data.il[2] = true;
  data.ol[3] = true;
  data.ia[4] = 4.5F;
  data.oa[5] = 5.5F;
  data.vi[0] = -7.0F;
  EXPECT_EQ(ReadByName(data, "VL[1]")->text, "1");
  EXPECT_EQ(ReadByName(data, "vl[2]")->text, "0");
  EXPECT_EQ(ReadByName(data, "IL[2]")->text, "1");
  EXPECT_EQ(ReadByName(data, "il[1]")->text, "0");
  EXPECT_EQ(ReadByName(data, "Ol[3]")->text, "1");
  EXPECT_EQ(ReadByName(data, "OL[2]")->text, "0");
  EXPECT_EQ(ReadByName(data, "IA[4]")->text, "4.5");
  EXPECT_EQ(ReadByName(data, "OA[5]")->text, "5.5");
  EXPECT_EQ(ReadByName(data, "VI[0]")->text, "-7");
  EXPECT_EQ(ReadByName(data, "VR[99]")->text, "0.0");
  for (const char* wrong : {"VR[100]", "VR[-1]", "VR[]", "VR5", "VR[5", "XR[5]", "VRR[5]", "V[5]",
                            "PAR[0]", "", "[5]", "VR[a]"}) {
    EXPECT_FALSE(ReadByName(data, wrong).has_value()) << wrong;
  }
}

std::vector<int> FindingsOf(const std::string& text) {
  std::vector<int> numbers;
  for (const Diagnostic& finding : RunText(text).findings) {
    numbers.push_back(Lookup(finding.code).number);
  }
  return numbers;
}

// OPT-B.90: Z0 = Z1 with another X or Y: 7313 and nothing else, whichever of the four it is.
TEST(ToolWarnings, BesideTheAxisIsNoReversal) {
  EXPECT_THAT(FindingsOf("TCP (0,0,3/0,1,3)\n"), ElementsAre(7313));
  EXPECT_THAT(FindingsOf("TCP (0,0,3/1,0,3)\n"), ElementsAre(7313));
  EXPECT_THAT(FindingsOf("TCP (0,1,3/0,0,3)\n"), ElementsAre(7313));
  EXPECT_THAT(FindingsOf("TCP (1,0,3/0,0,3)\n"), ElementsAre(7313));
}

// OPT-4.55, OPT-4.70, OPT-4.71: reversed with Z0 below Z1, undefined with equal points; a TCP along
// the axis says nothing.
TEST(ToolWarnings, EachHasItsCause) {
  EXPECT_THAT(FindingsOf("TCP (0,0,3/0,0,2)\n"), IsEmpty());
  EXPECT_THAT(FindingsOf("TCP (0,0,2/0,0,3)\n"), ElementsAre(7315));
  EXPECT_THAT(FindingsOf("TCP (0,0,3/0,0,3)\n"), ElementsAre(7312));
  EXPECT_THAT(FindingsOf("TCP (1,0,3/1,0,3)\n"), ElementsAre(7312, 7313));
}

// OPT-4.70: offset and reference point are kept as given, also for the next run.
TEST(ToolWarnings, TheToolIsKept) {
  const Ran ran = RunText("TCP (1,2,3/4,5,6)\n");
  const Result<MachineState> state = DecodeMachineState(ran.machine_state);
  ASSERT_TRUE(bool(state));
  EXPECT_EQ(state->tool.offset, (motion::ToolOffset{1.0, 2.0, 3.0}));
  EXPECT_THAT(state->tool.reference, ElementsAre(4.0, 5.0, 6.0));
}

}  // namespace
}  // namespace rmlcell::optimo::testing
