#include "server/base/log.h"

#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

namespace rmlcell::server {
namespace {

// The lines that a log of this level and form keeps of what `write` logs.
template <class Write>
std::vector<std::string> Logged(const std::string& level, const std::string& format,
                                const Write& write) {
  const std::string file = ::testing::TempDir() + "/rmlcell-log-" + format;
  std::filesystem::remove(file);
  const std::shared_ptr<spdlog::logger> before = spdlog::default_logger();
  EXPECT_TRUE(StartLog("cell-" + format, level, format, file));
  write();
  spdlog::default_logger()->flush();
  spdlog::drop("cell-" + format);
  spdlog::set_default_logger(before);
  std::vector<std::string> lines;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  std::filesystem::remove(file);
  return lines;
}

// Whatever a message holds, a line is one JSON object.
TEST(Log, LinesOfJsonSurviveAnyMessage) {
  const auto lines = Logged("info", "json", [] {
    spdlog::info("{}", R"(no "such" file: C:\parts)");
    spdlog::warn("{}", "two\nlines\x01");
    spdlog::debug("below the level");
  });
  ASSERT_EQ(lines.size(), 2U);
  std::vector<google::protobuf::Struct> parsed(2);
  for (std::size_t n = 0; n < lines.size(); ++n) {
    ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(lines[n], &parsed[n]).ok()) << lines[n];
  }
  EXPECT_EQ(parsed[0].fields().at("message").string_value(), R"(no "such" file: C:\parts)");
  EXPECT_EQ(parsed[0].fields().at("level").string_value(), "info");
  EXPECT_EQ(parsed[0].fields().at("who").string_value(), "cell-json");
  EXPECT_EQ(parsed[1].fields().at("message").string_value(), "two lines ");
  EXPECT_EQ(parsed[1].fields().at("level").string_value(), "warning");
}

TEST(Log, TextForPeople) {
  const auto lines = Logged("debug", "text", [] { spdlog::debug("a tool is missing"); });
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].find(" debug [cell-text "), std::string::npos) << lines[0];
  EXPECT_EQ(lines[0].substr(lines[0].rfind("] ") + 2), "a tool is missing");
}

// Whoever reads the file of a server that runs finds what it said last.
TEST(Log, ALineIsThereAtOnce) {
  const std::string file = ::testing::TempDir() + "/rmlcell-log-at-once";
  std::filesystem::remove(file);
  const std::shared_ptr<spdlog::logger> before = spdlog::default_logger();
  ASSERT_TRUE(StartLog("cell-at-once", "info", "text", file));
  spdlog::info("the last word");
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  spdlog::drop("cell-at-once");
  spdlog::set_default_logger(before);
  std::filesystem::remove(file);
  EXPECT_NE(line.find("] the last word"), std::string::npos) << line;
}

TEST(Log, AFileThatCannotBeWrittenIsAnError) {
  const Status started = StartLog("cell-nowhere", "info", "text", "/proc/no/such/file");
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().code, ErrorCode::kCellFileUnwritable);
}

}  // namespace
}  // namespace rmlcell::server
