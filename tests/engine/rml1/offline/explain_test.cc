#include "engine/rml1/offline/explain.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

std::vector<ExplainedPhrase> ExplainAll(std::string_view stream, std::string_view profile = "t1") {
  std::vector<ExplainedPhrase> phrases;
  const Status done = Explain(stream, ParametersOf(profile), [&](const ExplainedPhrase& phrase) {
    phrases.push_back(phrase);
    return true;
  });
  EXPECT_TRUE(done);
  return phrases;
}

std::vector<std::string> Words(std::string_view stream, std::string_view profile = "t1") {
  std::vector<std::string> words;
  for (const ExplainedPhrase& phrase : ExplainAll(stream, profile)) words.push_back(phrase.words);
  return words;
}

// T1: 100 units in a mm, Z0 20 mm below the top, tool up 5 mm, 2 mm/s, travel 60 mm/s, 4500 rpm
// (rml1.md 0.2).
TEST(Explain, MotionsInMillimetresOfTheWork) {
  EXPECT_EQ(Words("PU100,250;PD100,300;"),
            (std::vector<std::string>{
                "spindle starts, 4500 rpm; go to Z 5 at 2 mm/s; go to X 1 Y 2.5 at 60 mm/s",
                "tool down; down into the work to Z 0 at 2 mm/s; cut to Y 3 at 2 mm/s"}));
}

// The same numbers on a machine with 40 units in a mm: 100 / 40 = 2.5.
TEST(Explain, UnitsAreThoseOfTheProfile) {
  EXPECT_EQ(Words("!PZ0,80;PU100,0;", "mdx-20")[1],
            "spindle starts, 6500 rpm; go to Z 2 at 2 mm/s; go to X 2.5 at 15 mm/s");
}

// Places count from the work origin, here 50 mm from the left and 20 mm from the front.
TEST(Explain, PlacesAreFromTheWorkOrigin) {
  machine::Parameters moved = ParametersOf("t1");
  ASSERT_TRUE(moved.Set("ORIGIN_X", std::string_view("50")));
  ASSERT_TRUE(moved.Set("ORIGIN_Y", std::string_view("20")));
  std::vector<std::string> words;
  ASSERT_TRUE(Explain("!MC0;PU100,250;PU-6000,-2500;", moved, [&](const ExplainedPhrase& phrase) {
    words.push_back(phrase.words);
    return true;
  }));
  ASSERT_EQ(words.size(), 3U);
  EXPECT_EQ(words[1], "go to Z 5 at 2 mm/s; go to X 1 Y 2.5 at 60 mm/s");
  EXPECT_TRUE(words[2].ends_with(
      "beyond the travel: the commands lead to X -60 Y -25 Z 5, the tool does not follow"))
      << words[2];
}

TEST(Explain, SettingsSayWhatHoldsAfterwards) {
  // T1: Z0 is 20 mm below the top and 40 mm above the bottom; after !ZO-1000, 50 mm above it.
  EXPECT_EQ(Words("!PZ-4001,200;")[0],
            "tool down is Z 0 mm, tool up is Z 2 mm; the tool-down height may be from -40 to 0 mm");
  EXPECT_EQ(Words("!ZO-1000;!PZ5,200;")[1],
            "tool down is Z 0 mm, tool up is Z 2 mm; the tool-down height may be from -50 to 0 mm");
  EXPECT_EQ(Words("!PZ-50,-200;")[0],
            "tool down is Z -0.5 mm, tool up is Z 5 mm; the tool-up height may be from 0 mm");
  EXPECT_EQ(Words("!ZM-6001;")[0], "machine Z may be from -60 to 0 mm");
  EXPECT_EQ(Words("VS4;!VZ99;!PZ-150,300;!DW7;!MC0;!RC3;!ZO-1000;PR;PR;PD;"),
            (std::vector<std::string>{
                "cutting speed in X and Y 4 mm/s", "speed of Z and of three axes 60 mm/s",
                "tool down is Z -1.5 mm, tool up is Z 3 mm", "dwell of 7 ms before motions",
                "the spindle may not turn", "spindle speed 6600 rpm", "Z0 is machine Z -10 mm",
                "relative coordinates", "relative coordinates",
                // From the top, 10 mm above Z0, to 1.5 mm below it.
                "tool down; wait 7 ms; down into the work to Z -1.5 at 60 mm/s"}));
}

// RML1-3A.37, RML1-3B.03: H and IN say by themselves what they set; coordinates that become
// absolute with them are not told again.
TEST(Explain, WhatACommandSetsIsSaidOnce) {
  EXPECT_EQ(Words("PR;H;")[1],
            "home: up to the top, to the XY origin, spindle off, errors cleared");
  const std::string initialise = Words("PR;IN;")[1];
  EXPECT_TRUE(
      initialise.starts_with("initialise: defaults as DF, tool up, spindle off, errors cleared"));
  EXPECT_EQ(initialise.find("absolute"), std::string::npos) << initialise;
}

TEST(Explain, PlacesNumbersAndText) {
  const auto phrases = ExplainAll("PA;\r\n  PU1,2 ,3,4;");
  ASSERT_EQ(phrases.size(), 3U);
  EXPECT_EQ(phrases[1].offset, 7);
  EXPECT_EQ(phrases[1].command, 2U);
  EXPECT_EQ(phrases[1].name, "PU");
  EXPECT_EQ(phrases[1].text, "PU1,2");
  EXPECT_EQ(phrases[2].offset, 14);  // the 3
  EXPECT_EQ(phrases[2].command, 2U);
  EXPECT_EQ(phrases[2].text, "3,4");
}

TEST(Explain, ErrorsStandAtTheirPhraseAsInACheck) {
  const auto phrases = ExplainAll("XX 12;PU100;Z0,0,-9000;");
  ASSERT_EQ(phrases.size(), 3U);
  EXPECT_EQ(phrases[0].words, "5 bytes that are no command");
  EXPECT_EQ(phrases[0].name, "");
  EXPECT_EQ(phrases[0].command, 0U);
  ASSERT_EQ(phrases[0].findings.size(), 3U);
  EXPECT_EQ(phrases[0].findings[0].code, ErrorCode::kRml1UnknownCommand);
  EXPECT_EQ(phrases[0].findings[1].code, ErrorCode::kRml1WrongParameters);
  ASSERT_EQ(phrases[1].findings.size(), 1U);
  EXPECT_EQ(phrases[1].findings[0].detail, "PU lacks a number of its last set");
  EXPECT_EQ(phrases[1].words, "not carried out");
  // The bottom is 40 mm below Z0; the spindle starts, and the tool stays at the bottom.
  ASSERT_EQ(phrases[2].findings.size(), 1U);
  EXPECT_EQ(phrases[2].findings[0].code, ErrorCode::kRml1Clipped);
  EXPECT_NE(phrases[2].words.find("beyond the travel: the commands lead to X 0 Y 0 Z -90"),
            std::string::npos);
}

// Every setting that has words of its own, with the defaults of T1.
TEST(Explain, SettingsInWords) {
  EXPECT_EQ(Words("DF;!MC1;!DW0;F;V;@;!RC5;"),
            (std::vector<std::string>{
                "defaults: absolute coordinates, 2 mm/s in X and Y, 2 mm/s in Z, no dwell, the "
                "spindle may turn, tool down Z 0 mm, up Z 5 mm",
                "the spindle may turn: it starts with the next motion", "no dwell before motions",
                "cutting speed in X and Y 2 mm/s", "speed of Z and of three axes 2 mm/s",
                "tool down is Z 0 mm, tool up is Z 5 mm", "spindle speed 8000 rpm"}));
  EXPECT_EQ(Words("!RC5;", "t1f")[0],
            "no effect: the spindle speed of this machine is set by hand");
}

TEST(Explain, WhatTheMachineDoesInWords) {
  EXPECT_EQ(Words("PD;!RC15;!NR;PU;!MC0;"),
            (std::vector<std::string>{
                "tool down; spindle starts, 4500 rpm; down into the work to Z 0 at 2 mm/s",
                "spindle speed 15000 rpm; spindle changes to 15000 rpm", "pause until resumed",
                "tool up; up to Z 5 at 2 mm/s", "the spindle may not turn; spindle stops"}));
  EXPECT_EQ(Words("!ZE A30;", "t1a")[0], "spindle starts, 4500 rpm; go to A 30 degrees at 2 mm/s");
  EXPECT_EQ(Words("!ZE X8388608;")[0], "a coordinate may be from -83886.08 to 83886.07 mm");
  machine::Parameters pauses = ParametersOf("t1");
  ASSERT_TRUE(pauses.Set("OVER_AREA", std::string_view("PAUSE")));
  std::string last;
  ASSERT_TRUE(Explain("!MC0;PU21000,0;PU19000,0;", pauses, [&](const ExplainedPhrase& phrase) {
    last = phrase.words;
    return true;
  }));
  EXPECT_EQ(last, "pause on the way back into the travel; go to X 190 at 60 mm/s");
}

TEST(Explain, WhatIsNoCommandInWords) {
  EXPECT_EQ(Words("$;J1;", "mdx-540"),
            (std::vector<std::string>{"1 byte that is no command",
                                      "vendor command, skipped with its parameters"}));
  EXPECT_EQ(Words("\x1b.KPU1\x1b.K\x1b.B;"),
            (std::vector<std::string>{"ESC.K: what was received and not carried out is forgotten",
                                      "ESC.K: what was received and not carried out is forgotten",
                                      "a device control sequence that the machine refuses",
                                      "1 byte that is no command"}));
  EXPECT_EQ(Words("PU1")[0], "the data ends inside a command, which is not carried out");
}

TEST(Explain, EndsAndEdges) {
  EXPECT_EQ(Words("Z0,0,2000;H;"),
            (std::vector<std::string>{"the tool does not move",
                                      "home: up to the top, to the XY origin, spindle off, errors "
                                      "cleared"}));
  const auto cut = ExplainAll("PU1");
  ASSERT_EQ(cut.size(), 1U);
  EXPECT_EQ(cut[0].name, "");
  ASSERT_EQ(cut[0].findings.size(), 1U);
  EXPECT_EQ(cut[0].findings[0].code, ErrorCode::kRml1IncompleteCommand);
  const Status empty = Explain("", ParametersOf("t1"), [](const ExplainedPhrase&) { return true; });
  ASSERT_FALSE(empty);
  EXPECT_EQ(empty.error().code, ErrorCode::kCellEmptyProgram);
  EXPECT_EQ(ExplainAll("PU" + std::string(500, ' ') + "1,2;")[0].text, "PU");
}

TEST(Explain, AJunkFileIsOnePhraseWithAFewFindings) {
  const auto phrases = ExplainAll(std::string(100'000, '$'));
  ASSERT_EQ(phrases.size(), 1U);
  EXPECT_EQ(phrases[0].text.size(), kShownBytes);
  EXPECT_LE(phrases[0].findings.size(), 4U);
}

// Who is told may end it: at a command, and at bytes that are none, which are told when something
// else follows them.
TEST(Explain, TheConsumerMayEndIt) {
  for (const std::string stream : {"PU;PD;PU;", "$;$;PU;PD;", "$;PU;PD;", "$"}) {
    int told = 0;
    EXPECT_TRUE(Explain(stream, ParametersOf("t1"), [&](const ExplainedPhrase&) {
      ++told;
      return false;
    }));
    EXPECT_EQ(told, 1) << stream;
  }
}

// RML1-4.08, RML1-9.42: ESC.K and a torn name are no part of the command before them; the finding
// is of the byte where the torn one begins.
TEST(Explain, SequencesAndTornNamesBelongToNoCommand) {
  const auto aborted = ExplainAll("PU1,2,3\x1b.K");
  ASSERT_EQ(aborted.size(), 2U);
  EXPECT_EQ(aborted[1].command, 0U);
  EXPECT_EQ(aborted[1].name, "");
  const auto torn = ExplainAll("PU;\nP");
  ASSERT_EQ(torn.size(), 2U);
  EXPECT_EQ(torn[1].command, 0U);
  ASSERT_EQ(torn[1].findings.size(), 1U);
  EXPECT_EQ(torn[1].findings[0].where,
            (SourceSpan{.line = 2, .column = 1, .length = 1, .byte_offset = 4}));
}

// !ZM and groups of axes are motions, too, where they lead nowhere else; a tool that stays behind
// by a half of a unit stays behind. 90 degrees at 60 deg/s in 10 mm are 6.667 mm/s (RML1-3D.29).
TEST(Explain, MotionsThatAreNoneAndPartsOfUnits) {
  EXPECT_EQ(Words("!ZM0;!ZE X0;"),
            (std::vector<std::string>{"the tool does not move", "the tool does not move"}));
  EXPECT_TRUE(Words("!MC0;Z20000.5,0,0;")[1].ends_with(
      "beyond the travel: the commands lead to X 200.005 Y 0 Z 0, the tool does not follow"));
  EXPECT_EQ(Words("!MC0;V60;!ZE X1000A90;", "t1a")[2], "go to X 10 A 90 degrees at 6.667 mm/s");
}

// Where the tool stays behind is told of each motion that leads there, of a group of axes, too, and
// of nothing else. T1: X to 200 mm, Z0 20 mm below the top.
TEST(Explain, MotionsAloneLeadBeyondTheTravel) {
  const std::vector<std::string> words = Words("!MC0;!ZE X21000;VS4;PR;");
  ASSERT_EQ(words.size(), 4U);
  EXPECT_TRUE(words[1].ends_with(
      "beyond the travel: the commands lead to X 210 Y 0 Z 20, the tool does not follow"))
      << words[1];
  EXPECT_EQ(words[2], "cutting speed in X and Y 4 mm/s");
  EXPECT_EQ(words[3], "relative coordinates");
}

}  // namespace
}  // namespace rmlcell::rml1
