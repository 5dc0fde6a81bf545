// What a run of a job shows, and whose entry is taken back (live.md 7.09).
#include "server/machines/host_words.h"
#include "server/machines/teach_book.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/machines/hosts_bed.h"

namespace rmlcell::server {
namespace {

class OwnEntries : public HostsTest {
 protected:
  void Teach(TeachBook& book, int slot, const std::string& text) {
    const auto before = bed.store().GetProgram("optimo-1", slot);
    const storage::Revision from = before ? before->revision : 0;
    const auto put = Must(bed.store().PutPrograms(
        "optimo-1", {{.slot = slot, .object = ObjectOf(text), .expected = from}}, {}));
    v1::TeachEntry entry;
    entry.mutable_step()->set_program(slot);
    entry.mutable_step()->set_step(1);
    entry.set_act(v1::TeachEntry::ACT_INSERT);
    entry.set_after(text.substr(0, text.find('\n')));
    Must(book.Add("optimo-1", entry, from, put.front().revision));
  }
};

// A RUN is attempted once: what its machine shows of it is of the first attempt.
TEST_F(OwnEntries, WhatARunShowsIsOfItsFirstAttempt) {
  v1::MachineStatus status;
  status.mutable_run()->set_job("jobs/5");
  status.mutable_run()->set_run_time_ns(77);
  const v1::JobProgress progress = ProgressOf(status);
  EXPECT_EQ(progress.job(), "jobs/5");
  EXPECT_EQ(progress.attempt(), 1);
  EXPECT_EQ(progress.virtual_time_ns(), 77);
}

// LIVE-7.09: what was taught of another program since is not in the way.
TEST_F(OwnEntries, AnEntryIsTakenBackOfItsOwnProgram) {
  TeachBook book(bed.store());
  for (const int slot : {12, 13})
    Must(bed.store().PutPrograms("optimo-1", {{.slot = slot, .object = ObjectOf("DELAY 9.0\n")}},
                                 {}));
  const std::string object = Must(bed.store().GetProgram("optimo-1", 12)).object;
  Teach(book, 12, "DELAY 1.0\nDELAY 9.0\n");
  Teach(book, 13, "DELAY 2.0\nDELAY 9.0\n");
  v1::UndoTeachEntriesRequest request;
  request.set_program("machines/optimo-1/programs/12");
  request.set_down_to(1);
  const v1::TeachEntry undone = Must(book.TakeBack(request, "anna"));
  EXPECT_EQ(undone.step().program(), 12);
  EXPECT_EQ(Must(bed.store().GetProgram("optimo-1", 12)).object, object);
}

}  // namespace
}  // namespace rmlcell::server
