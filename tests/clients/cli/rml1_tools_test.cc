// The tools for streams of mills as verbs: where the result goes, what is said of it, and what is
// refused. What they make of a stream: tests/engine/rml1/offline.
#include "clients/cli/rml1_tools.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "clients/cli/verbs.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::UnorderedElementsAre;

// 5 mm of a cut in X, 0.5 mm deep, on a machine of 100 units in a mm.
constexpr const char* kCut = "PA;VS4;!VZ2;!PZ-50,200;!MC1;PU100,100;\nPD600,100;PU0,0;!MC0;\n";
// To X 300 mm on a travel of 203.2 mm.
constexpr const char* kWide = "PA;VS4;!VZ2;!PZ-50,200;!MC1;PU100,100;\nPD30000,100;PU0,0;!MC0;\n";
constexpr const char* kNote = ", for the srm-20: no profile was named";

class MillToolsTest : public testing::Test {
 protected:
  // Options of any tool for a file of this name.
  template <typename Options = MillToolOptions>
  Options Of(const std::string& name, const std::string& bytes, const std::string& output = {}) {
    Options options;
    options.file = folder.Put(name, bytes);
    if (!output.empty()) options.output = output == "-" ? output : folder.File(output);
    return options;
  }
  template <typename Options>
  static Options For(Options options, const std::string& profile) {
    options.machine.profile = profile;
    return options;
  }

  CliFolder folder;
};

TEST_F(MillToolsTest, ExplainHasAHeadingAndAlignedColumns) {
  const auto options = Of("a.rml", "VS4;PU100,200;");
  const Told told = Hear([&] { return ExplainStream(options); });
  EXPECT_EQ(told.exit_code, 0);
  // Offsets 9 wide and numbers of commands 8 wide, to the right; the text 24 wide.
  EXPECT_THAT(told.output,
              AllOf(HasSubstr("     byte  command  text                      what it "
                              "does\n"),
                    HasSubstr("\n        0        1  VS4                       cutting "
                              "speed")));
  EXPECT_THAT(told.output, HasSubstr("\n        4        2  PU100,200                 "));
}

TEST_F(MillToolsTest, ExplainTellsFindingsBelowTheirCommand) {
  Told told = Hear([&] { return ExplainStream(Of("a.rml", "QQ;\n")); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_THAT(told.output, HasSubstr("\n                    " + folder.File("a.rml") + ":1:1: "));
  auto options = Of("a.rml", "PU1,2;\nQQ;PU3,4;");
  options.json = true;
  told = Hear([&] { return ExplainStream(options); });
  EXPECT_EQ(told.exit_code, 0);
  std::size_t findings = 0;
  for (std::size_t at = 0; at < told.output.size(); at = told.output.find('\n', at) + 1) {
    const json line = json::parse(told.output.substr(at, told.output.find('\n', at) - at));
    for (const json& finding : line["findings"]) {
      ++findings;
      EXPECT_EQ(finding["line"], 2);
      EXPECT_EQ(finding["column"], 1);
      EXPECT_EQ(finding["code"].get<std::string>().substr(0, 6), "RML1-E");
      EXPECT_EQ(line["text"].get<std::string>().substr(0, 2), "QQ");
    }
  }
  EXPECT_EQ(findings, 1U);
}

TEST_F(MillToolsTest, WhatIsNoStreamIsRefused) {
  const auto refused = [](const MillToolOptions& options, const char* code) {
    for (const auto tool : {ExplainStream, StreamToGcode}) {
      const Told told = Hear([&] { return tool(options); });
      EXPECT_EQ(told.exit_code, 2);
      EXPECT_EQ(told.output, "");
      EXPECT_THAT(told.errors, HasSubstr(code));
    }
  };
  refused(Of("12.S", "SPEED 20\n"), "12.S is a program for ");
  refused(Of("a.rml", ""), "CELL-E9017");
  refused({.file = folder.File("none.rml"), .output = {}, .machine = {}}, "CELL-E9022");
  refused(For(Of("b.rml", kCut), "no-such-mill"), "no-such-mill");
  auto laser = Of("c.rml", kCut);
  laser.machine.file = folder.Put("laser.toml", "family = \"optimo\"\n");
  refused(laser, "CELL-E9026");
  refused(laser, "laser.toml is a machine of the family optimo");
  EXPECT_EQ(folder.Names().size(), 5U);
}

TEST_F(MillToolsTest, GcodeGoesBesideTheStream) {
  const auto options = Of("a.rml", kCut);
  Told told = Hear([&] { return StreamToGcode(options); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, folder.File("a.nc") + ": " + std::to_string(folder.Read("a.nc").size()) +
                             " B of G-code" + kNote + "\n");
  EXPECT_THAT(folder.Read("a.nc"), HasSubstr("G1 X6 F240\n"));  // 4 mm/s
  told = Hear([&] { return StreamToGcode(For(options, "srm-20")); });
  EXPECT_THAT(told.output, AllOf(HasSubstr(" of G-code\n"), Not(HasSubstr("no profile"))));
  auto own = options;
  own.machine.file = folder.Put("own.toml", "family = \"rml1\"\nprofile = \"srm-20\"\n");
  told = Hear([&] { return StreamToGcode(own); });
  EXPECT_THAT(told.output, Not(HasSubstr("no profile")));
  // And back: beside the G-code.
  auto back = For(FromGcodeToolOptions{}, "srm-20");
  back.file = folder.File("a.nc");
  back.output = folder.File("b.rml");
  told = Hear([&] { return StreamFromGcode(back); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, folder.File("b.rml") + ": stream of " +
                             std::to_string(folder.Read("b.rml").size()) + " B\n");
}

TEST_F(MillToolsTest, GcodeThatSaysNothingIsRefused) {
  Told told = Hear([&] { return StreamFromGcode(Of<FromGcodeToolOptions>("a.nc", "")); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, HasSubstr("CELL-E9017"));
  FromGcodeToolOptions none;
  none.file = folder.File("none.nc");
  told = Hear([&] { return StreamFromGcode(none); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, HasSubstr("CELL-E9022"));
  auto rough = Of<FromGcodeToolOptions>("b.nc", "G21\nG0 Z2\nG1 Z-0.5 F60\nG1 X5\nG0 Z2\n");
  rough.tolerance_mm = -1.0;
  told = Hear([&] { return StreamFromGcode(rough); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, HasSubstr("CELL-E9003"));
  EXPECT_THAT(folder.Names(), UnorderedElementsAre("a.nc", "b.nc"));
}

// Nothing is written of which the machine would leave out a part; forced, it is, with a warning.
TEST_F(MillToolsTest, WorkBeyondTheTravelIsWrittenOnlyWhenForced) {
  auto options = For(Of("a.rml", kWide, "a.nc"), "srm-20");
  Told told = Hear([&] { return StreamToGcode(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.errors, HasSubstr("a.rml:2:1: error RML1-E8114"));
  EXPECT_THAT(folder.Names(), ElementsAre("a.rml"));
  options.force = true;
  told = Hear([&] { return StreamToGcode(options); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_THAT(told.errors, HasSubstr("a.rml:2:1: warning RML1-E8114"));
  EXPECT_THAT(folder.Names(), UnorderedElementsAre("a.rml", "a.nc"));
}

TEST_F(MillToolsTest, TheOriginOfTheWorkCounts) {
  auto move = For(Of<MoveToolOptions>("a.rml", kCut, "-"), "srm-20");
  move.by_mm = {100.0, 0.0};
  EXPECT_EQ(Hear([&] { return MoveMillStream(move); }).exit_code, 0);
  // 100 + 6 mm of the work, and 100 mm of the origin, are more than 203.2 mm.
  move.machine.origin = {100.0, 0.0};
  const Told told = Hear([&] { return MoveMillStream(move); });
  EXPECT_EQ(told.exit_code, 1);
  // The line is that of the file, the numbers in it are others.
  EXPECT_THAT(told.errors, HasSubstr("a.rml:2:1: error RML1-E8114"));
  EXPECT_EQ(told.output, "");
}

TEST_F(MillToolsTest, MoveSaysByHowMuchAndKeepsTheOtherBytes) {
  auto move = Of<MoveToolOptions>("a.rml", "PU100,100; PD200,+50 ;PR5,5;", "b.rml");
  move.by_mm = {1.004, -0.5};
  Told told = Hear([&] { return MoveMillStream(move); });
  EXPECT_EQ(told.exit_code, 0);
  // Rounded to 0.01 mm.
  EXPECT_EQ(told.output, folder.File("b.rml") + ": moved by 1.000,-0.500,0.000 mm" + kNote + "\n");
  EXPECT_EQ(folder.Read("b.rml"), "PU200,50; PD300,0 ;PR5,5;");
  move.output.clear();  // standard output
  told = Hear([&] { return MoveMillStream(move); });
  EXPECT_EQ(told.output, "PU200,50; PD300,0 ;PR5,5;");
}

TEST_F(MillToolsTest, WhatIsWrongInTheFileHasItsPlaceAndAWrongCallHasNone) {
  auto move = Of<MoveToolOptions>("a.rml", "PU1,1;\nPU5;", "b.rml");
  move.by_mm = {1.0, 1.0};
  Told told = Hear([&] { return MoveMillStream(move); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.errors, HasSubstr("a.rml:2:1: error RML1-E8111"));
  auto steps = Of<StepsToolOptions>("c.rml", kCut, "b.rml");
  steps.from = 0.0;
  steps.to = 100.0;
  told = Hear([&] { return ScaleMillStream(steps); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, AllOf(HasSubstr("CELL-E9003"), Not(HasSubstr("c.rml:"))));
  EXPECT_THAT(folder.Names(), UnorderedElementsAre("a.rml", "c.rml"));
}

TEST_F(MillToolsTest, StepsAreCheckedOnTheMachineThatHasThem) {
  auto steps = Of<StepsToolOptions>("a.rml", "VS4;!PZ-40,80;PU100,3;PR3,0,3,0;", "b.rml");
  steps.from = 40.0;
  steps.to = 100.0;
  Told told = Hear([&] { return ScaleMillStream(steps); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, folder.File("b.rml") + ": 100 units in a mm\n");
  // 2.5 times as many; 3 at a time, 7.5 and then 15 from the start.
  EXPECT_EQ(folder.Read("b.rml"), "VS4;!PZ-100,200;PU250,8;PR8,0,7,0;");
  steps.from = 100.0;
  steps.to = 40.0;
  told = Hear([&] { return ScaleMillStream(steps); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output,
            folder.File("b.rml") +
                ": 40 units in a mm; whether it fits is not known: name the machine that it is "
                "for, of 40 units, with --profile\n");
  // From 20 to 100 units: 6 mm become 30 mm, and 60 mm become 300 mm.
  auto wide = For(Of<StepsToolOptions>("c.rml", kWide, "d.rml"), "srm-20");
  wide.from = wide.to = 100.0;
  told = Hear([&] { return ScaleMillStream(wide); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.errors, HasSubstr("c.rml:2:1: error RML1-E8114"));
  EXPECT_THAT(folder.Names(), UnorderedElementsAre("a.rml", "b.rml", "c.rml"));
}

// The cut is 5 mm by 0: with 2 mm between, every 7 mm in X and every 2 mm in Y.
TEST_F(MillToolsTest, TileSaysHowManyAndHowFarApart) {
  auto tile = Of<TileToolOptions>("a.rml", kCut, "b.rml");
  tile.gap_mm = 2.0;
  Told told = Hear([&] { return TileMillStream(tile); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_THAT(told.output, HasSubstr(folder.File("b.rml") + ": 1 copy, 1 in X and 1 in Y, every "));
  tile.columns = 3;
  tile.rows = 2;
  told = Hear([&] { return TileMillStream(tile); });
  EXPECT_EQ(told.output, folder.File("b.rml") +
                             ": 6 copies, 3 in X and 2 in Y, every 7.000 mm in X and 2.000 mm in "
                             "Y" +
                             kNote + "\n");
  // 5 + 7 + 7 mm; 0 + 2 + 2 mm.
  tile.columns = tile.rows = 1;
  tile.within = "19x4";
  told = Hear([&] { return TileMillStream(tile); });
  EXPECT_THAT(told.output, AllOf(HasSubstr(": 9 copies, 3 in X and 3 in Y, "),
                                 Not(HasSubstr("more are not on the travel"))));
  tile.within = "900x4";
  told = Hear([&] { return TileMillStream(tile); });
  EXPECT_THAT(told.output, HasSubstr("; more are not on the travel" + std::string(kNote) + "\n"));
}

TEST_F(MillToolsTest, AFieldHasAWidthAndAHeight) {
  auto tile = Of<TileToolOptions>("a.rml", kCut, "b.rml");
  for (const char* wrong : {"150", "x100", "150x", "axb", "150x100x2"}) {
    tile.within = wrong;
    const Told told = Hear([&] { return TileMillStream(tile); });
    EXPECT_EQ(told.exit_code, 2) << wrong;
    EXPECT_THAT(told.errors, AllOf(HasSubstr("CELL-E9003"),
                                   HasSubstr("'" + std::string(wrong) + "' is no field")));
  }
  tile.within = "3x3";
  const Told told = Hear([&] { return TileMillStream(tile); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.errors, HasSubstr("RML1-E8112"));
  EXPECT_THAT(folder.Names(), ElementsAre("a.rml"));
}

TEST_F(MillToolsTest, TilesBeyondTheTravelAreWrittenOnlyWhenForced) {
  auto tile = For(Of<TileToolOptions>("a.rml", kCut, "b.rml"), "srm-20");
  tile.columns = 40;  // 39 * 6 + 6 mm
  Told told = Hear([&] { return TileMillStream(tile); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.errors, HasSubstr("error RML1-E8112"));
  tile.force = true;
  told = Hear([&] { return TileMillStream(tile); });
  EXPECT_EQ(told.exit_code, 0);
  // Of a stream that is made: no line of the file is at fault.
  EXPECT_THAT(told.errors, HasSubstr("a.rml: warning RML1-E8114"));
}

// A picture of 5 by 3 pixels, 40 of them in a mm (zlib of five dark rows with one light pixel).
std::string PictureBytes() {
  static constexpr std::string_view kHex =
      "89504e470d0a1a0a0000000d49484452000000050000000308000000007e5d9a240000000970485973000003e8"
      "000003e801b57b526b0000000e49444154789c63608082ff300600090901004ac498610000000049454e44ae42"
      "6082";
  std::string bytes;
  for (std::size_t at = 0; at < kHex.size(); at += 2)
    bytes += static_cast<char>(std::stoi(std::string(kHex.substr(at, 2)), nullptr, 16));
  return bytes;
}

// 1000 pixels in a metre: a pixel is 1 mm; with 25.4 dpi by hand, too.
TEST_F(MillToolsTest, APictureIsMilledWhereItIsPlaced) {
  auto png = For(Of<PngToolOptions>("a.png", PictureBytes()), "srm-20");
  png.board.depth_mm = 1.0;
  png.at_mm = {10.0, 20.0};
  Told told = Hear([&] { return StreamFromPng(png); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, folder.File("a.rml") + ": 1 line, picture of 5.00 by 3.00 mm\n");
  // The light pixel is 12 to 13 mm in X and 21 to 22 mm in Y: in the work the tool is around it,
  // within the picture and two pixels.
  const std::string stream = folder.Read("a.rml");
  std::size_t in_the_work = 0;
  for (std::size_t at = stream.find('Z'); at != std::string::npos; at = stream.find('Z', at + 1)) {
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;
    if (std::sscanf(stream.c_str() + at, "Z%lf,%lf,%lf", &x, &y, &z) != 3 || z >= 0.0) continue;
    ++in_the_work;
    EXPECT_EQ(z, -100.0);
    EXPECT_NEAR(x, 1250.0, 250.0);
    EXPECT_NEAR(y, 2150.0, 250.0);
  }
  EXPECT_GT(in_the_work, 3U);
  png.dpi = 12.7;  // twice as large
  told = Hear([&] { return StreamFromPng(png); });
  EXPECT_THAT(told.output, HasSubstr("picture of 10.00 by 6.00 mm"));
}

TEST_F(MillToolsTest, APictureThatDoesNotFitIsRefusedInItsOwnTerms) {
  auto png = For(Of<PngToolOptions>("a.png", PictureBytes()), "srm-20");
  png.at_mm = {-10.0, 0.0};
  Told told = Hear([&] { return StreamFromPng(png); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.errors, HasSubstr("a.png: error RML1-E8126"));
  png.file = folder.Put("b.png", "GIF89a");
  told = Hear([&] { return StreamFromPng(png); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.errors, HasSubstr("b.png: error RML1-E81"));
  png.file = folder.File("none.png");
  told = Hear([&] { return StreamFromPng(png); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, HasSubstr("CELL-E9022"));
  png.machine.profile = "no-such-mill";
  EXPECT_EQ(Hear([&] { return StreamFromPng(png); }).exit_code, 2);
  EXPECT_THAT(folder.Names(), UnorderedElementsAre("a.png", "b.png"));
}

// place.
TEST_F(MillToolsTest, PlacesHaveAsManyNumbersAsAxes) {
  const std::string stream = folder.Put("a.rml", kCut);
  const std::string picture = folder.Put("a.png", PictureBytes());
  const auto reads = [](std::vector<std::string> words) {
    int exit_code = 0;
    CLI::App app;
    AddRml1Verbs(app, exit_code);
    words.insert(words.begin(), "rml1");
    std::ranges::reverse(words);
    bool read = true;
    Hear([&] {
      try {
        app.parse(words);
      } catch (const CLI::ParseError&) {
        read = false;
      }
      return 0;
    });
    return read;
  };
  for (const char* good : {"1,2", "1,2,0"}) {
    EXPECT_TRUE(reads({"move", stream, "--by", good})) << good;
    EXPECT_TRUE(reads({"explain", stream, "--origin", good})) << good;
  }
  for (const char* wrong : {"1", "1,2,0,0"}) {
    EXPECT_FALSE(reads({"move", stream, "--by", wrong})) << wrong;
    EXPECT_FALSE(reads({"explain", stream, "--origin", wrong})) << wrong;
  }
  const auto placed = [&](const char* at) {
    return reads({"from-png", picture, "--tool", "0.4", "--depth", "0.1", "-o", "-", "--at", at});
  };
  EXPECT_TRUE(placed("1,2"));
  EXPECT_FALSE(placed("1"));
  EXPECT_FALSE(placed("1,2,0"));
}

}  // namespace
}  // namespace rmlcell::cli
