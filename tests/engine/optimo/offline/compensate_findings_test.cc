#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/optimo/offline/compensate.h"

namespace rmlcell::optimo {
namespace {

// "line number: what is said", of each finding.
std::vector<std::string> TextsOf(const Compensation& compensation) {
  std::vector<std::string> texts;
  for (const Diagnostic& d : compensation.diagnostics) {
    texts.push_back(std::to_string(d.where.line) + " " + std::to_string(Lookup(d.code).number) +
                    ": " + d.detail);
  }
  return texts;
}

using Texts = std::vector<std::string>;

// Line 4 is the pierce point, the moves begin in line 6.
Compensation Cut(const std::string& radius, const std::string& moves,
                 const std::string& start = "0,0,0,0,0") {
  return Compensate(";$rad=" + radius + "\n;$left\nPATH LIN\nMOVE (" + start + ")\nWORK 0,0/ON\n" +
                    moves);
}

// OPT-8.15, OPT-8.16: A = 0 and B = pi/2 lay the head along -Y: u x d is +Z for a cut along +X, and
// -X for one along +Z. The corner lies beside both, from the head of the first move and the second.
TEST(CompensateFindings, CornersUnderATiltedHeadLieAcrossIt) {
  const std::string angles = ",0,1.5707963268";
  const Compensation cut =
      Cut("0.5", "MOVE (10,0,0" + angles + ")\nMOVE (10,0,10" + angles + ")\n", "0,0,0" + angles);
  ASSERT_TRUE(cut.ok);
  EXPECT_NE(cut.text.find("ON\nMOVE (9.50000,0.00000,0.50000,0.00000,1.57080)\n"
                          "MOVE (9.50000,0.00000,10.00000,0.00000,1.57080)\n"),
            std::string::npos)
      << cut.text;
}

// OPT-2.20, OPT-8.18: where the angles at the start of an arc are no numbers, those of the via
// point count: A = pi and B = pi/2 lay the head along the radius there, so left is +Z.
TEST(CompensateFindings, AnglesOfTheViaPointCountWhereTheStartHasNone) {
  for (const std::string start : {"VR[1],1.5707963268", "1.5707963268,VR[1]", "VR[1],VR[2]"}) {
    const std::string head =
        ";$rad=1\n;$left\nPATH CIR\nMOVE (10,0,0," + start + ")\nWORK 0,0/ON\n";
    const Compensation result = Compensate(
        head + "MOVE (-10,0,0,4.7123889804,1.5707963268)/VIA (0,10,0,3.1415926536,1.5707963268)\n");
    ASSERT_TRUE(result.ok);
    EXPECT_EQ(result.text.substr(head.size()),
              "MOVE (-10.00000,0.00000,1.00000,4.71239,1.57080)/VIA "
              "(0.00000,10.00000,1.00000,3.14159,1.57080)\n");
  }
}

// OPT-8.19: a slot of 1 mm. A beam of radius 0.75 comes within 0.25 mm of the other wall,
// one of radius 2 crosses the contour; on the ground of the slot the path leads back.
TEST(CompensateFindings, GougesSayHowFarTheyGo) {
  const std::string slot =
      "MOVE (20,0,0,0,0)\nMOVE (20,-20,0,0,0)\nMOVE (21,-20,0,0,0)\nMOVE (21,0,0,0,0)\nMOVE "
      "(40,0,0,0,0)\n";
  const std::string near =
      " 7812: the compensated path comes within 0.250 mm of the contour, and the beam has a radius of "
      "0.75 mm: it cuts 0.500 mm into the part";
  const std::string back = "8 7812: the move is shorter than the compensation at its corners needs";
  const std::string crosses = " 7812: the compensated path crosses the contour";
  const Compensation narrow = Cut("0.75", slot);
  EXPECT_TRUE(narrow.ok);
  EXPECT_EQ(TextsOf(narrow), (Texts{"7" + near, back, "9" + near}));
  for (const Diagnostic& d : narrow.diagnostics) EXPECT_EQ(d.severity, Severity::kWarning);
  // The wide one is near on its way from the pierce point, too: (21, 0) lies 21 * 2 / hypot(22, 2)
  // from the line to (22, 2).
  const std::string first =
      "6 7812: the compensated path comes within 1.901 mm of the contour, and the beam has a radius of "
      "2.0 mm: it cuts 0.099 mm into the part";
  EXPECT_EQ(TextsOf(Cut("2", slot)), (Texts{first, "7" + crosses, back, "9" + crosses}));
}

// OPT-8.20, OPT-E.7805: a point that is no number, the move that starts there, and a radius.
TEST(CompensateFindings, WhatIsNoNumberIsSaid) {
  EXPECT_EQ(TextsOf(Cut("1", "MOVE (VR[1],0,0,0,0)\nMOVE (10,0,0,0,0)\nMOVE (20,0,0,0,0)\n")),
            (Texts{"6 7805: a coordinate is no plain number",
                   "7 7805: the point where this move starts is not known as numbers"}));
  for (const std::string move :
       {"0,VR[1],0,0,0", "0,0,VR[1],0,0", "0,0,0,VR[1],0", "0,0,0,0,VR[1]"}) {
    EXPECT_EQ(TextsOf(Cut("1", "MOVE (" + move + ")\n")),
              (Texts{"6 7805: a coordinate is no plain number"}))
        << move;
  }
  for (const std::string via :
       {"VR[1],1,0,0,0", "1,VR[1],0,0,0", "1,1,VR[1],0,0", "1,1,0,0,VR[1]"}) {
    EXPECT_EQ(TextsOf(Cut("1", "PATH CIR\nMOVE (2,0,0,0,0)/VIA (" + via + ")\n")),
              (Texts{"7 7805: a coordinate is no plain number"}))
        << via;
  }
  for (const std::string start : {"VR[1],0,0,0,0", "0,VR[1],0,0,0", "0,0,VR[1],0,0"}) {
    EXPECT_EQ(TextsOf(Cut("1", "MOVE (9,0,0,0,0)\n", start)),
              (Texts{"6 7805: the point where this move starts is not known as numbers"}))
        << start;
  }
  EXPECT_EQ(TextsOf(Cut("1", "PATH HOLE (VR[1])\nMOVE (0,0,0,0,0)/VIA (0,0,5,0,0)\n")),
            (Texts{"6 7805: the radius is no plain number"}));
}

// OPT-8.09, OPT-E.7803: with the beam on neither side nor amount may change; what stays the same,
// and what comes before the beam, is no change.
TEST(CompensateFindings, OnlyAChangeUnderTheBeamIsOne) {
  EXPECT_TRUE(
      TextsOf(Cut("1", ";$left\n;$rad=1\n;$dia=2\nWORK 0,0/OFF\n;$right\n;$rad=3\n")).empty());
  EXPECT_EQ(TextsOf(Cut("1", ";$none\n")),
            (Texts{"6 7803: the side changes while the beam is on"}));
  EXPECT_EQ(TextsOf(Cut("1", ";$dia=1\n")),
            (Texts{"6 7803: the amount changes while the beam is on"}));
  EXPECT_EQ(TextsOf(Compensate("SPEED 5\n;$dia=-1\n;$middle\n")),
            (Texts{"2 7802: the amount is no number of at least 0", "3 7802: unknown directive"}));
}

// OPT-8.14, OPT-B.91: a hole of the size of the beam is none; what left means is said once.
TEST(CompensateFindings, HolesOfTheSizeOfTheBeam) {
  const std::string hole = "MOVE (0,0,0,0,0)/VIA (0,0,9,0,0)\n";
  const auto holes = [&](const std::string& radius) {
    return Compensate(";$rad=2\n;$right\nWORK 0,0/ON\nPATH HOLE (" + radius + ")\n" + hole +
                      "PATH HOLE (9)\n" + hole);
  };
  EXPECT_EQ(TextsOf(holes("2")).front(), "4 7807: the hole is not larger than the beam");
  const Compensation two = holes("2.5");
  ASSERT_EQ(two.diagnostics.size(), 1u);
  EXPECT_EQ(two.diagnostics[0].where.line, 5);
  EXPECT_EQ(two.diagnostics[0].severity, Severity::kAdvice);
  EXPECT_NE(two.text.find("PATH HOLE (0.50000)"), std::string::npos);
  EXPECT_NE(two.text.find("PATH HOLE (7.00000)"), std::string::npos);
}

// OPT-8.01, OPT-E.7801: inch sources are told by their name, or by whoever has them.
TEST(CompensateFindings, InchesAreToldByNameOrByTheCaller) {
  const auto number = [](const std::optional<FileNames>& names, bool inch) {
    const Compensation made = Compensate("SPEED 5\n", names, inch);
    EXPECT_EQ(made.ok, made.diagnostics.empty());
    if (made.ok) return 0;
    EXPECT_EQ(made.diagnostics[0].file, names ? names->input : "");
    return Lookup(made.diagnostics[0].code).number;
  };
  EXPECT_EQ(number({}, false), 0);
  EXPECT_EQ(number({}, true), 7801);
  EXPECT_EQ(number(FileNames{"a.S", "a.CMP", "now"}, false), 0);
  EXPECT_EQ(number(FileNames{"a.S", "a.CMP", "now"}, true), 7801);
  EXPECT_EQ(number(FileNames{"a.si", "a.CMP", "now"}, false), 7801);
}

}  // namespace
}  // namespace rmlcell::optimo
