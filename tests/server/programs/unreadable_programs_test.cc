// Programs of machines whose state or memory cannot be read, and bytes that find no room.
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>

#include "engine/machine/machine_note.h"
#include "server/programs/content_upload.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/programs/program_views_bed.h"

namespace rmlcell::server {
namespace {

class UnreadablePrograms : public ProgramViewsBed {
 protected:
  // As its host left the machine.
  void Stands(const std::string& machine, const std::string& state) {
    const storage::MachineLease lease = Must(bed.store().TakeMachine(
        {.machine = machine, .host = "hall/1", .server = "s", .duration = std::chrono::hours(1)}));
    Must(bed.store().AppendMachine(lease,
                                   {.mark = storage::MachineMark{.sequence = 1, .state = state}}));
  }
  void Put(const std::string& machine, int slot, const std::string& object) {
    Must(bed.store().PutPrograms(machine, {{.slot = slot, .object = object}}, {}));
  }
  Result<simulation::CheckedProgram> Check(const std::string& source, bool advice) {
    v1::ProgramText text;
    text.set_file_name("44.S");
    text.set_content(source);
    return programs.Check("", "machines/optimo-1", text, advice);
  }
};

TEST_F(UnreadablePrograms, AStateThatCannotBeReadIsADamageOfTheStore) {
  Put("optimo-1", 45, ObjectOf("STOP\n"));
  Stands("optimo-1", "no state");
  EXPECT_EQ(CodeOf(programs.Open("machines/optimo-1/programs/45")), ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(CodeOf(Check("STOP\n", true)), ErrorCode::kCellStoreCorrupt);
}

// What its family does not know shows when it would run.
TEST_F(UnreadablePrograms, WhatItsFamilyCannotReadIsNotFollowed) {
  const std::string name = "machines/mill-1/programs/7";
  Put("mill-1", 7, "PA;PU100,0;");
  EXPECT_EQ(Picture(name), std::nullopt);
  EXPECT_EQ(Path(name), std::nullopt);
  machine::MachineNote note;
  note.family = "no state";
  Stands("mill-1", machine::WriteMachineNote(note));
  EXPECT_NE(Picture(name), std::nullopt);
  EXPECT_NE(Path(name), std::nullopt);
}

// Nor is a text that is run to be checked.
TEST_F(UnreadablePrograms, OnSuchAMachineNoTextIsChecked) {
  machine::MachineNote note;
  note.family = "no state";
  Stands("optimo-1", machine::WriteMachineNote(note));
  EXPECT_NE(CodeOf(Check("STOP\n", true)), std::nullopt);
}

// FamilyInfo.checked_by_running: of a stream the text tells all, however its machine stands.
TEST_F(UnreadablePrograms, AStreamIsCheckedWithoutTheStateOfItsMachine) {
  Stands("mill-1", "no state");
  v1::ProgramText text;
  text.set_file_name("a.rml");
  text.set_content("PA;PU100,0;");
  EXPECT_EQ(CodeOf(programs.Check("", "machines/mill-1", text, true)), std::nullopt);
}

// OPT-E7301: where it goes hangs on a SYSDEF that may be in force. OPT-E7102: no program is there.
TEST_F(UnreadablePrograms, WithoutAdviceACheckTellsErrorsAlone) {
  const auto findings = [this](const std::string& source, bool advice) {
    return Must(Check(source, advice)).motion.findings.size();
  };
  const std::string doubtful = "COORD ABSOL\nMOVE (4000.,0.,0.,0.,0.)\n";
  EXPECT_EQ(findings(doubtful, true), 1U);
  EXPECT_EQ(findings(doubtful, false), 0U);
  const std::string missing = "COORD ABSOL\nPATH LIN\nSPEED 10\nCALL 77\n";
  EXPECT_EQ(findings(missing, true), 1U);
  EXPECT_EQ(findings(missing, false), 1U);
}

// The disk is full in the middle of a content.
class NarrowWriter final : public storage::BlobWriter {
 public:
  Status Append(std::string_view) override {
    return Error{ErrorCode::kCellStoreFailed, "the disk is full", {}};
  }
  Result<storage::WallTime> Finish(std::chrono::milliseconds) override {
    return storage::WallTime();
  }
};
class NarrowStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<std::unique_ptr<storage::BlobWriter>> WriteBlob(std::string_view, std::size_t) override {
    return std::unique_ptr<storage::BlobWriter>(std::make_unique<NarrowWriter>());
  }
};

TEST_F(UnreadablePrograms, AnUploadEndsWithThatWhichItsBytesMet) {
  NarrowStore narrow(bed.store());
  ContentUpload upload(narrow, programs);
  Must(upload.Begin(-1, {}));
  Must(upload.Add("text"));
  EXPECT_EQ(CodeOf(upload.End()), ErrorCode::kCellStoreFailed);
}

}  // namespace
}  // namespace rmlcell::server
