// The longest text that is a program, and one byte more.
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "engine/optimo/language/program.h"

namespace rmlcell::optimo::longest_text {
namespace {

// In memory that costs nothing until it is written to.
TEST(LongestText, AGibibyteIsParsedAndOneByteMoreIsRefused) {
  constexpr std::string_view kHead = "STOP\n;";
  const std::size_t room = kSourceBytesMax + 1;
  void* const memory = ::mmap(nullptr, room, PROT_READ | PROT_WRITE,
                              MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  std::ranges::copy(kHead, static_cast<char*>(memory));
  const std::string_view text(static_cast<const char*>(memory), room);
  Findings good;
  EXPECT_EQ(Parse(text.substr(0, kSourceBytesMax), good, Places::kStatements).statements.size(),
            1U);
  EXPECT_EQ(good.error_count(), 0U);
  Findings refused;
  EXPECT_TRUE(Parse(text, refused, Places::kStatements).statements.empty());
  const std::vector<Diagnostic> told = refused.Take({}, {});
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].code, ErrorCode::kCellTooLarge);
  ::munmap(memory, room);
}

}  // namespace
}  // namespace rmlcell::optimo::longest_text
