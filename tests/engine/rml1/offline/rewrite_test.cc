#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "engine/rml1/offline/stream_walk.h"
#include "tests/engine/rml1/offline/made_text.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

std::string Moved(std::string_view stream, double x_mm, double y_mm, double z_mm = 0.0,
                  std::string_view profile = "t1") {
  const auto made = MoveStream(stream, ParametersOf(profile), {x_mm, y_mm, z_mm});
  return made ? made->stream : "refused: " + made.error().detail;
}
std::string Scaled(std::string_view stream, double from, double to) {
  const auto made = ScaleStream(stream, ParametersOf("t1"), from, to);
  return made ? made->stream : "refused: " + made.error().detail;
}

// A way of the tool in the work, device units.
struct WorkWay {
  Point from;
  Point to;
};
class Work final : public PhraseListener {
 public:
  bool OnPhrase(const Phrase& phrase) override {
    Point at = phrase.physical_before;
    for (const Action& action : phrase.actions) {
      if (action.kind != Action::Kind::kMotion) continue;
      const bool in_work =
          action.use == machine::MotionUse::kCut || action.use == machine::MotionUse::kPlunge;
      if (in_work) ways.push_back({at, action.to});
      at = action.to;
    }
    return true;
  }
  std::vector<WorkWay> ways;
};
std::vector<WorkWay> WorkOf(std::string_view stream, const machine::Parameters& parameters) {
  const Profile profile = MakeProfile(parameters).value();
  Work work;
  StreamWalk walk(profile, work);
  walk.Run(stream);
  EXPECT_EQ(walk.device().carriage().lost().length, 0.0);
  return work.ways;
}
// The work origin in the middle of the table: nothing is cut off on either side of it.
machine::Parameters Centred(std::string_view profile_id) {
  machine::Parameters parameters = ParametersOf(profile_id);
  EXPECT_TRUE(parameters.Set("ORIGIN_X", std::string_view("50")));
  EXPECT_TRUE(parameters.Set("ORIGIN_Y", std::string_view("50")));
  return parameters;
}
void ExpectAt(const Point& got, const Point& wanted, double x, double y, double z,
              double tolerance = 1e-3) {
  EXPECT_NEAR(got.x, wanted.x + x, tolerance);
  EXPECT_NEAR(got.y, wanted.y + y, tolerance);
  EXPECT_NEAR(got.z, wanted.z + z, tolerance);
}

// 100 units in a mm: 1.5 mm are 150.
TEST(MoveStream, AbsoluteNumbersChangeAndNothingElse) {
  EXPECT_EQ(Moved("PA; VS4;\r\nPU 100 , +50 ;PD1,2,-3,4.25;PR10,20;H;", 1.5, -0.5),
            "PA; VS4;\r\nPU 250 , 0 ;PD151,-48,147,-45.75;PR10,20;H;");
  EXPECT_EQ(Moved("PU1,2;Z1,2,-50;!ZEx1:Z5:y7;", 1, 2), "PU101,202;Z101,202,-50;!ZEx101:Z5:y207;");
  EXPECT_EQ(Moved("PU40,0;", 1, 0, 0, "mdx-20"), "PU80,0;");
}

// A period behind a number that had one of its own stays apart from the new number.
TEST(MoveStream, NumbersStayApartFromWhatFollows) {
  EXPECT_EQ(Moved("PU1.5,2.5.5;", 0.5, 0.5), "PU51.5,52.5.5;");
  EXPECT_EQ(Moved("PU1.5,2.0.5;", 0.5, 0.5), "PU51.5,52.0.5;");
}

// From where the machine stands the way is put in: at power-on in absolute mode, and behind H.
TEST(MoveStream, RelativeBeginningsGetTheWayThere) {
  EXPECT_EQ(Moved("PR;PD100,0;", 1, 2), "PR;!ZZ100,200,0;PD100,0;");
  EXPECT_EQ(Moved("PD;PD5,5;", 1, 2), "PR;!ZZ100,200,0;PA;PD;PD105,205;");
  EXPECT_EQ(Moved("^PR;Z0,0,600;^PA;PU1,1;", 1, 2), "^PR;Z0,0,600;^PA;PU101,201;");
  EXPECT_EQ(Moved("PU1,1;H;PR;D;PD9,0;", 1, 0), "PU101,1;H;PR;!ZZ100,0,0;D;PD109,0;");
  EXPECT_EQ(Moved("PR;PU0,0,7,0;", 1, 0), "PR;!ZZ100,0,0;PU0,0,7,0;");
}

// RML1-3A.01: Z1 is at most 0, Z2 at least 0.
TEST(MoveStream, HeightsFollowZ) {
  EXPECT_EQ(Moved("!PZ-100,200;PU1,1;PD2,2;Z1,1,-50;!ZM0;", 0, 0, -0.5),
            "!PZ-150,150;PU1,1;PD2,2;Z1,1,-100;!ZM0;");
  EXPECT_TRUE(Moved("!PZ0,200;PU1,1;", 0, 0, 1).starts_with("refused: the tool-down height"));
  EXPECT_TRUE(Moved("!PZ0,20;PU1,1;", 0, 0, -1).starts_with("refused: the tool-up height"));
  EXPECT_TRUE(Moved("PU1,1;", 0, 0, 1).starts_with("refused: the tool goes to a height"));
  EXPECT_TRUE(Moved("!ZO-5;Z1,1,1;", 0, 0, 1).starts_with("refused: the program sets Z0"));
  EXPECT_EQ(Moved("!ZO-5;Z1,1,1;", 1, 0), "!ZO-5;Z101,1,1;");
  // Either may come to Z0 itself.
  EXPECT_EQ(Moved("!PZ-100,200;PU1,1;", 0, 0, 1), "!PZ0,300;PU1,1;");
  EXPECT_EQ(Moved("!PZ0,20;PU1,1;", 0, 0, -0.2), "!PZ-20,0;PU1,1;");
}

// RML1-3A.03, RML1-3C.12: one number gives Z1 alone, none gives back those of the machine, and so
// do DF and IN: what the program does not give cannot be moved.
TEST(MoveStream, HeightsAreThoseThatTheProgramGave) {
  const std::string refused =
      "refused: the tool goes to a height that the program does not give: write !PZ before";
  EXPECT_EQ(Moved("!PZ-100;Z1,1,5;PD1,1;", 0, 0, -0.5), "!PZ-150;Z1,1,-45;PD1,1;");
  EXPECT_EQ(Moved("!PZ-100;PU1,1;", 0, 0, -0.5), refused);
  EXPECT_EQ(Moved("!PZ-100,200;!PZ-50;PU1,1;", 0, 0, -0.5), "!PZ-150,150;!PZ-100;PU1,1;");
  for (const char* back : {"!PZ;", "@;", "DF;", "IN;"}) {
    const std::string head = std::string("!PZ-100,200;") + back;
    EXPECT_EQ(Moved(head + "PU1,1;", 0, 0, -0.5), refused) << back;
    EXPECT_EQ(Moved(head + "PD1,1;", 0, 0, -0.5), refused) << back;
  }
}

// The way there would have to stand before the command, and its first group has been changed.
TEST(MoveStream, RefusesAWayInTheMiddleOfACommand) {
  EXPECT_EQ(Moved("!MC0;!ZE Y500:Z-1;", 1, 1),
            "refused: a command whose first numbers are changed already");
  EXPECT_EQ(Moved("!MC0;!ZE X5Y500:Z-1;", 1, 1), "!MC0;!ZE X105Y600:Z-1;");
  // What is wrong first is told.
  EXPECT_EQ(Moved("PU1,.;", 1, 1, 1),
            "refused: the tool goes to a height that the program does not give: write !PZ before");
}

TEST(MoveStream, RefusesWhatItCannotFollow) {
  const auto refused = MoveStream("PU1,1;\nPU1;", ParametersOf("t1"), {1, 0, 0});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kRml1NotRewritten);
  EXPECT_EQ(refused.error().where->line, 2);
  EXPECT_TRUE(Moved("PU1,.;", 1, 0).starts_with("refused: numbers") ||
              Moved("PU1,.;", 1, 1).starts_with("refused: a lone period"));
  EXPECT_TRUE(Moved("PU1\x1b.5,2;", 1, 0).starts_with("refused: a number with other bytes"));
  EXPECT_EQ(Moved("PU8388507,-8388508;", 1, -1), "PU8388607,-8388608;");  // RML1-2.32
  EXPECT_EQ(Moved("PU8388508,2;", 1, 0), "refused: a number becomes 8388608, beyond its range");
  EXPECT_EQ(Moved("PU2,-8388509;", 0, -1), "refused: a number becomes -8388609, beyond its range");
  EXPECT_FALSE(MoveStream("PU;", ParametersOf("t1"), {NAN, 0, 0}));
  EXPECT_FALSE(MoveStream("", ParametersOf("t1"), {1, 0, 0}));
  EXPECT_FALSE(MoveStream(std::string(300, '$'), ParametersOf("t1"), {1, 0, 0}));
}

// Where the tool stands at the surface when the way is owed, it goes up first. T1: the top is 0 and
// Z0 -2000; !ZM and !ZO count from where the tool stands when coordinates are relative.
TEST(MoveStream, TheWayThereIsAboveTheWork) {
  EXPECT_EQ(Moved("PR;Z0,0,-2000;PU100,0;", 1, 2),
            "PR;Z0,0,-2000;!ZZ0,0,2000,100,200,0,0,0,-2000;PU100,0;");
  EXPECT_EQ(Moved("PR;!ZM-1500;!ZO0;PU100,0;", 1, 2),
            "PR;!ZM-1500;!ZO0;!ZZ0,0,1500,100,200,0,0,0,-1500;PU100,0;");
  // 1 unit above the surface is above it.
  EXPECT_EQ(Moved("PR;!ZM-1499;!ZO-1;PU100,0;", 1, 2), "PR;!ZM-1499;!ZO-1;!ZZ100,200,0;PU100,0;");
  // With a way in Z: 50 down at the end of it, for a plunge from the top to 10 below Z0.
  EXPECT_EQ(Moved("PR;Z0,0,-2010;", 1, 2, -0.5), "PR;!ZZ100,200,0,0,0,-50;Z0,0,-2010;");
  EXPECT_EQ(Moved("PR;Z0,0,-2090;", 1, 2, 0.5), "PR;!ZZ0,0,50,100,200,0;Z0,0,-2090;");
}

// A part in the middle of the travel, so that nothing is cut off: in both modes, with homes.
std::string RandomPart(std::mt19937& random) {
  const auto number = [&](int low, int high) {
    return std::to_string(low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1)));
  };
  const auto place = [&] { return number(3000, 4000) + "," + number(3000, 4000); };
  const auto step = [&] { return number(-20, 20) + "," + number(-20, 20); };
  std::string stream = random() % 2 == 0 ? "!PZ-50,100;PU" + place() + ";" : "!PZ-50,100;";
  for (int i = 0; i < 25; ++i) {
    switch (random() % 9) {
      case 0:
        stream += "^PR;PU" + step() + ";";
        break;
      case 1:
        stream += random() % 2 == 0 ? "^PA;PD" + place() + ";" : "^PR;PD" + step() + ";";
        break;
      case 2:
        stream += "PR" + step() + "," + step() + "\n";
        break;
      case 3:
        stream += "PA" + place() + ";";
        break;
      case 4:
        stream += "^PR;Z" + step() + ",-3;";
        break;
      case 5:
        stream += "PA;Z" + place() + "," + number(-90, 90) + ";";
        break;
      case 6:
        stream += "H;";
        break;
      case 7:
        stream += "D" + place() + ";";
        break;
      default:
        stream += "!ZM-" + number(0, 300) + ";";
        break;
    }
  }
  return stream;
}

TEST(MoveStream, AllWorkIsShiftedByTheSame) {
  std::mt19937 random(7);  // NOLINT: the same streams in every run
  std::size_t compared = 0;
  for (int i = 0; i < 400; ++i) {
    const std::string stream = RandomPart(random);
    SCOPED_TRACE(stream);
    const machine::Parameters parameters = Centred("t1");
    const auto made = MoveStream(stream, parameters, {12.0, 7.5, 0.0});
    ASSERT_TRUE(made) << made.error().detail;
    const auto before = WorkOf(stream, parameters);
    const auto after = WorkOf(made->stream, parameters);
    SCOPED_TRACE(made->stream);
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t k = 0; k < before.size(); ++k) {
      ExpectAt(after[k].from, before[k].from, 1200, 750, 0);
      ExpectAt(after[k].to, before[k].to, 1200, 750, 0);
    }
    if (HasFailure()) return;
    compared += before.size();
  }
  EXPECT_GT(compared, 2000U);
}

// 100 / 40 = 2.5: 3 units become 7.5 and are rounded, of relative ones the sum: 7.5 15 22.5 30.
TEST(ScaleStream, RoundingDoesNotAccumulate) {
  EXPECT_EQ(Scaled("PR3,0,3,0,3,0,3,0;", 40, 100), "PR8,0,7,0,8,0,7,0;");
  EXPECT_EQ(Scaled("PA3,1;PR3,0;PA9,9;PR1,1;", 40, 100), "PA8,3;PR7,0;PA23,23;PR2,2;");
  EXPECT_EQ(Scaled("PU100,250;", 100, 40), "PU40,100;");
}

TEST(ScaleStream, LengthsAloneAreScaled) {
  EXPECT_EQ(Scaled("VS4;!VZ3;!DW100;!RC6500;!MC1;!PZ-40,80;!ZM-400;!ZO-80;Z1.2,2,3;", 40, 100),
            "VS4;!VZ3;!DW100;!RC6500;!MC1;!PZ-100,200;!ZM-1000;!ZO-200;Z3,5,8;");
  const auto turned = ScaleStream("!ZE X4A30;", ParametersOf("t1a"), 40, 100);
  ASSERT_TRUE(turned);
  EXPECT_EQ(turned->stream, "!ZE X10A30;");
  EXPECT_EQ(Scaled("..R;\x01 PU4,4 ;;", 40, 100), "..R;\x01 PU10,10 ;;");
}

// Of heights too what rounding took is made good by what is relative behind them: 3 units are 7.5,
// Z1 of -7.5 becomes -8 and Z2 of 7.5 becomes 8.
TEST(ScaleStream, RelativeHeightsMakeGoodTheRounding) {
  const auto down = [](const std::string& heights, const std::string& to_height) {
    return Scaled(heights + to_height + "^PR;Z0,0,-3;", 40, 100);
  };
  EXPECT_EQ(down("!PZ-3,3;", "PD;"), "!PZ-8,8;PD;^PR;Z0,0,-7;");
  EXPECT_EQ(down("!PZ-3,3;", "PU;"), "!PZ-8,8;PU;^PR;Z0,0,-8;");
  EXPECT_EQ(down("!PZ-3,3;", "PD4,4;"), "!PZ-8,8;PD10,10;^PR;Z0,0,-7;");
  EXPECT_EQ(down("!PZ-3;", "PD;"), "!PZ-8;PD;^PR;Z0,0,-7;");
  // Those of the machine are not rounded.
  EXPECT_EQ(down("!PZ-3,3;!PZ;", "PD;"), "!PZ-8,8;!PZ;PD;^PR;Z0,0,-8;");
  EXPECT_EQ(down("!PZ-3,3;!PZ;", "PU;"), "!PZ-8,8;!PZ;PU;^PR;Z0,0,-8;");
  EXPECT_EQ(down("!PZ-3,3;DF;", "PD;"), "!PZ-8,8;DF;PD;^PR;Z0,0,-8;");
  // Home is at the top, and where Z0 lies is rounded too: -3 becomes -8.
  EXPECT_EQ(down("!PZ-3,3;PD;", "H;"), "!PZ-8,8;PD;H;^PR;Z0,0,-8;");
  EXPECT_EQ(down("!ZO-3;", "PD;"), "!ZO-8;PD;^PR;Z0,0,-7;");
  EXPECT_EQ(down("!ZO-3;!ZO;", "PD;"), "!ZO-8;!ZO;PD;^PR;Z0,0,-8;");
  EXPECT_EQ(down("!ZM-3;", ""), "!ZM-8;^PR;Z0,0,-7;");
}

// From 1 to 10000 units in a mm.
TEST(ScaleStream, StepsOfAllMachines) {
  EXPECT_EQ(Scaled("PU2,1;", 1, 10'000), "PU20000,10000;");
  EXPECT_EQ(Scaled("PU20000,10000;", 10'000, 1), "PU2,1;");
  EXPECT_TRUE(Scaled("PU2,1;", 0.999, 100).starts_with("refused: "));
  EXPECT_TRUE(Scaled("PU2,1;", 100, 10'001).starts_with("refused: "));
}

TEST(ScaleStream, Refuses) {
  EXPECT_FALSE(ScaleStream("PU;", ParametersOf("t1"), 0, 100));
  EXPECT_FALSE(ScaleStream("PU;", ParametersOf("t1"), 40, NAN));
  EXPECT_FALSE(ScaleStream("PU9000000,1;", ParametersOf("t1"), 100, 40));
  EXPECT_TRUE(Scaled("PU8000000,1;", 40, 100).starts_with("refused: a number becomes"));
}

// The MDX-20 and the SRM-20 have the same travel and 40 and 100 units: the same work in mm.
TEST(ScaleStream, TheWorkIsTheSameToHalfAUnit) {
  std::mt19937 random(11);  // NOLINT: the same streams in every run
  std::size_t compared = 0;
  for (int i = 0; i < 300; ++i) {
    const std::string stream = RandomPart(random);
    SCOPED_TRACE(stream);
    const auto before = WorkOf(stream, Centred("mdx-20"));
    const auto made = ScaleStream(stream, ParametersOf("mdx-20"), 40, 100);
    ASSERT_TRUE(made) << made.error().detail;
    const auto after = WorkOf(made->stream, Centred("srm-20"));
    // A motion of one unit may round to none, or one of none to one.
    if (before.size() != after.size()) continue;
    for (std::size_t k = 0; k < before.size(); ++k) {
      const Point wanted{before[k].to.x * 2.5, before[k].to.y * 2.5, before[k].to.z * 2.5};
      ExpectAt(after[k].to, wanted, 0, 0, 0, 0.501);
    }
    if (HasFailure()) return;
    compared += before.size();
  }
  EXPECT_GT(compared, 1000U);
}

const std::string kPart =
    "PA;VS4;!VZ2;!PZ0,200;!MC1;\nPU100,100;\nZ100,100,-50;\nZ300,100,-50;\nZ300,200,-50;\n"
    "PU100,100;\n!MC0;PU0,9000;";

// 200 units wide and 100 high; a gap of 1 mm makes a pitch of 300 and 200. The lift of the part's
// own PU is behind its last cut, so it lifts by itself between the copies.
TEST(TileStream, CopiesStandBesideEachOtherAndTheEndsStandOnce) {
  const auto made = TileStream(kPart, ParametersOf("t1"), {.columns = 2, .rows = 2, .gap_mm = 1.0});
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_EQ(made->pitch_x_mm, 3.0);
  EXPECT_EQ(made->pitch_y_mm, 2.0);
  EXPECT_TRUE(made->stream.starts_with(
      "PA;VS4;!VZ2;!PZ0,200;!MC1;\nPU100,100;\nZ100,100,-50;\nZ300,100,-50;\nZ300,200,-50;\nPU;\n"
      "PU400,100;\nZ400,100,-50;\nZ600,100,-50;\nZ600,200,-50;\nPU;\nPU100,300;"))
      << made->stream;
  EXPECT_TRUE(made->stream.ends_with("Z600,400,-50;\nPU;\n;\nPU100,100;\n!MC0;PU0,9000;"));
  EXPECT_EQ(made->stream.find("!MC1"), made->stream.rfind("!MC1"));
}

void ExpectTiled(const std::string& part, std::string_view profile, int columns, int rows) {
  SCOPED_TRACE(part.substr(0, 2000));
  const auto made =
      TileStream(part, ParametersOf(profile), {.columns = columns, .rows = rows, .gap_mm = 2.0});
  ASSERT_TRUE(made) << made.error().detail;
  const Profile p = MakeProfile(ParametersOf(profile)).value();
  const auto one = WorkOf(part, ParametersOf(profile));
  const auto all = WorkOf(made->stream, ParametersOf(profile));
  ASSERT_EQ(all.size(), one.size() * static_cast<std::size_t>(columns * rows));
  std::size_t k = 0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      for (const WorkWay& way : one) {
        const double x = column * made->pitch_x_mm * p.units_per_mm;
        const double y = row * made->pitch_y_mm * p.units_per_mm;
        ExpectAt(all[k].from, way.from, x, y, 0, 0.01);
        ExpectAt(all[k].to, way.to, x, y, 0, 0.01);
        ++k;
      }
    }
  }
}

// Settings that change on the way, relative parts, a tool-up height that is no clearance.
TEST(TileStream, EveryCopyDoesTheWorkOfTheFirst) {
  for (const char* part :
       {"!PZ-10,100;PU10,10;PD30,10;VS9;!VZ3;!PZ-20,100;PD30,30;PU0,0;",
        "!PZ-10,0;PU10,10;PD30,10;PR5,5;PU;", "PU50,50;PR;!PZ-10,50;PD10,0,0,10;PU;PA;",
        "Z9,9,90;Z9,9,-9,50,9,-9;V9;Z50,9,90;H;", "Z10,10,100;Z10,10,-20,40,10,-20;!ZM0;",
        "!PZ-5,50;D10,10;I5,5,5,0;M90,90;D95,95;M;H;",
        "!PZ-5,50;PD10,10;PD20,20;!DW5;!RC8;!MC0;PU1,1;", "PR;!PZ-5,50;PD10,10;PU;PD3,3;",
        "PR;!PZ-50,100;Z500,500,0;!ZO-2500;Z0,0,-2550;Z300,0,0;PU;PA;PU0,0;",
        "PR;!PZ-50,100;Z500,500,0;!ZM-1990;Z0,0,-20,30,0,0;PU;PA;PU0,0;",
        "PA;Z0,0,10;PR;Z300,0,-30,300,0,0;PU;"}) {
    ExpectTiled(part, "t1", 3, 2);
    if (HasFailure()) return;
  }
}

// T1: the surface is at -2000. Z0 comes to -2500, and the tool-up height with it to -2400: in the
// work still, so the way to the copy leads at the top.
TEST(TileStream, ATopOfTheToolThatLiesInTheWorkIsNoWayAcross) {
  const auto made = TileStream("PA;!PZ-50,100;PU500,500;!ZO-2500;PD500,500;PD800,500;PU;!ZM0;",
                               ParametersOf("t1"), {.columns = 2, .gap_mm = 1.0});
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_NE(made->stream.find("!ZM0;\n!ZO-2000;"), std::string::npos) << made->stream;
}

// T1: Z0 is -2000. The part begins at the top, sets Z0 to 2500 below and cuts from X 500 to 800;
// its tool-up height, 100 above that, lies in the work, so it goes up to the top. The copy comes
// from there, (800, 500, 0), to (400, 0, 0), and Z0 counts from the top again.
TEST(TileStream, ACopyThatSetsZ0RelativelyBeginsAtTheHeightOfTheFirst) {
  const auto made = TileStream("PR;!PZ-50,100;Z500,500,0;!ZO-2500;Z0,0,-2550;Z300,0,0;PU;PA;PU0,0;",
                               ParametersOf("t1"), {.columns = 2, .gap_mm = 1.0});
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_NE(made->stream.find("!ZM0;\n!ZO-2000;\nPR;\n!ZZ-400,-500,0;Z500,500,0;!ZO-2500;"),
            std::string::npos)
      << made->stream;
}

// It begins 10 above Z0 and ends 500 above: across at 500, and then down by 490. The first ends at
// X 600 and is cut from 0, so the copy begins at 700.
TEST(TileStream, ACopyThatBeginsLowComesFromAbove) {
  const auto made = TileStream("PA;Z0,0,10;PR;Z300,0,-30,300,0,0;PU;", ParametersOf("t1"),
                               {.columns = 2, .gap_mm = 1.0});
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_NE(made->stream.find("!ZZ100,0,0,0,0,-490;Z300,0,-30,300,0,0;"), std::string::npos)
      << made->stream;
}

// The cuts of kPart are 200 by 100 units; with 1 mm between, 3 mm in X and 2 mm in Y to the next.
TEST(TileStream, AsManyAsAFieldHasRoomFor) {
  const auto within = [](double width, double height, double gap = 1.0) -> std::string {
    const auto made =
        TileStream(kPart, ParametersOf("t1"), {.within_mm = {{width, height}}, .gap_mm = gap});
    if (!made) return made.error().detail;
    return std::to_string(made->columns) + " x " + std::to_string(made->rows) +
           (made->travel_is_less ? " on the travel" : "");
  };
  EXPECT_EQ(within(8.0, 5.0), "3 x 3");    // 2 + 3 + 3 and 1 + 2 + 2
  EXPECT_EQ(within(7.99, 4.99), "2 x 2");  // not quite
  EXPECT_EQ(within(6.0, 1.0, 0.0), "3 x 1");
  EXPECT_EQ(within(1.99, 5.0), "the paths of one copy take 2 by 1 mm, more than 1.99 by 5 mm");
  // 66 columns: see SaysHowManyFit.
  EXPECT_EQ(within(900.0, 1.0), "66 x 1 on the travel");
  const auto none = TileStream(kPart, ParametersOf("t1"), {.within_mm = {{0.0, 5.0}}});
  EXPECT_EQ(none.error().code, ErrorCode::kCellInvalidArgument);
  const auto two = TileStream(kPart, ParametersOf("t1"), {.columns = 2});
  const auto field = TileStream(kPart, ParametersOf("t1"), {.within_mm = {{5.0, 1.0}}});
  EXPECT_EQ(two->stream, field->stream);
}

TEST(TileStream, TheCorpus) {
  const std::string corpus = std::string(RMLCELL_SHARED_DIR) + "/corpus/rml1";
  if (!std::filesystem::exists(corpus)) GTEST_SKIP() << "no corpus at " << corpus;
  int tiled = 0;
  for (const auto& entry : std::filesystem::directory_iterator(corpus)) {
    const std::string extension = entry.path().extension();
    if (extension != ".rml" && extension != ".prn") continue;
    SCOPED_TRACE(entry.path());
    const std::string part = ReadFile(entry.path());
    const auto made = TileStream(part, ParametersOf("srm-20"), {.columns = 2, .gap_mm = 2.0});
    if (made) {
      ExpectTiled(part, "srm-20", 2, 1);
      ++tiled;
    } else {
      EXPECT_TRUE(made.error().code == ErrorCode::kRml1DoesNotFit ||
                  made.error().code == ErrorCode::kRml1WorkBeyondTravel ||
                  made.error().code == ErrorCode::kRml1NotRewritten)
          << made.error().detail;
    }
    if (HasFailure()) return;
  }
  EXPECT_GE(tiled, 5);
}

// 200 mm of travel; the part ends at 3 mm and comes again every 3 mm: 1 + floor(197 / 3) = 66. In
// Y: 1 + floor(148 / 2) = 75.
TEST(TileStream, SaysHowManyFit) {
  const auto many = TileStream(kPart, ParametersOf("t1"), {.columns = 67, .rows = 1});
  ASSERT_FALSE(many);
  EXPECT_EQ(many.error().code, ErrorCode::kRml1DoesNotFit);
  EXPECT_TRUE(many.error().detail.starts_with("at most 66 columns and 75 rows fit"));
  EXPECT_TRUE(TileStream(kPart, ParametersOf("t1"), {.columns = 66, .rows = 1}));
  EXPECT_FALSE(TileStream(kPart, ParametersOf("t1"), {.columns = 1, .rows = 76}));
}

TEST(TileStream, Refuses) {
  const auto code = [](std::string_view stream, const TileOptions& options) {
    const auto made = TileStream(stream, ParametersOf("t1"), options);
    return made ? ErrorCode::kCellUsage : made.error().code;
  };
  EXPECT_EQ(code(kPart, {.columns = 0}), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(code(kPart, {.rows = 1001}), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(code(kPart, {.gap_mm = -1}), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(code("PU1,1;", {.columns = 2}), ErrorCode::kRml1NotRewritten);
  EXPECT_EQ(code("PD1,1,9,9,", {.columns = 2}), ErrorCode::kRml1NotRewritten);
  EXPECT_EQ(code("", {}), ErrorCode::kCellEmptyProgram);
  EXPECT_EQ(code(kPart, {.columns = 9, .bytes_max = 400}), ErrorCode::kRml1ProductTooLarge);
}

// RML1-3C.25, RML1-3C.37: a relative !ZM leads from where the tool is, which has been moved
// already, and one without a number leads nowhere: neither owes a way. IN leads to a height of the
// machine, so that what counts from there has the way in Z before it. T1: the surface is 20 mm
// below the top, IN leads to 5 mm above it.
TEST(MoveStream, WhatOwesAWayInZ) {
  EXPECT_EQ(Moved("PR;Z0,0,-2010;!ZM-5;Z0,0,-5;", 0, 0, -0.5),
            "PR;!ZZ0,0,-50;Z0,0,-2010;!ZM-5;Z0,0,-5;");
  EXPECT_EQ(Moved("Z1,1,5;!ZM;PR;Z0,0,-10;", 0, 0, -0.5), "Z1,1,-45;!ZM;PR;Z0,0,-10;");
  EXPECT_EQ(Moved("Z1,1,5;!ZM-1500;PR;Z0,0,-510;", 0, 0, -0.5),
            "Z1,1,-45;!ZM-1500;PR;!ZZ0,0,-50;Z0,0,-510;");
  EXPECT_EQ(Moved("Z1,1,5;IN;PR;Z0,0,-510;", 0, 0, -0.5), "Z1,1,-45;IN;PR;!ZZ0,0,-50;Z0,0,-510;");
}

// Six decimals are written: less is no part of a 4-byte value there.
TEST(MoveStream, NumbersHaveSixDecimals) {
  EXPECT_EQ(Moved("Z0.1234567,0,0;", 1, 0), "Z100.123457,0,0;");
}

// 3 units are 7.5: what rounding took is made good by a relative !ZM and !ZO as by a set, over DF,
// which moves nothing. IN leads to a height of the machine, which is not rounded.
TEST(ScaleStream, RelativeHeightsOfTheMachineMakeGoodTheRounding) {
  EXPECT_EQ(Scaled("PR;Z0,0,-3;!ZM-3;", 40, 100), "PR;Z0,0,-8;!ZM-7;");
  EXPECT_EQ(Scaled("PR;Z0,0,-3;!ZO-3;", 40, 100), "PR;Z0,0,-8;!ZO-7;");
  EXPECT_EQ(Scaled("PR;Z3,0,0;DF;^PR;Z3,0,0;", 40, 100), "PR;Z8,0,0;DF;^PR;Z7,0,0;");
  EXPECT_EQ(Scaled("!PZ-3,3;PD;IN;^PR;Z0,0,-3;", 40, 100), "!PZ-8,8;PD;IN;^PR;Z0,0,-8;");
}

}  // namespace
}  // namespace rmlcell::rml1
