// What the tools for streams of mills refuse, each with its place in the file and its exit code,
// and what they tell of what they write all the same.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "clients/cli/rml1_tools.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class MillToolRefusals : public testing::Test {
 protected:
  MillToolRefusals() { ::setenv("NO_COLOR", "1", 1); }
  template <typename Options>
  Options Of(const std::string& name, const std::string& bytes, const std::string& profile) const {
    Options options;
    options.file = bytes.empty() ? folder_.File(name) : folder_.Put(name, bytes);
    options.output = folder_.File("made");
    options.machine.profile = profile;
    return options;
  }
  // Nothing is written.
  Told Refused(int exit_code, const std::function<int()>& tool) const {
    Told told = Hear(tool);
    EXPECT_EQ(told.exit_code, exit_code) << told.errors;
    EXPECT_EQ(told.output, "");
    EXPECT_THAT(folder_.Names(), Not(testing::Contains("made")));
    return told;
  }

  CliFolder folder_;
};

// A file that is not there, and a machine that nobody knows.
TEST_F(MillToolRefusals, EachReadsItsFileForItsMachine) {
  const std::vector<std::function<int(const std::string&, const std::string&)>> tools = {
      [&](const auto& bytes, const auto& profile) {
        return ExplainStream(Of<MillToolOptions>("a", bytes, profile));
      },
      [&](const auto& bytes, const auto& profile) {
        return StreamToGcode(Of<MillToolOptions>("a", bytes, profile));
      },
      [&](const auto& bytes, const auto& profile) {
        return StreamFromGcode(Of<FromGcodeToolOptions>("a", bytes, profile));
      },
      [&](const auto& bytes, const auto& profile) {
        auto options = Of<MoveToolOptions>("a", bytes, profile);
        options.by_mm = {1.0, 2.0};
        return MoveMillStream(options);
      },
      [&](const auto& bytes, const auto& profile) {
        return ScaleMillStream(Of<StepsToolOptions>("a", bytes, profile));
      },
      [&](const auto& bytes, const auto& profile) {
        return TileMillStream(Of<TileToolOptions>("a", bytes, profile));
      },
      [&](const auto& bytes, const auto& profile) {
        return StreamFromPng(Of<PngToolOptions>("a", bytes, profile));
      }};
  for (const auto& tool : tools) {
    const Told none = Refused(2, [&] { return tool("", "srm-20"); });
    EXPECT_THAT(none.errors, StartsWith("rmlcell: CELL-E9022: "));
    EXPECT_THAT(none.errors, HasSubstr(folder_.File("a")));
  }
  for (const auto& tool : tools) {
    const Told nobody = Refused(2, [&] { return tool("PU;", "no-such-mill"); });
    EXPECT_THAT(nobody.errors,
                AllOf(StartsWith("rmlcell: CELL-E9003: "), HasSubstr("no-such-mill")));
  }
}

// Who has no bytes is named; so is a machine file that cannot be read, or is of no family.
TEST_F(MillToolRefusals, WhatIsEmptyOrOfNoFamilyIsNamed) {
  auto gcode = Of<FromGcodeToolOptions>("a.nc", "G21\n", "srm-20");
  gcode.file = folder_.Put("empty.nc", "");
  const Told empty = Refused(2, [&] { return StreamFromGcode(gcode); });
  EXPECT_THAT(empty.errors, AllOf(StartsWith("rmlcell: CELL-E9017: "), HasSubstr(gcode.file)));
  auto stream = Of<MillToolOptions>("a.rml", "PU;", "");
  stream.machine.file = folder_.File("none.toml");
  const Told none = Refused(2, [&] { return StreamToGcode(stream); });
  EXPECT_THAT(none.errors, AllOf(StartsWith("rmlcell: CELL-E9022: "), HasSubstr("none.toml")));
  stream.machine.file = folder_.Put("lathe.toml", "family = \"lathe\"\n");
  const Told lathe = Refused(2, [&] { return StreamToGcode(stream); });
  EXPECT_THAT(lathe.errors, AllOf(StartsWith("rmlcell: CELL-E9026: "),
                                  HasSubstr("lathe.toml is a machine of the family lathe")));
}

// 70 mm deep, where the mill goes down 60.5 mm in all, and 40.5 mm below the surface: of the stream
// that is made, and of no line.
TEST_F(MillToolRefusals, ATileIsCheckedInDepth) {
  const std::string deep = "PA;VS4;!VZ2;!PZ-7000,200;!MC1;PU100,100;\nPD600,100;PU0,0;!MC0;\n";
  auto tile = Of<TileToolOptions>("a.rml", deep, "srm-20");
  const Told told = Refused(1, [&] { return TileMillStream(tile); });
  EXPECT_THAT(told.errors, StartsWith(tile.file + ": error RML1-E8115: "));
  EXPECT_THAT(told.errors, HasSubstr("may be from -40.5 to 0 mm"));
  tile.force = true;
  const Told forced = Hear([&] { return TileMillStream(tile); });
  EXPECT_EQ(forced.exit_code, 0);
  EXPECT_THAT(forced.errors, StartsWith(tile.file + ": warning RML1-E8115: "));
}

// docs/gcode.md
TEST_F(MillToolRefusals, GcodeIsRefusedAtItsLine) {
  const auto made = [&](const std::string& text) {
    return
        [this, text] { return StreamFromGcode(Of<FromGcodeToolOptions>("a.nc", text, "srm-20")); };
  };
  const std::string begin = "G21 G90\nM3 S5000\nG0 Z2\nG1 Z-0.5 F60\n";
  const Told wide = Refused(1, made(begin + "G1 X300\nG0 Z2\nM5\n"));
  EXPECT_THAT(wide.errors, StartsWith(folder_.File("a.nc") + ":5:1: error RML1-E8114: "));
  const Told wrong = Refused(1, made(begin + "G99 X3\nG0 Z2\nM5\n"));
  EXPECT_THAT(wrong.errors, StartsWith(folder_.File("a.nc") + ":5:1: error RML1-E8102: G99; "));
  const Told advice = Hear(made(begin + "M8\nG1 X3\nG0 Z2\nM5\n"));
  EXPECT_EQ(advice.exit_code, 0);
  EXPECT_THAT(advice.errors,
              StartsWith(folder_.File("a.nc") + ":5:1: advice RML1-E8105: M8, coolant\n"));
  EXPECT_THAT(folder_.Read("made"), HasSubstr("VZ1;"));  // 60 mm/min
}

TEST_F(MillToolRefusals, AStreamIsRefusedAtItsLine) {
  const auto made = [&](const std::string& text, const std::string& profile) {
    return [this, text, profile] {
      return StreamToGcode(Of<MillToolOptions>("a.rml", text, profile));
    };
  };
  const Told turned = Refused(1, made("PU;\n!ZE A90;", "t1a"));
  EXPECT_THAT(turned.errors, HasSubstr("a.rml:2:1: error RML1-E8107: "));
  const Told told =
      Hear(made("PA;VS4;!VZ2;!PZ-50,200;!MC1;PU100,100;\nQQ;PD600,100;PU0,0;!MC0;\n", "srm-20"));
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_THAT(told.errors, HasSubstr("a.rml:2:1: device error RML1-E1: "));
}

// A picture of 5 by 3 pixels that does not say how large they are.
TEST_F(MillToolRefusals, APictureNeedsASizeAndADepth) {
  static constexpr std::string_view kHex =
      "89504e470d0a1a0a0000000d49484452000000050000000308000000007e5d9a24"
      "0000000e49444154789c63608082ff300600090901004ac498610000000049454e44ae426082";
  std::string bytes;
  for (std::size_t at = 0; at < kHex.size(); at += 2)
    bytes += static_cast<char>(std::stoi(std::string(kHex.substr(at, 2)), nullptr, 16));
  auto png = Of<PngToolOptions>("a.png", bytes, "srm-20");
  png.board.depth_mm = 1.0;
  png.at_mm = {10.0, 20.0};
  const Told size = Refused(1, [&] { return StreamFromPng(png); });
  EXPECT_THAT(size.errors, AllOf(HasSubstr("a.png: error RML1-E81"), HasSubstr("no resolution")));
  png.dpi = 25.4;
  png.board.depth_mm = 0.0;
  const Told depth = Refused(2, [&] { return StreamFromPng(png); });
  EXPECT_THAT(depth.errors, AllOf(StartsWith("rmlcell: CELL-E9003: "), HasSubstr("the depth")));
  png.board.depth_mm = 1.0;
  const Told one = Hear([&] { return StreamFromPng(png); });
  EXPECT_EQ(one.output, folder_.File("made") + ": 1 line, picture of 5.00 by 3.00 mm\n");
  const std::string dark = folder_.Read("made");
  // What is left of the other colour lies around another place.
  png.invert = true;
  EXPECT_EQ(Hear([&] { return StreamFromPng(png); }).exit_code, 0);
  EXPECT_NE(folder_.Read("made"), dark);
}

}  // namespace
}  // namespace rmlcell::cli
