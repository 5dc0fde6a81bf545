// The conversions that the manual prints (chapters 8 and 10), as a table: direction, input,
// expected, note, context (declarations that come before, separated by " / ").
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "engine/optimo/offline/compensate.h"
#include "engine/optimo/offline/convert.h"

namespace rmlcell::optimo {
namespace {

std::string ReadFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::filesystem::path TablePath() {
  return std::filesystem::path(RMLCELL_SOURCE_DIR) / "tests/conformance/optimo_convert_cases.csv";
}

std::vector<std::string> Fields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

// OPT-8.27, OPT-8.28, OPT-8.37, OPT-8.42, OPT-8.44
TEST(OptimoConvertCases, EveryLineOfTheTableIsConverted) {
  std::istringstream table(ReadFile(TablePath()));
  std::string line;
  std::getline(table, line);
  int count = 0;
  while (std::getline(table, line)) {
    const std::vector<std::string> fields = Fields(line);
    ASSERT_EQ(fields.size(), 5U) << line;
    std::string context = fields[4];
    for (std::size_t at; (at = context.find(" / ")) != std::string::npos;)
      context.replace(at, 3, 1, '\n');
    if (!context.empty()) context += '\n';
    const Direction direction = fields[0] == "to_inch" ? Direction::kToInch : Direction::kToMetric;
    const Conversion converted = Convert(context + fields[1] + '\n', direction);
    EXPECT_EQ(converted.text, context + fields[2] + '\n') << fields[3];
    ++count;
  }
  EXPECT_EQ(count, 24);
}

TEST(OptimoConvertCases, TheTableIsTheSharedOne) {
  const std::filesystem::path shared =
      std::filesystem::path(RMLCELL_SHARED_DIR) / "corpus/optimo/convert-cases.csv";
  if (!std::filesystem::exists(shared)) GTEST_SKIP() << "the shared corpus is not here";
  EXPECT_EQ(ReadFile(TablePath()), ReadFile(shared));
}

// OPT-10.09, OPT-8.51, OPT-B.78
TEST(OptimoConvertCases, SampleThreeBecomesTheMetricListing) {
  const std::filesystem::path corpus = std::filesystem::path(RMLCELL_SHARED_DIR) / "corpus/optimo";
  if (!std::filesystem::exists(corpus)) GTEST_SKIP() << "the shared corpus is not here";
  const FileNames names{"C:\\CST\\CCTEST\\17MAR93E.SI", "C:\\CST\\CCTEST\\17MAR93E.S",
                        "Tue Apr 20 13:37:22 1993"};
  const Conversion converted =
      Convert(ReadFile(corpus / "sample3.SI"), Direction::kToMetric, names);
  EXPECT_EQ(converted.text, ReadFile(corpus / "sample3.S"));
  EXPECT_TRUE(converted.diagnostics.empty());
}

// OPT-10.10, OPT-8.12, OPT-8.24: only the radius of the hole changes.
TEST(OptimoConvertCases, SampleThreeBecomesTheCompensatedListing) {
  const std::filesystem::path corpus = std::filesystem::path(RMLCELL_SHARED_DIR) / "corpus/optimo";
  if (!std::filesystem::exists(corpus)) GTEST_SKIP() << "the shared corpus is not here";
  const FileNames names{"C:\\CST\\CCTEST\\17MAR93E.S", "C:\\CST\\CCTEST\\17MAR93E.CMP",
                        "Tue Apr 20 13:37:33 1993"};
  const Compensation compensated = Compensate(ReadFile(corpus / "sample3.S"), names);
  EXPECT_TRUE(compensated.ok);
  EXPECT_EQ(compensated.text, ReadFile(corpus / "sample3.CMP"));
}

}  // namespace
}  // namespace rmlcell::optimo
