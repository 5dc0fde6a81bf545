// Whichever call to the store fails in the middle of something, its error is what the caller hears.
#include <gtest/gtest.h>

#include "server/base/config.h"
#include "server/programs/program_book.h"
#include "server/projects/project_book.h"
#include "server/projects/project_transfer.h"
#include "tests/server/failing_store.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class ProjectFailures : public testing::Test {
 protected:
  template <class T>
  static std::optional<ErrorCode> Code(const ProgramResult<T>& result) {
    return result ? std::nullopt : std::optional(result.error.error.code);
  }
  void Expect(const std::string& what, int calls,
              const std::function<std::optional<ErrorCode>()>& operation) {
    ExpectFailuresHandedOn(store, what, calls, operation);
  }
  static v1::CreateProjectRequest Creation(const std::string& id) {
    v1::CreateProjectRequest request;
    request.set_project_id(id);
    v1::ProjectProgram& program = *request.mutable_project()->add_programs();
    program.set_slot(45);
    program.mutable_source()->set_file_name("45.S");
    program.mutable_source()->set_content("STOP\n");
    return request;
  }
  v1::TransferProjectRequest Transfer(const std::string& machine) {
    v1::TransferProjectRequest request;
    request.set_name("projects/lid");
    request.set_machine(machine);
    return request;
  }

  ServerBed bed;
  FailingStore store{bed.store()};
  ProjectBook book{store};
  Config config;
  ProgramBook programs{store, config};
  ProjectTransfer transfer{store, book, programs};
};

TEST_F(ProjectFailures, AreHandedOn) {
  v1::CreateProjectRequest create = Creation("lid");
  create.set_validate_only(true);
  Expect("asking whether it can be created", 1, [&] { return Code(book.Create(create, "anna")); });
  create.set_validate_only(false);
  Expect("creating", 1, [&] { return Code(book.Create(create, "anna")); });
  Expect("getting", 1, [&] { return CodeOf(book.Get("projects/lid")); });
  Expect("listing", 1, [&] { return CodeOf(book.List({})); });
  Expect("updating", 2, [&] {
    v1::UpdateProjectRequest request;
    request.mutable_project()->set_name("projects/lid");
    request.mutable_project()->set_title("Lid");
    return Code(book.Update(request, "anna"));
  });
  Expect("transferring", 4,
         [&] { return Code(transfer.ToMachine(Transfer("machines/optimo-1"), "anna")); });
  Expect("deleting", 1, [&]() -> std::optional<ErrorCode> {
    v1::DeleteProjectRequest request;
    request.set_name("projects/lid");
    const Status deleted = book.Delete(request, "anna");
    return deleted ? std::nullopt : std::optional(deleted.error().code);
  });
}

// A store that a later version has written to may have machines of families unknown here.
TEST_F(ProjectFailures, AMachineThatThisServerDoesNotKnow) {
  ASSERT_TRUE(book.Create(Creation("lid"), "anna"));
  Must(bed.store().PutMachine({.id = "odd", .family = "lathe"}, 0));
  Must(bed.store().PutMachine({.id = "strange", .family = "optimo", .parameters = {{"NONE", "1"}}},
                              0));
  EXPECT_EQ(Code(transfer.ToMachine(Transfer("machines/odd"), "anna")),
            ErrorCode::kCellUnknownFamily);
  EXPECT_NE(Code(transfer.ToMachine(Transfer("machines/strange"), "anna")), std::nullopt);
  EXPECT_EQ(Code(transfer.ToMachine(Transfer("machines/none"), "anna")),
            ErrorCode::kCellUnknownMachine);
  EXPECT_EQ(Code(transfer.ToMachine(Transfer("none"), "anna")), ErrorCode::kCellInvalidArgument);
}

// With its schedules, and the other way: the machine is read twice and must be the same.
TEST_F(ProjectFailures, OfSchedulesAndOfTheWayBack) {
  v1::CreateProjectRequest create = Creation("lid");
  v1::ProjectLaserSchedule& schedule = *create.mutable_project()->add_laser_schedules();
  schedule.set_number(7);
  schedule.set_mode(v1::LASER_MODE_CW);
  schedule.set_power_percent(40.0);
  ASSERT_TRUE(book.Create(create, "anna"));
  Expect("transferring schedules", 6,
         [&] { return Code(transfer.ToMachine(Transfer("machines/optimo-1"), "anna")); });
  v1::TransferProjectFromMachineRequest back;
  back.set_machine("machines/optimo-1");
  back.set_project_id("back");
  back.set_validate_only(true);
  const auto taken = [&] {
    return Code(transfer.FromMachine(back, "Thu Mar 04 08:52:34 1993", "anna"));
  };
  Expect("taking it back", 7, taken);
  EXPECT_EQ(CodeOf(bed.store().GetProject("back")), ErrorCode::kCellNotFound);  // it was asked only
  back.set_machine("optimo-1");
  EXPECT_EQ(taken(), ErrorCode::kCellInvalidArgument);
}

// What is told of a project is what the store says that it keeps.
class GarbledStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<storage::ProjectRecord> PutProject(const storage::ProjectRecord& project,
                                            storage::Revision expected,
                                            std::string_view caller) override {
    auto kept = store_.PutProject(project, expected, caller);
    if (kept) kept->body = "\xFF\xFF";
    return kept;
  }
};

TEST_F(ProjectFailures, OfAnAnswerThatCannotBeRead) {
  GarbledStore garbled(bed.store());
  ProjectBook another(garbled);
  EXPECT_EQ(Code(another.Create(Creation("lid"), "anna")), ErrorCode::kCellStoreCorrupt);
}

// Lists have the names of files, of targets as well, and not their bytes.
TEST_F(ProjectFailures, BytesOfTargetsAreLeftOutOfLists) {
  v1::Project project;
  for (int slot = 1; slot <= 3; ++slot) {
    v1::ProjectProgram& program = *project.add_programs();
    program.set_slot(slot);
    program.mutable_source()->set_content("PU;");
    if (slot == 3) continue;
    v1::MillTarget& target = *program.mutable_milling()->mutable_target();
    if (slot == 1) {
      target.mutable_file()->set_file_name("a.stl");
      target.mutable_file()->set_content("solid");
    } else {
      target.mutable_inline_program()->set_file_name("a.rml");
      target.mutable_inline_program()->set_content("PD;");
    }
  }
  const v1::Project bare = WithoutContent(project);
  for (const v1::ProjectProgram& program : bare.programs()) {
    EXPECT_EQ(program.source().content(), "");
    const v1::MillTarget& target = program.milling().target();
    EXPECT_EQ(target.file().content() + target.inline_program().content(), "");
  }
  EXPECT_EQ(bare.programs(0).milling().target().file().file_name(), "a.stl");
  EXPECT_EQ(bare.programs(1).milling().target().inline_program().file_name(), "a.rml");
  EXPECT_FALSE(bare.programs(2).has_milling());  // as it was
}

}  // namespace
}  // namespace rmlcell::server
