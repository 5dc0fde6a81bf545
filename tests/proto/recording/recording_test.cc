// The file of a recording, and what counts of a torn one (live.md 3).
#include "proto/recording/recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/core/catalogue.h"
#include "engine/families/families.h"
#include "proto/recording/records.h"
#include "proto/recording/told.h"
#include "tests/proto/bridge/message_text.h"

namespace rmlcell::recording {
namespace {

using testing::ElementsAre;

const std::string kTitle = "rmlcell recording 1\n";

v1::JournalEntry Entry(std::int64_t fence, std::int64_t sequence, std::int64_t time_ns) {
  v1::JournalEntry entry;
  entry.set_fence(fence);
  entry.set_sequence(sequence);
  entry.set_virtual_time_ns(time_ns);
  return entry;
}
v1::JournalEntry Mark(std::int64_t sequence, std::int64_t time_ns, const std::string& state) {
  v1::JournalEntry entry = Entry(7, sequence, time_ns);
  entry.mutable_mark()->set_state(state);
  return entry;
}
v1::JournalEntry Over(std::int64_t sequence, const std::string& job) {
  v1::JournalEntry entry = Entry(7, sequence, 0);
  entry.mutable_run_over()->set_job(job);
  return entry;
}
v1::MachineRecording Head() {
  v1::MachineRecording head;
  head.set_machine("machines/mill-1");
  head.set_job("jobs/17");
  return head;
}
std::vector<std::int64_t> Sequences(const Recording& recording) {
  std::vector<std::int64_t> numbers;
  for (const v1::JournalEntry& entry : recording.entries) numbers.push_back(entry.sequence());
  return numbers;
}

TEST(RecordingFile, IsReadAsItWasWritten) {
  std::string file = BeginFile(Head(), Mark(1, 0, "state"));
  AddEntry(Entry(7, 2, 5), file);
  EXPECT_TRUE(file.starts_with(kTitle));
  const auto read = ReadFile(file);
  ASSERT_TRUE(read) << read.error().detail;
  EXPECT_EQ(read->head.machine(), "machines/mill-1");
  EXPECT_THAT(Sequences(*read), ElementsAre(1, 2));
  EXPECT_EQ(read->entries[1].virtual_time_ns(), 5);
  EXPECT_EQ(FileOf(*read), file);
}

TEST(RecordingFile, SaysFromWhichByteOnItIsNone) {
  const auto said = [](const std::string& file) {
    const auto read = ReadFile(file);
    if (read) return std::string("read");
    EXPECT_EQ(read.error().code, ErrorCode::kCellBadText);
    return std::string(read.error().detail);
  };
  const auto at = [](std::size_t byte) {
    return "byte " + std::to_string(byte) + " of the recording: ";
  };
  const std::string file = BeginFile(Head(), Mark(1, 0, "state"));
  EXPECT_EQ(said("rmlcell recording 2\n"), at(0) + "it does not begin as one");
  EXPECT_EQ(said(kTitle), at(kTitle.size()) + "it has no head");
  EXPECT_EQ(said(file.substr(0, kTitle.size() + 9)), at(kTitle.size()) + "it has no head");
  std::string no_head = kTitle;
  AddRecord("\xFF", no_head);
  EXPECT_EQ(said(no_head), at(kTitle.size()) + "no head is there");
  EXPECT_EQ(said(file + "x"), at(file.size()) + "from here on it is damaged or cut off");
  std::string no_entry = file;
  AddRecord("\xFF", no_entry);
  EXPECT_EQ(said(no_entry), at(file.size() + 8) + "no entry is there");
  std::string head_alone = kTitle;
  AddRecord(Head().SerializeAsString(), head_alone);
  const std::string stood = "it does not say where the machine stood";
  EXPECT_EQ(said(head_alone), at(head_alone.size()) + stood);
  for (const v1::JournalEntry& first : {Mark(1, 0, ""), Entry(7, 1, 0)}) {
    const std::string stateless = BeginFile(Head(), first);
    EXPECT_EQ(said(stateless), at(stateless.size()) + stood);
  }
}

// All up to the mark; up to the end of the run of that job where it is not behind the mark.
TEST(RecordingFile, WhatCountsOfATornOne) {
  std::string file = BeginFile(Head(), Mark(1, 0, "state"));
  std::vector<std::size_t> ends = {0, file.size()};
  for (std::int64_t sequence = 2; sequence <= 4; ++sequence) {
    AddEntry(Entry(7, sequence, 0), file);
    ends.push_back(file.size());
  }
  for (std::int64_t sequence = 1; sequence <= 4; ++sequence) {
    const auto found = DurableIn(file + "torn", 7, sequence);
    ASSERT_TRUE(found) << sequence;
    EXPECT_EQ(found->job, "jobs/17");
    EXPECT_EQ(found->bytes, ends[static_cast<std::size_t>(sequence)]);
    EXPECT_FALSE(found->whole);
  }
  std::string whole = file;
  AddEntry(Over(5, "jobs/16"), whole);
  AddEntry(Over(6, "jobs/17"), whole);
  const std::size_t end = whole.size();
  AddEntry(Entry(7, 7, 0), whole);
  for (const auto& [fence, sequence] : {std::pair(7, 6), {7, 7}, {7, 100}, {8, 1}}) {
    const auto found = DurableIn(whole, fence, sequence);
    ASSERT_TRUE(found) << sequence;
    EXPECT_EQ(found->bytes, end);
    EXPECT_TRUE(found->whole);
  }
  EXPECT_FALSE(DurableIn(whole, 7, 5)->whole);
}

TEST(RecordingFile, WithoutTheMarkNothingCounts) {
  std::string file = BeginFile(Head(), Mark(1, 0, "state"));
  AddEntry(Entry(7, 3, 0), file);
  const auto said = [](const std::string& torn, std::int64_t fence, std::int64_t sequence) {
    const auto found = DurableIn(torn, fence, sequence);
    return found ? std::string("found") : std::string(found.error().detail);
  };
  const std::string at = "byte " + std::to_string(file.size()) + " of the recording: ";
  EXPECT_EQ(said(file + "x", 7, 4), at + "it does not reach entry 4 of fence 7");
  EXPECT_EQ(said(file, 7, 2), at + "it does not reach entry 2 of fence 7");
  EXPECT_EQ(said(file, 6, 9), at + "it does not reach entry 9 of fence 6");
  EXPECT_EQ(said("x", 7, 1), "byte 0 of the recording: it does not begin as one");
  // That the run was over behind the mark says nothing of what lies before it.
  std::string over = file;
  AddEntry(Over(5, "jobs/17"), over);
  EXPECT_EQ(said(over, 7, 4), "byte " + std::to_string(over.size()) +
                                  " of the recording: it does not reach entry 4 of fence 7");
  std::string bad = BeginFile(Head(), Mark(1, 0, "state"));
  AddRecord("\xFF", bad);
  AddEntry(Entry(7, 3, 0), bad);
  EXPECT_THAT(said(bad, 7, 3), testing::HasSubstr("does not reach entry 3"));
}

TEST(RecordingFile, FromATimeOn) {
  const Recording all{.head = Head(),
                      .entries = {Mark(1, 0, "a"), Entry(7, 2, 5), Mark(3, 10, "b"),
                                  Mark(4, 20, ""), Entry(7, 5, 25), Mark(6, 30, "c")}};
  const auto from = [&](std::int64_t time_ns) { return Sequences(From(all, SimTime(time_ns))); };
  EXPECT_THAT(from(0), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(from(9), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(from(10), ElementsAre(3, 4, 5, 6));
  EXPECT_THAT(from(29), ElementsAre(3, 4, 5, 6));
  EXPECT_THAT(from(30), ElementsAre(6));
  EXPECT_THAT(from(-1), ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(RecordedMemory, ThereAndBack) {
  machine::MachineMemory memory;
  memory.programs[12] = {.name = "part",
                         .object = machine::Bytes::Of("object"),
                         .executable = machine::Bytes::Of("executable")};
  memory.programs[13] = {.name = "other", .object = machine::Bytes::Of("o")};
  memory.deleted = {3, 4};
  memory.schedules = {{.number = 5, .name = "steel", .mode = "PULSE", .power_percent = 12.5}};
  v1::MachineRecording head;
  SetMemory(memory, head);
  bridge::ExpectMessage(
      head,
      "programs { slot: 12 title: 'part' content: 'object' size: 6 executable: 'executable' } "
      "programs { slot: 13 title: 'other' content: 'o' size: 1 } deleted_programs: 3 "
      "deleted_programs: 4 schedules { number: 5 title: 'steel' mode: 'PULSE' power_percent: 12.5 "
      "}");
  const machine::MachineMemory back = MemoryOf(head);
  ASSERT_EQ(back.programs.size(), 2U);
  EXPECT_EQ(back.programs.at(12).name, "part");
  EXPECT_EQ(*back.programs.at(12).object, "object");
  EXPECT_EQ(*back.programs.at(12).executable, "executable");
  EXPECT_FALSE(back.programs.at(13).executable);
  EXPECT_EQ(back.deleted, memory.deleted);
  EXPECT_EQ(back.schedules, memory.schedules);
  v1::MachineRecording plain;
  SetMemory({}, plain);
  EXPECT_TRUE(plain.default_schedules());
}

TEST(BroughtProgram, IsTranslatedWhereItIsASource) {
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  const machine::Parameters parameters = *machine::MakeParameters(family, "", {});
  v1::AssignedProgram message;
  message.set_file_name("part.S");
  message.set_content("SPEED 20\n");
  const auto as_it_is = ProgramOf(message, family, parameters);
  ASSERT_TRUE(as_it_is);
  EXPECT_EQ(as_it_is->name, "part.S");
  EXPECT_EQ(*as_it_is->object, "SPEED 20\n");
  EXPECT_EQ(as_it_is->source, nullptr);
  EXPECT_FALSE(as_it_is->executable);
  message.set_title("part");
  message.set_is_source(true);
  message.set_executable("e");
  const auto translated = ProgramOf(message, family, parameters);
  ASSERT_TRUE(translated);
  EXPECT_EQ(translated->name, "part");
  EXPECT_NE(*translated->object, "SPEED 20\n");
  EXPECT_NE(translated->source, nullptr);
  EXPECT_EQ(*translated->executable, "e");
  message.set_content("SPEED 20\nSPEDE 20\n");
  const auto refused = ProgramOf(message, family, parameters);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where->line, 2);
}

TEST(Told, OfARun) {
  bridge::ExpectMessage(
      BegunOf({.number = 3, .program = 12, .source = machine::StartSource::kQueue}),
      "run: 3 program: 12 source: START_SOURCE_QUEUE");
  bridge::ExpectMessage(HaltedOf({.place = {.program = 1, .step = 2, .line = 3},
                                  .reason = machine::HaltReason::kProgram,
                                  .why = "M0"}),
                        "reason: HOLD_REASON_PROGRAM message: 'M0' place { program: 1 step: 2 "
                        "line: 3 }");
  bridge::ExpectMessage(ResumedOf({.program = 1, .step = 2}), "place { program: 1 step: 2 }");
  bridge::ExpectMessage(MessageOf({.program = 1, .step = 2}, "a\xFF"),
                        "text: 'a?' place { program: 1 step: 2 }");
}

// Power is no end of a program: the machine was taken away from it. LIVE-2.10
TEST(Told, OfTheEndOfARun) {
  machine::RunOver over;
  over.run.number = 3;
  over.run.program = 12;
  over.outcome.kind = machine::OutcomeKind::kFailed;
  over.outcome.code = ErrorCode::kHoleRadiusZero;
  over.worked = SimTime(5);
  const v1::RunOver failed = OverOf(over);
  EXPECT_EQ(failed.run(), 3);
  EXPECT_EQ(failed.program(), 12);
  EXPECT_EQ(failed.outcome().kind(), v1::Outcome::KIND_FAILED);
  EXPECT_EQ(failed.outcome().cycle_time_ns(), 5);
  over.outcome.code = ErrorCode::kCellPowerOff;
  EXPECT_EQ(OverOf(over).outcome().kind(), v1::Outcome::KIND_INTERRUPTED);
}

}  // namespace
}  // namespace rmlcell::recording
