// Whichever call to the store fails in the middle of something, its error is what the caller hears.
#include <gtest/gtest.h>

#include "server/base/config.h"
#include "server/programs/content_upload.h"
#include "server/programs/memory_tools.h"
#include "server/programs/program_views.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/failing_store.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class ProgramStoreFailures : public testing::Test {
 protected:
  static std::string Name(int number) {
    return "machines/optimo-1/programs/" + std::to_string(number);
  }
  static v1::ProgramText Text() {
    v1::ProgramText text;
    text.set_file_name("44.S");
    text.set_content("STOP\n");
    return text;
  }
  std::optional<ErrorCode> Store(ProgramBook::Put put) {
    const auto stored = programs.Store(std::move(put));
    return stored ? std::nullopt : std::optional(stored.error.error.code);
  }
  std::optional<ErrorCode> Delete(int number, const std::string& etag = "") {
    v1::DeleteProgramRequest request;
    request.set_name(Name(number));
    request.set_etag(etag);
    const Status deleted = programs.Delete(request, "anna");
    return deleted ? std::nullopt : std::optional(deleted.error().code);
  }
  void Put(int slot) {
    Must(bed.store().PutPrograms("optimo-1", {{.slot = slot, .object = ObjectOf("STOP\n")}}, {}));
  }
  void Expect(const std::string& what, int calls,
              const std::function<std::optional<ErrorCode>()>& operation) {
    ExpectFailuresHandedOn(store, what, calls, operation);
  }

  ServerBed bed;
  FailingStore store{bed.store()};
  Config config;
  ProgramBook programs{store, config};
  MemoryTools tools{store, programs};
};

TEST_F(ProgramStoreFailures, OfTheProgramBook) {
  Expect("storing", 2,
         [&] { return Store({.name = Name(45), .file_name = "a.S", .bytes = "STOP\n"}); });
  Expect("asking whether it can be stored", 3, [&] {
    return Store({.name = Name(46),
                  .file_name = "a.S",
                  .etag = "none",
                  .bytes = "STOP\n",
                  .validate_only = true});
  });
  Expect("storing an executable", 3,
         [&] { return Store({.name = Name(145), .bytes = ExecutableOf(45, "STOP\n")}); });
  Expect("getting", 2, [&] { return CodeOf(programs.Get(Name(45))); });
  Expect("reading", 2, [&] { return CodeOf(programs.Read(Name(45), v1::PROGRAM_FORM_SOURCE)); });
  Expect("listing", 2, [&] {
    v1::ListProgramsRequest request;
    request.set_parent("machines/optimo-1");
    return CodeOf(programs.List(request));
  });
  Expect("translating", 1,
         [&] { return CodeOf(programs.Translate("", "machines/optimo-1", Text(), true)); });
  Expect("checking", 1,
         [&] { return CodeOf(programs.Check("", "machines/optimo-1", Text(), true)); });
  Expect("deleting an executable", 3, [&] { return Delete(145); });
  Expect("deleting", 2, [&] { return Delete(45); });
}

TEST_F(ProgramStoreFailures, OfTheTools) {
  Put(44);
  Put(45);
  Expect("linking", 1, [&] {
    v1::LinkProgramRequest request;
    request.set_slot(45);
    request.set_machine("machines/optimo-1");
    return CodeOf(tools.Link(request));
  });
  Expect("looking for stale executables", 1, [&] {
    v1::ListStaleExecutablesRequest request;
    request.set_parent("machines/optimo-1");
    return CodeOf(tools.ListStale(request));
  });
  Expect("decompiling", 3, [&] {
    v1::DecompileProgramRequest request;
    request.set_name(Name(45));
    return CodeOf(tools.Decompile(request));
  });
  Expect("comparing", 4, [&]() -> std::optional<ErrorCode> {
    v1::DiffProgramsRequest request;
    request.mutable_before()->set_name(Name(44));
    request.mutable_after()->set_name(Name(45));
    const auto diff = tools.Diff(request);
    return diff ? std::nullopt : std::optional(diff.error.error.code);
  });
  v1::FixProgramRequest fix;
  *fix.mutable_program() = Text();
  fix.set_machine("machines/optimo-1");
  store.FailAt(1);
  EXPECT_EQ(CodeOf(tools.Fix(fix)), ErrorCode::kCellStoreFailed);
}

// The machine goes away while its program is being mended: what was found before stays true.
TEST_F(ProgramStoreFailures, AFixGoesOnWithWhatWasFoundBefore) {
  v1::FixProgramRequest fix;
  fix.mutable_program()->set_file_name("44.S");
  fix.mutable_program()->set_content("SPEDE 20\n");
  fix.set_machine("machines/optimo-1");
  store.FailAt(2);
  const auto fixed = Must(tools.Fix(fix));
  EXPECT_TRUE(store.failed());
  EXPECT_EQ(fixed.content(), "SPEED 20\n");
}

// And so it is told as it was asked for: with advice, or without.
TEST_F(ProgramStoreFailures, WhatWasFoundBeforeHasNoMoreThanWasAskedFor) {
  v1::FixProgramRequest fix;
  fix.mutable_program()->set_file_name("44.S");
  fix.mutable_program()->set_content("GOTO 10\nDELAY 1.\n10 STOP\n");
  fix.set_machine("machines/optimo-1");
  for (const bool errors_only : {false, true}) {
    fix.set_errors_only(errors_only);
    store.FailAt(2);
    const auto fixed = Must(tools.Fix(fix));
    EXPECT_TRUE(store.failed());
    EXPECT_EQ(fixed.findings().diagnostics_size() == 0, errors_only);
  }
}

// Another client stores the object between the look at it and the executable for it.
class HastyStore final : public ForwardingStore {
 public:
  explicit HastyStore(storage::Store& store) : ForwardingStore(store), another_(store) {}
  Result<storage::ProgramSummary> GetProgramSummary(std::string_view machine, int slot) override {
    auto found = another_.GetProgramSummary(machine, slot);
    Must(another_.PutPrograms(machine, {{.slot = slot, .object = ObjectOf("SPEED 5\n")}}, {}));
    return found;
  }

 private:
  storage::Store& another_;
};

TEST_F(ProgramStoreFailures, AnExecutableOfAnObjectThatIsGone) {
  Put(45);
  HastyStore hasty(bed.store());
  ProgramBook meanwhile(hasty, config);
  const auto stored = meanwhile.Store({.name = Name(145), .bytes = ExecutableOf(45, "STOP\n")});
  ASSERT_FALSE(stored);
  EXPECT_EQ(stored.error.error.code, ErrorCode::kCellEtagMismatch);
  EXPECT_EQ(stored.error.error.detail, "the object was stored again meanwhile");
  EXPECT_EQ(Must(bed.store().GetProgram("optimo-1", 45)).executable, std::nullopt);
}

// A mill's memory is not read for one of its streams.
TEST_F(ProgramStoreFailures, OfAProgramThatIsLookedAt) {
  Put(45);
  Expect("opening", 2, [&] { return CodeOf(programs.Open(Name(45))); });
  Must(bed.store().PutPrograms("mill-1", {{.slot = 7, .object = "IN;"}}, {}));
  const auto open_stream = [&] { return programs.Open("machines/mill-1/programs/7"); };
  Expect("opening a stream", 3, [&] { return CodeOf(open_stream()); });
  const ProgramBook::Opened opened = Must(open_stream());
  EXPECT_EQ(opened.slot, 7);
  EXPECT_EQ(opened.etag, "1");
  ASSERT_EQ(opened.memory.programs.size(), 1U);
  EXPECT_EQ(opened.memory.programs[0].slot, 7);
  ProgramViews views(programs);
  v1::GetProgramPictureRequest picture;
  picture.set_name(Name(45));
  v1::StreamProgramToolpathRequest path;
  path.set_name(Name(45));
  for (int call = 1; call <= 2; ++call) {
    store.FailAt(call);
    EXPECT_EQ(CodeOf(views.Picture(picture)), ErrorCode::kCellStoreFailed) << call;
    store.FailAt(call);
    EXPECT_EQ(CodeOf(views.Path(path)), ErrorCode::kCellStoreFailed) << call;
  }
}

// Where the store has no room for bytes that come.
class FullStore final : public ForwardingStore {
 public:
  explicit FullStore(storage::Store& store) : ForwardingStore(store) {}
  Result<std::unique_ptr<storage::BlobWriter>> WriteBlob(std::string_view, std::size_t) override {
    return Error{ErrorCode::kCellStoreFailed, "the disk is full", {}};
  }
};

TEST_F(ProgramStoreFailures, OfAnUpload) {
  FullStore full(bed.store());
  // With size and digest told before, it goes to the store as it comes.
  for (const int size : {1, 4}) {
    ContentUpload told(full, programs);
    EXPECT_EQ(CodeOf(told.Begin(size, std::string(64, 'a'))), ErrorCode::kCellStoreFailed) << size;
  }
  ContentUpload untold(full, programs);
  Must(untold.Begin(-1, {}));
  Must(untold.Add("text"));
  EXPECT_EQ(CodeOf(untold.End()), ErrorCode::kCellStoreFailed);
}

// A size that was told without a digest is one as well.
TEST_F(ProgramStoreFailures, AnUploadHasTheSizeThatWasTold) {
  ContentUpload right(bed.store(), programs);
  Must(right.Begin(4, {}));
  Must(right.Add("text"));
  EXPECT_EQ(CodeOf(right.Add("s")), ErrorCode::kCellChecksum);
  ContentUpload short_one(bed.store(), programs);
  Must(short_one.Begin(4, {}));
  Must(short_one.Add("tex"));
  EXPECT_EQ(CodeOf(short_one.End()), ErrorCode::kCellChecksum);
}

// limits.program_bytes: of what is told before, and of what comes.
TEST_F(ProgramStoreFailures, AnUploadHasTheBytesOfAProgram) {
  config.limit_program_bytes = 4;
  ContentUpload told(bed.store(), programs);
  EXPECT_EQ(CodeOf(told.Begin(5, {})), ErrorCode::kCellTooLarge);
  Must(told.Begin(4, {}));
  Must(told.Add("text"));
  EXPECT_EQ(Must(told.End()).size(), 4);
  ContentUpload untold(bed.store(), programs);
  Must(untold.Begin(-1, {}));
  Must(untold.Add("text"));
  EXPECT_EQ(CodeOf(untold.Add("s")), ErrorCode::kCellTooLarge);
}

}  // namespace
}  // namespace rmlcell::server
