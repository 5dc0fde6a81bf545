#include "engine/core/line_table.h"

#include <gtest/gtest.h>

#include <string>

namespace rmlcell {
namespace {

struct Row {
  std::string text;
  std::vector<std::size_t> begins, ends;
};

// Lines end at LF, CR LF or a CR alone; behind the last end there is one more, which may be empty.
TEST(LineTable, LinesBeginAndEnd) {
  const Row rows[] = {{"", {0}, {0}},
                      {"a", {0}, {1}},
                      {"a\n", {0, 2}, {1, 2}},
                      {"\n\n", {0, 1, 2}, {0, 1, 2}},
                      {"ab\r\nc", {0, 4}, {2, 5}},
                      {"\r\n", {0, 2}, {0, 2}},
                      {"a\rb\r", {0, 2, 4}, {1, 3, 4}},
                      {"\r\r\nx", {0, 1, 3}, {0, 1, 4}}};
  for (const Row& row : rows) {
    const LineTable lines(row.text);
    ASSERT_EQ(lines.count(), row.begins.size()) << row.text;
    for (std::size_t line = 0; line < lines.count(); ++line) {
      EXPECT_EQ(lines.Begin(line), row.begins[line]) << row.text;
      EXPECT_EQ(lines.End(row.text, line), row.ends[line]) << row.text;
    }
  }
}

TEST(LineTable, ALineHoldsItsEnd) {
  const LineTable lines("a\r\n\nbc");  // begins 0, 3, 4
  const std::size_t of_byte[] = {0, 0, 0, 1, 2, 2, 2};
  for (std::size_t offset = 0; offset < std::size(of_byte); ++offset)
    EXPECT_EQ(lines.LineOf(offset), of_byte[offset]) << offset;
}

// Every change of every text of up to four bytes: the table is that of the new text.
TEST(LineTable, AChangeGivesTheTableOfTheNewText) {
  const std::string bytes = "x\r\n";
  std::vector<std::string> texts = {""};
  for (std::size_t begin = 0, round = 0; round < 4; ++round) {
    const std::size_t end = texts.size();
    for (; begin < end; ++begin) {
      for (const char c : bytes) texts.push_back(texts[begin] + c);
    }
  }
  ASSERT_EQ(texts.size(), 1U + 3 + 9 + 27 + 81);
  for (const std::string& text : texts) {
    for (std::size_t begin = 0; begin <= text.size(); ++begin) {
      for (std::size_t end = begin; end <= text.size(); ++end) {
        for (std::size_t i = 0; i < 13; ++i) {  // of up to two bytes
          const std::string changed = text.substr(0, begin) + texts[i] + text.substr(end);
          LineTable lines(text);
          lines.Replace(changed, begin, end, texts[i].size());
          ASSERT_TRUE(lines == LineTable(changed)) << begin << " to " << end << " of " << text;
        }
      }
    }
  }
}

}  // namespace
}  // namespace rmlcell
