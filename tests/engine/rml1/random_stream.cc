#include "tests/engine/rml1/random_stream.h"

#include <gtest/gtest.h>

#include <iterator>
#include <string_view>

#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

// clang-format off
constexpr std::string_view kPieces[] = {
    "PD", "PU", "PA", "PR", "Z", "M", "D", "I", "VS", "V", "F", "!PZ", "!ZZ", "!MC", "!ZE X1Y",
    "!NR", "^PD", "^", "IN;", "H;", "!DW", "!ZO", "!ZM-", "@", ",", ",", ",", " ", ";", ";\n",
    "\n", "\r\n", "\t", ",,", ", ", "-", "+", ".", "..", ":", "100", "2000", "-35", "0", "00",
    "-0", "12.5", "-7.25", "1.", ".5", "999999", "1000000", "8388607", "8388608", "-8388609",
    "16777217", "33554433.0", "3.1415926535897932384", "12345678901234567890", "0.1", "7000000",
    "1.2.3", "\x1b.K", "\x1b.B", "\x1b", "\x1b.M1;2:", "\xb1", "Q", "pd", "p d",
};
// clang-format on

}  // namespace

std::string RandomStream(std::mt19937_64& dice, std::uint64_t pieces) {
  std::string stream;
  for (std::uint64_t n = pieces; n > 0; --n) {
    if (dice() % 3 == 0) {  // a whole command
      stream += kPieces[dice() % 8];
      for (std::uint64_t k = 1 + dice() % 6; k > 0; --k) {
        stream += std::to_string(static_cast<int>(dice() % 9000) - 500);
        if (k > 1) stream += dice() % 4 == 0 ? ' ' : ',';
      }
      stream += dice() % 8 == 0 ? "" : ";";
    } else {
      stream += kPieces[dice() % std::size(kPieces)];
    }
  }
  return stream;
}

machine::Parameters RandomMachine(std::mt19937_64& dice) {
  machine::Parameters parameters = ParametersOf(dice() % 4 == 0 ? "t1a" : "t1");
  const auto set = [&](const char* name, std::string_view value) {
    if (dice() % 4 != 0) return;
    EXPECT_TRUE(parameters.Set(name, value).ok());
  };
  set("COMMAND", dice() % 2 == 0 ? "MODE1" : "MODE2");
  set("OVER_AREA", "PAUSE");
  set("DATA_BITS", "7");
  set("SEQUENCES", "ALL");
  set("SKIP", "VPANEL");
  return parameters;
}

}  // namespace rmlcell::rml1
