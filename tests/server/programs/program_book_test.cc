#include "server/programs/program_book.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/bridge/framing.h"
#include "proto/bridge/sha256.h"
#include "server/base/config.h"
#include "server/programs/content_upload.h"
#include "server/programs/program_views.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using storage::CodeOf;
template <class T>
std::optional<ErrorCode> CodeOf(const ProgramResult<T>& result) {
  return result ? std::nullopt : std::optional(result.error.error.code);
}

class ProgramBookTest : public testing::Test {
 protected:
  using Put = ProgramBook::Put;
  static std::string Name(int number, const std::string& machine = "optimo-1") {
    return "machines/" + machine + "/programs/" + std::to_string(number);
  }
  ProgramResult<v1::Program> Store(int number, const std::string& source,
                                   const std::string& etag = {}) {
    return programs.Store(
        {.name = Name(number), .file_name = "part.S", .etag = etag, .bytes = source});
  }
  ProgramResult<v1::Program> StoreExecutable(int number, const std::string& bytes,
                                             const std::string& etag = {}) {
    return programs.Store(
        {.name = Name(number), .form = v1::PROGRAM_FORM_EXECUTABLE, .etag = etag, .bytes = bytes});
  }
  v1::Program Get(int number) { return Must(programs.Get(Name(number))); }
  Status Delete(int number, const std::string& etag = {}) {
    v1::DeleteProgramRequest request;
    request.set_name(Name(number));
    request.set_etag(etag);
    return programs.Delete(request, "anna");
  }

  ServerBed bed;
  Config config;
  ProgramBook programs{bed.store(), config};
};

// OPT-B.73, OPT-E.7109: what would exceed the memory of its machine is refused, and changes
// nothing.
TEST_F(ProgramBookTest, WhatHasNoRoomIsRefused) {
  storage::MachineRecord machine = Must(bed.store().GetMachine("optimo-1"));
  machine.parameters = {{"CMOS_SIZE", "2000"}};
  Must(bed.store().PutMachine(machine, storage::kAnyRevision));
  std::string large;
  for (int i = 0; i < 1000; ++i) large += "DELAY 1\n";
  const auto refused = Store(45, large);
  EXPECT_EQ(CodeOf(refused), ErrorCode::kCmosFull);
  EXPECT_THAT(refused.error.error.detail, testing::HasSubstr("the program memory has 2000 bytes"));
  EXPECT_EQ(CodeOf(programs.Get(Name(45))), ErrorCode::kProgramMissing);
  // Said as well where it is only asked.
  EXPECT_EQ(CodeOf(programs.Store(
                {.name = Name(45), .file_name = "part.S", .bytes = large, .validate_only = true})),
            ErrorCode::kCmosFull);
  ASSERT_TRUE(Store(45, "DELAY 1\n"));
  const std::int64_t object = Get(45).object_bytes();
  const std::string executable = ExecutableOf(45, "DELAY 1\n");
  machine = Must(bed.store().GetMachine("optimo-1"));
  machine.parameters = {{"CMOS_SIZE", "1000"}};
  Must(bed.store().PutMachine(machine, storage::kAnyRevision));
  std::string rest = "DELAY 2\n";
  while (Store(46, rest)) rest += "DELAY 2\n";
  const std::int64_t left = 1000 - object - Get(46).object_bytes();
  ASSERT_LT(left, static_cast<std::int64_t>(executable.size()));
  EXPECT_EQ(CodeOf(StoreExecutable(145, executable)), ErrorCode::kCmosFull);
  EXPECT_FALSE(Get(45).has_executable_bytes());
  // A mill keeps what comes.
  EXPECT_TRUE(programs.Store({.name = Name(1, "mill-1"),
                              .file_name = "a.rml",
                              .bytes = "PA;" + std::string(100'000, ';')}));
}

// OPT-1.10: objects under numbers 1 to 99.
TEST_F(ProgramBookTest, StoresSourceAsObjectAndGivesBothBack) {
  const auto stored = Store(45, "SPEED 5\nSTOP\n");
  ASSERT_TRUE(stored) << stored.error.error.detail;
  EXPECT_EQ(stored.value->name(), Name(45));
  EXPECT_EQ(stored.value->title(), "part");
  EXPECT_EQ(stored.value->file_name(), "part.S");
  EXPECT_EQ(stored.value->source_bytes(), 13);
  EXPECT_FALSE(stored.value->has_executable_bytes());
  const auto source = Must(programs.Read(Name(45), v1::PROGRAM_FORM_SOURCE));
  EXPECT_EQ(source.bytes, "SPEED 5\nSTOP\n");
  EXPECT_EQ(source.file_name, "part.S");
  const auto object = Must(programs.Read(Name(45), v1::PROGRAM_FORM_OBJECT));
  EXPECT_EQ(object.file_name, "part.O");
  EXPECT_EQ(object.bytes, ObjectOf("SPEED 5\nSTOP\n"));
  // The object stored elsewhere decompiles to a source that compiles to it again.
  ASSERT_TRUE(
      programs.Store({.name = Name(46), .form = v1::PROGRAM_FORM_OBJECT, .bytes = object.bytes}));
  const auto decompiled = Must(programs.Read(Name(46), v1::PROGRAM_FORM_SOURCE));
  EXPECT_EQ(decompiled.file_name, "46.S");
  EXPECT_EQ(ObjectOf(decompiled.bytes), object.bytes);
}

// OPT-1.10: 0, 100 and 200 are no program numbers.
TEST_F(ProgramBookTest, RefusesOtherNumbersAndBadBytes) {
  for (const int number : {0, 100, 200, -1})
    EXPECT_EQ(CodeOf(Store(number, "STOP\n")), ErrorCode::kProgramNumber);
  EXPECT_EQ(CodeOf(Store(1, "")), ErrorCode::kCellEmptyProgram);
  config.limit_program_bytes = 1024;
  EXPECT_EQ(CodeOf(Store(1, std::string(1025, ';'))), ErrorCode::kCellTooLarge);
  EXPECT_EQ(CodeOf(programs.Store({.name = "machines/none/programs/1", .bytes = "STOP\n"})),
            ErrorCode::kCellUnknownMachine);
  EXPECT_EQ(CodeOf(programs.Store({.name = "programs/1", .bytes = "STOP\n"})),
            ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(programs.Store({.name = Name(1), .file_name = "a.rml", .bytes = "IN;"})),
            ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(programs.Store(
                {.name = Name(1), .form = v1::PROGRAM_FORM_OBJECT, .bytes = "no object"})),
            ErrorCode::kObjectCorrupt);
  EXPECT_EQ(
      CodeOf(programs.Store({.name = Name(1), .title = std::string(201, 't'), .bytes = "STOP\n"})),
      ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(Must(bed.store().ListPrograms("optimo-1", 0, 100)).size(), 0U);
}

// A program with errors is not stored, and the one that was there stays with its executable.
TEST_F(ProgramBookTest, AProgramWithErrorsChangesNothing) {
  ASSERT_TRUE(Store(45, "STOP\n"));
  ASSERT_TRUE(StoreExecutable(145, ExecutableOf(45, "STOP\n")));
  const v1::Program before = Get(45);
  const auto wrong = Store(45, "STOP\nSPEED 101\nMOVE (1.0)\n");
  EXPECT_EQ(CodeOf(wrong), ErrorCode::kLiteralRange);
  EXPECT_THAT(wrong.error.error.detail, testing::StartsWith("line 2: "));
  EXPECT_THAT(wrong.error.error.detail, testing::HasSubstr("(and 1 more)"));
  EXPECT_EQ(wrong.error.diagnostics.size(), 2U);
  EXPECT_EQ(Get(45).SerializeAsString(), before.SerializeAsString());
}

TEST_F(ProgramBookTest, AnEtagThatDoesNotFitChangesNothing) {
  const std::string first = Store(45, "STOP\n").value->etag();
  const std::string second = Store(45, "SPEED 5\n", first).value->etag();
  EXPECT_NE(first, second);
  for (const bool validate_only : {true, false}) {
    const auto put = [&](int slot, const std::string& etag) {
      return CodeOf(programs.Store({.name = Name(slot),
                                    .file_name = "a.S",
                                    .etag = etag,
                                    .bytes = "SPEED 6\n",
                                    .validate_only = validate_only}));
    };
    EXPECT_EQ(put(45, first), ErrorCode::kCellEtagMismatch);
    EXPECT_EQ(put(45, "none"), ErrorCode::kCellAlreadyExists);
    for (const std::string& etag : {first, second}) {
      EXPECT_EQ(put(46, etag), ErrorCode::kCellNotFound) << etag;
    }
    EXPECT_EQ(put(45, "junk"), ErrorCode::kCellEtagMismatch);
  }
  EXPECT_EQ(Delete(45, first).error().code, ErrorCode::kCellEtagMismatch);
  EXPECT_EQ(Must(programs.Read(Name(45), v1::PROGRAM_FORM_SOURCE)).bytes, "SPEED 5\n");
  EXPECT_TRUE(Store(46, "STOP\n", "none"));
  EXPECT_TRUE(Delete(45, second));
}

TEST_F(ProgramBookTest, AskingOnlyStoresNothing) {
  const auto asked = programs.Store(
      {.name = Name(45), .file_name = "a.S", .bytes = "STOP\n", .validate_only = true});
  ASSERT_TRUE(asked);
  EXPECT_GT(asked.value->object_bytes(), 0);
  EXPECT_EQ(CodeOf(programs.Get(Name(45))), ErrorCode::kProgramMissing);
}

// OPT-10.17, OPT-E.7413: stored, and told of.
TEST_F(ProgramBookTest, NumbersUpToSevenAreReserved) {
  const auto reserved = Store(5, "STOP\n");
  ASSERT_TRUE(reserved);
  ASSERT_EQ(reserved.value->findings().diagnostics_size(), 1);
  EXPECT_EQ(reserved.value->findings().diagnostics(0).code(), "OPT-E7413");
  EXPECT_EQ(Store(8, "STOP\n").value->findings().diagnostics_size(), 0);
}

// OPT-1.12: altering or deleting an object deletes its executable, and OPT-1.13: no other one.
TEST_F(ProgramBookTest, AnAlteredObjectLosesItsExecutableAndOthersKeepTheirs) {
  for (const int slot : {32, 44}) {
    ASSERT_TRUE(Store(slot, "STOP\n"));
    ASSERT_TRUE(StoreExecutable(slot + 100, ExecutableOf(slot, "STOP\n")));
    ASSERT_TRUE(Get(slot).has_executable_bytes());
  }
  ASSERT_TRUE(Store(44, "SPEED 5\nSTOP\n"));
  EXPECT_FALSE(Get(44).has_executable_bytes());
  EXPECT_EQ(CodeOf(programs.Get(Name(144))), ErrorCode::kProgramMissing);
  EXPECT_TRUE(Get(32).has_executable_bytes());
  EXPECT_TRUE(programs.Get(Name(132)));
  ASSERT_TRUE(Delete(44));
  EXPECT_EQ(CodeOf(programs.Get(Name(44))), ErrorCode::kProgramMissing);
  EXPECT_TRUE(Get(32).has_executable_bytes());
  ASSERT_TRUE(Delete(32));
  EXPECT_EQ(CodeOf(programs.Get(Name(132))), ErrorCode::kProgramMissing);
}

// OPT-1.14: an executable can be deleted on its own; the object stays.
TEST_F(ProgramBookTest, AnExecutableIsDeletedOnItsOwn) {
  const std::string etag = Store(32, "STOP\n").value->etag();
  ASSERT_TRUE(StoreExecutable(132, ExecutableOf(32, "STOP\n")));
  EXPECT_EQ(Delete(132, "99").error().code, ErrorCode::kCellEtagMismatch);
  EXPECT_TRUE(Get(32).has_executable_bytes());
  ASSERT_TRUE(Delete(132, etag));
  EXPECT_FALSE(Get(32).has_executable_bytes());
  EXPECT_EQ(Get(32).etag(), etag);  // the object is as it was
  EXPECT_EQ(Delete(132).error().code, ErrorCode::kProgramMissing);
  EXPECT_EQ(Delete(33).error().code, ErrorCode::kProgramMissing);
}

// OPT-1.15: an executable made off-line is stored under n + 100 if object n is there.
TEST_F(ProgramBookTest, AnExecutableNeedsItsObject) {
  const std::string executable = ExecutableOf(32, "STOP\n");
  EXPECT_EQ(CodeOf(StoreExecutable(132, executable)), ErrorCode::kProgramMissing);
  EXPECT_EQ(CodeOf(StoreExecutable(200, executable)), ErrorCode::kProgramNumber);
  const std::string etag = Store(32, "STOP\n").value->etag();
  EXPECT_EQ(CodeOf(StoreExecutable(132, "no executable")), ErrorCode::kObjectCorrupt);
  EXPECT_EQ(CodeOf(StoreExecutable(132, ExecutableOf(33, "STOP\n"))),
            ErrorCode::kCellInvalidArgument);  // that of another program
  EXPECT_EQ(CodeOf(StoreExecutable(132, executable, "99")), ErrorCode::kCellEtagMismatch);
  EXPECT_FALSE(Get(32).has_executable_bytes());
  const auto stored = StoreExecutable(132, executable, etag);
  ASSERT_TRUE(stored);
  EXPECT_EQ(stored.value->name(), Name(132));
  EXPECT_EQ(Get(132).name(), Name(132));
  EXPECT_EQ(CodeOf(StoreExecutable(132, executable, "none")), ErrorCode::kCellAlreadyExists);
  EXPECT_TRUE(StoreExecutable(32, executable));  // the form says which one is meant
  const auto read = Must(programs.Read(Name(132), v1::PROGRAM_FORM_UNSPECIFIED));
  EXPECT_EQ(read.bytes, executable);
  EXPECT_EQ(read.form, v1::PROGRAM_FORM_EXECUTABLE);
  EXPECT_EQ(Get(32).etag(), etag);
}

TEST_F(ProgramBookTest, AFormIsOneThatThereIs) {
  ASSERT_TRUE(Store(45, "STOP\n"));
  constexpr auto kNone = static_cast<v1::ProgramForm>(99);
  EXPECT_EQ(CodeOf(programs.Read(Name(45), kNone)), ErrorCode::kCellInvalidArgument);
  for (const v1::ProgramForm form : {kNone, v1::PROGRAM_FORM_LISTING}) {
    EXPECT_EQ(CodeOf(programs.Store({.name = Name(46), .form = form, .bytes = "STOP\n"})),
              ErrorCode::kCellInvalidArgument);
  }
}

// Codes of an Optimo are of an Optimo: a mill has none for slots.
TEST_F(ProgramBookTest, SlotsHaveTheCodesOfTheirMachine) {
  for (const int number : {0, 100, 107, 199}) {
    EXPECT_EQ(CodeOf(programs.Get(Name(number, "mill-1"))), ErrorCode::kCellInvalidArgument)
        << number;
  }
  EXPECT_EQ(CodeOf(programs.Get(Name(7, "mill-1"))), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(programs.Read(Name(7, "mill-1"), v1::PROGRAM_FORM_SOURCE)),
            ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(programs.Get(Name(100))), ErrorCode::kProgramNumber);
  EXPECT_EQ(CodeOf(programs.Get(Name(7))), ErrorCode::kProgramMissing);
  EXPECT_EQ(CodeOf(programs.Get(Name(100, "none"))), ErrorCode::kCellUnknownMachine);
}

// Stored all the same, with the verdict of a check: the SRM-20 has 203.2 mm of X, of 204 mm that
// are asked for 0.8 are not cut. What is run to be checked is not judged when it is stored.
TEST_F(ProgramBookTest, AStreamIsStoredWithItsVerdict) {
  const auto stored = programs.Store(
      {.name = Name(7, "mill-1"),
       .file_name = "far.rml",
       .bytes = "IN;PA;!PZ-100,200;VS5;!VZ2;!MC1;PU100,100;PD20400,100;PU0,0;!MC0;"});
  ASSERT_TRUE(stored);
  const v1::Findings& found = stored.value->findings();
  EXPECT_EQ(found.verdict(), v1::VERDICT_BAD);
  ASSERT_GE(found.reasons_size(), 1);
  EXPECT_EQ(found.reasons(0).code(), "RML1-E8002");
  EXPECT_NEAR(found.reasons(0).amount(), 0.8, 1e-9);
  ASSERT_EQ(found.diagnostics_size(), 1);
  EXPECT_EQ(found.diagnostics(0).code(), "RML1-E8002");
  EXPECT_EQ(found.diagnostics(0).verdict(), v1::VERDICT_BAD);
  EXPECT_EQ(Must(programs.Get(Name(7, "mill-1"))).object_bytes(), 65);
  EXPECT_EQ(Store(45, "SPEED 5\nSTOP\n").value->findings().verdict(), v1::VERDICT_UNSPECIFIED);
}

// A mill keeps the stream itself, and has no executables.
TEST_F(ProgramBookTest, AStreamIsItsOwnObject) {
  const auto stored =
      programs.Store({.name = Name(7, "mill-1"), .file_name = "a.rml", .bytes = "IN;PU0,0;"});
  ASSERT_TRUE(stored);
  EXPECT_FALSE(stored.value->has_source_bytes());  // kept once
  EXPECT_EQ(Must(programs.Read(Name(7, "mill-1"), v1::PROGRAM_FORM_SOURCE)).bytes, "IN;PU0,0;");
  EXPECT_EQ(Must(programs.Read(Name(7, "mill-1"), v1::PROGRAM_FORM_SOURCE)).file_name, "a.rml");
  EXPECT_EQ(CodeOf(programs.Store({.name = Name(107, "mill-1"), .bytes = "IN;"})),
            ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(programs.Store(
                {.name = Name(7, "mill-1"), .form = v1::PROGRAM_FORM_EXECUTABLE, .bytes = "IN;"})),
            ErrorCode::kCellInvalidArgument);
  ASSERT_TRUE(
      programs.Store({.name = Name(8, "mill-1"), .form = v1::PROGRAM_FORM_OBJECT, .bytes = "IN;"}));
  EXPECT_EQ(Must(programs.Read(Name(8, "mill-1"), v1::PROGRAM_FORM_SOURCE)).file_name,
            "8.RML");  // as the family writes its extension
}

TEST_F(ProgramBookTest, ListsSlotsInPages) {
  for (const int slot : {99, 1, 45, 44, 7}) ASSERT_TRUE(Store(slot, "STOP\n"));
  v1::ListProgramsRequest request;
  request.set_parent("machines/optimo-1");
  request.set_page_size(2);
  std::vector<std::string> names;
  int pages = 0;
  for (; pages < 10; ++pages) {
    const v1::ListProgramsResponse page = Must(programs.List(request));
    for (const v1::Program& program : page.programs()) names.push_back(program.name());
    request.set_page_token(page.next_page_token());
    if (page.next_page_token().empty()) break;
  }
  EXPECT_EQ(pages, 2);
  EXPECT_THAT(names, testing::ElementsAre(Name(1), Name(7), Name(44), Name(45), Name(99)));
  for (const std::string token : {"x", "0", "100", "-1", "4294967297", "18446744073709551617"}) {
    request.set_page_token(token);
    EXPECT_EQ(CodeOf(programs.List(request)), ErrorCode::kCellBadPageToken) << token;
  }
  request.clear_page_token();
  request.set_page_size(-1);
  EXPECT_EQ(CodeOf(programs.List(request)), ErrorCode::kCellInvalidArgument);
  request.set_page_size(0);
  EXPECT_EQ(Must(programs.List(request)).programs_size(), 5);
  request.set_parent("machines/none");
  EXPECT_EQ(CodeOf(programs.List(request)), ErrorCode::kCellUnknownMachine);
}

TEST_F(ProgramBookTest, ChecksWithoutAMachineToo) {
  v1::ProgramText text;
  text.set_file_name("a.S");
  text.set_content("SPEED 101\n");
  EXPECT_FALSE(Must(programs.Translate("", "", text, true)).ok);
  EXPECT_FALSE(Must(programs.Translate("optimo", "", text, true)).ok);
  EXPECT_FALSE(Must(programs.Translate("", "machines/optimo-1", text, true)).ok);
  text.set_content("SPEED 100\n");
  EXPECT_TRUE(Must(programs.Translate("", "", text, true)).ok);
  EXPECT_EQ(CodeOf(programs.Translate("lathe", "", text, true)), ErrorCode::kCellUnknownFamily);
  EXPECT_EQ(CodeOf(programs.Translate("", "machines/none", text, true)),
            ErrorCode::kCellUnknownMachine);
  text.set_file_name("a.txt");
  EXPECT_EQ(CodeOf(programs.Translate("", "", text, true)), ErrorCode::kCellFamilyUnknownFromName);
  text.clear_content();
  EXPECT_EQ(CodeOf(programs.Translate("optimo", "", text, true)), ErrorCode::kCellEmptyProgram);
}

constexpr const char* kTwoMoves =
    "COORD ABSOL\nPATH LIN\nMOVE (100.,100.,-100.,0.,0.)\nMOVE (200.,100.,-100.,0.,0.)\n";
constexpr const char* kGoesOn = "10 VI[2] = VI[3]\nGOTO 10\n";

// GetProgramPictureRequest.width_px: 64 to 8192; one of less than 400 has room for one view.
TEST_F(ProgramBookTest, AStoredProgramHasAPicture) {
  ASSERT_TRUE(Store(45, kTwoMoves));
  ASSERT_TRUE(Store(46, kGoesOn));
  ProgramViews views(programs);
  const auto picture = [&](int width_px, int number = 45) {
    v1::GetProgramPictureRequest request;
    request.set_name(Name(number));
    request.set_width_px(width_px);
    return views.Picture(request);
  };
  for (const int width_px : {-1, 63, 8193})
    EXPECT_EQ(CodeOf(picture(width_px)), ErrorCode::kCellInvalidArgument) << width_px;
  std::set<std::string> etags;
  for (const int width_px : {64, 399, 400, 8192}) {
    const v1::GetProgramPictureResponse made = Must(picture(width_px));
    EXPECT_THAT(made.content(), testing::HasSubstr("<svg"));
    EXPECT_EQ(made.media_type(), "image/svg+xml");
    EXPECT_TRUE(made.complete());
    etags.insert(made.etag());
  }
  EXPECT_EQ(etags.size(), 4U);
  EXPECT_TRUE(picture(0));  // as wide as pictures are
  EXPECT_LT(Must(picture(399)).content().size(), Must(picture(400)).content().size());
  EXPECT_FALSE(Must(picture(0, 46)).complete());  // it is followed as far as a check follows it
  EXPECT_FALSE(picture(0, 47));                   // there is none
}

// Its path, and a coarser one: ToolpathHeader says which it is.
TEST_F(ProgramBookTest, AStoredProgramHasAPath) {
  ASSERT_TRUE(Store(45, kTwoMoves));
  ASSERT_TRUE(Store(46, kGoesOn));
  ProgramViews views(programs);
  const auto path = [&](int level, int number = 45) {
    v1::StreamProgramToolpathRequest request;
    request.set_name(Name(number));
    request.set_level(level);
    return views.Path(request);
  };
  for (const int level : {-1, 1'000})
    EXPECT_EQ(CodeOf(path(level)), ErrorCode::kCellInvalidArgument) << level;
  double tolerance_mm = 0.0;
  for (const int level : {0, 1}) {
    const ProgramViews::Toolpath made = Must(path(level));
    EXPECT_EQ(made.header.level(), level);
    EXPECT_GT(made.header.tolerance_mm(), tolerance_mm);
    tolerance_mm = made.header.tolerance_mm();
    EXPECT_EQ(made.header.bytes(), static_cast<std::int64_t>(made.frames.size()));
    EXPECT_GT(made.header.points(), 0);
    EXPECT_GT(made.header.duration_ns(), 0);
    EXPECT_TRUE(made.header.complete());
    EXPECT_TRUE(made.header.has_tip_box());
    std::string_view rest = made.frames;
    EXPECT_TRUE(bridge::TakeFrame(rest)) << level;
  }
  EXPECT_FALSE(Must(path(0, 46)).header.complete());
}

// OPT-3.49: START goes on behind a STOP, and what comes there belongs to the picture and the path.
TEST_F(ProgramBookTest, AStoredProgramIsFollowedBehindItsHalts) {
  ASSERT_TRUE(Store(45, std::string(kTwoMoves) + "STOP\nDELAY 5.\nSTOP\nDELAY 5.\n"));
  ProgramViews views(programs);
  v1::StreamProgramToolpathRequest path;
  path.set_name(Name(45));
  const v1::ToolpathHeader header = Must(views.Path(path)).header;
  EXPECT_TRUE(header.complete());
  EXPECT_GE(header.duration_ns(), 10'000'000'000);
  v1::GetProgramPictureRequest picture;
  picture.set_name(Name(45));
  EXPECT_TRUE(Must(views.Picture(picture)).complete());
}

// program.proto UploadContent: with size and digest told before, or without both.
TEST_F(ProgramBookTest, AContentComesInParts) {
  const std::string digest = bridge::Sha256Hex("content");
  ContentUpload unsized(bed.store(), programs);
  EXPECT_EQ(CodeOf(unsized.Add("c")), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(unsized.End()), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(unsized.Begin(0, {})), ErrorCode::kCellEmptyProgram);
  EXPECT_EQ(CodeOf(unsized.Begin(-1, "no digest")), ErrorCode::kCellInvalidArgument);
  Must(unsized.Begin(-1, {}));
  EXPECT_EQ(CodeOf(unsized.Begin(-1, {})), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(unsized.End()), ErrorCode::kCellEmptyProgram);
  Must(unsized.Add("con"));
  Must(unsized.Add("tent"));
  const v1::UploadContentResponse made = Must(unsized.End());
  EXPECT_EQ(made.sha256(), digest);
  EXPECT_EQ(made.size(), 7);
  EXPECT_EQ(made.expire_time().seconds(),
            std::chrono::floor<std::chrono::seconds>(bed.clock().Now() + std::chrono::hours(1))
                .time_since_epoch()
                .count());
  EXPECT_EQ(Must(bed.store().ReadBlob(digest)), "content");
  ContentUpload too_short(bed.store(), programs);
  Must(too_short.Begin(7, digest));
  Must(too_short.Add("con"));
  EXPECT_EQ(CodeOf(too_short.End()), ErrorCode::kCellChecksum);
  ContentUpload too_long(bed.store(), programs);
  Must(too_long.Begin(7, digest));
  EXPECT_EQ(CodeOf(too_long.Add("contents")), ErrorCode::kCellChecksum);
  ContentUpload sized(bed.store(), programs);
  Must(sized.Begin(7, digest));
  Must(sized.Add("content"));
  EXPECT_EQ(Must(sized.End()).sha256(), digest);
}

}  // namespace
}  // namespace rmlcell::server
