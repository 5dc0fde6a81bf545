// How many errors are left untold, executables of no bytes, and what is refused as no source.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/machine/program_file.h"
#include "server/base/config.h"
#include "server/programs/memory_tools.h"
#include "server/programs/program_book.h"
#include "server/programs/special_programs.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class ProgramCounts : public testing::Test {
 protected:
  ServerBed bed;
  Config config;
  ProgramBook programs{bed.store(), config};
  MemoryTools tools{bed.store(), programs};
};

// The first is told; all others are counted, those too that no list has room for.
TEST_F(ProgramCounts, ErrorsThatAreNotKeptAreCountedToo) {
  const auto detail = [&](std::size_t errors) {
    std::string source;
    for (std::size_t i = 0; i < errors; ++i) source += "SPEED 101\n";
    return programs
        .Store({.name = "machines/optimo-1/programs/45", .file_name = "a.S", .bytes = source})
        .error.error.detail;
  };
  EXPECT_THAT(detail(machine::kDiagnosticsMax), testing::EndsWith(" (and 999 more)"));
  EXPECT_THAT(detail(machine::kDiagnosticsMax + 7), testing::EndsWith(" (and 1006 more)"));
}

// An executable of no bytes is one; where there is none the slot is empty.
TEST_F(ProgramCounts, AnExecutableOfNoBytesIsThere) {
  const auto put =
      Must(bed.store().PutPrograms("optimo-1", {{.slot = 7, .object = ObjectOf("STOP\n")}}, {}));
  EXPECT_FALSE(programs.Get("machines/optimo-1/programs/107"));
  ASSERT_TRUE(Must(bed.store().PutExecutable("optimo-1", 7, put.front().revision, "", "anna")));
  const auto got = programs.Get("machines/optimo-1/programs/107");
  ASSERT_TRUE(got) << got.error().detail;
  EXPECT_EQ(got->name(), "machines/optimo-1/programs/107");
  const auto stored = programs.Store({.name = "machines/optimo-1/programs/107",
                                      .etag = "none",
                                      .bytes = ExecutableOf(7, "STOP\n")});
  ASSERT_FALSE(stored);
  EXPECT_EQ(stored.error.error.code, ErrorCode::kCellAlreadyExists);
}

// But nobody stores one: what has no bytes is told by its file, before anything is looked for.
TEST_F(ProgramCounts, NothingOfNoBytesIsStored) {
  for (const std::string number : {"7", "107"}) {
    const auto stored = programs.Store(
        {.name = "machines/optimo-1/programs/" + number, .file_name = "empty", .bytes = ""});
    ASSERT_FALSE(stored) << number;
    EXPECT_EQ(stored.error.error.code, ErrorCode::kCellEmptyProgram) << number;
    EXPECT_EQ(stored.error.error.detail, "empty") << number;
  }
}

TEST_F(ProgramCounts, SpecialProgramsAreThoseOfAFamily) {
  Must(bed.store().PutMachine({.id = "odd", .family = "lathe"}, 0));
  v1::StoreSpecialProgramsRequest request;
  request.set_parent("machines/odd");
  EXPECT_EQ(CodeOf(StoreSpecialPrograms(bed.store(), request, "anna")),
            ErrorCode::kCellUnknownFamily);
}

// There is nothing to mend in an object.
TEST_F(ProgramCounts, AnObjectIsNotMended) {
  v1::FixProgramRequest request;
  request.set_family("optimo");
  request.mutable_program()->set_file_name("a.O");
  request.mutable_program()->set_form(v1::PROGRAM_FORM_OBJECT);
  request.mutable_program()->set_content(ObjectOf("STOP\n"));
  EXPECT_EQ(CodeOf(tools.Fix(request)), ErrorCode::kCellBadText);
}

}  // namespace
}  // namespace rmlcell::server
