// The etag with which an executable is stored is that of its object; none of its own is asked for
// by "none".
#include <gtest/gtest.h>

#include "server/base/config.h"
#include "server/programs/program_book.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class EtagsOfExecutables : public testing::Test {
 protected:
  std::optional<ErrorCode> Refusal(const std::string& etag, bool validate_only) {
    const auto stored = programs.Store({.name = "machines/optimo-1/programs/132",
                                        .etag = etag,
                                        .bytes = ExecutableOf(32, "STOP\n"),
                                        .validate_only = validate_only});
    return stored ? std::nullopt : std::optional(stored.error.error.code);
  }

  ServerBed bed;
  Config config;
  ProgramBook programs{bed.store(), config};
};

TEST_F(EtagsOfExecutables, AreThoseOfTheirObjects) {
  for (const char* text : {"SPEED 5\n", "STOP\n"}) {
    ASSERT_TRUE(programs.Store(
        {.name = "machines/optimo-1/programs/32", .file_name = "32.S", .bytes = text}));
  }
  ASSERT_EQ(Must(programs.Get("machines/optimo-1/programs/32")).etag(), "2");
  for (const bool validate_only : {true, false}) {
    EXPECT_EQ(Refusal("1", validate_only), ErrorCode::kCellEtagMismatch);
    EXPECT_EQ(Refusal("3", validate_only), ErrorCode::kCellEtagMismatch);
    EXPECT_EQ(Refusal("no etag", validate_only), ErrorCode::kCellEtagMismatch);
  }
  for (const bool validate_only : {true, false}) {
    EXPECT_EQ(Refusal("none", validate_only), std::nullopt);
  }
  for (const bool validate_only : {true, false}) {
    EXPECT_EQ(Refusal("none", validate_only), ErrorCode::kCellAlreadyExists);
    EXPECT_EQ(Refusal("2", validate_only), std::nullopt);
    EXPECT_EQ(Refusal("", validate_only), std::nullopt);
  }
}

}  // namespace
}  // namespace rmlcell::server
