// What a program reads of a stream that is explained: each member of each line.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "clients/cli/rml1_tools.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

TEST(ExplainedMembers, AreThoseOfTheirPhrase) {
  const CliFolder folder;
  MillToolOptions explain;
  explain.file = folder.Put("a.rml", "PU;!! X;PU5,6;");
  explain.machine.profile = "srm-20";
  explain.json = true;
  std::istringstream told(Hear([&] { return ExplainStream(explain); }).output);
  std::vector<nlohmann::json> lines;
  for (std::string line; std::getline(told, line);) lines.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0]["offset"], 0);
  EXPECT_EQ(lines[0]["command"], 1);
  EXPECT_EQ(lines[0]["name"], "PU");
  EXPECT_EQ(lines[0]["text"], "PU");
  EXPECT_EQ(lines[0]["words"].get<std::string>().substr(0, 7), "tool up");
  EXPECT_TRUE(lines[0]["findings"].empty());
  EXPECT_EQ(lines[1]["offset"], 3);
  EXPECT_EQ(lines[1]["command"], 0);
  EXPECT_EQ(lines[1]["name"], "");
  EXPECT_EQ(lines[1]["words"], "4 bytes that are no command");
  EXPECT_FALSE(lines[1]["findings"].empty());
  EXPECT_EQ(lines[1]["findings"][0]["code"], "RML1-E1");
  EXPECT_EQ(lines[1]["findings"][0]["word"], "device error");
  EXPECT_EQ(lines[1]["findings"][0]["column"], 4);
  EXPECT_EQ(lines[2]["offset"], 8);
  EXPECT_EQ(lines[2]["command"], 2);
  EXPECT_EQ(lines[2]["text"], "PU5,6");
}

// RML1-9.42: how serious a finding is for the whole stream.
TEST(ExplainedMembers, AFindingIsJudged) {
  const CliFolder folder;
  MillToolOptions explain;
  explain.file = folder.Put("a.rml", "PU;PD1,1");
  explain.machine.profile = "srm-20";
  EXPECT_NE(Hear([&] { return ExplainStream(explain); }).output.find(": DOUBTFUL RML1-E8001: "),
            std::string::npos);
  explain.json = true;
  EXPECT_NE(Hear([&] { return ExplainStream(explain); }).output.find("\"word\":\"DOUBTFUL\""),
            std::string::npos);
}

}  // namespace
}  // namespace rmlcell::cli
