#include "server/projects/project_book.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "server/base/config.h"
#include "server/programs/program_book.h"
#include "server/projects/project_transfer.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using storage::CodeOf;
template <class T>
std::optional<ErrorCode> CodeOf(const ProgramResult<T>& result) {
  return result ? std::nullopt : std::optional(result.error.error.code);
}
using storage::Must;
template <class T>
T Must(ProgramResult<T> result) {
  if (!result) ADD_FAILURE() << result.error.error.detail;
  return *std::move(result.value);
}
constexpr auto kInvalid = ErrorCode::kCellInvalidArgument;

class ProjectBookTest : public testing::Test {
 protected:
  static void Add(v1::Project& project, int slot, const std::string& source,
                  const std::string& name = {}) {
    v1::ProjectProgram& program = *project.add_programs();
    program.set_slot(slot);
    program.set_title("p" + std::to_string(slot));
    program.mutable_source()->set_file_name(name.empty() ? std::to_string(slot) + ".S" : name);
    program.mutable_source()->set_content(source);
  }
  static void AddSchedule(v1::Project& project, int number) {
    v1::ProjectLaserSchedule& schedule = *project.add_laser_schedules();
    schedule.set_number(number);
    schedule.set_title("s" + std::to_string(number));
    schedule.set_power_percent(50.0);
  }
  static void Define(v1::Project& project, int kind, int number,
                     std::initializer_list<double> values) {
    v1::ProjectProcess& process = *project.add_processes();
    process.set_kind(kind);
    process.set_process(number);
    for (const double value : values) process.add_values(value);
  }
  ProgramResult<v1::Project> Create(const std::string& id, const v1::Project& project,
                                    bool validate_only = false) {
    v1::CreateProjectRequest request;
    request.set_project_id(id);
    *request.mutable_project() = project;
    request.set_validate_only(validate_only);
    return book.Create(request, "anna");
  }
  ProgramResult<v1::TransferProjectResponse> Transfer(const std::string& id, bool insert = false,
                                                      bool validate_only = false) {
    v1::TransferProjectRequest request;
    request.set_name("projects/" + id);
    request.set_machine("machines/optimo-1");
    request.set_insert_missing_definitions(insert);
    request.set_validate_only(validate_only);
    return transfer.ToMachine(request, "anna");
  }
  std::size_t Programs() { return Must(bed.store().ListPrograms("optimo-1", 0, 100)).size(); }

  ServerBed bed;
  ProjectBook book{bed.store()};
  Config config;
  ProgramBook programs{bed.store(), config};
  ProjectTransfer transfer{bed.store(), book, programs};
};

TEST_F(ProjectBookTest, KeepsAllThatAProjectHas) {
  v1::Project project;
  project.set_title("Bracket");
  project.set_notes("clamp it twice");
  Add(project, 45, "STOP\n");
  AddSchedule(project, 11);
  Define(project, 1, 3, {6.5, 80, 1.5, 95});
  const v1::Project created = Must(Create("bracket", project));
  EXPECT_EQ(created.name(), "projects/bracket");
  EXPECT_FALSE(created.etag().empty());
  v1::Project got = Must(book.Get("projects/bracket"));
  EXPECT_EQ(got.SerializeAsString(), created.SerializeAsString());
  EXPECT_EQ(got.notes(), "clamp it twice");
  EXPECT_EQ(got.programs(0).source().content(), "STOP\n");
  EXPECT_EQ(got.laser_schedules(0).power_percent(), 50.0);
  EXPECT_EQ(got.processes(0).values_size(), 4);
  EXPECT_EQ(CodeOf(book.Get("projects/none")), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(book.Get("bracket")), kInvalid);
}

TEST_F(ProjectBookTest, AnIdIsTakenOnce) {
  ASSERT_TRUE(Create("a", {}));
  EXPECT_EQ(CodeOf(Create("a", {})), ErrorCode::kCellAlreadyExists);
  EXPECT_EQ(CodeOf(Create("a", {}, true)), ErrorCode::kCellAlreadyExists);
  EXPECT_EQ(CodeOf(Create("A", {})), kInvalid);
  EXPECT_EQ(CodeOf(Create("", {})), kInvalid);
  EXPECT_TRUE(Create("b", {}, true));
  EXPECT_EQ(CodeOf(book.Get("projects/b")), ErrorCode::kCellNotFound);  // it was asked only
}

// OPT-1.10, OPT-3.02, OPT-3.44, and what the API says of a project.
TEST_F(ProjectBookTest, ChecksItsPartsBeforeItIsKept) {
  using Change = std::function<void(v1::Project&)>;
  const std::vector<std::tuple<std::string, ErrorCode, Change>> cases = {
      {"long title", kInvalid, [](auto& p) { p.set_title(std::string(201, 't')); }},
      {"long notes", kInvalid, [](auto& p) { p.set_notes(std::string((64 << 10) + 1, 'n')); }},
      {"long title of a program", kInvalid,
       [](auto& p) {
         Add(p, 1, "STOP\n"), p.mutable_programs(0)->set_title(std::string(201, 't'));
       }},
      {"long title of a schedule", kInvalid,
       [](auto& p) {
         AddSchedule(p, 1), p.mutable_laser_schedules(0)->set_title(std::string(201, 't'));
       }},
      {"slot 0", ErrorCode::kProgramNumber, [](auto& p) { Add(p, 0, "STOP\n"); }},
      {"slot 100", ErrorCode::kProgramNumber, [](auto& p) { Add(p, 100, "STOP\n"); }},
      {"slot twice", ErrorCode::kProjectDuplicate,
       [](auto& p) { Add(p, 9, "STOP\n"), Add(p, 9, "STOP\n"); }},
      {"no source", ErrorCode::kProjectSource, [](auto& p) { Add(p, 9, ""); }},
      {"schedule 0", ErrorCode::kScheduleRange, [](auto& p) { AddSchedule(p, 0); }},
      {"schedule 64", ErrorCode::kScheduleRange, [](auto& p) { AddSchedule(p, 64); }},
      {"schedule twice", kInvalid, [](auto& p) { AddSchedule(p, 1), AddSchedule(p, 1); }},
      {"mode", kInvalid,
       [](auto& p) {
         AddSchedule(p, 1), p.mutable_laser_schedules(0)->set_mode(static_cast<v1::LaserMode>(9));
       }},
      {"power 101", kInvalid,
       [](auto& p) { AddSchedule(p, 1), p.mutable_laser_schedules(0)->set_power_percent(100.5); }},
      {"power NaN", kInvalid,
       [](auto& p) {
         AddSchedule(p, 1), p.mutable_laser_schedules(0)->set_power_percent(std::nan(""));
       }},
      {"process 3,0", ErrorCode::kProcessNumber, [](auto& p) { Define(p, 3, 0, {}); }},
      {"process 0,10", ErrorCode::kProcessNumber, [](auto& p) { Define(p, 0, 10, {}); }},
      {"process twice", ErrorCode::kProjectDuplicate,
       [](auto& p) { Define(p, 0, 1, {}), Define(p, 0, 1, {}); }},
  };
  ASSERT_TRUE(Create("kept", {}));
  for (const auto& [what, code, change] : cases) {
    v1::Project project;
    change(project);
    EXPECT_EQ(CodeOf(Create("new", project)), code) << what;
    v1::UpdateProjectRequest update;
    *update.mutable_project() = project;
    update.mutable_project()->set_name("projects/kept");
    EXPECT_EQ(CodeOf(book.Update(update, "anna")), code) << what;
  }
  EXPECT_EQ(CodeOf(book.Get("projects/new")), ErrorCode::kCellNotFound);
  EXPECT_EQ(Must(book.Get("projects/kept")).etag(), "1");
}

// OPT-3.03, OPT-3.04, OPT-3.06, OPT-3.08: a definition is checked when it is kept, not when it is
// needed.
TEST_F(ProjectBookTest, ChecksTheDefinitionsOfItsProcesses) {
  const std::vector<std::tuple<int, std::initializer_list<double>, ErrorCode>> cases = {
      {0, {1.0}, ErrorCode::kArgumentCount},
      {1, {6.5, 80.0, 1.5}, ErrorCode::kArgumentCount},
      {1, {6.5, 80.0, 1.5, 95.0, 1.0, 1.0}, ErrorCode::kArgumentCount},
      {2, {}, ErrorCode::kArgumentCount},
      {2, {64.0}, ErrorCode::kScheduleRange},
      {1, {0.0, 80.0, 1.5, 95.0}, ErrorCode::kLiteralRange},
      {1, {6.5, 100.5, 1.5, 95.0}, ErrorCode::kLiteralRange},
      {1, {6.5, 80.0, -1.0, 95.0}, ErrorCode::kLiteralRange},
      {1, {6.5, 80.0, 1.5, std::nan("")}, ErrorCode::kLiteralRange},
  };
  for (const auto& [kind, values, code] : cases) {
    v1::Project project;
    Define(project, 0, 4, {});
    Define(project, kind, 3, values);
    const auto made = Create("new", project);
    EXPECT_EQ(CodeOf(made), code) << kind << ", " << values.size() << " values";
    ASSERT_EQ(made.error.diagnostics.size(), 1U);
    EXPECT_THAT(made.error.error.detail, testing::HasSubstr(std::to_string(kind) + ",3"));
  }
  v1::Project good;
  Define(good, 1, 3, {100.0, 0.0, 0.0, 100.0, 63.0});
  Define(good, 2, 3, {63.0});
  EXPECT_TRUE(Create("good", good));
}

TEST_F(ProjectBookTest, AnUpdateChangesWhatItsMaskNames) {
  v1::Project project;
  project.set_title("old");
  project.set_notes("old");
  Add(project, 45, "STOP\n");
  const v1::Project first = Must(Create("a", project));
  v1::UpdateProjectRequest update;
  update.mutable_project()->set_name("projects/a");
  update.mutable_project()->set_title("new");
  update.mutable_project()->set_etag(first.etag());
  update.mutable_update_mask()->add_paths("title");
  update.set_validate_only(true);
  EXPECT_EQ(Must(book.Update(update, "anna")).title(), "new");
  EXPECT_EQ(Must(book.Get("projects/a")).title(), "old");
  update.set_validate_only(false);
  const v1::Project second = Must(book.Update(update, "anna"));
  EXPECT_EQ(second.title(), "new");
  EXPECT_EQ(second.notes(), "old");
  EXPECT_EQ(second.programs_size(), 1);
  EXPECT_NE(second.etag(), first.etag());
  for (const bool validate_only : {true, false}) {  // the etag is of before
    update.set_validate_only(validate_only);
    EXPECT_EQ(CodeOf(book.Update(update, "anna")), ErrorCode::kCellEtagMismatch);
  }
  update.mutable_project()->clear_etag();
  update.clear_update_mask();  // what has a value
  update.mutable_project()->set_title("third");
  AddSchedule(*update.mutable_project(), 11);
  const v1::Project third = Must(book.Update(update, "anna"));
  EXPECT_EQ(third.title(), "third");
  EXPECT_EQ(third.laser_schedules_size(), 1);
  EXPECT_EQ(third.notes(), "old");
  EXPECT_EQ(third.programs_size(), 1);
  update.mutable_update_mask()->add_paths("notes");  // named, and empty
  EXPECT_EQ(Must(book.Update(update, "anna")).notes(), "");
  update.mutable_project()->clear_laser_schedules();
  *update.mutable_update_mask()->mutable_paths(0) = "*";  // all of it
  const v1::Project fourth = Must(book.Update(update, "anna"));
  EXPECT_EQ(fourth.title(), "third");
  EXPECT_EQ(fourth.laser_schedules_size(), 0);
  EXPECT_EQ(fourth.programs_size(), 0);
  update.mutable_update_mask()->add_paths("colour");
  EXPECT_EQ(CodeOf(book.Update(update, "anna")), kInvalid);
  update.mutable_project()->set_name("projects/none");
  update.clear_update_mask();
  EXPECT_EQ(CodeOf(book.Update(update, "anna")), ErrorCode::kCellNotFound);
}

TEST_F(ProjectBookTest, OfManyUpdatesWithTheSameEtagOneWins) {
  const std::string etag = Must(Create("a", {})).etag();
  std::atomic<int> won = 0;
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 8; ++i) {
      threads.emplace_back([&, i] {
        v1::UpdateProjectRequest update;
        update.mutable_project()->set_name("projects/a");
        update.mutable_project()->set_etag(etag);
        update.mutable_project()->set_title(std::to_string(i));
        const auto updated = book.Update(update, "anna");
        if (updated) {
          ++won;
        } else {
          EXPECT_EQ(CodeOf(updated), ErrorCode::kCellEtagMismatch);
        }
      });
    }
  }
  EXPECT_EQ(won, 1);
}

TEST_F(ProjectBookTest, DeletesAndListsInPages) {
  for (const std::string id : {"c", "a", "b"}) {
    v1::Project project;
    Add(project, 1, "STOP\n");
    Must(Create(id, project));
  }
  v1::ListProjectsRequest request;
  request.set_page_size(2);
  const v1::ListProjectsResponse first = Must(book.List(request));
  ASSERT_EQ(first.projects_size(), 2);
  EXPECT_EQ(first.projects(0).name(), "projects/a");
  EXPECT_EQ(first.projects(0).programs(0).source().content(), "");  // without sources
  request.set_page_token(first.next_page_token());
  const v1::ListProjectsResponse second = Must(book.List(request));
  ASSERT_EQ(second.projects_size(), 1);
  EXPECT_EQ(second.projects(0).name(), "projects/c");
  EXPECT_EQ(second.next_page_token(), "");
  request.set_page_token("No token!");
  EXPECT_EQ(CodeOf(book.List(request)), ErrorCode::kCellBadPageToken);
  request.clear_page_token();
  request.set_page_size(-1);
  EXPECT_EQ(CodeOf(book.List(request)), kInvalid);

  v1::DeleteProjectRequest remove;
  remove.set_name("projects/b");
  remove.set_etag("99");
  EXPECT_EQ(book.Delete(remove, "anna").error().code, ErrorCode::kCellEtagMismatch);
  remove.clear_etag();
  EXPECT_TRUE(book.Delete(remove, "anna"));
  EXPECT_EQ(book.Delete(remove, "anna").error().code, ErrorCode::kCellNotFound);
}

// The family follows from the file name: a mill would take the text of a laser program for a
// stream.
TEST_F(ProjectBookTest, ATransferTakesNoProgramOfAnotherFamily) {
  v1::Project project;
  Add(project, 10, "PU;", "10.rml");
  Add(project, 11, "SPEED 10\nSPEED 200\n");
  Must(Create("f", project));
  v1::TransferProjectRequest request;
  request.set_name("projects/f");
  request.set_machine("machines/mill-1");
  const auto refused = transfer.ToMachine(request, "anna");
  EXPECT_EQ(CodeOf(refused), kInvalid);
  EXPECT_THAT(refused.error.error.detail,
              testing::HasSubstr("program 11: 11.S is a program for Amada OPTIMO"));
  EXPECT_EQ(Must(bed.store().ListPrograms("mill-1", 0, 100)).size(), 0U);
  request.set_machine("machines/optimo-1");
  EXPECT_THAT(transfer.ToMachine(request, "anna").error.error.detail,
              testing::HasSubstr("program 10: 10.rml is a program for Roland"));
  EXPECT_EQ(Programs(), 0U);

  v1::Project mill;
  Add(mill, 10, "PU;", "10.rml");
  Add(mill, 11, "PU;", "outline");  // no extension of anybody's
  Must(Create("mill", mill));
  request.set_name("projects/mill");
  request.set_machine("machines/mill-1");
  EXPECT_EQ(Must(transfer.ToMachine(request, "anna")).items_size(), 2);
}

// A stream is its own object, and has no second text beside it.
TEST_F(ProjectBookTest, AStreamThatAProjectBringsIsKeptOnce) {
  v1::Project mill;
  Add(mill, 10, "PU;", "10.rml");
  Must(Create("mill", mill));
  v1::TransferProjectRequest request;
  request.set_name("projects/mill");
  request.set_machine("machines/mill-1");
  const v1::TransferProjectResponse brought = Must(transfer.ToMachine(request, "anna"));
  ASSERT_EQ(brought.items_size(), 1);
  EXPECT_FALSE(brought.items(0).program_after().has_source_bytes());
  const storage::ProgramRecord kept = Must(bed.store().GetProgram("mill-1", 10));
  EXPECT_EQ(kept.object, "PU;");
  EXPECT_EQ(kept.source, std::nullopt);
  EXPECT_EQ(kept.source_name, "10.rml");
}

// Issue "Projects": compiled, and put into slots together with the schedules.
TEST_F(ProjectBookTest, ATransferStoresProgramsAndSchedulesTogether) {
  v1::Project project;
  Add(project, 45, "WORKDEF 2,0 (11)\nSTOP\n");
  Add(project, 46, "SPEED 5\nSTOP\n");
  AddSchedule(project, 11);
  Must(Create("a", project));
  const auto asked = Transfer("a", false, true);
  ASSERT_TRUE(asked);
  EXPECT_EQ(asked.value->items_size(), 3);
  EXPECT_EQ(Programs(), 0U);
  const auto done = Transfer("a");
  ASSERT_TRUE(done) << done.error.error.detail;
  ASSERT_EQ(done.value->items_size(), 3);
  EXPECT_EQ(done.value->items(1).program_after().name(), "machines/optimo-1/programs/46");
  EXPECT_EQ(done.value->items(1).program_after().title(), "p46");
  EXPECT_EQ(done.value->items(1).program_after().etag(), "1");
  EXPECT_EQ(done.value->items(1).program_after().object_bytes(),
            static_cast<std::int64_t>(ObjectOf("SPEED 5\nSTOP\n").size()));
  const storage::ProgramSummary summary = Must(bed.store().GetProgramSummary("optimo-1", 46));
  EXPECT_EQ(done.value->items(1).program_after().object_sha256(), summary.object_sha256);
  EXPECT_EQ(summary.source_name, "46.S");
  const storage::ProgramRecord program = Must(bed.store().GetProgram("optimo-1", 46));
  EXPECT_EQ(program.object, ObjectOf("SPEED 5\nSTOP\n"));
  EXPECT_EQ(program.source, "SPEED 5\nSTOP\n");
  EXPECT_EQ(program.name, "p46");
  const auto schedules = Must(bed.store().ListSchedules("optimo-1"));
  ASSERT_EQ(schedules.size(), 1U);
  EXPECT_EQ(schedules[0].number, 11);
  EXPECT_EQ(schedules[0].name, "s11");
  EXPECT_EQ(schedules[0].mode, "CW");
  EXPECT_EQ(schedules[0].power_percent, 50.0);
}

// OPT-8.71: one program with an error leaves the control as it was.
TEST_F(ProjectBookTest, ATransferIsAllOrNothing) {
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 45, .object = "before"}}, {}));
  Must(bed.store().PutExecutable("optimo-1", 45, 1, "executable before"));
  v1::Project project;
  Add(project, 45, "STOP\n");
  Add(project, 46, "SPEED 101\n");
  Add(project, 47, "STOP\n");
  AddSchedule(project, 11);
  Must(Create("a", project));
  const auto done = Transfer("a");
  EXPECT_EQ(CodeOf(done), ErrorCode::kLiteralRange);
  EXPECT_THAT(done.error.error.detail, testing::StartsWith("program 46: "));
  ASSERT_EQ(done.error.diagnostics.size(), 1U);
  EXPECT_EQ(done.error.diagnostics[0].where.line, 1);
  EXPECT_EQ(Programs(), 1U);
  EXPECT_EQ(Must(bed.store().GetProgram("optimo-1", 45)).object, "before");
  EXPECT_EQ(Must(bed.store().GetProgram("optimo-1", 45)).executable, "executable before");
  EXPECT_TRUE(Must(bed.store().ListSchedules("optimo-1")).empty());
}

// OPT-1.12, OPT-1.13: a transfer alters the objects that it brings, and no others.
TEST_F(ProjectBookTest, ATransferDeletesTheExecutablesOfWhatItBrings) {
  Must(bed.store().PutPrograms("optimo-1",
                               {{.slot = 45, .object = "a"}, {.slot = 60, .object = "b"}}, {}));
  Must(bed.store().PutExecutable("optimo-1", 45, 1, "x"));
  Must(bed.store().PutExecutable("optimo-1", 60, 1, "y"));
  v1::Project project;
  Add(project, 45, "STOP\n");
  Must(Create("a", project));
  ASSERT_TRUE(Transfer("a"));
  EXPECT_EQ(Must(bed.store().GetProgram("optimo-1", 45)).executable, std::nullopt);
  EXPECT_EQ(Must(bed.store().GetProgram("optimo-1", 60)).executable, "y");
}

// OPT-8.72, OPT-8.69: inch by the extension or by the word of the project.
TEST_F(ProjectBookTest, InchProgramsAreConverted) {
  v1::Project project;
  Add(project, 45, "PATH HOLE (.5)\n", "45.SI");
  Add(project, 46, "PATH HOLE (.5)\n", "46.si");
  Add(project, 47, "PATH HOLE (.5)\n", "47.Si");
  Add(project, 48, "PATH HOLE (.5)\n", "48.S");
  project.mutable_programs(3)->set_units(v1::UNITS_INCH);
  Add(project, 49, "PATH HOLE (.5)\n", "49.sI");
  Add(project, 50, "PATH HOLE (12.7)\n", "50.S");
  Must(Create("a", project));
  const auto done = Transfer("a");
  ASSERT_TRUE(done) << done.error.error.detail;
  const std::string object = ObjectOf("PATH HOLE (12.7)\n");
  for (int slot = 45; slot <= 50; ++slot) {
    EXPECT_EQ(Must(bed.store().GetProgram("optimo-1", slot)).object, object) << slot;
  }
}

// OPT-8.70, OPT-8.72: the programmer gets his own text back, under a name that tells its units. A
// text that the transfer had to write is metric, whatever the name in the project says.
TEST_F(ProjectBookTest, TheStoredSourceIsThatOfTheProgrammer) {
  v1::Project project;
  Add(project, 45, "PATH HOLE (.5)  ; inches\n", "45.SI");
  Add(project, 46, "PATH HOLE (.5)  ; inches\n", "46.S");
  project.mutable_programs(1)->set_units(v1::UNITS_INCH);
  Add(project, 47, "path hole (12.7)  ; mm\n", "47.S");
  Add(project, 48, "WORK 1,3 /ON\nWORK 1,3 /OFF\n", "48.SI");
  Define(project, 1, 3, {6.5, 80, 1.5, 95});
  Must(Create("a", project));
  ASSERT_TRUE(Transfer("a", true));
  const auto source = [&](int slot) { return Must(bed.store().GetProgram("optimo-1", slot)); };
  EXPECT_EQ(source(45).source, "PATH HOLE (.5)  ; inches\n");
  EXPECT_EQ(source(45).source_name, "45.SI");
  EXPECT_EQ(source(46).source, "PATH HOLE (12.7)  ; inches\n");
  EXPECT_EQ(source(46).source_name, "46.S");
  EXPECT_EQ(source(47).source, "path hole (12.7)  ; mm\n");
  EXPECT_THAT(source(48).source.value(), testing::HasSubstr("WORKDEF 1,3"));
  EXPECT_EQ(source(48).source_name, "48.S");
}

// OPT-3.09, OPT-3.11: differences are told, a WORK with neither is refused, a missing one is
// inserted.
TEST_F(ProjectBookTest, ProcessDefinitionsAreComparedAndInserted) {
  v1::Project project;
  Add(project, 45, "WORKDEF 1,0 (6.5, 81., 1.5, 95.)\nSTOP\n");
  Define(project, 1, 0, {6.5, 80, 1.5, 95});
  Must(Create("differs", project));
  const auto differs = Transfer("differs");
  ASSERT_TRUE(differs);
  ASSERT_EQ(differs.value->findings().diagnostics_size(), 1);
  EXPECT_EQ(differs.value->findings().diagnostics(0).code(), CodeText(ErrorCode::kProjectProcess));

  v1::Project missing;
  Add(missing, 50, "WORK 1,3 /ON\nWORK 1,3 /OFF\n");
  Must(Create("missing", missing));
  EXPECT_EQ(CodeOf(Transfer("missing")), ErrorCode::kWorkdefMissing);

  v1::Project inserted = missing;
  Define(inserted, 1, 3, {6.5, 80, 1.5, 95});
  Must(Create("inserted", inserted));
  ASSERT_TRUE(Transfer("inserted", true));
  EXPECT_EQ(Must(bed.store().GetProgram("optimo-1", 50)).object,
            ObjectOf("WORKDEF 1,3 (6.5, 80.0, 1.5, 95.0)\nWORK 1,3 /ON\nWORK 1,3 /OFF\n"));
}

// Issue "Projects": a schedule number that the project lacks is refused.
TEST_F(ProjectBookTest, AScheduleThatTheProjectLacksIsRefused) {
  v1::Project project;
  Add(project, 45, "WORKDEF 2,0 (12)\nSTOP\n");
  AddSchedule(project, 11);
  Must(Create("a", project));
  EXPECT_EQ(CodeOf(Transfer("a")), ErrorCode::kProjectSource);
  EXPECT_EQ(Programs(), 0U);
}

TEST_F(ProjectBookTest, ATransferNamesWhatIsNotThere) {
  Must(Create("empty", {}));
  EXPECT_EQ(CodeOf(Transfer("empty")), ErrorCode::kProjectSource);
  EXPECT_EQ(CodeOf(Transfer("none")), ErrorCode::kCellNotFound);
  v1::TransferProjectRequest request;
  request.set_name("projects/empty");
  request.set_machine("machines/none");
  EXPECT_EQ(CodeOf(transfer.ToMachine(request, "anna")), ErrorCode::kCellUnknownMachine);
  request.set_machine("optimo-1");
  EXPECT_EQ(CodeOf(transfer.ToMachine(request, "anna")), kInvalid);
}

TEST_F(ProjectBookTest, ABodyThatCannotBeReadIsAnErrorAndNoEmptyProject) {
  Must(bed.store().PutProject({.id = "broken", .title = "t", .body = "\xFF\xFF"}, 0));
  EXPECT_EQ(CodeOf(book.Get("projects/broken")), ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(CodeOf(Transfer("broken")), ErrorCode::kCellStoreCorrupt);
}

}  // namespace
}  // namespace rmlcell::server
