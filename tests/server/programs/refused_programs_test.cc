// What is asked of stored programs in vain, each with its own code.
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/programs/memory_tools.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/programs/program_views_bed.h"

namespace rmlcell::server {
namespace {

class RefusedPrograms : public ProgramViewsBed {
 protected:
  static std::string Name(int number, const std::string& machine = "optimo-1") {
    return "machines/" + machine + "/programs/" + std::to_string(number);
  }
  void Put(int slot, const std::string& object, const std::string& machine = "optimo-1") {
    Must(bed.store().PutPrograms(machine, {{.slot = slot, .object = object}}, {}));
  }
  std::optional<ErrorCode> Store(ProgramBook::Put put) {
    const auto stored = programs.Store(std::move(put));
    return stored ? std::nullopt : std::optional(stored.error.error.code);
  }
  std::optional<ErrorCode> Delete(int number, const std::string& etag = {}) {
    v1::DeleteProgramRequest request;
    request.set_name(Name(number));
    request.set_etag(etag);
    return CodeOf(programs.Delete(request, "anna"));
  }
  std::optional<ErrorCode> Translated(const std::string& machine) {
    v1::ProgramText text;
    text.set_file_name("44.S");
    text.set_content("STOP\n");
    return CodeOf(programs.Translate({}, machine, text, true));
  }

  MemoryTools tools{bed.store(), programs};
};

// OPT-1.10: programs have 1 to 99; an executable is looked at by its object.
TEST_F(RefusedPrograms, WhatCannotBeLookedAt) {
  Put(45, ObjectOf("STOP\n"));
  const std::vector<std::pair<std::string, std::optional<ErrorCode>>> cases = {
      {Name(45), std::nullopt},
      {Name(46), ErrorCode::kProgramMissing},
      {Name(145), ErrorCode::kProgramNumber},
      {"programs/45", ErrorCode::kCellInvalidArgument}};
  for (const auto& [name, code] : cases) {
    EXPECT_EQ(Picture(name), code) << name;
    EXPECT_EQ(Path(name), code) << name;
  }
}

// OPT-B.08: parameters that no machine has, as a later version may have stored them.
TEST_F(RefusedPrograms, OnAMachineWhoseParametersAreNone) {
  Must(bed.store().PutMachine({.id = "strange", .family = "optimo", .parameters = {{"NONE", "1"}}},
                              0));
  Put(45, ObjectOf("STOP\n"), "strange");
  EXPECT_NE(Picture(Name(45, "strange")), std::nullopt);
  EXPECT_NE(Path(Name(45, "strange")), std::nullopt);
  EXPECT_NE(Translated("machines/strange"), std::nullopt);
  EXPECT_NE(Store({.name = Name(46, "strange"), .file_name = "a.S", .bytes = "STOP\n"}),
            std::nullopt);
}

// A later version may have stored a machine whose family nobody knows here.
TEST_F(RefusedPrograms, OnAMachineOfNoFamily) {
  Must(bed.store().PutMachine({.id = "odd", .family = "lathe"}, 0));
  EXPECT_EQ(Translated("machines/odd"), ErrorCode::kCellUnknownFamily);
  v1::ProgramText text;
  text.set_file_name("44.S");
  text.set_content("STOP\n");
  EXPECT_EQ(CodeOf(programs.Check({}, "machines/odd", text, true)), ErrorCode::kCellUnknownFamily);
}

// OPT-1.15: where there is no object there is no executable, whatever etag it is said to have.
TEST_F(RefusedPrograms, AnExecutableOfAnEmptySlotIsMissing) {
  EXPECT_EQ(Delete(146, "7"), ErrorCode::kProgramMissing);
  EXPECT_EQ(Delete(146), ErrorCode::kProgramMissing);
}

// OPT-1.08: what is in the slot is no object, whichever of its forms is asked for.
TEST_F(RefusedPrograms, OfAnObjectThatIsNone) {
  Put(45, "no object");
  for (const v1::ProgramForm form : {v1::PROGRAM_FORM_SOURCE, v1::PROGRAM_FORM_LISTING})
    EXPECT_EQ(CodeOf(programs.Read(Name(45), form)), ErrorCode::kObjectCorrupt) << form;
  EXPECT_EQ(Must(programs.Read(Name(45), v1::PROGRAM_FORM_OBJECT)).bytes, "no object");
}

TEST_F(RefusedPrograms, OfNamesAndEtagsThatAreNone) {
  Put(45, ObjectOf("STOP\n"));
  v1::ListProgramsRequest list;
  list.set_parent("optimo-1");
  EXPECT_EQ(CodeOf(programs.List(list)), ErrorCode::kCellInvalidArgument);
  v1::ListStaleExecutablesRequest stale;
  stale.set_parent("optimo-1");
  EXPECT_EQ(CodeOf(tools.ListStale(stale)), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(Translated("optimo-1"), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(Translated("machines/optimo-1"), std::nullopt);
  EXPECT_EQ(Delete(45, "junk"), ErrorCode::kCellEtagMismatch);
  EXPECT_EQ(Must(programs.Get(Name(45))).etag(), "1");
}

// OPT-4.63: what a run is in is not deleted; its executable and other programs are.
TEST_F(RefusedPrograms, AProgramThatARunIsInStays) {
  Put(45, ObjectOf("STOP\n"));
  Put(46, ObjectOf("STOP\n"));
  programs.OnInUse(
      [](const std::string& machine, int slot) { return machine == "optimo-1" && slot == 45; });
  EXPECT_EQ(Delete(45), ErrorCode::kProgramInUse);
  EXPECT_EQ(CodeOf(programs.Get(Name(45))), std::nullopt);
  EXPECT_EQ(Delete(46), std::nullopt);
  EXPECT_EQ(CodeOf(programs.Get(Name(46))), ErrorCode::kProgramMissing);
}

// OPT-B.73: objects and executables share the memory, to its last byte; so says a trial.
TEST_F(RefusedPrograms, ATrialOfAnExecutableLooksForItsRoom) {
  constexpr std::size_t kMemory = 100'000;
  const std::string object = ObjectOf("STOP\n");
  const std::string executable = ExecutableOf(45, "STOP\n");
  ASSERT_LT(object.size() + executable.size(), kMemory);
  storage::MachineRecord machine = Must(bed.store().GetMachine("optimo-1"));
  machine.parameters = {{"CMOS_SIZE", std::to_string(kMemory)}};
  Must(bed.store().PutMachine(machine, storage::kAnyRevision));
  Put(45, object);
  const std::size_t left = kMemory - object.size() - executable.size();
  const auto tried = [&] {
    return Store({.name = Name(145), .bytes = executable, .validate_only = true});
  };
  Put(46, std::string(left, 'o'));
  EXPECT_EQ(tried(), std::nullopt);
  Put(46, std::string(left + 1, 'o'));
  EXPECT_EQ(tried(), ErrorCode::kCmosFull);
}

}  // namespace
}  // namespace rmlcell::server
