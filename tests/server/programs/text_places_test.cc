// Places of a text as clients count them, and what a program memory has room for.
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/programs/edited_text.h"
#include "server/records/program_memory.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

v1::TextPosition PositionAt(int line, int column, int utf16 = 0) {
  v1::TextPosition position;
  position.set_line(line);
  position.set_column(column);
  position.set_utf16_column(utf16);
  return position;
}
std::optional<std::size_t> OffsetIn(const TextPlaces& places, const v1::TextPosition& position) {
  const Result<std::size_t> offset = places.OffsetOf(position);
  if (offset) return *offset;
  EXPECT_EQ(offset.error().code, ErrorCode::kCellInvalidArgument);
  return std::nullopt;
}

// TextPosition: lines and columns count from 1, a column behind the end of its line is its end.
TEST(TextPlaces, AreLinesAndColumns) {
  const TextPlaces places("abc\ndefgh\nij");
  EXPECT_EQ(OffsetIn(places, PositionAt(1, 1)), 0U);
  EXPECT_EQ(OffsetIn(places, PositionAt(1, 3)), 2U);
  EXPECT_EQ(OffsetIn(places, PositionAt(1, 4)), 3U);
  EXPECT_EQ(OffsetIn(places, PositionAt(1, 5)), 3U);
  EXPECT_EQ(OffsetIn(places, PositionAt(2, 1)), 4U);
  EXPECT_EQ(OffsetIn(places, PositionAt(2, 6)), 9U);
  EXPECT_EQ(OffsetIn(places, PositionAt(2, 99)), 9U);
  EXPECT_EQ(OffsetIn(places, PositionAt(3, 99)), 12U);
  EXPECT_EQ(OffsetIn(places, PositionAt(0, 1)), std::nullopt);
  EXPECT_EQ(OffsetIn(places, PositionAt(4, 1)), std::nullopt);
  EXPECT_EQ(OffsetIn(places, PositionAt(1, -1)), std::nullopt);
  EXPECT_EQ(OffsetIn(places, PositionAt(1, 0, -1)), std::nullopt);
  const auto none = places.OffsetOf(PositionAt(4, 1));
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().detail, "position.line is 4, the text has 3");
}

// Without a column its UTF-16 units count, from 0: an umlaut is one and has two bytes, a face is
// two and has four.
TEST(TextPlaces, AreUnitsOfUtf16) {
  const std::string text = "x\n\xC3\xA4\xF0\x9F\x98\x80y\nz";
  const TextPlaces places(text);
  EXPECT_EQ(OffsetIn(places, PositionAt(2, 0, 0)), 2U);
  EXPECT_EQ(OffsetIn(places, PositionAt(2, 0, 1)), 4U);
  EXPECT_EQ(OffsetIn(places, PositionAt(2, 0, 3)), 8U);
  EXPECT_EQ(OffsetIn(places, PositionAt(2, 0, 4)), 9U);
  EXPECT_EQ(OffsetIn(places, PositionAt(2, 0, 99)), 9U);
  const v1::TextPosition y = places.PositionOf(8);
  EXPECT_EQ(y.line(), 2);
  EXPECT_EQ(y.column(), 7);
  EXPECT_EQ(y.utf16_column(), 3);
  const v1::TextRange range = places.RangeOf({.begin = 2, .end = 4});
  EXPECT_EQ(range.begin().column(), 1);
  EXPECT_EQ(range.end().column(), 3);
  EXPECT_EQ(range.end().utf16_column(), 1);
}

// OPT-B.73: what has more than there is room for may become less of, or stay as much, and no more.
TEST(OverfullMemory, MayStayAsFull) {
  ServerBed bed;
  storage::MachineRecord machine = Must(bed.store().GetMachine("optimo-1"));
  for (const auto& [slot, bytes] : {std::pair{1, 1400}, {2, 600}})
    Must(bed.store().PutPrograms(
        "optimo-1", {{.slot = slot, .object = std::string(static_cast<std::size_t>(bytes), 'o')}},
        {}));
  machine.parameters = {{"CMOS_SIZE", "1000"}};
  ASSERT_EQ(LimitOfMemory(machine)->bytes, 1000);
  const auto room = [&](int slot, std::size_t bytes) {
    const std::vector<storage::ProgramWrite> writes{
        {.slot = slot, .object = std::string(bytes, 'w')}};
    return CheckRoomFor(bed.store(), machine, writes).ok();
  };
  EXPECT_TRUE(room(1, 1399));
  EXPECT_TRUE(room(1, 1400));
  EXPECT_FALSE(room(1, 1401));
  EXPECT_TRUE(room(2, 600));
  EXPECT_FALSE(room(2, 601));
  EXPECT_FALSE(room(3, 1));
}

// OPT-B.73: so with executables, which share the memory with their objects.
TEST(OverfullMemory, IsAsFullByItsExecutables) {
  ServerBed bed;
  storage::MachineRecord machine = Must(bed.store().GetMachine("optimo-1"));
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 1, .object = std::string(1400, 'o')}}, {}));
  const auto put =
      Must(bed.store().PutPrograms("optimo-1", {{.slot = 2, .object = std::string(600, 'o')}}, {}));
  ASSERT_TRUE(Must(bed.store().PutExecutable("optimo-1", 2, put.front().revision,
                                             std::string(300, 'e'), "anna")));
  machine.parameters = {{"CMOS_SIZE", "1000"}};
  const auto room_of_object = [&](std::size_t bytes) {
    const std::vector<storage::ProgramWrite> writes{{.slot = 1, .object = std::string(bytes, 'w')}};
    return CheckRoomFor(bed.store(), machine, writes).ok();
  };
  const auto room_of_executable = [&](int slot, std::int64_t bytes) {
    return CheckRoomForExecutable(bed.store(), machine, slot, bytes).ok();
  };
  EXPECT_TRUE(room_of_object(1400));
  EXPECT_FALSE(room_of_object(1401));
  EXPECT_TRUE(room_of_executable(2, 300));
  EXPECT_FALSE(room_of_executable(2, 301));
  EXPECT_FALSE(room_of_executable(1, 1));
}

}  // namespace
}  // namespace rmlcell::server
