// What a board says of speeds that a machine does not have.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/engine/rml1/board/made_board.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

std::vector<std::string> NotesOf(const BoardOptions& options, std::string_view profile) {
  const Bitmap bitmap{
      .width = 4, .height = 4, .copper = {0, 0, 0, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 0}};
  const auto made = StreamOfBoard(bitmap, ParametersOf(profile), options);
  EXPECT_TRUE(made) << made.error().detail;
  std::vector<std::string> notes;
  for (const Diagnostic& one : made->findings) {
    if (one.code == ErrorCode::kRml1SpeedRounded) notes.emplace_back(one.detail);
  }
  return notes;
}

// RML1-3C.20: a model whose spindle speed nobody can program says so; another one what it makes of
// it.
TEST(BoardNotes, SpindleSpeeds) {
  BoardOptions options{.pixel_mm = 1.0, .rpm = 6000.0};
  EXPECT_EQ(NotesOf(options, "t1f"),
            (std::vector<std::string>{"the spindle speed of this machine is set by hand"}));
  EXPECT_EQ(NotesOf(options, "t1"), (std::vector<std::string>{}));
  options.rpm = 6050.0;
  EXPECT_EQ(NotesOf(options, "t1"), (std::vector<std::string>{"6050 rpm becomes 6000"}));
  options.rpm = 0.0;
  EXPECT_EQ(NotesOf(options, "t1f"), (std::vector<std::string>{}));
}

}  // namespace
}  // namespace rmlcell::rml1
