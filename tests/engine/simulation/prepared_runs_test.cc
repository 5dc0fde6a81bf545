// What runs and checks are prepared with: the machine, what a request asks for, the programs of a
// memory, and what a check sets itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/families/families.h"
#include "engine/simulation/run/rehearsal.h"
#include "tests/engine/simulation/fake_family.h"
#include "tests/engine/simulation/verdict_text.h"

namespace rmlcell::simulation::prepared_runs {
namespace {

const machine::MachineFamily& LaserFamily() { return *families::FindFamily("optimo"); }
machine::Parameters LaserParameters() { return machine::Parameters(LaserFamily().parameters()); }

MemoryProgram SourceIn(int slot, const std::string& text) {
  return {.slot = slot,
          .file_name = std::to_string(slot) + ".S",
          .bytes = machine::Bytes::Of(text),
          .is_source = true};
}

ProgramMemory LaserMemory(const std::map<int, std::string>& programs) {
  ProgramMemory memory{.family = &LaserFamily()};
  for (const auto& [slot, text] : programs) memory.programs.push_back(SourceIn(slot, text));
  return memory;
}

// As a run of the first of these programs is set up.
machine::RunSetup LaserSetup(const std::map<int, std::string>& programs) {
  const Result<PreparedRun> prepared =
      PrepareRun(LaserMemory(programs), {.main_program = programs.begin()->first});
  EXPECT_TRUE(prepared->setup);
  return *prepared->setup;
}

// A mill whose origin lies 10 mm to the right, by a file of somebody.
ProgramMemory MillOfTheWorkshop() {
  return {.family = families::FindFamily("rml1"),
          .profile = "t1",
          .parameters = {{"ORIGIN_X", "10"}},
          .parameters_of = "mine.toml",
          .own = {.name = "Mill of the workshop"},
          .programs = {{.slot = 3,
                        .file_name = "a.rml",
                        .bytes = machine::Bytes::Of("PD100,100;"),
                        .is_source = true}},
          .schedules = {{.number = 5, .name = "five"}}};
}

TEST(PreparedRuns, TheMachineIsThatOfTheMemory) {
  ProgramMemory memory = MillOfTheWorkshop();
  const machine::MachineUsed used = MachineOf(memory);
  EXPECT_EQ(used.profile, "t1");
  EXPECT_TRUE(used.named);
  ASSERT_EQ(used.changes.size(), 1U);
  EXPECT_EQ(used.changes[0].name, "ORIGIN_X");
  EXPECT_EQ(used.changed_by, "mine.toml");
  EXPECT_EQ(used.own_name, "Mill of the workshop");
  // Its profile alone where its parameters cannot be.
  memory.parameters = {{"NOBODY", "1"}};
  EXPECT_EQ(MachineOf(memory), (machine::MachineUsed{.profile = "t1", .named = true}));
  memory.profile.clear();
  EXPECT_EQ(MachineOf(memory), machine::MachineUsed{});
}

TEST(PreparedRuns, ARunHasWhatWasAskedFor) {
  const RunOptions asked{.main_program = 3,
                         .mode = machine::Mode::kSingle,
                         .override_percent = 70.0,
                         .breakpoint = machine::ProgramStep{3, 2},
                         .breakpoints = {{.at = {3, 4}, .condition = {}, .from_pass = 6}},
                         .simul = machine::ProgramStep{3, 5},
                         .inputs = {{SimTime(7), machine::InputKind::kStart, 0, 1.0}},
                         .budget = {.steps = 8, .virtual_time = SimTime(9)}};
  const Result<PreparedRun> prepared = PrepareRun(MillOfTheWorkshop(), asked);
  ASSERT_TRUE(prepared) << prepared.error().detail;
  ASSERT_TRUE(prepared->setup);
  const machine::RunSetup& setup = *prepared->setup;
  EXPECT_EQ(setup.main_program, 3);
  EXPECT_EQ(setup.mode, machine::Mode::kSingle);
  EXPECT_TRUE(setup.forecast);
  EXPECT_EQ(setup.override_percent, 70.0);
  EXPECT_EQ(setup.breakpoint, asked.breakpoint);
  EXPECT_EQ(setup.breakpoints, asked.breakpoints);
  EXPECT_EQ(setup.simul, asked.simul);
  EXPECT_EQ(setup.inputs, asked.inputs);
  EXPECT_EQ(setup.budget.steps, 8U);
  EXPECT_EQ(setup.budget.virtual_time, SimTime(9));
  ASSERT_EQ(setup.schedules.size(), 1U);
  EXPECT_EQ(setup.schedules[0].number, 5);
  EXPECT_EQ(setup.programs.count(3), 1U);
}

// What the request says stands over what the machine has, and both are named.
TEST(PreparedRuns, ParametersOfTheRequestCountMore) {
  ProgramMemory memory = MillOfTheWorkshop();
  RunOptions asked{.main_program = 3};
  const auto machine_of = [&] {
    const Result<PreparedRun> prepared = PrepareRun(memory, asked);
    EXPECT_TRUE(prepared);
    return prepared->setup->parameters;
  };
  EXPECT_EQ(machine_of().Number("ORIGIN_X"), 10.0);
  EXPECT_EQ(machine_of().Used().changed_by, "mine.toml");
  EXPECT_EQ(machine_of().Used().own_name, "Mill of the workshop");
  asked.parameters = {{"ORIGIN_X", "20"}, {"ORIGIN_Y", "30"}};
  EXPECT_EQ(machine_of().Number("ORIGIN_X"), 20.0);
  EXPECT_EQ(machine_of().Number("ORIGIN_Y"), 30.0);
  EXPECT_EQ(machine_of().Used().changed_by, "mine.toml and the request");
  memory.parameters_of.clear();
  EXPECT_EQ(machine_of().Used().changed_by, "the request");
  asked.parameters = {{"NOBODY", "1"}};
  EXPECT_FALSE(PrepareRun(memory, asked));
}

// Advice is given about the program that is run, and says which one that is.
TEST(PreparedRuns, AdviceIsAboutTheProgramThatIsRun) {
  const ProgramMemory memory = LaserMemory({{1, "OL[20] = ON\n"}, {2, "OL[20] = ON\nSTOP\n"}});
  const Result<PreparedRun> prepared = PrepareRun(memory, {.main_program = 2});
  ASSERT_TRUE(prepared);
  ASSERT_TRUE(prepared->setup);
  ASSERT_EQ(prepared->diagnostics.size(), 1U);
  EXPECT_EQ(prepared->diagnostics[0].code, ErrorCode::kSystemOutput);
  EXPECT_EQ(prepared->diagnostics[0].program, 2);
  // The lines of the steps come along, and that behind the last one.
  const auto& source = prepared->setup->programs.at(2).source;
  ASSERT_NE(source, nullptr);
  EXPECT_EQ(source->step_lines, (std::vector<int>{1, 2, 3}));
}

TEST(CheckedPrograms, OfOneSlotTheLaterIsChecked) {
  const auto ok = [](std::vector<MemoryProgram> programs) {
    ProgramMemory memory{.family = &LaserFamily()};
    memory.programs = std::move(programs);
    const auto check = CheckProgram(memory, LaserParameters(), 45, false, {});
    EXPECT_TRUE(check);
    return check->ok();
  };
  const MemoryProgram good = SourceIn(45, "SPEED 5\n"), bad = SourceIn(45, "SPEED 101\n");
  EXPECT_TRUE(ok({bad, good, SourceIn(46, "SPEED 101\n")}));
  EXPECT_FALSE(ok({good, bad, SourceIn(46, "SPEED 5\n")}));
  const auto none =
      CheckProgram(LaserMemory({{45, "SPEED 5\n"}}), LaserParameters(), 44, false, {});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kProgramMissing);
  EXPECT_EQ(none.error().detail, "program 44");
}

TEST(CheckedPrograms, AdviceIsGivenToThoseWhoAsk) {
  const ProgramMemory memory = LaserMemory({{45, "OL[20] = ON\n"}});
  for (const bool advice : {true, false}) {
    const auto check = CheckProgram(memory, LaserParameters(), 45, advice, {});
    ASSERT_TRUE(check);
    EXPECT_EQ(check->slot, 45);
    EXPECT_EQ(check->translation.diagnostics.size(), advice ? 1U : 0U);
    EXPECT_EQ(check->translation.source.step_lines, (std::vector<int>{1, 2}));
  }
}

// OPT-1.12: a source that is checked in the place of a program has nothing of its executable. X
// ends at 3600 mm.
TEST(CheckedPrograms, TheExecutableOfWhatItWasIsNotLookedAt) {
  machine::RunSetup old = LaserSetup({{45, "COORD ROBOT\nMOVE (4000.,0.,0.,0.,0.)\n"}});
  ASSERT_TRUE(MakeExecutable(LaserFamily(), old, 45));
  ProgramMemory memory = LaserMemory({{45, "COORD ROBOT\nMOVE (400.,0.,0.,0.,0.)\n"}});
  memory.programs[0].executable = old.programs.at(45).executable;
  const auto check = CheckProgram(memory, LaserParameters(), 45, false, {});
  ASSERT_TRUE(check);
  EXPECT_TRUE(check->motion.findings.empty());
  EXPECT_TRUE(check->ok());
}

// OPT-E.7102: of a memory in which a program could not be read nobody knows what is missing.
TEST(CheckedPrograms, AProgramWithErrorsLeavesTheMemoryUnknown) {
  const auto verdict = [](ProgramMemory memory) {
    memory.given = MemoryGiven::kWhole;
    CheckedProgram check = *CheckProgram(memory, LaserParameters(), 45, false, {});
    const std::string told = TextOf(JudgeCheck(check));
    return told.substr(0, told.find(' ', told.find("-E")));
  };
  const std::string call = "COORD ABSOL\nSPEED 10\nCALL 77\n";
  EXPECT_EQ(verdict(LaserMemory({{45, call}, {46, "SPEED 5\n"}})), "BAD; OPT-E7102");
  EXPECT_EQ(verdict(LaserMemory({{45, call}, {46, "SPEED 101\n"}})), "DOUBTFUL; CELL-E9606");
}

// What a verdict rests on is marked wherever it stands: in the text, in the motion, and where there
// was no room for it; the rest is not.
TEST(CheckedPrograms, FindingsOfTheVerdictAreMarked) {
  CheckedProgram check{.family = &LaserFamily(), .slot = 45, .translation = {.ok = true}};
  const Diagnostic counts{.code = ErrorCode::kWorkActiveAtEnd, .severity = Severity::kWarning};
  const Diagnostic other{.code = ErrorCode::kSystemOutput, .severity = Severity::kWarning};
  check.motion.reasons = {{.code = ErrorCode::kWorkActiveAtEnd}};
  check.translation.diagnostics = check.motion.findings = {counts, other};
  for (UntoldFindings* dropped :
       {&check.translation.diagnostics_dropped, &check.motion.findings_dropped}) {
    dropped->Add(counts);
    dropped->Add(other);
  }
  EXPECT_EQ(JudgeCheck(check).verdict, machine::Verdict::kDoubtful);
  for (const std::vector<Diagnostic>& told :
       {check.translation.diagnostics, check.motion.findings}) {
    EXPECT_EQ(told[0].judged, Judged::kDoubtful);
    EXPECT_EQ(told[1].judged, Judged::kNo);
  }
  for (const UntoldFindings& dropped :
       {check.translation.diagnostics_dropped, check.motion.findings_dropped}) {
    EXPECT_EQ(dropped.kinds().at(counts.code).judged, Judged::kDoubtful);
    EXPECT_EQ(dropped.kinds().at(other.code).judged, Judged::kNo);
  }
}

// How far a check came is told where nothing else says why: an error of the motion speaks for
// itself, and that of a program that this one calls is told as that. Each code is told once.
TEST(CheckedPrograms, WhereACheckEndedIsToldOnce) {
  const auto codes = [](const std::vector<Diagnostic>& findings,
                        const std::vector<machine::Reason>& reasons, ErrorCode cause) {
    CheckedProgram check{.family = &LaserFamily(), .slot = 45, .translation = {.ok = true}};
    check.motion.findings = findings;
    check.motion.reasons = reasons;
    check.motion.cut_short[45] = {.cause = cause, .text = "only up to step 3"};
    const machine::Judgement judgement = JudgeCheck(check);
    std::vector<ErrorCode> told;
    for (const machine::Reason& reason : judgement.reasons) told.push_back(reason.code);
    return told;
  };
  using Codes = std::vector<ErrorCode>;
  const Diagnostic error{.code = ErrorCode::kHoleRadiusZero, .severity = Severity::kCompile};
  const machine::Reason called{.code = ErrorCode::kHoleRadiusZero,
                               .verdict = machine::Verdict::kBad};
  EXPECT_EQ(codes({}, {}, ErrorCode::kCellCheckWaits), Codes{ErrorCode::kCellCheckWaits});
  EXPECT_EQ(codes({error}, {}, ErrorCode::kCellCheckWaits), Codes{ErrorCode::kHoleRadiusZero});
  EXPECT_EQ(codes({error}, {called}, ErrorCode::kCellCheckWaits),
            Codes{ErrorCode::kHoleRadiusZero});
  EXPECT_EQ(codes({}, {called}, ErrorCode::kHoleRadiusZero), Codes{ErrorCode::kHoleRadiusZero});
  EXPECT_EQ(codes({}, {called}, ErrorCode::kCellCheckWaits),
            (Codes{ErrorCode::kHoleRadiusZero, ErrorCode::kCellCheckWaits}));
}

// What is no RML-1 is refused when it comes; of what is stored already that was said before.
TEST(CheckedPrograms, AStoredStreamIsNotRefusedAgain) {
  std::string stream;
  for (int k = 0; k < 90; ++k) stream += "PU100,100;";
  stream += std::string(101, '$');  // more than a tenth
  const machine::MachineFamily& mill = *families::FindFamily("rml1");
  const auto ok = [&](bool is_source) {
    ProgramMemory memory{.family = &mill, .profile = "t1"};
    memory.programs = {{.slot = 3,
                        .file_name = "a.rml",
                        .bytes = machine::Bytes::Of(stream),
                        .is_source = is_source}};
    const auto check = CheckProgram(memory, *machine::MakeParameters(mill, "t1", {}), 3, false, {});
    EXPECT_TRUE(check);
    return check->translation.ok;
  };
  EXPECT_FALSE(ok(true));
  EXPECT_TRUE(ok(false));
}

// Of a program with more errors than are told the others are counted, with its slot.
TEST(PreparedRuns, FindingsWithoutRoomHaveTheirProgram) {
  std::string wrong;
  for (int k = 0; k < 1100; ++k) wrong += "NOSUCHWORD 1\n";
  const ProgramMemory memory = LaserMemory({{2, wrong}});
  const machine::Translation alone = TranslateProgram(
      LaserFamily(), LaserParameters(), memory.programs[0], {.advice = true, .source = true});
  ASSERT_GT(alone.diagnostics_dropped.count(), 0U);
  const auto prepared = PrepareRun(memory, {.main_program = 2});
  ASSERT_TRUE(prepared);
  EXPECT_FALSE(prepared->setup);
  EXPECT_EQ(prepared->diagnostics.size(), alone.diagnostics.size());
  EXPECT_EQ(prepared->diagnostics_dropped.count(), alone.diagnostics_dropped.count());
  for (const auto& [code, kind] : prepared->diagnostics_dropped.kinds()) {
    EXPECT_EQ(kind.first.program, 2) << CodeText(code);
    EXPECT_EQ(kind.last.program, 2) << CodeText(code);
  }
}

// A check goes through the program in one go and to its end, however the machine stands.
TEST(CheckSetups, TheCheckSetsModeAndBudgetItself) {
  machine::RunSetup setup = LaserSetup({{45,
                                         "SYSDEF\nCOORD ABSOL\nPATH LIN\nMOVE (4000.,0.,0.,0.,0.)\n"
                                         "MOVE (4100.,0.,0.,0.,0.)\n"}});
  setup.mode = machine::Mode::kSingle;
  setup.forecast = false;
  setup.budget = {.steps = 1, .virtual_time = std::chrono::seconds(1)};
  const auto check = CheckMotion(LaserFamily(), setup, {45});
  ASSERT_TRUE(check);
  EXPECT_EQ(check->findings.size(), 2U);
  EXPECT_TRUE(check->cut_short.empty());
  EXPECT_EQ(
      std::ranges::count(check->reasons, ErrorCode::kCellWaitsForever, &machine::Reason::code), 0);
}

// Of two programs 1203 motions leave the travel: a thousand are told, and the others counted.
TEST(CheckSetups, FindingsWithoutRoomAreCounted) {
  const auto beyond = [](int moves) {
    std::string text = "COORD ROBOT\n";
    for (int k = 0; k < moves; ++k)
      text += k % 2 == 0 ? "MOVE (4000.,0.,0.,0.,0.)\n" : "MOVE (4100.,0.,0.,0.,0.)\n";
    return text;
  };
  const auto told = [](const std::map<int, std::string>& programs) {
    const auto check = CheckMotion(LaserFamily(), LaserSetup(programs), {1, 2});
    EXPECT_TRUE(check);
    return std::pair(check->findings.size(), check->findings_dropped.count());
  };
  const std::pair expected{machine::kDiagnosticsMax, std::uint64_t{203}};
  EXPECT_EQ(told({{1, beyond(601)}, {2, beyond(602)}}), expected);
  EXPECT_EQ(told({{1, beyond(601) + "CALL 2\n"}, {2, beyond(602)}}), expected);
}

// Of what two callers make of one program the more serious counts, and of as serious ones the
// greater, whoever calls it first. 44 cuts on from X 50 with the beam off, up to VR[1].
TEST(CheckSetups, TheMoreSeriousOfTwoRunsCounts) {
  const std::string cut =
      "COORD ABSOL\nPATH LIN\nMOVE (0.,1000.,-400.,0.,0.)\nSPEED 10\nWORK 0,0 /ON\n"
      "MOVE (50.,1000.,-400.,0.,0.)\nWORK 2,5 /OFF\nMOVE (VR[1],1000.,-400.,0.,0.)\n"
      "WORK 0,0 /OFF\n";
  const auto of_44 = [&](const std::string& first, const std::string& second) {
    const auto check = CheckMotion(
        LaserFamily(), LaserSetup({{44, cut}, {45, first}, {46, second}}), {44, 45, 46});
    EXPECT_TRUE(check);
    for (const machine::Reason& reason : check->reasons) {
      if (reason.code == ErrorCode::kCutWithoutBeam && reason.first.program == 44) return reason;
    }
    return machine::Reason{};
  };
  const std::string ten = "VR[1] = 60.\nCALL 44\n", twenty = "VR[1] = 70.\nCALL 44\n";
  const std::string perhaps = "IF IL[5] THEN 10\n" + twenty + "10 COORD ROBOT\n";
  EXPECT_NEAR(of_44(ten, twenty).amount, 20.0, 1e-3);
  EXPECT_NEAR(of_44(twenty, ten).amount, 20.0, 1e-3);
  for (const auto& [first, second] : {std::pair(ten, perhaps), std::pair(perhaps, ten)}) {
    const machine::Reason reason = of_44(first, second);
    EXPECT_EQ(reason.verdict, machine::Verdict::kBad);
    EXPECT_NEAR(reason.amount, 10.0, 1e-3);
  }
}

// A halt of which nobody knows the place is one of the program that was run.
TEST(CheckSetups, AReasonWithoutAPlaceIsOfItsProgram) {
  Script script;
  script.Halt("STOP").Nothing(1.0);
  const auto check = CheckMotion(FakeFamily(script, true), FakeFamily::Setup(), {1});
  ASSERT_TRUE(check);
  ASSERT_EQ(check->reasons.size(), 1U);
  EXPECT_EQ(check->reasons[0].code, machine::kWaitsForKey.code);
  EXPECT_EQ(check->reasons[0].first.program, 1);
  EXPECT_EQ(check->reasons[0].amount, 1.0);
}

}  // namespace
}  // namespace rmlcell::simulation::prepared_runs
