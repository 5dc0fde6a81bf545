#include "clients/lsp/check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "tests/clients/lsp/editor.h"

namespace rmlcell::lsp {
namespace {

using testing::HasSubstr;

Json DiagnosticsOf(std::string_view text, std::string_view uri = kUri,
                   std::string_view language = "optimo-rml") {
  Editor editor;
  editor.Open(text, uri, language);
  return editor.Diagnostics()["diagnostics"];
}

// OPT-2.35
TEST(Check, AnErrorHasItsPlaceCodeAndRule) {
  const Json found = DiagnosticsOf("PATH LIN\n  SPEED 101\n");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0]["range"], ToJson(Range{{1, 8}, {1, 11}}));
  EXPECT_EQ(found[0]["severity"], 1);
  EXPECT_EQ(found[0]["code"], "OPT-E7004");
  EXPECT_EQ(found[0]["source"], "rmlcell");
  EXPECT_THAT(found[0]["message"], HasSubstr("[OPT-2.35]"));
}

// OPT-1.32: behind characters of two and four bytes.
TEST(Check, PlacesAreUtf16) {
  const Json found =
      DiagnosticsOf("SPEED 5 ; \xF0\x9D\x84\x9E\nSPEED \xC3\xA4 5\nVR[0] = 1 ; \xE2\x82\xAC\n");
  ASSERT_GE(found.size(), 1U);
  EXPECT_EQ(found[0]["code"], "OPT-E7001");
  EXPECT_EQ(found[0]["range"]["start"], ToJson(Position{1, 6}));
}

// OPT-7.105, OPT-2.61
TEST(Check, SeveritiesAreThoseOfTheCatalogue) {
  const Json found = DiagnosticsOf("VI[75] = 1\n");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0]["severity"], 2);
  EXPECT_EQ(found[0]["code"], "OPT-E7413");
}

// OPT-3.47
TEST(Check, CodeThatIsNeverReachedIsGreyed) {
  const Json found = DiagnosticsOf("ENDTASK\nSPEED 5\n");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0]["severity"], 3);
  EXPECT_EQ(found[0]["tags"], Json::array({1}));
}

// OPT-5.46: other practice advice is about code that runs.
TEST(Check, OtherAdviceIsNotGreyed) {
  int advice = 0;
  for (const Json& found : DiagnosticsOf("COORD ABSOL\nPATH LIN\nSPEED 90\nMOVE (1,2,3,0,0)\n")) {
    if (found["code"] == "OPT-E7033") ++advice;
    EXPECT_FALSE(found.contains("tags")) << found.dump();
  }
  EXPECT_GE(advice, 1);
}

// OPT-2.04, OPT-8.26: an inch source is written before it is converted.
TEST(Check, AnInchSourceIsCheckedAsItStands) {
  const Json found = DiagnosticsOf("SPEED 101\n", "file:///work/a.SI");
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0]["code"], "OPT-E7030");
  EXPECT_EQ(found[0]["severity"], 3);
  EXPECT_EQ(found[1]["code"], "OPT-E7004");
}

// OPT-2.51: half an inch is more than a millimetre.
TEST(Check, AdviceInMillimetresIsNotGivenOnInches) {
  constexpr const char* kText =
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0.,0.,0.,0.,0.)\nMOVE (.5,0.,0.,0.,0.)/FLY\n"
      "MOVE (9.,0.,0.,0.,0.)\n";
  EXPECT_THAT(DiagnosticsOf(kText).dump(), HasSubstr("OPT-E7314"));
  EXPECT_THAT(DiagnosticsOf(kText, "file:///work/a.SI").dump(),
              testing::Not(HasSubstr("OPT-E7314")));
}

TEST(Check, AStreamForAMillHasItsFindings) {
  const Json found = DiagnosticsOf("PU0,0;QQ5;PD10,10;", "file:///work/a.rml", "rml1");
  ASSERT_GE(found.size(), 1U);
  EXPECT_THAT(found[0]["code"], HasSubstr("RML1-E"));
  EXPECT_EQ(found[0]["range"]["start"]["line"], 0);
}

TEST(Check, TheExtensionDecidesThenTheLanguage) {
  const auto family = [](std::string uri, std::string language) {
    return FamilyOf({std::move(uri), std::move(language), 0, {}, Encoding::kUtf16}).info().id;
  };
  EXPECT_EQ(family("file:///a.PRN", "optimo-rml"), "rml1");
  EXPECT_EQ(family("file:///a.s", "rml1"), "optimo");
  EXPECT_EQ(family("untitled:Untitled-1", "rml1"), "rml1");
  EXPECT_EQ(family("untitled:Untitled-1", "optimo-rml"), "optimo");
}

TEST(Check, AnEmptyTextIsNoError) { EXPECT_EQ(DiagnosticsOf(""), Json::array()); }

// check.h: texts of up to 64 MiB are checked; of a longer one only that is said.
TEST(Check, ATextThatIsTooLongIsNotChecked) {
  const auto check = [](std::size_t size) {
    std::string text = "SPEED 101\n;";
    text.resize(size, 'x');
    return CheckDocument({"file:///a.S", "optimo-rml", 1, std::move(text), Encoding::kUtf16});
  };
  const Findings checked = check(std::size_t{64} << 20);
  ASSERT_FALSE(checked.list.empty());
  for (const Diagnostic& finding : checked.list) EXPECT_NE(finding.code, ErrorCode::kCellTooLarge);
  const Findings left = check((std::size_t{64} << 20) + 1);
  ASSERT_EQ(left.list.size(), 1U);
  EXPECT_EQ(left.list[0].code, ErrorCode::kCellTooLarge);
  EXPECT_EQ(left.list[0].severity, Severity::kWarning);
  EXPECT_EQ(left.list[0].detail, "the text has 67108865 bytes; at most 67108864 are checked");
  EXPECT_TRUE(left.dropped.empty());
}

TEST(Check, MoreThanAThousandFindingsAreCounted) {
  std::string text;
  for (int i = 0; i < 1500; ++i) text += "SPEED 101\n";
  const Json found = DiagnosticsOf(text);
  ASSERT_EQ(found.size(), 1001U);
  EXPECT_EQ(found.back()["message"], "and 500 more findings");
}

// A place is bytes of the text: none where there is none, and cut where the text ends before it.
TEST(Check, AFindingMarksWhatIsInTheText) {
  const auto marked = [](std::int64_t offset, int length) {
    Diagnostic finding{.code = ErrorCode::kNameUndeclared};
    finding.where.byte_offset = offset;
    finding.where.length = length;
    const Marked place = PlaceOf(finding, "SPEED 5\n");
    return std::pair(place.begin, place.end);
  };
  using Pair = std::pair<std::size_t, std::size_t>;
  EXPECT_EQ(marked(-1, 5), Pair(0, 0));
  EXPECT_EQ(marked(0, 5), Pair(0, 5));
  EXPECT_EQ(marked(6, 0), Pair(6, 6));
  EXPECT_EQ(marked(6, -3), Pair(6, 6));
  EXPECT_EQ(marked(6, 2), Pair(6, 8));
  EXPECT_EQ(marked(6, 3), Pair(6, 8));
  EXPECT_EQ(marked(8, 1), Pair(8, 8));
  EXPECT_EQ(marked(9, 1), Pair(8, 8));
}

// A language that nobody here speaks is taken for that which people write.
TEST(Check, AnUnknownLanguageIsThatOfPrograms) {
  for (const char* language : {"plaintext", ""}) {
    const Document document("untitled:Untitled-1", language, 0, {}, Encoding::kUtf16);
    EXPECT_EQ(FamilyOf(document).info().id, "optimo") << language;
  }
}

// How many were left out is a warning at the end of the text.
TEST(Check, WhatWasLeftOutStandsAtTheEnd) {
  std::string text;
  for (int i = 0; i < 1001; ++i) text += "SPEED 101\n";
  const Json last = DiagnosticsOf(text).back();
  EXPECT_EQ(last["message"], "and 1 more findings");
  EXPECT_EQ(last["severity"], 2);
  EXPECT_EQ(last["source"], "rmlcell");
  EXPECT_EQ(last["range"], ToJson(Range{{1001, 0}, {1001, 0}}));
}

}  // namespace
}  // namespace rmlcell::lsp
