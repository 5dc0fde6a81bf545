// The off-line tools at the bounds of what they take, and with the parameters of a machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "engine/families/families.h"
#include "engine/optimo/language/linker.h"
#include "server/base/config.h"
#include "server/programs/memory_tools.h"
#include "server/programs/text_tools.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;

class ToolLimits : public testing::Test {
 protected:
  struct LinkPart {
    int slot;
    std::string source;
    bool object = false;
  };
  static v1::LinkProgramRequest LinkOf(int slot, const std::vector<LinkPart>& parts,
                                       const std::string& machine = "") {
    v1::LinkProgramRequest request;
    request.set_slot(slot);
    request.set_machine(machine);
    for (const LinkPart& part : parts) {
      v1::LinkProgramRequest::Part& made = *request.add_programs();
      made.set_slot(part.slot);
      made.mutable_program()->set_file_name("part.S");
      made.mutable_program()->set_content(part.source);
      if (part.object) made.mutable_program()->set_form(v1::PROGRAM_FORM_OBJECT);
    }
    return request;
  }
  // Why it was refused, or the code of the first finding, or nothing.
  std::string Linked(const v1::LinkProgramRequest& request) {
    const auto linked = tools.Link(request);
    if (!linked) return "refused " + CodeText(linked.error().code);
    EXPECT_EQ(linked->executable().empty(), !linked->findings().ok());
    return linked->findings().diagnostics_size() > 0 ? linked->findings().diagnostics(0).code()
                                                     : "";
  }
  void Machine(const std::string& id, const std::map<std::string, std::string>& parameters) {
    Must(bed.store().PutMachine({.id = id, .family = "optimo", .parameters = parameters}, 0));
  }

  ServerBed bed;
  Config config;
  ProgramBook programs{bed.store(), config};
  MemoryTools tools{bed.store(), programs};
};

// OPT-1.10: numbers 1 to 99, of the program and of each part.
TEST_F(ToolLimits, SlotsOfALink) {
  for (const int slot : {1, 99}) EXPECT_EQ(Linked(LinkOf(slot, {{slot, "STOP\n"}})), "") << slot;
  for (const int slot : {-1, 0, 100}) {
    const std::string refused = "refused " + CodeText(ErrorCode::kProgramNumber);
    EXPECT_EQ(Linked(LinkOf(slot, {{1, "STOP\n"}})), refused) << slot;
    EXPECT_EQ(Linked(LinkOf(1, {{1, "STOP\n"}, {slot, "STOP\n"}})), refused) << slot;
  }
  EXPECT_EQ(Linked(LinkOf(1, {{1, ""}})), "refused " + CodeText(ErrorCode::kCellEmptyProgram));
  const std::string twice = "refused " + CodeText(ErrorCode::kCellInvalidArgument);
  const std::string object = ObjectOf("STOP\n");
  EXPECT_EQ(Linked(LinkOf(1, {{1, "STOP\n"}, {1, "STOP\n"}})), twice);
  EXPECT_EQ(Linked(LinkOf(1, {{1, object, true}, {1, "STOP\n"}})), twice);
  EXPECT_EQ(Linked(LinkOf(1, {{1, "STOP\n"}, {1, object, true}})), twice);
  EXPECT_EQ(Linked(LinkOf(1, {{1, object, true}})), "");
}

TEST_F(ToolLimits, MachinesOfALink) {
  const auto linked = [&](const std::string& machine) {
    return Linked(LinkOf(1, {{1, "STOP\n"}}, machine));
  };
  EXPECT_EQ(linked("machines/optimo-1"), "");
  EXPECT_EQ(linked("optimo-1"), "refused " + CodeText(ErrorCode::kCellInvalidArgument));
  EXPECT_EQ(linked("machines/none"), "refused " + CodeText(ErrorCode::kCellUnknownMachine));
  EXPECT_EQ(linked("machines/mill-1"), "refused " + CodeText(ErrorCode::kCellPrecondition));
  Machine("strange", {{"NONE", "1"}});
  EXPECT_NE(linked("machines/strange"), "");
}

// OPT-9.02: executables smaller than the limit of the machine; OPT-1.08: objects up to theirs.
TEST_F(ToolLimits, AMachineHasLimitsOfItsOwn) {
  std::string long_program;
  for (int i = 0; i < 40; ++i) long_program += "VI[2] = VI[3]\n";
  const std::string bytes = ObjectOf(long_program);
  const std::size_t object = bytes.size();
  const auto lookup = [&](int) -> std::optional<std::string_view> { return bytes; };
  const std::uint32_t executable = optimo::ExecutableSize(Must(optimo::Link(1, lookup, {})));
  ASSERT_GT(object, 100U);
  Machine("object-fits", {{"OBJECT_LIMIT", std::to_string(object)}});
  Machine("object-long", {{"OBJECT_LIMIT", std::to_string(object - 1)}});
  Machine("fits", {{"EXECUTABLE_LIMIT", std::to_string(executable + 1)}});
  Machine("long", {{"EXECUTABLE_LIMIT", std::to_string(executable)}});
  const auto on = [&](const std::string& machine) {
    return Linked(LinkOf(1, {{1, long_program}}, "machines/" + machine));
  };
  EXPECT_EQ(on("object-fits"), "");
  EXPECT_EQ(on("object-long"), CodeText(ErrorCode::kObjectTooLong));
  EXPECT_EQ(on("fits"), "");
  EXPECT_EQ(on("long"), CodeText(ErrorCode::kExecutableTooLong));
}

// OPT-9.19: the rotary table is built into the control that has one.
TEST_F(ToolLimits, ARotaryTableIsNoMissingFunction) {
  Machine("table", {{"ROTARY_TABLE", "ON"}});
  const std::vector<LinkPart> parts = {{1, "FUNCTION 99 (90.)\n"}};
  EXPECT_EQ(Linked(LinkOf(1, parts, "machines/table")), "");
  EXPECT_EQ(Linked(LinkOf(1, parts, "machines/optimo-1")), CodeText(ErrorCode::kFunctionMissing));
  EXPECT_EQ(Linked(LinkOf(1, parts)), CodeText(ErrorCode::kFunctionMissing));
}

// What is sent goes before what is stored, a source as well as an object.
TEST_F(ToolLimits, ALinkTakesWhatIsSentFirst) {
  Must(
      bed.store().PutPrograms("optimo-1", {{.slot = 44, .object = ObjectOf("FUNCTION 45\n")}}, {}));
  const auto functions = [&](const LinkPart& part) {
    const auto linked =
        Must(tools.Link(LinkOf(1, {{1, "FUNCTION 44\n"}, part}, "machines/optimo-1")));
    EXPECT_TRUE(linked.findings().ok());
    return std::vector<int>(linked.functions().begin(), linked.functions().end());
  };
  EXPECT_THAT(functions({44, "STOP\n"}), ElementsAre(44));
  EXPECT_THAT(functions({44, ObjectOf("STOP\n"), true}), ElementsAre(44));
  EXPECT_THAT(functions({45, "STOP\n"}), ElementsAre(44, 45));
}

// DiffProgramsRequest: names of programs that are there, texts that are not empty.
TEST_F(ToolLimits, SidesOfAComparison) {
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 45, .object = ObjectOf("STOP\n")}}, {}));
  const auto compared = [&](const std::string& name) {
    v1::DiffProgramsRequest request;
    request.mutable_before()->mutable_text()->set_file_name("a");
    request.mutable_before()->mutable_text()->set_form(v1::PROGRAM_FORM_OBJECT);
    request.mutable_before()->mutable_text()->set_content(ObjectOf("STOP\n"));
    request.mutable_after()->set_name(name);
    const auto diff = tools.Diff(request);
    if (!diff) return CodeText(diff.error.error.code);
    return std::string(diff.value->equal() ? "equal" : "different");
  };
  EXPECT_EQ(compared("machines/optimo-1/programs/45"), "equal");
  EXPECT_EQ(compared("machines/optimo-1/programs/46"), CodeText(ErrorCode::kProgramMissing));
  EXPECT_EQ(compared("machines/optimo-1/programs/145"), CodeText(ErrorCode::kCellInvalidArgument));
  EXPECT_EQ(compared("programs/45"), CodeText(ErrorCode::kCellInvalidArgument));
}

// An error shows its file, its line and its own code.
TEST_F(ToolLimits, AComparisonOfWhatHasErrors) {
  v1::DiffProgramsRequest request;
  request.mutable_before()->mutable_text()->set_file_name("old.S");
  request.mutable_before()->mutable_text()->set_content("STOP\n");
  request.mutable_after()->mutable_text()->set_file_name("new.S");
  request.mutable_after()->mutable_text()->set_content("STOP\nSPEED 101\nSPEED 102\n");
  const auto diff = tools.Diff(request);
  ASSERT_FALSE(diff);
  EXPECT_EQ(diff.error.error.code, ErrorCode::kLiteralRange);
  EXPECT_THAT(diff.error.error.detail, testing::StartsWith("new.S line 2: "));
  EXPECT_EQ(diff.error.error.where->line, 2);
  EXPECT_EQ(diff.error.diagnostics.size(), 2U);
  EXPECT_TRUE(diff.error.dropped.empty());
}

// Of both sides all is told that is wrong; the first error of the first one stands for all.
TEST_F(ToolLimits, BothSidesOfAComparisonMayHaveErrors) {
  v1::DiffProgramsRequest request;
  request.mutable_before()->mutable_text()->set_file_name("old.S");
  request.mutable_before()->mutable_text()->set_content("SPEED 101\n");
  request.mutable_after()->mutable_text()->set_file_name("new.S");
  request.mutable_after()->mutable_text()->set_content("STOP\nSPEED 102\n");
  const auto diff = tools.Diff(request);
  ASSERT_FALSE(diff);
  EXPECT_EQ(diff.error.error.code, ErrorCode::kLiteralRange);
  EXPECT_THAT(diff.error.error.detail, testing::StartsWith("old.S line 1: "));
  ASSERT_EQ(diff.error.diagnostics.size(), 2U);
  EXPECT_EQ(diff.error.diagnostics[0].file, "old.S");
  EXPECT_EQ(diff.error.diagnostics[1].file, "new.S");
}

// DiffProgramsResponse.steps: at most 10,000; those beyond are counted.
TEST_F(ToolLimits, ChangedStepsThatAreNotListedAreCounted) {
  const auto compared = [&](int added) {
    const machine::MachineFamily& family = *families::FindFamily("optimo");
    std::string text;
    for (int step = 0; step < added; ++step) text += "VI[2] = 1\n";
    const machine::CompiledProgram longer = family.tools()->Compile(
        {.name = "a.S", .bytes = text + "STOP\n"}, machine::Parameters(family.parameters()),
        {.advice = false, .any_size = true});
    v1::DiffProgramsRequest request;
    request.mutable_before()->mutable_text()->set_file_name("old.S");
    request.mutable_before()->mutable_text()->set_content("STOP\n");
    request.mutable_after()->mutable_text()->set_file_name("new.O");
    request.mutable_after()->mutable_text()->set_content(longer.object);
    const auto diff = tools.Diff(request);
    if (!diff) throw std::runtime_error(diff.error.error.detail);
    EXPECT_EQ(diff.value->steps_size(), 10'000) << added;
    return diff.value->steps_dropped();
  };
  EXPECT_EQ(compared(10'000), 0);
  EXPECT_EQ(compared(10'001), 1);
}

// DiffProgramsResponse.notes: a program of a slot is called as the file of its object, after its
// text or after the slot. OPT-2.09: a hole of radius 0 ends its run.
TEST_F(ToolLimits, NotesNameTheObjectsOfSlots) {
  const std::string hole = "COORD ABSOL\nPATH HOLE (0.)\nMOVE (1000.,900.,-500.,0.,0.)\n";
  ASSERT_TRUE(programs.Store({.name = "machines/optimo-1/programs/45",
                              .file_name = "hole.S",
                              .bytes = "SPEED 5\n" + hole}));
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 46, .object = ObjectOf("SPEED 6\n" + hole)}},
                               {}));
  v1::DiffProgramsRequest request;
  request.mutable_before()->set_name("machines/optimo-1/programs/45");
  request.mutable_after()->set_name("machines/optimo-1/programs/46");
  const auto diff = tools.Diff(request);
  ASSERT_TRUE(diff) << diff.error.error.detail;
  EXPECT_FALSE(diff.value->compared_runs());
  ASSERT_EQ(diff.value->notes_size(), 2);
  EXPECT_THAT(diff.value->notes(0), testing::StartsWith("hole.O: "));
  EXPECT_THAT(diff.value->notes(1), testing::StartsWith("46.O: "));
}

// FixProgramRequest.errors_only. OPT-3.47: what is never reached is advice.
TEST_F(ToolLimits, AFixMayTellOfErrorsAlone) {
  const auto told = [&](bool errors_only) {
    v1::FixProgramRequest request;
    request.mutable_program()->set_file_name("a.S");
    request.mutable_program()->set_content("GOTO 10\nDELAY 1.\n10 STOP\n");
    request.set_errors_only(errors_only);
    return Must(tools.Fix(request)).findings().diagnostics_size();
  };
  EXPECT_GT(told(false), 0);
  EXPECT_EQ(told(true), 0);
}

// Nor is a link a check, which would tell of what is never reached.
TEST_F(ToolLimits, ALinkGivesNoAdvice) {
  EXPECT_EQ(Linked(LinkOf(1, {{1, "GOTO 10\nDELAY 1.\n10 STOP\n"}})), "");
}

// A thousand findings are listed, and the others counted.
TEST_F(ToolLimits, FindingsThatAreNotListedAreCounted) {
  std::string many;
  for (int line = 0; line < 1'005; ++line) many += "SPEED 101\n";
  v1::DiffProgramsRequest request;
  request.mutable_before()->mutable_text()->set_file_name("old.S");
  request.mutable_before()->mutable_text()->set_content("STOP\n");
  request.mutable_after()->mutable_text()->set_file_name("new.S");
  request.mutable_after()->mutable_text()->set_content(many);
  const auto diff = tools.Diff(request);
  ASSERT_FALSE(diff);
  EXPECT_EQ(diff.error.diagnostics.size(), 1'000U);
  EXPECT_EQ(diff.error.dropped.count(), 5U);
  const auto linked = Must(tools.Link(LinkOf(1, {{1, "FUNCTION 44\n"}, {44, many}})));
  EXPECT_EQ(linked.executable(), "");
  EXPECT_FALSE(linked.findings().ok());
  EXPECT_EQ(linked.findings().diagnostics_size(), 1'000);
  EXPECT_EQ(linked.findings().diagnostics_dropped(), 5);
  EXPECT_EQ(linked.findings().diagnostics(0).place().program(), 44);
}

// So they are where the texts of a link have more together.
TEST_F(ToolLimits, FindingsOfAllTextsOfALinkAreOneList) {
  std::string many;
  for (int line = 0; line < 999; ++line) many += "SPEED 101\n";
  const auto of = [&](const std::string& warned) {
    return Must(tools.Link(LinkOf(1, {{1, warned + "FUNCTION 44\n"}, {44, many}}))).findings();
  };
  const v1::Findings full = of("TASK 2\n");
  EXPECT_EQ(full.diagnostics_size(), 1'000);
  EXPECT_EQ(full.diagnostics_dropped(), 0);
  const v1::Findings more = of("TASK 2\nTASK 2\nTASK 2\n");
  ASSERT_EQ(more.diagnostics_size(), 1'000);
  EXPECT_FALSE(more.ok());
  EXPECT_EQ(more.diagnostics(0).code(), CodeText(ErrorCode::kWordIgnored));
  EXPECT_EQ(more.diagnostics(999).place().program(), 44);
  EXPECT_EQ(more.diagnostics_dropped(), 2);
  ASSERT_EQ(more.gathered_size(), 1);
  EXPECT_EQ(more.gathered(0).code(), more.diagnostics(999).code());
}

// Texts that are moved: three turns or none, finite numbers; values from
// proto/rmlcell/v1/program.proto.
TEST(TextLimits, OffsetsOfAMove) {
  const auto code = [](const std::vector<double>& turns, double x, double y, double z) {
    v1::TransformProgramRequest request;
    request.mutable_program()->set_file_name("a.S");
    request.mutable_program()->set_content("STOP\n");
    request.mutable_translation()->set_x(x);
    request.mutable_translation()->set_y(y);
    request.mutable_translation()->set_z(z);
    for (const double turn : turns) request.add_rotation(turn);
    return CodeOf(TransformText(request));
  };
  constexpr auto kInvalid = ErrorCode::kCellInvalidArgument;
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(code({}, 1, 2, 3), std::nullopt);
  EXPECT_EQ(code({0.1, 0.2, 0.3}, 1, 2, 3), std::nullopt);
  EXPECT_EQ(code({0.1}, 1, 2, 3), kInvalid);
  EXPECT_EQ(code({0.1, 0.2}, 1, 2, 3), kInvalid);
  EXPECT_EQ(code({0.1, 0.2, 0.3, 0.4}, 1, 2, 3), kInvalid);
  EXPECT_EQ(code({}, infinite, 2, 3), kInvalid);
  EXPECT_EQ(code({}, 1, infinite, 3), kInvalid);
  EXPECT_EQ(code({}, 1, 2, infinite), kInvalid);
  for (std::size_t at = 0; at < 3; ++at) {
    std::vector<double> turns = {0.1, 0.2, 0.3};
    turns[at] = infinite;
    EXPECT_EQ(code(turns, 1, 2, 3), kInvalid) << at;
  }
}

// Each tool refuses nothing to work on and, but for listings, an object; two refuse inches.
TEST(TextLimits, WhatIsNoText) {
  const auto codes = [](const std::string& file_name, const std::string& content) {
    v1::ProgramText text;
    text.set_file_name(file_name);
    text.set_content(content);
    v1::FormatProgramRequest format;
    *format.mutable_program() = text;
    v1::ConvertProgramRequest convert;
    *convert.mutable_program() = text;
    v1::CompensateProgramRequest compensate;
    *compensate.mutable_program() = text;
    v1::TransformProgramRequest transform;
    *transform.mutable_program() = text;
    v1::ShiftProgramRequest shift;
    *shift.mutable_program() = text;
    v1::MakeListingRequest listing;
    *listing.mutable_program() = text;
    return std::vector<std::optional<ErrorCode>>{CodeOf(FormatText(format)),
                                                 CodeOf(ConvertText(convert, "today")),
                                                 CodeOf(CompensateText(compensate, "today")),
                                                 CodeOf(TransformText(transform)),
                                                 CodeOf(ShiftText(shift)),
                                                 CodeOf(ListText(listing))};
  };
  constexpr auto kEmpty = ErrorCode::kCellEmptyProgram;
  constexpr auto kInvalid = ErrorCode::kCellInvalidArgument;
  constexpr auto kInch = ErrorCode::kSourceIsInch;
  EXPECT_THAT(codes("a.S", ""), ElementsAre(kEmpty, kEmpty, kEmpty, kEmpty, kEmpty, kEmpty));
  const std::string object = ObjectOf("STOP\n");
  EXPECT_THAT(codes("a.O", object),
              ElementsAre(kInvalid, kInvalid, kInvalid, kInvalid, kInvalid, std::nullopt));
  const auto inch = codes("a.SI", "STOP\n");
  EXPECT_EQ(inch[0], std::nullopt);
  EXPECT_EQ(inch[3], kInch);
  EXPECT_EQ(inch[4], kInch);
  EXPECT_EQ(inch[5], std::nullopt);
}

// A shift has the bounds of any other move; what is no object has no listing, a stream no tools,
// and a name without an ending no direction.
TEST(TextLimits, WhatTheToolsRefuse) {
  v1::ProgramText text;
  text.set_file_name("a.S");
  text.set_content("STOP\n");
  v1::ShiftProgramRequest shift;
  *shift.mutable_program() = text;
  EXPECT_EQ(CodeOf(ShiftText(shift)), std::nullopt);
  shift.add_rotation(0.1);
  EXPECT_EQ(CodeOf(ShiftText(shift)), ErrorCode::kCellInvalidArgument);
  v1::FormatProgramRequest format;
  *format.mutable_program() = text;
  EXPECT_EQ(CodeOf(FormatText(format)), std::nullopt);
  format.mutable_program()->set_file_name("a.rml");
  EXPECT_EQ(CodeOf(FormatText(format)), ErrorCode::kCellInvalidArgument);
  v1::ConvertProgramRequest convert;
  *convert.mutable_program() = text;
  convert.mutable_program()->set_file_name("part");
  EXPECT_EQ(CodeOf(ConvertText(convert, "today")), ErrorCode::kConvertDirection);
  v1::MakeListingRequest listing;
  *listing.mutable_program() = text;
  listing.mutable_program()->set_form(v1::PROGRAM_FORM_OBJECT);
  EXPECT_EQ(CodeOf(ListText(listing)), ErrorCode::kObjectCorrupt);
}

}  // namespace
}  // namespace rmlcell::server
