// What was taught at a machine, and how it is taken back (live.md 7.09).
#include "server/machines/teach_book.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/engine_bytes.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;

class TeachBookTest : public testing::Test {
 protected:
  std::string Object() { return Must(bed.store().GetProgram("optimo-1", 12)).object; }
  storage::Revision Revision() {
    const auto program = bed.store().GetProgram("optimo-1", 12);
    return program ? program->revision : 0;
  }
  void Stored(const std::string& text) {
    Must(bed.store().PutPrograms("optimo-1", {{.slot = 12, .object = ObjectOf(text)}}, {}));
  }
  // As the host of the machine does it: the object, then what was done to it.
  void Teach(v1::TeachEntry::Act act, const std::string& text, int step = 0,
             const std::string& before = "", const std::string& after = "") {
    const storage::Revision from = Revision();
    const auto put = Must(bed.store().PutPrograms(
        "optimo-1", {{.slot = 12, .object = ObjectOf(text), .expected = from}}, {}));
    v1::TeachEntry entry;
    entry.mutable_step()->set_program(12);
    entry.mutable_step()->set_step(step);
    entry.set_place(step > 0 ? step - 1 : 0);
    entry.set_act(act);
    entry.set_before(before);
    entry.set_after(after);
    Must(book.Add("optimo-1", entry, from, put.front().revision));
  }
  static v1::UndoTeachEntriesRequest DownTo(std::int64_t number) {
    v1::UndoTeachEntriesRequest request;
    request.set_program("machines/optimo-1/programs/12");
    request.set_down_to(number);
    return request;
  }
  std::vector<std::int64_t> Numbers(int size = 0, const std::string& token = "") {
    v1::ListTeachEntriesRequest request;
    request.set_machine("machines/optimo-1");
    request.set_page_size(size);
    request.set_page_token(token);
    const v1::ListTeachEntriesResponse listed = Must(book.List(request));
    token_ = listed.next_page_token();
    std::vector<std::int64_t> numbers;
    for (const v1::TeachEntry& one : listed.entries()) numbers.push_back(one.number());
    return numbers;
  }

  ServerBed bed;
  TeachBook book{bed.store()};
  std::string token_;
};

// LIVE-7.09: listed newest first, in pages; taken back one and two at a time, byte for byte; asked
// twice it is done once; an undo is an entry.
TEST_F(TeachBookTest, WhatWasTaughtIsTakenBack) {
  Stored("DELAY 9.0\n");
  const std::string before = Object();
  Teach(v1::TeachEntry::ACT_INSERT, "DELAY 1.0\nDELAY 9.0\n", 1, "", "DELAY 1.0");
  const std::string one = Object();
  Teach(v1::TeachEntry::ACT_INSERT, "DELAY 1.0\nDELAY 2.0\nDELAY 9.0\n", 2, "", "DELAY 2.0");
  Teach(v1::TeachEntry::ACT_DELETE, "DELAY 2.0\nDELAY 9.0\n", 1, "DELAY 1.0", "");
  EXPECT_THAT(Numbers(), ElementsAre(3, 2, 1));
  EXPECT_THAT(Numbers(2), ElementsAre(3, 2));
  EXPECT_THAT(Numbers(2, token_), ElementsAre(1));
  EXPECT_EQ(token_, "");

  const v1::TeachEntry undone = Must(book.TakeBack(DownTo(2), "anna"));
  EXPECT_EQ(undone.number(), 4);
  EXPECT_EQ(undone.act(), v1::TeachEntry::ACT_UNDO);
  EXPECT_EQ(undone.undone_down_to(), 2);
  EXPECT_EQ(undone.caller(), "anna");
  EXPECT_EQ(Object(), one);
  EXPECT_EQ(Must(book.TakeBack(DownTo(2), "anna")).number(), 4);
  EXPECT_THAT(Numbers(), ElementsAre(4, 3, 2, 1));
  EXPECT_EQ(CodeOf(book.TakeBack(DownTo(3), "anna")), ErrorCode::kCellNotFound);
  Must(book.TakeBack(DownTo(1), "anna"));
  EXPECT_EQ(Object(), before);
  EXPECT_EQ(CodeOf(book.TakeBack(DownTo(99), "anna")), ErrorCode::kCellNotFound);
}

// A slot, or all of them; a page as it was asked for, behind the number that its token names.
TEST_F(TeachBookTest, PagesOfWhatWasTaught) {
  Stored("DELAY 9.0\n");
  Teach(v1::TeachEntry::ACT_INSERT, "DELAY 1.0\nDELAY 9.0\n", 1, "", "DELAY 1.0");
  Teach(v1::TeachEntry::ACT_INSERT, "DELAY 1.0\nDELAY 2.0\nDELAY 9.0\n", 2, "", "DELAY 2.0");
  EXPECT_THAT(Numbers(2), ElementsAre(2, 1));
  EXPECT_EQ(token_, "");  // they are all on it
  EXPECT_THAT(Numbers(1), ElementsAre(2));
  EXPECT_EQ(token_, "2");
  EXPECT_THAT(Numbers(1, "1"), ElementsAre());
  v1::ListTeachEntriesRequest request;
  request.set_machine("machines/optimo-1");
  const auto code = [&] { return CodeOf(book.List(request)); };
  for (const int program : {-1, 100}) {
    request.set_program(program);
    EXPECT_EQ(code(), ErrorCode::kCellInvalidArgument) << program;
  }
  for (const auto& [program, entries] : {std::pair{0, 2}, {12, 2}, {1, 0}, {99, 0}}) {
    request.set_program(program);
    EXPECT_EQ(Must(book.List(request)).entries_size(), entries) << program;
  }
  for (const char* token : {"0", "-1", "x", "1 "}) {
    request.set_page_token(token);
    EXPECT_EQ(code(), ErrorCode::kCellInvalidArgument) << token;
  }
}

// LIVE-7.09: an undo is taught again, and not taken back; each entry says what it was made from.
TEST_F(TeachBookTest, AnUndoIsNotTakenBack) {
  Stored("DELAY 9.0\n");
  const storage::Revision first = Revision();
  Teach(v1::TeachEntry::ACT_INSERT, "DELAY 1.0\nDELAY 9.0\n", 1, "", "DELAY 1.0");
  const storage::Revision taught = Revision();
  const v1::TeachEntry undone = Must(book.TakeBack(DownTo(1), "anna"));
  EXPECT_EQ(undone.number(), 2);
  EXPECT_EQ(undone.step().program(), 12);
  EXPECT_EQ(undone.etag_before(), std::to_string(taught));
  EXPECT_EQ(undone.etag_after(), std::to_string(Revision()));
  EXPECT_GT(undone.time().seconds(), 0);
  EXPECT_EQ(CodeOf(book.TakeBack(DownTo(2), "anna")), ErrorCode::kCellInvalidArgument);
  v1::ListTeachEntriesRequest request;
  request.set_machine("machines/optimo-1");
  EXPECT_EQ(Must(book.List(request)).entries(1).etag_before(), std::to_string(first));
}

// LIVE-7.09: of a program that was made and removed there is nothing to change, and it is an entry.
TEST_F(TeachBookTest, WhatWasMadeAndRemovedIsTakenBack) {
  v1::TeachEntry entry;
  entry.mutable_step()->set_program(12);
  entry.set_act(v1::TeachEntry::ACT_CREATE);
  Must(book.Add("optimo-1", entry, 0, 1));
  entry.set_act(v1::TeachEntry::ACT_REMOVE);
  entry.set_before("     DELAY 9.0\n");
  Must(book.Add("optimo-1", entry, 1, 0));
  const v1::TeachEntry undone = Must(book.TakeBack(DownTo(1), "anna"));
  EXPECT_EQ(undone.number(), 3);
  EXPECT_EQ(undone.etag_after(), "");
  EXPECT_EQ(Revision(), 0);
}

// LIVE-7.09: not over a change that somebody else made.
TEST_F(TeachBookTest, AnotherChangeIsNotTakenBack) {
  Stored("DELAY 9.0\n");
  Teach(v1::TeachEntry::ACT_INSERT, "DELAY 1.0\nDELAY 9.0\n", 1, "", "DELAY 1.0");
  Stored("DELAY 7.0\n");
  const std::string other = Object();
  EXPECT_EQ(CodeOf(book.TakeBack(DownTo(1), "anna")), ErrorCode::kCellEtagMismatch);
  EXPECT_EQ(Object(), other);
  EXPECT_EQ(CodeOf(book.TakeBack(DownTo(5), "anna")), ErrorCode::kCellNotFound);
}

// LIVE-7.09: nor one that somebody made between two entries, though their steps are where they
// were.
TEST_F(TeachBookTest, AChangeBetweenIsNotTakenBack) {
  Stored("DELAY 9.0\n");
  Teach(v1::TeachEntry::ACT_INSERT, "DELAY 1.0\nDELAY 9.0\n", 1, "", "DELAY 1.0");
  Stored("DELAY 1.0\nDELAY 9.0\nDELAY 8.0\n");
  const std::string between = Object();
  Teach(v1::TeachEntry::ACT_INSERT, "DELAY 1.0\nDELAY 2.0\nDELAY 9.0\nDELAY 8.0\n", 2, "",
        "DELAY 2.0");
  EXPECT_EQ(CodeOf(book.TakeBack(DownTo(1), "anna")), ErrorCode::kCellEtagMismatch);
  Must(book.TakeBack(DownTo(2), "anna"));
  EXPECT_EQ(Object(), between);
  EXPECT_EQ(CodeOf(book.TakeBack(DownTo(1), "anna")), ErrorCode::kCellEtagMismatch);
}

// LIVE-7.09: asked again is what was taken back last: behind anything newer it is asked anew, and
// is not there any more.
TEST_F(TeachBookTest, AnOlderUndoIsNoAnswer) {
  Stored("DELAY 9.0\n");
  Teach(v1::TeachEntry::ACT_INSERT, "DELAY 1.0\nDELAY 9.0\n", 1, "", "DELAY 1.0");
  Must(book.TakeBack(DownTo(1), "anna"));
  Teach(v1::TeachEntry::ACT_INSERT, "DELAY 2.0\nDELAY 9.0\n", 1, "", "DELAY 2.0");
  const std::string stands = Object();
  EXPECT_EQ(CodeOf(book.TakeBack(DownTo(1), "anna")), ErrorCode::kCellNotFound);
  EXPECT_EQ(Object(), stands);
}

// An entry of another program is none of this one, however far back it is looked for.
TEST_F(TeachBookTest, AnEntryOfAnotherProgramIsNotFound) {
  v1::TeachEntry other;
  other.mutable_step()->set_program(13);
  Must(book.Add("optimo-1", other, 0, 1));
  Stored("DELAY 9.0\n");
  Teach(v1::TeachEntry::ACT_INSERT, "DELAY 1.0\nDELAY 9.0\n", 1, "", "DELAY 1.0");
  EXPECT_EQ(CodeOf(book.TakeBack(DownTo(1), "anna")), ErrorCode::kCellNotFound);
}

}  // namespace
}  // namespace rmlcell::server
