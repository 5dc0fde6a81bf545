#include "clients/cli/place_option.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

namespace rmlcell::cli {
namespace {

using testing::ElementsAre;

struct Line {
  std::vector<double> place{};
  std::string file{};
  std::string refused{};
};

Line Read(std::vector<std::string> words) {
  Line line;
  CLI::App app;
  app.add_option("FILE", line.file);
  AddPlace(app, "--origin", "X,Y[,Z]: where the origin lies", 2, 3, line.place);
  std::ranges::reverse(words);
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    line.refused = error.what();
  }
  return line;
}

TEST(PlaceOption, IsOneWordAndLeavesTheFileBehindIt) {
  const Line line = Read({"--origin", "10,-2.5", "part.rml"});
  EXPECT_EQ(line.refused, "");
  EXPECT_THAT(line.place, ElementsAre(10.0, -2.5));
  EXPECT_EQ(line.file, "part.rml");
  EXPECT_THAT(Read({"--origin=1,2,3"}).place, ElementsAre(1.0, 2.0, 3.0));
}

TEST(PlaceOption, SaysWhatToGive) {
  const std::string give = "': give X,Y[,Z]: where the origin lies";
  EXPECT_EQ(Read({"--origin", "10"}).refused, "--origin: '10" + give);
  EXPECT_EQ(Read({"--origin", "1,2,3,4"}).refused, "--origin: '1,2,3,4" + give);
  for (const char* text : {"1,x", "1,", "1,,2", "a.rml", "1,nan", "inf,1", "1 2"}) {
    EXPECT_EQ(Read({"--origin", text}).refused,
              "--origin: '" + std::string(text) + "' is no list of numbers");
  }
}

}  // namespace
}  // namespace rmlcell::cli
