// What is held at once, and where: a long message as JSON, and the bytes of a program.
#include <gtest/gtest.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <string>

#include "proto/bridge/encoding.h"
#include "proto/bridge/spooled_bytes.h"
#include "rmlcell/v1/report.pb.h"

namespace rmlcell::bridge {
namespace {

// The JSON of this message, and the longest piece in which it was written.
std::pair<std::string, std::size_t> InPieces(const google::protobuf::Message& message,
                                             bool whitespace) {
  std::string whole;
  std::size_t longest = 0;
  const bool good = WriteStableJson(message, whitespace, [&](std::string_view piece) {
    whole += piece;
    longest = std::max(longest, piece.size());
  });
  EXPECT_TRUE(good);
  return {whole, longest};
}

v1::RunReport WithFindings(int count) {
  v1::RunReport report;
  for (int i = 0; i < count; ++i) {
    v1::Diagnostic& finding = *report.add_diagnostics();
    finding.set_code("RML1-E1");
    finding.set_message("finding " + std::to_string(i));
  }
  return report;
}

// Who writes a message out holds no more than a piece of it: a list of a hundred comes whole, one
// that is longer entry by entry.
TEST(WrittenJson, ALongListComesEntryByEntry) {
  for (const bool whitespace : {false, true}) {
    const auto [hundred, whole] = InPieces(WithFindings(100), whitespace);
    EXPECT_EQ(whole, hundred.size());
    const auto [more, piece] = InPieces(WithFindings(101), whitespace);
    EXPECT_LT(piece, more.size() / 2) << whitespace;
    EXPECT_NE(more.find("finding 0\""), std::string::npos);
    EXPECT_NE(more.find("finding 100\""), std::string::npos);
  }
}

// Whether this address lies in a file that is mapped.
bool LiesInAFile(const void* address) {
  const auto wanted = reinterpret_cast<std::uintptr_t>(address);
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    std::uintptr_t begin = 0;
    std::uintptr_t end = 0;
    unsigned long inode = 0;
    if (std::sscanf(line.c_str(), "%" SCNxPTR "-%" SCNxPTR " %*s %*s %*s %lu", &begin, &end,
                    &inode) == 3 &&
        begin <= wanted && wanted < end)
      return inode != 0;
  }
  return false;
}

// Few lie in memory; more lie in a file, of which only what is being read takes memory.
TEST(SpooledPlace, FewLieInMemoryAndManyInAFile) {
  constexpr std::size_t kFew = std::size_t{1} << 20;
  for (const auto& [size, in_file] :
       {std::pair{std::size_t{5}, false}, {kFew, false}, {kFew + 1, true}}) {
    SpooledBytes spooled;
    spooled.append(std::string(size, 'x'));
    const machine::Bytes bytes = spooled.Finish();
    ASSERT_EQ(bytes->size(), size);
    EXPECT_EQ(LiesInAFile(bytes->data()), in_file) << size;
  }
}

}  // namespace
}  // namespace rmlcell::bridge
