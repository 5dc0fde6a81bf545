// For which machine: the options of the command line, those of a machine file, and where the work
// lies.
#include "clients/cli/machine_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <string>
#include <vector>

#include "clients/cli/program_files.h"
#include "engine/families/families.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing::UnorderedElementsAre;

using Parameters = std::map<std::string, std::string>;

class MachineChoiceTest : public testing::Test {
 protected:
  // What is refused, as code and detail; "good" where nothing is.
  static std::string Told(const Status& status) {
    return status ? "good" : CodeText(status.error().code) + " " + status.error().detail;
  }
  static MachineChoice At(std::vector<double> origin) {
    MachineChoice choice;
    choice.profile = "srm-20";
    choice.origin = std::move(origin);
    return choice;
  }

  CliFolder folder;
  const machine::MachineFamily& mill = *families::FindFamily("rml1");
  const machine::MachineFamily& laser = *families::FindFamily("optimo");
};

TEST_F(MachineChoiceTest, OptionsGoBeforeTheFile) {
  MachineChoice choice;
  EXPECT_EQ(ReadMachine(choice)->family, "");
  choice.file = folder.Put(
      "mine.toml", "family = \"rml1\"\nprofile = \"mdx-20\"\n[parameters]\nXY_SPEED_MAX = 3\n");
  const auto read = ReadMachine(choice);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->family, "rml1");
  EXPECT_EQ(read->profile, "mdx-20");
  EXPECT_THAT(read->parameters, UnorderedElementsAre(Pair("XY_SPEED_MAX", "3")));
  choice.family = "optimo";
  choice.profile = "srm-20";
  const auto chosen = ReadMachine(choice);
  EXPECT_EQ(chosen->family, "optimo");
  EXPECT_EQ(chosen->profile, "srm-20");
  EXPECT_EQ(chosen->parameters.size(), 1U);
}

TEST_F(MachineChoiceTest, AFileThatCannotBeReadIsRefused) {
  MachineChoice choice;
  choice.file = folder.File("none.toml");
  EXPECT_EQ(ReadMachine(choice).error().code, ErrorCode::kCellFileUnreadable);
  choice.file = folder.Put("bad.toml", "family = \n");
  const auto bad = ReadMachine(choice);
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().code, ErrorCode::kCellBadText);
  EXPECT_THAT(bad.error().detail, HasSubstr("bad.toml"));
}

TEST_F(MachineChoiceTest, WhoChangesParametersIsNamed) {
  MachineChoice choice;
  EXPECT_EQ(ParametersOf(choice), "");
  choice.clamps_mm = 0.0;
  EXPECT_EQ(ParametersOf(choice), "--clamps");
  choice.origin = {1.0, 2.0};
  EXPECT_EQ(ParametersOf(choice), "--origin and --clamps");
  choice.file = "mine.toml";
  EXPECT_EQ(ParametersOf(choice), "mine.toml and --origin and --clamps");
  choice.origin.clear();
  EXPECT_EQ(ParametersOf(choice), "mine.toml and --clamps");
}

// The travel of an SRM-20 is 203.2 x 152.4 x 60.5 mm; its Z is 0 at the top.
TEST_F(MachineChoiceTest, AnOriginLiesOnTheTravelUpToItsEnds) {
  const auto placed = [&](std::vector<double> origin) {
    Parameters parameters;
    return Told(PlaceWork(At(std::move(origin)), mill, parameters));
  };
  EXPECT_EQ(placed({}), "good");
  EXPECT_EQ(placed({0.0, 0.0}), "good");
  EXPECT_EQ(placed({203.2, 152.4, -60.5}), "good");
  EXPECT_EQ(placed({203.2, 152.4, 0.0}), "good");
  EXPECT_EQ(placed({-0.1, 0.0}),
            "CELL-E9026 --origin: X -0.1 is beyond the travel, which is from 0.0 to 203.2 mm");
  EXPECT_EQ(placed({203.3, 0.0}),
            "CELL-E9026 --origin: X 203.3 is beyond the travel, which is from 0.0 to 203.2 mm");
  EXPECT_EQ(placed({0.0, 152.5}),
            "CELL-E9026 --origin: Y 152.5 is beyond the travel, which is from 0.0 to 152.4 mm");
  EXPECT_EQ(placed({0.0, 0.0, -60.6}),
            "CELL-E9026 --origin: Z -60.6 is beyond the travel, which is from -60.5 to 0.0 mm");
  EXPECT_THAT(placed({0.0, 0.0, 0.1}), HasSubstr("CELL-E9011 Z0 is 0.1"));  // as a parameter
  for (const std::vector<double>& wrong : {std::vector{1.0}, {1.0, 2.0, 3.0, 4.0}})
    EXPECT_EQ(placed(wrong), "CELL-E9026 --origin: give X,Y or X,Y,Z in mm");
}

TEST_F(MachineChoiceTest, AnOriginIsThreeParametersAndTheClampsAreOne) {
  const auto& names = mill.info().origin_parameters;
  Parameters parameters{{"XY_SPEED_MAX", "3"}};
  EXPECT_EQ(Told(PlaceWork(At({1.5, 2.0}), mill, parameters)), "good");
  EXPECT_THAT(parameters,
              UnorderedElementsAre(Pair("XY_SPEED_MAX", "3"), Pair(std::string(names[0]), "1.5"),
                                   Pair(std::string(names[1]), "2")));
  MachineChoice choice = At({1.5, 2.0, -3.25});
  choice.clamps_mm = 7.5;
  EXPECT_EQ(Told(PlaceWork(choice, mill, parameters)), "good");
  EXPECT_EQ(parameters[std::string(names[2])], "-3.25");
  EXPECT_EQ(parameters[std::string(mill.info().clamps_parameter)], "7.5");
}

TEST_F(MachineChoiceTest, AMachineWhoseProgramsSetZeroTakesNoOrigin) {
  Parameters parameters;
  MachineChoice choice;
  EXPECT_EQ(Told(PlaceWork(choice, laser, parameters)), "good");
  choice.origin = {0.0, 0.0};
  EXPECT_EQ(Told(PlaceWork(choice, laser, parameters)), "CELL-E9026 --origin: programs of " +
                                                            std::string(laser.info().title) +
                                                            " set their work offset themselves");
  choice.origin.clear();
  choice.clamps_mm = 5.0;
  EXPECT_EQ(Told(PlaceWork(choice, laser, parameters)),
            "CELL-E9026 --clamps: a " + std::string(laser.info().title) + " knows of no clamps");
  EXPECT_THAT(parameters, IsEmpty());
}

TEST_F(MachineChoiceTest, AnOriginIsLookedAtOnTheMachineThatIsChosen) {
  Parameters parameters;
  MachineChoice choice = At({200.0, 0.0});
  EXPECT_EQ(Told(PlaceWork(choice, mill, parameters)), "good");
  choice.profile = "no-such-mill";
  EXPECT_NE(Told(PlaceWork(choice, mill, parameters)), "good");
  choice.file = folder.File("none.toml");
  EXPECT_THAT(Told(PlaceWork(choice, mill, parameters)), HasSubstr("CELL-E9022"));
}

}  // namespace
}  // namespace rmlcell::cli
