// What is told of a text: its listing, its outline, why it is refused, and what lies around it.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "proto/bridge/sha256.h"
#include "server/base/config.h"
#include "server/programs/content_upload.h"
#include "server/programs/edited_text.h"
#include "server/programs/language_tools.h"
#include "server/programs/memory_tools.h"
#include "server/programs/program_book.h"
#include "server/programs/text_tools.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

v1::MakeListingResponse ListingOf(const std::string& text) {
  v1::MakeListingRequest request;
  request.mutable_program()->set_file_name("a.S");
  request.mutable_program()->set_content(text);
  return Must(ListText(request));
}

// A listing is no check: it gives no advice, and has no limit of a machine.
TEST(ListedAndOutlined, AListingIsOfAnySizeAndWithoutAdvice) {
  const v1::MakeListingResponse listed = ListingOf("GOTO 10\nDELAY 1.\n10 STOP\n");
  EXPECT_TRUE(listed.findings().ok());
  EXPECT_EQ(listed.findings().diagnostics_size(), 0);
  std::string text;
  for (int line = 0; line < 30'000; ++line) text += "VI[2] = VI[3]\n";
  const v1::MakeListingResponse long_one = ListingOf(text);
  EXPECT_TRUE(long_one.findings().ok());
  EXPECT_EQ(std::ranges::count(long_one.content(), '='), 30'000);
}

// Of a text with errors there is no object to list: what is wrong with it is told.
TEST(ListedAndOutlined, ATextWithErrorsHasNoListing) {
  const v1::MakeListingResponse listed = ListingOf("SPEED 101\n");
  EXPECT_FALSE(listed.findings().ok());
  ASSERT_EQ(listed.findings().diagnostics_size(), 1);
  EXPECT_EQ(listed.findings().diagnostics(0).code(), CodeText(ErrorCode::kLiteralRange));
  EXPECT_EQ(listed.content(), "");
}

class OutlinedTexts : public testing::Test {
 protected:
  ServerBed bed;
  Config config;
  ProgramBook programs{bed.store(), config};
  MemoryTools memory_tools{bed.store(), programs};
  LanguageTools tools{bed.store(), programs};
};

// With what each part is worth, and what lies within it.
TEST_F(OutlinedTexts, AnOutlineHasPartsWithinParts) {
  v1::OutlineRequest request;
  request.mutable_text()->mutable_program()->set_file_name("45.S");
  request.mutable_text()->mutable_program()->set_content("DECLARE WAY = 5\n10 VR[1] = WAY\nSTOP\n");
  const v1::OutlineResponse outline = Must(tools.Outline(request));
  ASSERT_EQ(outline.parts_size(), 2);
  EXPECT_EQ(outline.parts(0).name(), "WAY");
  EXPECT_EQ(outline.parts(0).kind(), v1::OutlinePart::KIND_CONSTANT);
  EXPECT_EQ(outline.parts(0).detail(), "5");
  EXPECT_EQ(outline.parts(1).name(), "10");
  ASSERT_EQ(outline.parts(1).parts_size(), 2);
  EXPECT_EQ(outline.parts(1).parts(0).kind(), v1::OutlinePart::KIND_STEP);
  EXPECT_EQ(outline.parts(1).parts(0).name(), "1 VR[1] = WAY");
  EXPECT_EQ(outline.parts(1).parts(1).name(), "2 STOP");
  EXPECT_EQ(outline.parts(1).parts(1).range().begin().line(), 3);
}

// A machine that is named is there, though its family is named beside it.
TEST_F(OutlinedTexts, AMachineThatIsNamedIsThere) {
  v1::OutlineRequest request;
  request.mutable_text()->set_family("optimo");
  request.mutable_text()->set_machine("machines/none");
  request.mutable_text()->mutable_program()->set_content("STOP\n");
  EXPECT_EQ(CodeOf(tools.Outline(request)), ErrorCode::kCellUnknownMachine);
  request.mutable_text()->clear_machine();
  EXPECT_EQ(CodeOf(tools.Outline(request)), std::nullopt);
}

// Of a machine whose family nobody knows here that is told, and not that a name says nothing.
TEST_F(OutlinedTexts, AMachineOfAFamilyThatNobodyKnowsHasNoWords) {
  Must(bed.store().PutMachine({.id = "odd", .family = "lathe"}, 0));
  v1::OutlineRequest request;
  request.mutable_text()->set_machine("machines/odd");
  request.mutable_text()->mutable_program()->set_content("STOP\n");
  EXPECT_EQ(CodeOf(tools.Outline(request)), ErrorCode::kCellUnknownFamily);
}

TEST_F(OutlinedTexts, ARefusalSaysWhy) {
  v1::FixProgramRequest fix;
  fix.mutable_program()->set_file_name("a.O");
  fix.mutable_program()->set_content(ObjectOf("SPEED 20\n"));
  EXPECT_EQ(memory_tools.Fix(fix).error().detail, "a.O is an object, not a source");
  fix.mutable_program()->set_file_name("a.S");
  fix.mutable_program()->set_content("SPEDE 20\n");
  fix.mutable_program()->set_form(v1::PROGRAM_FORM_OBJECT);  // as it is said to be
  EXPECT_EQ(CodeOf(memory_tools.Fix(fix)), ErrorCode::kCellBadText);
  const TextPlaces places("abc");
  v1::TextPosition nowhere;
  nowhere.set_column(1);
  const auto offset = places.OffsetOf(nowhere);
  ASSERT_FALSE(offset);
  EXPECT_EQ(offset.error().detail, "position: lines and columns count from 1, utf16_column from 0");
}

// Of a machine of another version nothing is out of date.
TEST_F(OutlinedTexts, AFamilyThatNobodyKnowsHasNoExecutables) {
  Must(bed.store().PutMachine({.id = "odd", .family = "lathe"}, 0));
  v1::ListStaleExecutablesRequest request;
  request.set_parent("machines/odd");
  EXPECT_EQ(Must(memory_tools.ListStale(request)).executables_size(), 0);
}

// But none can be linked for it.
TEST_F(OutlinedTexts, NothingIsLinkedForAFamilyThatNobodyKnows) {
  Must(bed.store().PutMachine({.id = "odd", .family = "lathe"}, 0));
  v1::LinkProgramRequest request;
  request.set_machine("machines/odd");
  request.set_slot(44);
  const auto linked = memory_tools.Link(request);
  ASSERT_FALSE(linked);
  EXPECT_EQ(linked.error().code, ErrorCode::kCellUnknownFamily);
  EXPECT_EQ(linked.error().detail, "'lathe'; there are optimo rml1");
}

// What a program is looked at with is all that its machine has, executables among it.
TEST_F(OutlinedTexts, AProgramIsOpenedWithItsMachine) {
  Must(bed.store().PutPrograms("optimo-1",
                               {{.slot = 12, .name = "door", .object = ObjectOf("STOP\n")},
                                {.slot = 13, .object = ObjectOf("SPEED 5\n")}},
                               {}));
  Must(bed.store().PutExecutable("optimo-1", 13, 1, "executable 13", "anna"));
  Must(bed.store().PutSchedule(
      {.machine = "optimo-1", .number = 7, .name = "thin", .mode = "PULSE", .power_percent = 40.0},
      0));
  const auto opened = Must(programs.Open("machines/optimo-1/programs/12"));
  EXPECT_EQ(opened.slot, 12);
  EXPECT_EQ(opened.etag, "1");
  ASSERT_EQ(opened.memory.programs.size(), 2U);
  EXPECT_EQ(opened.memory.programs[0].slot, 12);
  EXPECT_EQ(opened.memory.programs[0].name, "door");
  EXPECT_FALSE(opened.memory.programs[0].executable);
  EXPECT_EQ(opened.memory.programs[1].slot, 13);
  ASSERT_TRUE(opened.memory.programs[1].executable);
  EXPECT_EQ(std::string_view(*opened.memory.programs[1].executable), "executable 13");
  ASSERT_EQ(opened.memory.schedules.size(), 1U);
  EXPECT_EQ(opened.memory.schedules[0].number, 7);
  EXPECT_EQ(opened.memory.schedules[0].name, "thin");
  EXPECT_EQ(opened.memory.schedules[0].mode, "PULSE");
  EXPECT_EQ(opened.memory.schedules[0].power_percent, 40.0);
}

// OPT-1.13: slots that were emptied are known, as executables of others may hold what was there.
TEST_F(OutlinedTexts, AProgramIsOpenedWithTheSlotsThatWereEmptied) {
  for (const int slot : {12, 44})
    Must(bed.store().PutPrograms("optimo-1", {{.slot = slot, .object = ObjectOf("STOP\n")}}, {}));
  Must(bed.store().DeleteProgram("optimo-1", 44, storage::kAnyRevision));
  const auto opened = Must(programs.Open("machines/optimo-1/programs/12"));
  EXPECT_EQ(opened.memory.deleted_programs, std::vector<int>{44});
}

// What was announced is what has to come, whether its size was known or not.
TEST_F(OutlinedTexts, AnUploadIsWhatWasAnnounced) {
  for (const int size : {-1, 5}) {
    ContentUpload right(bed.store(), programs);
    ASSERT_TRUE(right.Begin(size, bridge::Sha256Hex("STOP\n")));
    ASSERT_TRUE(right.Add("STOP\n"));
    const auto stored = right.End();
    ASSERT_TRUE(stored) << size;
    EXPECT_EQ(stored->size(), 5);
    EXPECT_EQ(stored->sha256(), bridge::Sha256Hex("STOP\n"));
    ContentUpload wrong(bed.store(), programs);
    ASSERT_TRUE(wrong.Begin(size, bridge::Sha256Hex("another")));
    ASSERT_TRUE(wrong.Add("SPEED"));
    EXPECT_FALSE(wrong.End()) << size;
  }
}

}  // namespace
}  // namespace rmlcell::server
