#include "server/programs/memory_tools.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/base/config.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kLine =
    "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (1000.,900.,-500.,0.,0.)   ; here\n"
    "MOVE (1010.,900.,-500.,0.,0.)\n";

class MemoryToolsTest : public testing::Test {
 protected:
  static std::string Name(int number) {
    return "machines/optimo-1/programs/" + std::to_string(number);
  }
  void Store(int number, const std::string& source, const std::string& file_name = "part.S") {
    const auto stored =
        programs.Store({.name = Name(number), .file_name = file_name, .bytes = source});
    ASSERT_TRUE(stored) << stored.error.error.detail;
  }
  void StoreObject(int number, const std::string& object) {
    ASSERT_TRUE(
        programs.Store({.name = Name(number), .form = v1::PROGRAM_FORM_OBJECT, .bytes = object}));
  }
  void StoreExecutable(int number, const std::string& bytes) {
    ASSERT_TRUE(programs.Store(
        {.name = Name(number + 100), .form = v1::PROGRAM_FORM_EXECUTABLE, .bytes = bytes}));
  }
  void Delete(int number) {
    v1::DeleteProgramRequest request;
    request.set_name(Name(number));
    ASSERT_TRUE(programs.Delete(request, "anna"));
  }
  static v1::LinkProgramRequest LinkRequest(int slot, const std::map<int, std::string>& programs) {
    v1::LinkProgramRequest request;
    request.set_slot(slot);
    for (const auto& [number, source] : programs) {
      v1::LinkProgramRequest::Part& part = *request.add_programs();
      part.set_slot(number);
      part.mutable_program()->set_file_name(std::to_string(number) + ".S");
      part.mutable_program()->set_content(source);
    }
    return request;
  }
  // "132: 44 CHANGED" for each part.
  std::vector<std::string> Stale(const std::string& machine = "machines/optimo-1") {
    v1::ListStaleExecutablesRequest request;
    request.set_parent(machine);
    std::vector<std::string> lines;
    const auto listed = Must(tools.ListStale(request));
    const auto number = [](const std::string& name) { return name.substr(name.rfind('/') + 1); };
    for (const v1::StaleExecutable& stale : listed.executables()) {
      for (const v1::StaleExecutable::Part& part : stale.parts()) {
        EXPECT_FALSE(part.text().empty());
        lines.push_back(number(stale.name()) + ": " + number(part.program()) + " " +
                        v1::StaleExecutable::Reason_Name(part.reason()).substr(7));
      }
    }
    return lines;
  }
  Result<v1::DecompileProgramResponse> Decompile(const std::string& name,
                                                 const std::string& object = {}) {
    v1::DecompileProgramRequest request;
    request.set_name(name);
    request.set_object(object);
    return tools.Decompile(request);
  }

  ServerBed bed;
  Config config;
  ProgramBook programs{bed.store(), config};
  MemoryTools tools{bed.store(), programs};
};

// OPT-1.12, OPT-1.13: an altered or deleted FUNCTION, and the program's own object; storing the
// program again drops its executable.
TEST_F(MemoryToolsTest, StaleExecutablesAreNamedWithTheirReasons) {
  Store(44, "VI[2]=1\n");
  Store(45, "VI[3]=1\n");
  Store(32, "FUNCTION 45\nFUNCTION 44\n");
  Store(12, "VI[4]=1\n");
  const auto linked = Must(tools.Link([] {
    v1::LinkProgramRequest request;
    request.set_slot(32);
    request.set_machine("machines/optimo-1");
    return request;
  }()));
  StoreExecutable(32, linked.executable());
  StoreExecutable(12, ExecutableOf(12, "VI[4]=1\n"));
  EXPECT_THAT(Stale(), ElementsAre());
  Store(44, "VI[2]=2\n");
  EXPECT_THAT(Stale(), ElementsAre("132: 44 FUNCTION_CHANGED"));
  Delete(45);
  EXPECT_THAT(Stale(), ElementsAre("132: 45 FUNCTION_DELETED", "132: 44 FUNCTION_CHANGED"));
  StoreExecutable(12, ExecutableOf(12, "VI[4]=2\n"));
  EXPECT_THAT(Stale(), ElementsAre("112: 12 OBJECT_CHANGED", "132: 45 FUNCTION_DELETED",
                                   "132: 44 FUNCTION_CHANGED"));
  Store(12, "VI[4]=1\n");
  Store(32, "FUNCTION 44\n");
  EXPECT_THAT(Stale(), ElementsAre());
  EXPECT_THAT(Stale("machines/mill-1"), ElementsAre());
  v1::ListStaleExecutablesRequest request;
  request.set_parent("machines/none");
  EXPECT_EQ(CodeOf(tools.ListStale(request)), ErrorCode::kCellUnknownMachine);
}

// OPT-1.15: linked off-line with a FUNCTION that this machine never had.
TEST_F(MemoryToolsTest, AFunctionThatWasNeverStoredMakesNothingStale) {
  Store(32, "FUNCTION 44\n");
  const auto linked = Must(tools.Link(LinkRequest(32, {{32, "FUNCTION 44\n"}, {44, "VI[2]=1\n"}})));
  StoreExecutable(32, linked.executable());
  EXPECT_THAT(Stale(), ElementsAre());
  Store(44, "VI[2]=2\n");  // now there is one, and it is another
  EXPECT_THAT(Stale(), ElementsAre("132: 44 FUNCTION_CHANGED"));
}

// OPT-9.02: what nobody calls is not compiled.
TEST_F(MemoryToolsTest, LinksOnlyWhatIsCalled) {
  const auto linked = Must(
      tools.Link(LinkRequest(32, {{32, "FUNCTION 44\n"}, {44, "VI[2]=1\n"}, {64, "SPEED 101\n"}})));
  EXPECT_TRUE(linked.findings().ok());
  EXPECT_EQ(linked.findings().diagnostics_size(), 0);
  EXPECT_FALSE(linked.executable().empty());
  const auto wrong =
      Must(tools.Link(LinkRequest(32, {{32, "FUNCTION 64\n"}, {64, "SPEED 101\n"}})));
  ASSERT_EQ(wrong.findings().diagnostics_size(), 1);
  EXPECT_EQ(wrong.findings().diagnostics(0).code(), "OPT-E7004");
  EXPECT_TRUE(wrong.executable().empty());
}

// OPT-9.02: the FUNCTIONs that it needs in order of first use, from the request before the machine.
TEST_F(MemoryToolsTest, LinksWhatIsSentAndWhatIsStored) {
  Store(44, "VI[2]=1\n");
  v1::LinkProgramRequest request = LinkRequest(32, {{32, "FUNCTION 45\nFUNCTION 44\n"}});
  const auto missing = Must(tools.Link(request));
  EXPECT_EQ(missing.executable(), "");
  EXPECT_FALSE(missing.findings().ok());
  EXPECT_EQ(missing.findings().diagnostics(0).code(), CodeText(ErrorCode::kFunctionMissing));

  request = LinkRequest(32, {{32, "FUNCTION 45\nFUNCTION 44\n"}, {45, "VI[3]=1\n"}});
  request.set_machine("machines/optimo-1");
  const auto linked = Must(tools.Link(request));
  EXPECT_TRUE(linked.findings().ok());
  EXPECT_THAT(linked.functions(), ElementsAre(45, 44));

  request = LinkRequest(32, {{32, "SPEED 101\n"}});
  const auto wrong = Must(tools.Link(request));
  EXPECT_EQ(wrong.executable(), "");
  EXPECT_EQ(wrong.findings().diagnostics(0).place().program(), 32);

  *request.add_programs() = request.programs(0);
  EXPECT_EQ(CodeOf(tools.Link(request)), ErrorCode::kCellInvalidArgument);
  request.set_slot(100);
  EXPECT_EQ(CodeOf(tools.Link(request)), ErrorCode::kProgramNumber);
  // The name of a program tells whose tools link it: a stream has none.
  request = LinkRequest(32, {{32, "^IN;!MC1;"}});
  request.mutable_programs(0)->mutable_program()->set_file_name("part.prn");
  EXPECT_EQ(CodeOf(tools.Link(request)), ErrorCode::kCellInvalidArgument);
}

// OPT-8.70: the programmer's own text, comments and blanks included, while the object is that of
// the text; else what the decompiler writes.
TEST_F(MemoryToolsTest, TheProgrammerGetsHisOwnTextBack) {
  const std::string own = "; mine\nspeed   20   ; slow\n";
  Store(45, own, "slow.S");
  const std::string object = ObjectOf(own);
  for (const auto& got : {Must(Decompile(Name(45))), Must(Decompile(Name(45), object))}) {
    EXPECT_EQ(got.content(), own);
    EXPECT_TRUE(got.own_text());
    EXPECT_EQ(got.file_name(), "slow.S");
  }
  const auto other = Must(Decompile(Name(45), ObjectOf("SPEED 21\n")));
  EXPECT_FALSE(other.own_text());
  EXPECT_THAT(other.content(), HasSubstr("SPEED 21"));

  StoreObject(45, object);  // the same object, but stored without its text
  const auto replaced = Must(Decompile(Name(45)));
  EXPECT_FALSE(replaced.own_text());
  EXPECT_THAT(replaced.content(), HasSubstr("SPEED 20"));
  EXPECT_EQ(replaced.file_name(), "45.S");

  EXPECT_EQ(CodeOf(Decompile(Name(46))), ErrorCode::kProgramMissing);
  EXPECT_EQ(CodeOf(Decompile(Name(145))), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(Decompile("")), ErrorCode::kCellEmptyProgram);
  EXPECT_EQ(CodeOf(Decompile("", "no object")), ErrorCode::kObjectCorrupt);
}

// OPT-7.91: fixes and what is left; with the parameters of the machine that is named.
TEST_F(MemoryToolsTest, FixesATextWithoutStoringIt) {
  v1::FixProgramRequest request;
  request.mutable_program()->set_file_name("a.S");
  request.mutable_program()->set_content("SPEDE 20 ; slow\nSPEED 101\n");
  const auto fixed = Must(tools.Fix(request));
  EXPECT_EQ(fixed.content(), "SPEED 20 ; slow\nSPEED 101\n");
  ASSERT_EQ(fixed.fixed_size(), 1);
  EXPECT_EQ(fixed.fixed(0).place().line(), 1);
  EXPECT_FALSE(fixed.findings().ok());
  for (const v1::Diagnostic& left : fixed.findings().diagnostics())
    EXPECT_NE(left.code(), fixed.fixed(0).code());
  request.set_machine("machines/none");
  EXPECT_EQ(CodeOf(tools.Fix(request)), ErrorCode::kCellUnknownMachine);
  request.clear_machine();
  request.mutable_program()->set_content(ObjectOf("SPEED 20\n"));
  EXPECT_EQ(CodeOf(tools.Fix(request)), ErrorCode::kCellBadText);
  request.mutable_program()->set_content(std::string("SPEED 20 ; ") + '\0' + "\n");
  EXPECT_EQ(CodeOf(tools.Fix(request)), ErrorCode::kCellBadText);
  request.mutable_program()->set_file_name("a.rml");
  request.mutable_program()->set_content("IN;");
  EXPECT_EQ(CodeOf(tools.Fix(request)), ErrorCode::kCellInvalidArgument);
}

// A text against a stored program: the step, how far its target moved, and the figures of both
// runs.
TEST_F(MemoryToolsTest, ComparesTextsAndStoredPrograms) {
  Store(45, kLine);
  v1::DiffProgramsRequest request;
  request.mutable_before()->set_name(Name(45));
  std::string moved = kLine;
  moved.replace(moved.find("1010."), 5, "1013.");
  request.mutable_after()->mutable_text()->set_file_name("new.S");
  request.mutable_after()->mutable_text()->set_content(moved);
  request.set_picture(true);
  const auto diff = tools.Diff(request);
  ASSERT_TRUE(diff) << diff.error.error.detail;
  EXPECT_FALSE(diff.value->equal());
  ASSERT_EQ(diff.value->steps_size(), 1);
  EXPECT_EQ(diff.value->steps(0).step_before(), 5);
  EXPECT_NEAR(diff.value->steps(0).target_moved_mm(), 3.0, 1e-6);
  EXPECT_THAT(diff.value->aspects(), ElementsAre(v1::DIFF_ASPECT_PATH));
  EXPECT_TRUE(diff.value->compared_runs());
  EXPECT_THAT(diff.value->picture_svg(), HasSubstr("3.000 mm travel"));  // added

  request.mutable_after()->set_name(Name(45));
  const auto same = tools.Diff(request);
  ASSERT_TRUE(same);
  EXPECT_TRUE(same.value->equal());
}

// A loop that never ends is given up, a program with errors is refused with its findings.
TEST_F(MemoryToolsTest, ComparisonsEnd) {
  v1::DiffProgramsRequest request;
  for (v1::DiffProgramsRequest::Side* side : {request.mutable_before(), request.mutable_after()}) {
    side->mutable_text()->set_file_name("a.S");
    side->mutable_text()->set_content("10 VI[2] = VI[3]\nGOTO 10\n");
  }
  const auto diff = tools.Diff(request);
  ASSERT_TRUE(diff);
  EXPECT_TRUE(diff.value->equal());
  EXPECT_FALSE(diff.value->compared_runs());
  request.mutable_after()->mutable_text()->set_content("SPEED 101\nSPEED 102\n");
  const auto wrong = tools.Diff(request);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error.diagnostics.size(), 2u);
  request.mutable_after()->mutable_text()->set_file_name("a.rml");
  EXPECT_EQ(tools.Diff(request).error.error.code, ErrorCode::kCellInvalidArgument);
  request.mutable_after()->set_name("machines/mill-1/programs/7");
  EXPECT_EQ(tools.Diff(request).error.error.code, ErrorCode::kCellPrecondition);
  request.clear_after();
  EXPECT_EQ(tools.Diff(request).error.error.code, ErrorCode::kCellEmptyProgram);
}

}  // namespace
}  // namespace rmlcell::server
