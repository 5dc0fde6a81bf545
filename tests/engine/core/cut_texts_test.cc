// Texts that are a part of a longer one: what stands behind them is none of theirs.
#include <gtest/gtest.h>

#include "engine/core/characters.h"
#include "engine/core/hex.h"
#include "engine/core/untold_findings.h"

namespace rmlcell {
namespace {

TEST(CutTexts, HalfAByteOfDigitsIsNone) {
  constexpr std::string_view kDigits = "00a9ff";
  EXPECT_EQ(BytesOfHex(kDigits.substr(0, 3)), std::nullopt);
  EXPECT_EQ(BytesOfHex(kDigits.substr(0, 4)), std::string("\x00\xA9", 2));
}

TEST(CutTexts, ACharacterThatIsCutIsBytes) {
  constexpr std::string_view kText = "\xC3\xA4\xE2\x82\xAC";
  EXPECT_EQ(CharactersIn(kText.substr(0, 1), Encoding::kUtf8), 1U);
  EXPECT_EQ(CharactersIn(kText.substr(0, 4), Encoding::kUtf32), 3U);
  EXPECT_EQ(BytesOfCharacters(kText.substr(0, 4), 9, Encoding::kUtf32), 4U);
}

// The place of a finding that is not told is as serious as the finding.
TEST(UntoldFindings, APlaceHasItsSeverity) {
  UntoldFindings untold;
  untold.Add(Diagnostic{.code = ErrorCode::kRml1Clipped, .severity = Severity::kProgram});
  EXPECT_EQ(untold.kinds().at(ErrorCode::kRml1Clipped).first.severity, Severity::kProgram);
  EXPECT_EQ(untold.kinds().at(ErrorCode::kRml1Clipped).last.severity, Severity::kProgram);
}

}  // namespace
}  // namespace rmlcell
