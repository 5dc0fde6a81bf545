// What is wrong with a program that has no lines, and the slot of one that is checked.
#include <gtest/gtest.h>

#include <string>

#include "server/base/config.h"
#include "server/programs/program_book.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class ErrorsWithoutALine : public testing::Test {
 protected:
  ServerBed bed;
  Config config;
  ProgramBook programs{bed.store(), config};
};

// Of an object no line is told.
TEST_F(ErrorsWithoutALine, AnObjectHasNoLines) {
  const auto stored = programs.Store({.name = "machines/optimo-1/programs/45",
                                      .file_name = "45.O",
                                      .form = v1::PROGRAM_FORM_OBJECT,
                                      .bytes = "no object"});
  ASSERT_FALSE(stored);
  EXPECT_EQ(stored.error.error.detail.find("line"), std::string::npos)
      << std::string(stored.error.error.detail);
  EXPECT_NE(stored.error.error.detail, "");
}

// OPT-1.10: a name that is a number is that slot, though it is used: the first and the last of them
// as well.
TEST_F(ErrorsWithoutALine, ANameThatIsANumberIsItsSlot) {
  for (const int slot : {1, 2, 99})
    Must(bed.store().PutPrograms("optimo-1", {{.slot = slot, .object = ObjectOf("STOP\n")}}, {}));
  const auto slot_of = [this](const std::string& file_name) {
    v1::ProgramText text;
    text.set_file_name(file_name);
    text.set_content("STOP\n");
    return Must(programs.Check("", "machines/optimo-1", text, true)).slot;
  };
  EXPECT_EQ(slot_of("1.S"), 1);
  EXPECT_EQ(slot_of("2.S"), 2);
  EXPECT_EQ(slot_of("99.S"), 99);
  EXPECT_EQ(slot_of("100.S"), 3);
  EXPECT_EQ(slot_of("0.S"), 3);
  EXPECT_EQ(slot_of("-1.S"), 3);
  EXPECT_EQ(slot_of("part.S"), 3);
}

// OPT-E.7102: what is looked at in a slot without a program is refused as its start is.
TEST_F(ErrorsWithoutALine, AnEmptySlotSaysSo) {
  const auto opened = programs.Open("machines/optimo-1/programs/45");
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::kProgramMissing);
  EXPECT_NE(opened.error().detail.find("programs/45"), std::string::npos);
}

}  // namespace
}  // namespace rmlcell::server
