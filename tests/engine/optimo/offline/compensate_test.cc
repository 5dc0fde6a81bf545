#include "engine/optimo/offline/compensate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>

#include "engine/core/number_text.h"
#include "engine/optimo/language/program.h"

namespace rmlcell::optimo {
namespace {

std::vector<int> FindingsOf(const Compensation& compensation) {
  std::vector<int> numbers;
  for (const Diagnostic& d : compensation.diagnostics) numbers.push_back(Lookup(d.code).number);
  return numbers;
}

// A contour from the pierce point (0,0,0) with the given moves, compensated; its MOVE lines.
std::string Contour(const std::string& directives, const std::string& moves) {
  const std::string head = directives + "PATH LIN\nMOVE (0.,0.,0.,0.,0.)\nWORK 0,0/ON\n";
  const Compensation result = Compensate(head + moves + "WORK 0,0/OFF\n");
  if (!result.ok) {
    std::string errors;
    for (const int number : FindingsOf(result)) errors += std::to_string(number) + " ";
    return errors;
  }
  EXPECT_EQ(result.text.substr(0, head.size()), head);  // the pierce point stays
  return result.text.substr(head.size(), result.text.size() - head.size() - 13);
}

// OPT-8.11, OPT-8.15, OPT-8.17, OPT-8.03
TEST(Compensate, ALineMovesSideways) {
  EXPECT_EQ(Contour(";$dia=0.508\n;$left\n", "MOVE (10.0,0.0,-5.0,0.0,0.0)/FLY ; cut\n")
                .find("MOVE (10.00000,"),
            0U);
  EXPECT_EQ(Contour(";$rad=0.254\n;$left\n", "MOVE (10.0,0.0,0.0,0.0,0.0)/FLY\n"),
            "MOVE (10.00000,0.25400,0.00000,0.00000,0.00000)/FLY\n");
  EXPECT_EQ(Contour(";$DIA=0.508\n;$Sright\n", "MOVE (10.0,0.0,0.0,0.0,0.0)\n"),
            "MOVE (10.00000,-0.25400,0.00000,0.00000,0.00000)\n");
}

// OPT-8.15, OPT-B.40: a number in parentheses has the sign before them, and keeps them.
TEST(Compensate, NumbersInParenthesesHaveTheirSign) {
  EXPECT_EQ(Contour(";$rad=0.254\n;$left\n", "MOVE (-(10.),-(0.),0.,0.,0.)\n"),
            "MOVE (-(10.00000),-(0.25400),0.00000,0.00000,0.00000)\n");
}

// OPT-8.16: the intersection of the two offset lines.
TEST(Compensate, CornersAreTheMeetingOfTheOffsetLines) {
  const std::string moves = "MOVE (10,0,0,0,0)\nMOVE (10,10,0,0,0)\n";
  EXPECT_EQ(Contour(";$rad=1\n;$left\n", moves),
            "MOVE (9.00000,1.00000,0.00000,0.00000,0.00000)\nMOVE "
            "(9.00000,10.00000,0.00000,0.00000,0.00000)\n");
  EXPECT_EQ(Contour(";$rad=1\n;$right\n", moves),
            "MOVE (11.00000,-1.00000,0.00000,0.00000,0.00000)\nMOVE "
            "(11.00000,10.00000,0.00000,0.00000,0.00000)\n");
}

// OPT-8.18, OPT-B.79: a tangent arc of radius 5 about (10,5), left 1: it starts at (10,1) and has
// radius 4.
TEST(Compensate, TangentArcsBecomeConcentric) {
  EXPECT_EQ(Contour(";$rad=1\n;$left\n",
                    "MOVE (10,0,0,0,0)\nPATH CIR\nMOVE (15,5,0,0,0)/VIA "
                    "(13.53553390593,1.46446609407,0,0,0)\n"),
            "MOVE (10.00000,1.00000,0.00000,0.00000,0.00000)\nPATH CIR\n"
            "MOVE (14.00000,5.00000,0.00000,0.00000,0.00000)/VIA "
            "(12.82843,2.17157,0.00000,0.00000,0.00000)\n");
}

// OPT-B.79: a line that meets an arc at a corner. The arc about (10,0) of radius 5 goes from (15,0)
// over (10,5) to (5,0); left 1 makes its radius 4. The offset line y = 1 meets it at x = 10 +
// sqrt(15).
TEST(Compensate, CornersWithAnArcMeetTheConcentricCircle) {
  EXPECT_EQ(Contour(";$rad=1\n;$left\n",
                    "MOVE (15,0,0,0,0)\nPATH CIR\nMOVE (5,0,0,0,0)/VIA (10,5,0,0,0)\n"),
            "MOVE (13.87298,1.00000,0.00000,0.00000,0.00000)\nPATH CIR\n"
            "MOVE (6.00000,0.00000,0.00000,0.00000,0.00000)/VIA "
            "(10.00000,4.00000,0.00000,0.00000,0.00000)\n");
}

// OPT-8.15: a head that is tilted by B about X tilts the offset. d = +X, u = (0,-sin B,cos B):
// u x d = (0, cos B, sin B).
TEST(Compensate, ATiltedHeadTiltsTheOffset) {
  EXPECT_EQ(Contour(";$rad=1\n;$left\n", "MOVE (10,0,0,0,1.5707963268)\n"),
            "MOVE (10.00000,0.00000,1.00000,0.00000,1.57080)\n");
}

// OPT-2.20, OPT-8.18: along an arc the head turns evenly from the start to the target, whatever the
// via point says. A half circle about (0,0,0) from (10,0,0), A from pi/2 to 3 pi/2, B = pi/2: at
// the via point A is pi and u = (0,1,0), along the radius (the head stands on a cylinder); left of
// the cut (-1,0,0) is u x d = (0,0,1).
TEST(Compensate, TheHeadTurnsEvenlyAlongAnArc) {
  const std::string head =
      ";$rad=1\n;$left\nPATH CIR\nMOVE (10,0,0,1.5707963268,1.5707963268)\nWORK 0,0/ON\n";
  const Compensation result = Compensate(
      head + "MOVE (-10,0,0,4.7123889804,1.5707963268)/VIA (0,10,0,0,0)\nWORK 0,0/OFF\n");
  ASSERT_TRUE(result.ok);
  EXPECT_EQ(result.text.substr(head.size()),
            "MOVE (-10.00000,0.00000,1.00000,4.71239,1.57080)/VIA "
            "(0.00000,10.00000,1.00000,0.00000,0.00000)\nWORK 0,0/OFF\n");
}

// OPT-2.15: in PATH LIN a via point leads nowhere, and stays as it is.
TEST(Compensate, AViaPointOfALineStays) {
  EXPECT_EQ(Contour(";$rad=1\n;$left\n", "MOVE (10,0,0,0,0)/VIA (5,5,0,0,0)\n"),
            "MOVE (10.00000,1.00000,0.00000,0.00000,0.00000)/VIA "
            "(5.00000,5.00000,0.00000,0.00000,0.00000)\n");
}

// OPT-8.16: WORK ON while the beam is on already does not end the contour.
TEST(Compensate, ASecondBeamOnLeavesTheCornerACorner) {
  EXPECT_EQ(Contour(";$rad=1\n;$left\n", "MOVE (10,0,0,0,0)\nWORK 0,0/ON\nMOVE (10,10,0,0,0)\n"),
            "MOVE (9.00000,1.00000,0.00000,0.00000,0.00000)\nWORK 0,0/ON\nMOVE "
            "(9.00000,10.00000,0.00000,0.00000,0.00000)\n");
}

// OPT-8.79
TEST(Compensate, MovesWithoutDirectionTakeTheNormalOfTheOther) {
  const std::string head = ";$rad=1\n;$left\nPATH LIN\nMOVE (0.,0.,5.,0.,0.)\nWORK 0,0/ON\n";
  const Compensation result =
      Compensate(head + "MOVE (0,0,0,0,0)\nMOVE (10,0,0,0,0)\nWORK 0,0/OFF\n");
  ASSERT_TRUE(result.ok);
  EXPECT_EQ(result.text.substr(head.size()),
            "MOVE (0.00000,1.00000,0.00000,0.00000,0.00000)\nMOVE "
            "(10.00000,1.00000,0.00000,0.00000,0.00000)\nWORK 0,0/OFF\n");
}

// OPT-8.06, OPT-8.07, OPT-8.08, OPT-8.10, OPT-E.7804
TEST(Compensate, ItIsActiveOnlyWhileEverythingHolds) {
  const auto unchanged = [](const std::string& text) { return Compensate(text).text == text; };
  EXPECT_TRUE(unchanged(";$rad=1\n;$left\nWORK 0,0/ON\nMOVE (10,0,0,0,0)\nWORK 0,0/OFF\n"));  // PTP
  EXPECT_TRUE(unchanged(
      ";$rad=1\n;$left\nPATH LIN\nWORKDEF 2,0 (11)\nWORK 2,0/ON\nMOVE (10,0,0,0,0)\n"));  // schedule
                                                                                          // only
  EXPECT_TRUE(unchanged(
      ";$rad=1\nPATH LIN\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\nMOVE (10,0,0,0,0)\n"));  // no side
  EXPECT_TRUE(unchanged(
      ";$rad=1\n;$left\n;$none\nPATH LIN\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\nMOVE (10,0,0,0,0)\n"));
  const Compensation side_only = Compensate(";$left\nPATH LIN\nWORK 0,0/ON\nMOVE (10,0,0,0,0)\n");
  EXPECT_TRUE(side_only.ok);
  EXPECT_EQ(FindingsOf(side_only), (std::vector<int>{7804}));
  const Compensation two = Compensate(
      ";$rad=1\n;$left\nPATH LIN\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\nMOVE (10,0,0,0,0)\nWORK 2,1/OFF\n"
      "MOVE (0,50,0,0,0)\nWORK 0,0/ON\nMOVE (10,50,0,0,0)\nWORK 0,0/OFF\n");
  EXPECT_NE(two.text.find("MOVE (10.00000,1.00000,"), std::string::npos);
  EXPECT_NE(two.text.find("MOVE (0,50,0,0,0)"), std::string::npos);
  EXPECT_NE(two.text.find("MOVE (10.00000,51.00000,"), std::string::npos);
}

// OPT-8.12, OPT-8.13, OPT-8.14, OPT-B.91, OPT-E.7807
TEST(Compensate, HolesChangeTheirRadius) {
  const auto hole = [](const std::string& directives, const std::string& radius) {
    return Compensate(directives + "path hole (" + radius +
                      ")\nwork 0,0/on\nMOVE (0,0,0,0,0)/via(0,0,9,0,0)\nwork 0,0/off\n");
  };
  const Compensation right = hole(";$dia=0.508\n;$right\n", "12.7");
  EXPECT_EQ(right.text.find("path hole (12.44600)\nwork 0,0/on\nMOVE (0,0,0,0,0)/via(0,0,9,0,0)"),
            20U);  // behind the directives
  EXPECT_EQ(FindingsOf(right), (std::vector<int>{7033}));
  EXPECT_NE(hole(";$dia=0.508\n;$left\n", "12.7").text.find("(12.95400)"), std::string::npos);
  EXPECT_EQ(FindingsOf(hole(";$rad=0.254\n;$right\n", "0.2")), (std::vector<int>{7807}));
  // Several holes of one PATH HOLE have its radius, which changes once.
  const std::string holes = "MOVE (0,0,0,0,0)/VIA(0,0,9,0,0)\nMOVE (50,0,0,0,0)/VIA(50,0,9,0,0)\n";
  EXPECT_EQ(Compensate(";$rad=2\n;$right\nWORK 0,0/ON\nPATH HOLE (9)\n" + holes).text,
            ";$rad=2\n;$right\nWORK 0,0/ON\nPATH HOLE (7.00000)\n" + holes);
}

// OPT-8.05, OPT-8.09, OPT-E.7802, OPT-E.7803
TEST(Compensate, WrongDirectivesStop) {
  EXPECT_EQ(FindingsOf(Compensate(";$middle\n")), (std::vector<int>{7802}));
  EXPECT_EQ(FindingsOf(Compensate(";$dia=x\n")), (std::vector<int>{7802}));
  EXPECT_EQ(FindingsOf(Compensate(";$rad=-1\n")), (std::vector<int>{7802}));
  EXPECT_EQ(FindingsOf(Compensate(";$rad=1\n;$left\nWORK 0,0/ON\n;$right\n")),
            (std::vector<int>{7803}));
}

// OPT-8.01, OPT-E.7801
TEST(Compensate, InchSourcesStop) {
  const Compensation inch = Compensate("SPEED 5\n", FileNames{"a.SI", "a.CMP", "now"});
  EXPECT_EQ(FindingsOf(inch), (std::vector<int>{7801}));
  EXPECT_FALSE(inch.ok);
  EXPECT_TRUE(inch.text.empty());
}

// OPT-8.19, OPT-E.7806, OPT-E.7808
TEST(Compensate, PathsThatAreTooTightStop) {
  const std::string left = ";$rad=1\n;$left\n";
  EXPECT_EQ(Contour(left, "MOVE (10,0,0,0,0)\nMOVE (0,0,0,0,0)\n"), "7808 ");
  EXPECT_EQ(
      Contour(left, "PATH CIR\nMOVE (1,1,0,0,0)/VIA (0.7071067811865,0.2928932188135,0,0,0)\n"),
      "7806 ");
}

// OPT-8.20, OPT-8.21, OPT-E.7805, OPT-E.7810
TEST(Compensate, MovesThatCannotBeOffsetStop) {
  const std::string left = ";$rad=1\n;$left\n";
  EXPECT_EQ(Contour(left, "MOVE (VR[1],0,0,0,0)\n"), "7805 ");
  EXPECT_EQ(Contour(left, "COORD ROBOT\nMOVE (10,0,0,0,0)\n"), "7810 ");
}

// OPT-2.23, OPT-2.29, OPT-8.15: a hole ends on its circle, at the point nearest to where it began.
// From (30,0,0), centre (0,0,0), radius 10, axis Z: it ends in (10,0,0), and the cut goes on from
// there along Y: left 1 is X - 1. Without /VIA it ends in the centre. The hole itself grows to 11:
// the next cut begins in (11,0,0), and the line to (11,20,0) is parallel to Y.
TEST(Compensate, AContourGoesOnAfterAHole) {
  const auto last_move = [](const std::string& hole, const std::string& target) {
    const Compensation result =
        Compensate(";$rad=1\n;$left\nPATH PTP\nMOVE (30,0,0,0,0)\nPATH HOLE (10)\n" + hole +
                   "PATH LIN\nWORK 0,0/ON\nMOVE (" + target + ",0,0,0)\nWORK 0,0/OFF\n");
    EXPECT_TRUE(result.ok);
    const std::size_t at = result.text.rfind("MOVE");
    return result.text.substr(at, result.text.find(",0.00000,0.00000,0.00000)", at) - at);
  };
  const std::string hole = "MOVE (0,0,0,0,0)/VIA(0,0,5,0,0)\n";
  EXPECT_EQ(last_move(hole, "10,20"), "MOVE (9.00000,20.00000");
  EXPECT_EQ(last_move("MOVE (0,0,0,0,0)\n", "0,20"), "MOVE (-1.00000,20.00000");
  EXPECT_EQ(last_move("WORK 0,0/ON\n" + hole + "WORK 0,0/OFF\n", "11,20"),
            "MOVE (10.00000,20.00000");
}

// OPT-7.29, OPT-7.30, OPT-8.23: the tip stands at (10,20,0) of the machine; in a system that is
// shifted by (10,0,0) and turned by 90 degrees that is (20,0,0). From there to (20,10,0): left 1.
TEST(Compensate, AContourGoesOnAfterSysdef) {
  const std::string head =
      ";$rad=1\n;$left\nPATH LIN\nMOVE (10,20,0,0,0)\nSYSDEF (10,0,0,1.57079632679,0,0)\n"
      "WORK 0,0/ON\n";
  const Compensation result = Compensate(head + "MOVE (20,10,0,0,0)\n");
  ASSERT_TRUE(result.ok);
  EXPECT_EQ(result.text.substr(head.size()), "MOVE (19.00000,10.00000,0.00000,0.00000,0.00000)\n");
  EXPECT_EQ(FindingsOf(Compensate(
                ";$rad=1\n;$left\nPATH LIN\nMOVE (0,0,0,0,0)\nSYSDEF (VR[86],0,0,0,0,0)\n"
                "WORK 0,0/ON\nMOVE (20,10,0,0,0)\n")),
            (std::vector<int>{7805}));
}

// OPT-E.7305: an arc that ends where it begins is no circle.
TEST(Compensate, AnArcThatIsNoneStops) {
  EXPECT_EQ(Contour(";$rad=1\n;$left\n", "PATH CIR\nMOVE (0,0,0,0,0)/VIA (10,0,0,0,0)\n"), "7305 ");
}

// OPT-8.22, OPT-E.7809
TEST(Compensate, JumpsAreReported) {
  const Compensation jump = Compensate(";$rad=1\n;$left\nPATH LIN\nWORK 0,0/ON\n20 GOTO 20\n");
  EXPECT_EQ(FindingsOf(jump), (std::vector<int>{7809}));
  EXPECT_TRUE(jump.ok);
}

// OPT-8.23, OPT-E.7811: a system that is turned by 90 degrees about Z does not change u for a head
// straight down, but for a tilted head u is turned back.
TEST(Compensate, SysdefTurnsTheToolBack) {
  const std::string head =
      ";$rad=1\n;$left\nPATH LIN\nSYSDEF (0,0,0,1.5707963268,0,0)\nMOVE "
      "(0,0,0,1.5707963268,1.5707963268)\nWORK 0,0/ON\n";
  const Compensation result = Compensate(head + "MOVE (10,0,0,1.5707963268,1.5707963268)\n");
  ASSERT_TRUE(result.ok);
  // u(pi/2, pi/2) = (1,0,0) in the machine is (0,-1,0) in the program; u x (1,0,0) = (0,0,1).
  EXPECT_EQ(result.text.substr(head.size()), "MOVE (10.00000,0.00000,1.00000,1.57080,1.57080)\n");
  EXPECT_EQ(FindingsOf(Compensate("SYSDEF (0,0,0,VR[1],0,0)\n")), (std::vector<int>{7811}));
}

// OPT-8.02, OPT-8.04: directives in any case, behind a sequence number, with blanks behind them;
// other comments are none.
TEST(Compensate, DirectivesAreComments) {
  for (const std::string side : {"15 ;$cleft", ";$LEFT  ", "15;$Sleft", ";$left"}) {
    EXPECT_EQ(Contour("; left\n; $right\n;$Rad= 1\n" + side + "\n", "MOVE (10,0,0,0,0)\n"),
              "MOVE (10.00000,1.00000,0.00000,0.00000,0.00000)\n")
        << side;
  }
}

// OPT-8.02: directives are comment lines; behind an instruction ";$" begins a comment.
TEST(Compensate, ACommentBehindAnInstructionIsNoDirective) {
  EXPECT_EQ(Contour(";$rad=1\n;$left\nSPEED 5 ;$right\nSPEED 5 ;$dia=9\nSPEED 5 ;$middle\n",
                    "MOVE (10,0,0,0,0) ;$right\n"),
            "MOVE (10.00000,1.00000,0.00000,0.00000,0.00000) ;$right\n");
}

// OPT-8.05: the amount is one number.
TEST(Compensate, AnAmountWithSomethingBehindItStops) {
  for (const std::string amount : {"1 mm", "1 2", "1mm", "", "1;"}) {
    EXPECT_EQ(FindingsOf(Compensate(";$dia=" + amount + "\n")), (std::vector<int>{7802})) << amount;
  }
  EXPECT_TRUE(Compensate(";$dia = +1.5 \t\n").ok);
}

// OPT-8.24, OPT-8.25
TEST(Compensate, TheHeaderIsTheFirstLine) {
  EXPECT_EQ(Compensate("; old\n", FileNames{"a.S", "a.CMP", "Tue Apr 20 13:37:33 1993"}).text,
            "; File a.CMP Created From File a.S - Tue Apr 20 13:37:33 1993\n; old\n");
}

// OPT-8.16, OPT-8.17: another way to the same: every side of an offset polygon lies beside its
// programmed side, at the distance of the offset, on the side asked for.
TEST(Compensate, SidesOfRandomPolygonsKeepTheirDistance) {
  std::mt19937 random(11);
  for (int round = 0; round < 100; ++round) {
    const int corners = 3 + static_cast<int>(random() % 9);
    const double offset = 0.05 + static_cast<double>(random() % 1000) / 1000.0;
    const bool left = random() % 2 == 0;
    std::vector<std::pair<double, double>> points;  // convex, counter-clockwise
    for (int c = 0; c <= corners; ++c) {
      const double angle =
          2.0 * M_PI * (c + 0.3 * static_cast<double>(random() % 100) / 100.0) / (corners + 1);
      points.emplace_back(50.0 * std::cos(angle), 50.0 * std::sin(angle));
    }
    std::string text =
        ";$rad=" + FixedText(offset, 6) + (left ? "\n;$left" : "\n;$right") + "\nPATH LIN\n";
    for (std::size_t n = 0; n < points.size(); ++n) {
      if (n == 1) text += "WORK 0,0/ON\n";
      text += "MOVE (" + FixedText(points[n].first, 6) + "," + FixedText(points[n].second, 6) +
              ",0,0,0)\n";
    }
    const Compensation result = Compensate(text + "WORK 0,0/OFF\n");
    ASSERT_TRUE(result.ok) << text;
    Findings none;
    const ParsedProgram moved = Parse(result.text, none);
    std::vector<std::pair<double, double>> offsets;
    for (const Instruction& i : moved.module.instructions) {
      if (i.op != Op::kMove) continue;
      offsets.emplace_back(static_cast<double>(moved.module.Value(i, 0)[0].number),
                           static_cast<double>(moved.module.Value(i, 1)[0].number));
    }
    ASSERT_EQ(offsets.size(), points.size());
    // From the second side on: the first leads from the pierce point to its offset.
    for (std::size_t n = 1; n + 1 < points.size(); ++n) {
      const double dx = points[n + 1].first - points[n].first,
                   dy = points[n + 1].second - points[n].second, length = std::hypot(dx, dy);
      for (const auto& end : {offsets[n], offsets[n + 1]}) {
        const double beside =
            (dx * (end.second - points[n].second) - dy * (end.first - points[n].first)) / length;
        EXPECT_NEAR(beside, left ? offset : -offset, 2e-5) << text;
      }
    }
  }
}

// A slot narrower than the beam: the offset sides cross each other.
TEST(Compensate, GougesAreReported) {
  const std::string moves =
      "MOVE (20,0,0,0,0)\nMOVE (20,-20,0,0,0)\nMOVE (21,-20,0,0,0)\nMOVE (21,0,0,0,0)\nMOVE "
      "(40,0,0,0,0)\n";
  const Compensation result = Compensate(
      ";$rad=2\n;$left\nPATH LIN\nMOVE (0.,0.,0.,0.,0.)\nWORK 0,0/ON\n" + moves + "WORK 0,0/OFF\n");
  ASSERT_TRUE(result.ok);
  const std::vector<int> numbers = FindingsOf(result);
  ASSERT_FALSE(numbers.empty());
  for (const int number : numbers) EXPECT_EQ(number, 7812);
  // The same contour with a beam that fits.
  EXPECT_TRUE(
      FindingsOf(
          Compensate(";$rad=0.1\n;$left\nPATH LIN\nMOVE (0.,0.,0.,0.,0.)\nWORK 0,0/ON\n" + moves))
          .empty());
}

// OPT-8.02, OPT-8.04, OPT-8.05, OPT-8.06: what is a directive, what it sets, and what is wrong with
// it. A line to the right by 10: Y says how far to which side it went.
TEST(Compensate, DirectivesSayWhatTheySay) {
  const auto moved = [](const std::string& directives) {
    const Compensation made = Compensate(directives +
                                         "PATH LIN\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\n"
                                         "MOVE (10,0,0,0,0)\nWORK 0,0/OFF\n");
    if (!made.ok) return std::to_string(FindingsOf(made).front());
    const std::size_t at = made.text.rfind("MOVE (") + 6;
    const std::size_t comma = made.text.find(',', at) + 1;
    return made.text.substr(comma, made.text.find(',', comma) - comma);
  };
  const std::vector<std::pair<std::string, std::string>> rows = {
      {";$rad=1\n;$left\n", "1.00000"},
      {";$rad=1\n;$right\n", "-1.00000"},
      {";$rad=1\n;$cright\n", "-1.00000"},
      {";$rad=1\n;$cleft\n", "1.00000"},
      {";$rad=1\n;$sleft\n", "1.00000"},
      {";$dia=1\n;$left\n", "0.50000"},
      {";$DIA = 1\n;$LEFT\n", "0.50000"},
      {";$dia=\t1 \r\n;$left \r\n", "0.50000"},
      {";$dia=0\n;$left\n", "0.00000"},
      {";$rad=1\n;$left\n;$none\n", "0"},
      {";$rad=1\n;$left\n;$snone\n", "0"},
      {";$rad=1\n;$left\n;$right\n", "-1.00000"},
      {";$rad=1\n;$rad=2\n;$left\n", "2.00000"},
      {"10 ;$rad=1\n \t20\t;$left\n", "1.00000"},
      {";$rad=1\n;$left\nSPEED 5;$right\n", "1.00000"},
      {";$rad=1\n;$left\n; $right\n;left\n;\n;x$right\n", "1.00000"},
      {";$rad=1\n;$left\n;$\n", "7802"},
      {";$rad=1\n;$left right\n", "7802"},
      {";$rad=1+1\n", "7802"},
      {";$rad=1\n;$left=1\n", "7802"},
      {";$rad=1\n;$lef\n", "7802"},
      {";$rad=1\n;$xleft\n", "7802"},
      {";$rad=1\n;$c\n", "7802"},
      {";$rad\n", "7802"},
      {";$rad 1\n", "7802"},
      {";$rad 12\n;$left\n", "7802"},
      {";$rad:1\n;$left\n", "7802"},
      {";$rad=\n", "7802"},
      {";$rad=1E400\n", "7802"},
      {";$radius=1\n", "7802"},
  };
  for (const auto& [directives, y] : rows) EXPECT_EQ(moved(directives), y) << directives;
}

// OPT-8.07, OPT-8.08, OPT-8.12, OPT-8.21: when the path is offset and when it is not, by what comes
// between; the last MOVE tells.
TEST(Compensate, WhatEndsAndBeginsAContour) {
  const auto last = [](const std::string& middle) {
    const Compensation made = Compensate(
        ";$rad=1\n;$left\nPATH LIN\nMOVE (0,0,0,0,0)\n"
        "WORK 0,0/ON\nMOVE (10,0,0,0,0)\n" +
        middle);
    if (!made.ok) return std::to_string(FindingsOf(made).front());
    const std::size_t at = made.text.rfind("MOVE (") + 6;
    return made.text.substr(at, made.text.find(",0", made.text.find(',', at) + 2) - at);
  };
  const std::string turn = "MOVE (10,10,0,0,0)\n";
  EXPECT_EQ(last(turn), "9.00000,10.00000");
  EXPECT_EQ(last("PATH PTP\n" + turn), "10,10");
  EXPECT_EQ(last("PATH PTP\nMOVE (10,5,0,0,0)\nPATH LIN\n" + turn), "9.00000,10.00000");
  EXPECT_EQ(last("WORK 0,0/OFF\n" + turn), "10,10");
  EXPECT_EQ(last("WORK 1,3/OFF\n" + turn), "10,10");
  EXPECT_EQ(last("WORKDEF 2,1 (5)\nWORK 2,1/ON\n" + turn), "9.00000,10.00000");
  EXPECT_EQ(last("COORD ROBOT\nPATH PTP\n" + turn), "10,10");
  EXPECT_EQ(last("COORD ROBOT\n" + turn), "7810");
  EXPECT_EQ(last("SPEED 5\nDELAY 1\nOL[8]=ON\n" + turn), "9.00000,10.00000");
  // Where the contour ends its last point lies beside the programmed one, and what follows begins
  // anew: no corner.
  const auto first = [](const std::string& middle) {
    const Compensation made = Compensate(
        ";$rad=1\n;$left\nPATH LIN\nMOVE (0,0,0,0,0)\n"
        "WORK 0,0/ON\nMOVE (10,0,0,0,0)\n" +
        middle + "MOVE (10,10,0,0,0)\n");
    if (!made.ok) return std::string();
    const std::size_t at = made.text.find("WORK 0,0/ON\nMOVE (") + 18;
    return made.text.substr(at, made.text.find(",0.00000", at) - at);
  };
  EXPECT_EQ(first(""), "9.00000,1.00000");
  EXPECT_EQ(first("COORD ABSOL\n"), "9.00000,1.00000");
  EXPECT_EQ(first("PATH CIR\n"), "9.00000,1.00000");
  // OPT-8.06: also where nothing is done in between.
  for (const std::string end :
       {"WORK 0,0/OFF\n", "PATH PTP\n", "PATH HOLE (5)\n", "PATH PTP\nPATH LIN\n",
        "PATH HOLE (5)\nPATH LIN\n", "WORK 0,0/OFF\nWORK 0,0/ON\n", "COORD ROBOT\nPATH PTP\n",
        "COORD ROBOT\nCOORD ABSOL\n", "SYSDEF\n", "TCP (0,0,0/0,0,-5)\n"}) {
    const std::string point = first(end);
    EXPECT_EQ(point, end.starts_with("TCP") ? "" : "10.00000,1.00000") << end;
  }
}

}  // namespace
}  // namespace rmlcell::optimo
