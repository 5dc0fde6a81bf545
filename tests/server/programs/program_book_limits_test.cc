// The bounds of stored programs and of their lists, each on both sides, and what is told of a
// program; values from proto/rmlcell/v1/program.proto.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "server/base/config.h"
#include "server/programs/program_book.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

// What a store of a program was refused with.
std::optional<ErrorCode> RefusedWith(const ProgramResult<v1::Program>& stored) {
  return stored ? std::nullopt : std::optional(stored.error.error.code);
}
using testing::HasSubstr;

class ProgramBookLimits : public testing::Test {
 protected:
  static std::string Name(int number, const std::string& machine = "optimo-1") {
    return "machines/" + machine + "/programs/" + std::to_string(number);
  }
  v1::Program Stored(ProgramBook::Put put) {
    auto stored = programs.Store(std::move(put));
    if (!stored) throw std::runtime_error(stored.error.error.detail);
    return *std::move(stored.value);
  }
  v1::ListProgramsResponse Page(int size, const std::string& token = "") {
    v1::ListProgramsRequest request;
    request.set_parent("machines/mill-1");
    request.set_page_size(size);
    request.set_page_token(token);
    return Must(programs.List(request));
  }

  ServerBed bed;
  Config config;
  ProgramBook programs{bed.store(), config};
};

// ListProgramsRequest.page_size: 0 is all 99; more are all of them, too.
TEST_F(ProgramBookLimits, APageHasUpToNinetyNinePrograms) {
  std::vector<storage::ProgramWrite> writes;
  for (int slot = 1; slot <= 99; ++slot) writes.push_back({.slot = slot, .object = "IN;"});
  Must(bed.store().PutPrograms("mill-1", writes, {}));
  for (const int size : {0, 99, 100, std::numeric_limits<int>::max()}) {
    EXPECT_EQ(Page(size).programs_size(), 99) << size;
    EXPECT_EQ(Page(size).next_page_token(), "") << size;
  }
  const v1::ListProgramsResponse most = Page(98);
  EXPECT_EQ(most.programs_size(), 98);
  EXPECT_EQ(most.next_page_token(), "98");
  const v1::ListProgramsResponse last = Page(98, "98");
  ASSERT_EQ(last.programs_size(), 1);
  EXPECT_EQ(last.programs(0).name(), Name(99, "mill-1"));
  EXPECT_EQ(Page(1).programs(0).name(), Name(1, "mill-1"));
  EXPECT_EQ(Page(1, "1").programs(0).name(), Name(2, "mill-1"));
  EXPECT_EQ(Page(1, "99").programs_size(), 0);
}

TEST_F(ProgramBookLimits, OfBytesTitlesAndFileNames) {
  const auto code = [&](std::size_t bytes, std::size_t title, std::size_t name) {
    return RefusedWith(programs.Store({.name = Name(45),
                                       .file_name = std::string(name, 'f'),
                                       .title = std::string(title, 't'),
                                       .bytes = std::string(bytes - 1, ';') + "\n",
                                       .validate_only = true}));
  };
  config.limit_program_bytes = 1024;
  EXPECT_EQ(code(1024, 200, 255), std::nullopt);
  EXPECT_EQ(code(1025, 200, 255), ErrorCode::kCellTooLarge);
  EXPECT_EQ(code(1024, 201, 255), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(code(1024, 200, 256), ErrorCode::kCellInvalidArgument);
}

// Program: title and file name without a folder, sizes, a hash and the etag; times of the store.
TEST_F(ProgramBookLimits, WhatIsToldOfAProgram) {
  const v1::Program first =
      Stored({.name = Name(45), .file_name = "a/b\\c.part.S", .bytes = "STOP\n"});
  EXPECT_EQ(first.title(), "c.part");
  EXPECT_EQ(first.file_name(), "c.part.S");
  EXPECT_EQ(first.source_bytes(), 5);
  EXPECT_EQ(first.object_bytes(), static_cast<std::int64_t>(ObjectOf("STOP\n").size()));
  EXPECT_EQ(first.etag(), "1");
  EXPECT_EQ(first.create_time().seconds(), first.update_time().seconds());
  bed.clock().Advance(std::chrono::seconds(5));
  const v1::Program second =
      Stored({.name = Name(45), .file_name = "lid.S", .title = "Lid", .bytes = "SPEED 5\n"});
  EXPECT_EQ(second.title(), "Lid");
  EXPECT_EQ(second.etag(), "2");
  EXPECT_EQ(second.update_time().seconds() - second.create_time().seconds(), 5);
  EXPECT_NE(second.object_sha256(), first.object_sha256());
  EXPECT_EQ(Must(programs.Get(Name(45))).SerializeAsString().size(), [&] {
    v1::Program program = second;
    program.clear_findings();
    return program.SerializeAsString().size();
  }());

  const auto asked = programs.Store({.name = Name(46),
                                     .file_name = "x/lid.S",
                                     .title = "Lid",
                                     .bytes = "STOP\n",
                                     .validate_only = true});
  ASSERT_TRUE(asked);
  EXPECT_EQ(asked.value->name(), Name(46));
  EXPECT_EQ(asked.value->title(), "Lid");
  EXPECT_EQ(asked.value->file_name(), "lid.S");
  EXPECT_EQ(asked.value->object_bytes(), static_cast<std::int64_t>(ObjectOf("STOP\n").size()));
  EXPECT_EQ(asked.value->etag(), "");
}

// An object is known by its form or by its name, and has no text of its own.
TEST_F(ProgramBookLimits, AnObjectIsKnownByItsFormOrItsName) {
  const std::string object = ObjectOf("SPEED 5\nSTOP\n");
  const v1::Program by_name = Stored({.name = Name(44), .file_name = "part.O", .bytes = object});
  const v1::Program by_form = Stored(
      {.name = Name(45), .file_name = "part", .form = v1::PROGRAM_FORM_OBJECT, .bytes = object});
  for (const v1::Program& program : {by_name, by_form}) {
    EXPECT_FALSE(program.has_source_bytes());
    EXPECT_EQ(program.file_name(), "");
    EXPECT_EQ(program.title(), "part");
    const auto unspecified = Must(programs.Read(program.name(), v1::PROGRAM_FORM_UNSPECIFIED));
    EXPECT_EQ(unspecified.form, v1::PROGRAM_FORM_OBJECT);  // what there is of it
    EXPECT_EQ(unspecified.bytes, object);
    EXPECT_FALSE(unspecified.own_text);
  }
  Stored({.name = Name(46), .file_name = "part.S", .bytes = "STOP\n"});
  const auto source = Must(programs.Read(Name(46), v1::PROGRAM_FORM_UNSPECIFIED));
  EXPECT_EQ(source.form, v1::PROGRAM_FORM_SOURCE);
  EXPECT_EQ(source.bytes, "STOP\n");
  EXPECT_TRUE(source.own_text);
  // FIPS 180-2, as sha256sum gives it.
  EXPECT_EQ(source.sha256, "2af183be253fd571e13dd3d310357f3a1ccc7b18502a83ed918e0b88a1e5355f");
  EXPECT_EQ(source.object_sha256, Must(programs.Get(Name(46))).object_sha256());
}

// Or by its bytes, where neither says so: then it is kept once.
TEST_F(ProgramBookLimits, AnObjectIsKnownByItsBytes) {
  const std::string object = ObjectOf("STOP\n");
  const v1::Program stored = Stored({.name = Name(45), .file_name = "part", .bytes = object});
  EXPECT_EQ(stored.object_bytes(), static_cast<std::int64_t>(object.size()));
  EXPECT_FALSE(stored.has_source_bytes());
}

TEST_F(ProgramBookLimits, EachFormHasItsFileName) {
  Stored({.name = Name(32), .file_name = "part.S", .bytes = "STOP\n"});
  ASSERT_TRUE(programs.Store({.name = Name(132), .bytes = ExecutableOf(32, "STOP\n")}));
  const auto name = [&](v1::ProgramForm form) {
    return Must(programs.Read(Name(32), form)).file_name;
  };
  EXPECT_EQ(name(v1::PROGRAM_FORM_SOURCE), "part.S");
  EXPECT_EQ(name(v1::PROGRAM_FORM_OBJECT), "part.O");
  EXPECT_EQ(name(v1::PROGRAM_FORM_EXECUTABLE), "part.X");
  EXPECT_EQ(name(v1::PROGRAM_FORM_LISTING), "part.LST");
  EXPECT_THAT(Must(programs.Read(Name(32), v1::PROGRAM_FORM_LISTING)).bytes, HasSubstr("STOP"));
  Stored({.name = Name(7, "mill-1"), .file_name = "a.rml", .bytes = "IN;"});
  EXPECT_EQ(CodeOf(programs.Read(Name(7, "mill-1"), v1::PROGRAM_FORM_LISTING)),
            ErrorCode::kCellPrecondition);
  EXPECT_EQ(CodeOf(programs.Read(Name(33), v1::PROGRAM_FORM_SOURCE)), ErrorCode::kProgramMissing);
  Stored({.name = Name(33), .file_name = "part.S", .bytes = "STOP\n"});
  EXPECT_EQ(CodeOf(programs.Read(Name(133), v1::PROGRAM_FORM_SOURCE)), ErrorCode::kProgramMissing);
}

// A check takes the slot that the name says, else the first that the machine does not use
// (OPT-1.10).
TEST_F(ProgramBookLimits, ACheckTakesASlotOfItsOwn) {
  const auto slot = [&](const std::string& file_name,
                        const std::string& machine = "machines/optimo-1") {
    v1::ProgramText text;
    text.set_file_name(file_name);
    text.set_content("STOP\n");
    return Must(programs.Check("", machine, text, true)).slot;
  };
  EXPECT_EQ(slot("part.S"), 1);
  EXPECT_EQ(slot("part.S", ""), 1);
  EXPECT_EQ(slot("1.S"), 1);
  EXPECT_EQ(slot("44.S"), 44);
  EXPECT_EQ(slot("99.S"), 99);
  EXPECT_EQ(slot("0.S"), 1);
  EXPECT_EQ(slot("100.S"), 1);
  EXPECT_EQ(slot("a/44.S"), 44);
  for (const int used : {1, 2, 4}) {
    Must(bed.store().PutPrograms("optimo-1", {{.slot = used, .object = ObjectOf("STOP\n")}}, {}));
  }
  EXPECT_EQ(slot("part.S"), 3);
  EXPECT_EQ(slot("1.S"), 1);
  EXPECT_EQ(slot("2.S"), 2);
}

// OPT-E.7102: of a machine all programs are known, of a family alone none.
TEST_F(ProgramBookLimits, ACheckKnowsWhatItsMachineLacks) {
  const auto good = [&](const std::string& family, const std::string& machine) {
    v1::ProgramText text;
    text.set_file_name("45.S");
    text.set_content("CALL 77\n");
    return Must(programs.Check(family, machine, text, true)).ok();
  };
  EXPECT_FALSE(good("", "machines/optimo-1"));
  EXPECT_TRUE(good("optimo", ""));
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 77, .object = ObjectOf("STOP\n")}}, {}));
  EXPECT_TRUE(good("", "machines/optimo-1"));
}

// An error shows its line and how many more there are; a single one says nothing of more.
TEST_F(ProgramBookLimits, TheFirstErrorStandsForAll) {
  const auto detail = [&](const std::string& source) {
    return programs.Store({.name = Name(45), .file_name = "a.S", .bytes = source})
        .error.error.detail;
  };
  EXPECT_THAT(detail("STOP\nSPEED 101\n"), testing::StartsWith("line 2: "));
  EXPECT_THAT(detail("STOP\nSPEED 101\n"), testing::Not(HasSubstr("more")));
  EXPECT_THAT(detail("SPEED 101\nSPEED 102\nSPEED 103\n"), testing::StartsWith("line 1: "));
  EXPECT_THAT(detail("SPEED 101\nSPEED 102\nSPEED 103\n"), testing::EndsWith(" (and 2 more)"));
}

// OPT-W.44: of TASK 2 nothing comes. A warning is no error, wherever it stands.
TEST_F(ProgramBookLimits, AWarningIsNotTheFirstError) {
  const auto wrong = programs.Store(
      {.name = Name(45), .file_name = "a.S", .bytes = "TASK 2\nSPEED 101\nSPEED 102\n"});
  ASSERT_FALSE(wrong);
  ASSERT_FALSE(wrong.error.diagnostics.empty());
  ASSERT_FALSE(IsError(wrong.error.diagnostics.front().severity));
  EXPECT_EQ(wrong.error.error.code, ErrorCode::kLiteralRange);
  EXPECT_THAT(wrong.error.error.detail, testing::StartsWith("line 2: "));
  EXPECT_THAT(wrong.error.error.detail, testing::EndsWith(" (and 1 more)"));
  // Nor does it keep a program from being good.
  const v1::Program stored =
      Stored({.name = Name(45), .file_name = "a.S", .bytes = "TASK 2\nSPEED 100\n"});
  EXPECT_GT(stored.findings().diagnostics_size(), 0);
  EXPECT_TRUE(stored.findings().ok());
}

}  // namespace
}  // namespace rmlcell::server
