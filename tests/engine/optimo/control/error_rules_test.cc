#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/machine/machine_state.h"
#include "engine/optimo/machine/motion_errors.h"
#include "engine/optimo/machine/telling.h"
#include "tests/engine/optimo/control/run_text.h"

// Each code that the control raises while a program runs: by a small program, told with its place.
namespace rmlcell::optimo::testing {
namespace {

using machine::InputKind;
using machine::OutcomeKind;

const std::string kAbsolThere =
    "COORD ABSOL\nPATH LIN\nMOVE (1000.,1000.,-400.,0.,0.)\n";  // steps 1 to 3

struct Row {
  const char* name;
  int code;
  int step;
  std::string text;
  RunOptions options{};
  int program = 1;

  friend void PrintTo(const Row& row, std::ostream* out) { *out << row.name; }
};

std::string NameOf(const ::testing::TestParamInfo<Row>& row) { return row.param.name; }

void ExpectTold(const Row& row, const Ran& ran) {
  const Ran::Event& told = ran.First("E" + std::to_string(row.code));
  EXPECT_EQ(told.program, row.program);
  EXPECT_EQ(told.step, row.step);
}

// Errors and alarms: the run ends with the code, at the place.
class EndsTheRun : public ::testing::TestWithParam<Row> {};

TEST_P(EndsTheRun, WithItsCodeAndPlace) {
  const Row& row = GetParam();
  const Ran ran = RunText(row.text, row.options);
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kFailed);
  ASSERT_TRUE(ran.outcome.code.has_value());
  EXPECT_EQ(Lookup(*ran.outcome.code).number, row.code);
  EXPECT_EQ(ran.outcome.place.program, row.program);
  EXPECT_EQ(ran.outcome.place.step, row.step);
  ExpectTold(row, ran);
  const Result<MachineState> state = DecodeMachineState(ran.machine_state);
  ASSERT_TRUE(bool(state));
  EXPECT_EQ(static_cast<int>(state->data.vi[99]), row.code);  // OPT-3.54
  EXPECT_FALSE(ran.end.beam_on);
}

std::string Functions(int count) {
  std::string text;
  for (int n = 0; n < count; ++n) text += "FUNCTION " + std::to_string(2 + n) + "\n";
  return text;
}

std::map<int, std::string> Slots(int first, int count, const std::string& text) {
  std::map<int, std::string> programs;
  for (int n = 0; n < count; ++n) programs[first + n] = text;
  return programs;
}

std::string NotZeroed() {
  machine::Parameters parameters(OptimoParameterTable());
  MachineState state = NewMachine(Resolve(parameters));
  state.zeroed = false;
  return EncodeMachineState(state);
}

std::string Lines(int count) {
  std::string text;
  for (int n = 0; n < count; ++n) text += "VR[0]=VR[1]+1.5\n";
  return text;
}

// OPT-E.60, OPT-E.129, OPT-E.348, OPT-E.931: the manual's own numbers.
INSTANTIATE_TEST_SUITE_P(
    Manual, EndsTheRun,
    ::testing::Values(
        Row{"goto", 60, 2, "VI[2]=1\nGOTO 77\n"}, Row{"gosub", 60, 1, "GOSUB 77\n"},
        Row{"computed_goto", 60, 2, "VI[2]=2\nGOTO VI[2] (20,77)\n20 VI[3]=1\n"},
        Row{"timer", 60, 2, "TIMER (1.,77)\nDELAY 2\nVI[2]=1\n"},
        Row{"time", 60, 4, kAbsolThere + "MOVE (1400.,1000.,-400.,0.,0.)/TIME (.1,77)\n"},
        Row{"hole_on_axis",
            129,
            5,
            kAbsolThere +
                "PATH HOLE (5.)\nMOVE (1000.,1000.,-400.,0.,0.)/VIA (1000.,1000.,-300.,0.,0.)\n",
            {.parameters = {{"TEACH_SIM", "ON"}}}},
        Row{"hole_radius", 348, 5,
            kAbsolThere +
                "PATH HOLE (0.)\nMOVE (1000.,1000.,-400.,0.,0.)/VIA (1000.,1000.,-300.,0.,0.)\n"},
        Row{"gas_three", 931, 3, "ERR 900\nVI[2]=1\nOL[9]=ON\n900 VI[3]=1\n"}),
    NameOf);

// OPT-E.7101, OPT-E.7102, OPT-E.7103, OPT-E.7104, OPT-E.7105
INSTANTIATE_TEST_SUITE_P(
    Programs, EndsTheRun,
    ::testing::Values(
        Row{"number", 7101, 2, "VI[2]=145\nCALL VI[2]\n"}, Row{"missing", 7102, 1, "CALL 77\n"},
        Row{"function_missing", 7103, 1, "CALL 45\n", {.programs = {{45, "FUNCTION 44\n"}}}},
        Row{"function_is_main",
            7104,
            1,
            "CALL 45\n",
            {.programs = {{45, "FUNCTION 44\n"}, {44, "FUNCTION 45\n"}}}},
        Row{"functions", 7105, 1, "CALL 99\n",
            [] {
              RunOptions options{.programs = Slots(2, 33, "VI[2]=1\n")};
              options.programs[99] = Functions(33);
              return options;
            }()}),
    NameOf);

// OPT-E.7106, OPT-E.7107, OPT-E.7108
INSTANTIATE_TEST_SUITE_P(
    Executables, EndsTheRun,
    ::testing::Values(
        Row{"too_long",
            7106,
            1,
            "CALL 45\n",
            {.programs = {{45, Lines(200)}}, .parameters = {{"EXECUTABLE_LIMIT", "1000"}}}},
        Row{"fourth_level",
            7107,
            1,
            "CALL 11\n",
            {.programs =
                 {{11, "CALL 12\n"}, {12, "CALL 13\n"}, {13, "CALL 14\n"}, {14, "VI[2]=1\n"}}},
            13},
        Row{"entry",
            7108,
            1,
            "CALL 45\n",
            {.programs = {{45, "FUNCTION 44\n"}, {44, "TASK 2\nVI[2]=1\n"}}}}),
    NameOf);

// OPT-E.7201, OPT-E.7202, OPT-E.7203, OPT-E.7204
INSTANTIATE_TEST_SUITE_P(
    Arithmetic, EndsTheRun,
    ::testing::Values(Row{"division", 7201, 1, "VR[0]=1/VR[1]\n"},
                      Row{"modulo", 7201, 1, "VI[2]=5 MOD VI[3]\n"},
                      Row{"no_short_cut", 7201, 2,
                          "VL[0]=ON\nIF VL[0] OR (1/VR[0] > 0) THEN 5\n5 VI[2]=1\n"},
                      Row{"real_overflow", 7202, 2, "VR[1]=1E18\nVR[0]=VR[1]*100.\n"},
                      Row{"integer_overflow", 7203, 2, "VI[2]=32767\nVI[2]=VI[2]+1\n"},
                      Row{"parameter_overflow",
                          7203,
                          2,
                          "VR[0]=40000.\nFUNCTION 44 (VR[0])\n",
                          {.programs = {{44, "DEFINE PAR[0] = INT\nVI[2]=PAR[0]\n"}}}},
                      Row{"domain", 7204, 2, "VR[1]=-1.\nVR[0]=SQRT(VR[1])\n"},
                      Row{"condition", 7204, 1, "WAIT ASIN(VR[0]+2.) > 0.\n"}),
    NameOf);

// OPT-E.7205, OPT-E.7206
INSTANTIATE_TEST_SUITE_P(
    Values, EndsTheRun,
    ::testing::Values(Row{"speed", 7205, 2, "VR[64]=100.5\nSPEED VR[64]\n"},
                      Row{"accel", 7205, 2, "VR[64]=-1.\nACCEL VR[64]\n"},
                      Row{"oversh", 7205, 2, "VR[64]=101.\nOVERSH VR[64]\n"},
                      Row{"delay", 7205, 2, "VR[64]=-1.\nDELAY VR[64]\n"},
                      Row{"workdef", 7205, 1, "WORKDEF 1,0 (VR[0],80.,1.,90.)\n"},
                      Row{"time", 7205, 5,
                          kAbsolThere +
                              "VR[0]=-1.\nMOVE (1100.,1000.,-400.,0.,0.)/TIME (VR[0],900)\n"},
                      Row{"assign", 7206, 2, "VI[2]=16\nASSIGN OL[12]=VI[2] /4\n"}),
    NameOf);

// OPT-E.7301, OPT-E.7302, OPT-E.7303, OPT-E.7305, OPT-E.7307
INSTANTIATE_TEST_SUITE_P(
    Motion, EndsTheRun,
    ::testing::Values(
        Row{"target", 7301, 1, "MOVE (9000.,0.,0.,0.,0.)\n"},
        Row{"way", 7301, 4,
            "COORD ABSOL\nPATH CIR\nMOVE (100.,3000.,-400.,0.,0.)\n"
            "MOVE (900.,3000.,-400.,0.,0.)/VIA (500.,3400.,-400.,0.,0.)\n"},
        Row{"lin_in_robot", 7302, 3, "COORD ROBOT\nPATH LIN\nMOVE (0.,0.,0.,0.,0.)\n"},
        Row{"fly_before_coord", 7303, 6,
            kAbsolThere + "VI[2]=1\nMOVE (1100.,1000.,-400.,0.,0.)/FLY\nCOORD ROBOT\n"},
        Row{"arc", 7305, 5,
            kAbsolThere +
                "PATH CIR\nMOVE (1010.,1000.,-400.,0.,0.)/VIA (1020.,1000.,-400.,0.,0.)\n"},
        Row{"no_speed", 7307, 5, kAbsolThere + "SPEED 0\nMOVE (1100.,1000.,-400.,0.,0.)\n"}),
    NameOf);

// OPT-E.7309, OPT-E.7310, OPT-E.7401, OPT-E.7403, OPT-E.7404
INSTANTIATE_TEST_SUITE_P(
    MotionAndLaser, EndsTheRun,
    ::testing::Values(
        Row{"normal", 7309, 5,
            kAbsolThere +
                "PATH HOLE (5.)\nMOVE (1000.,1000.,-400.,0.,0.)/VIA (1000.,1000.,-400.,0.,0.)\n"},
        Row{"not_zeroed",
            7310,
            2,
            "VI[2]=1\nMOVE (0.,0.,0.,0.,0.)\n",
            {.machine_state = NotZeroed()}},
        Row{"workdef_missing", 7401, 1, "WORK 1,3/ON\n"},
        Row{"schedule_range", 7403, 2, "VR[0]=64.\nWORKDEF 2,0 (VR[0])\n"},
        Row{"schedule_missing",
            7404,
            2,
            "WORKDEF 2,0 (12)\nWORK 2,0/ON\n",
            {.parameters = {{"SCHEDULES", "11"}}}}),
    NameOf);

// OPT-E.7405, OPT-E.7406, OPT-E.7407, OPT-E.7410
INSTANTIATE_TEST_SUITE_P(
    Laser, EndsTheRun,
    ::testing::Values(
        Row{"schedules_of_efa", 7405, 2, "WORKDEF 2,0 (12)\nWORK 2,0/ON\n", {.profile = "efa-51"}},
        Row{"ramp",
            7406,
            3,
            "WORKDEF 1,0 (8.,75.,0.,50.)\nOL[2]=ON\nWORK 1,0/ON\n",
            {.profile = "efa-51"}},
        Row{"go_with_work", 7407, 2, "WORK 0,0/ON\nGO 2\n", {.programs = {{2, "VI[2]=1\n"}}}},
        Row{"call_with_work", 7407, 2, "WORK 0,0/ON\nCALL 2\n", {.programs = {{2, "VI[2]=1\n"}}}},
        Row{"door",
            7410,
            2,
            "DELAY 1\nWORK 0,0/ON\n",
            {.inputs = {{SimTime(0), InputKind::kDoor, 0, 1.0},
                        {FromSeconds(1), InputKind::kStart}}}}),
    NameOf);

const std::string kRecursive = "VI[2]=VI[2]+1\nFUNCTION 44\n";

// OPT-E.7501, OPT-E.7502, OPT-E.7503, OPT-E.7504, OPT-E.7505
INSTANTIATE_TEST_SUITE_P(
    Nesting, EndsTheRun,
    ::testing::Values(
        Row{"call", 7501, 1, "CALL 1\n"},
        Row{"function", 7502, 2, "FUNCTION 44\n", {.programs = {{44, kRecursive}}}, 44},
        Row{"gosub", 7503, 1, "10 GOSUB 10\n"}, Row{"return", 7504, 1, "RETURN\n"},
        Row{"seterr", 7505, 1, "SETERR VI[2]\n"},
        Row{"seterr_high", 7505, 2, "VI[2]=10000\nSETERR VI[2]\n"}),
    NameOf);

// Warnings: told once at the place, nothing else is told, and the run goes on to its end.
class OnlyWarns : public ::testing::TestWithParam<Row> {};

TEST_P(OnlyWarns, AtItsPlace) {
  const Row& row = GetParam();
  const Ran ran = RunText(row.text, row.options);
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  ExpectTold(row, ran);
  std::vector<int> told;
  for (const Diagnostic& finding : ran.findings) told.push_back(Lookup(finding.code).number);
  EXPECT_EQ(told, std::vector<int>{row.code});
  const Result<MachineState> state = DecodeMachineState(ran.machine_state);
  ASSERT_TRUE(bool(state));
  EXPECT_EQ(state->data.vi[99], 0.0F);
}

// OPT-E.7304, OPT-E.7306, OPT-E.7308, OPT-E.7311, OPT-E.7312
INSTANTIATE_TEST_SUITE_P(
    Motion, OnlyWarns,
    ::testing::Values(
        Row{"fly_cancelled", 7304, 5,
            kAbsolThere + "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nDELAY 1\n"},
        Row{"straight_arc", 7306, 5,
            kAbsolThere +
                "PATH CIR\nMOVE (1010.,1000.,-400.,0.,0.)/VIA (1010.,1000.,-400.,0.,0.)\n"},
        Row{"no_via", 7308, 5, kAbsolThere + "PATH CIR\nMOVE (1010.,1000.,-400.,0.,0.)\n"},
        Row{"hole_without_via", 7308, 5,
            kAbsolThere + "PATH HOLE (5.)\nMOVE (1010.,1000.,-400.,0.,0.)\n"},
        Row{"zero_sysdef", 7311, 2, "VI[2]=1\nSYSDEF (0.0,0.0,0.0,0.0,0.0,0.0)\n"},
        Row{"tcp_axis", 7312, 1, "TCP (0,0,0/0,0,0)\n"}),
    NameOf);

// OPT-E.7313, OPT-E.7315, OPT-E.7316, OPT-E.7320, OPT-B.90
INSTANTIATE_TEST_SUITE_P(
    Tool, OnlyWarns,
    ::testing::Values(
        Row{"off_axis", 7313, 1, "TCP (8.68,0,0.72/0,1.77,0)\n"},
        Row{"beside", 7313, 1, "TCP (0,0,3/0,1,3)\n"},
        Row{"reversed", 7315, 1, "TCP (0,0,0/0,0,5)\n"},
        Row{"reversal", 7316, 5,
            kAbsolThere +
                "SPEED 20\nMOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1000.,1000.,-400.,0.,0.)\n"},
        Row{"limited",
            7320,
            4,
            "COORD ABSOL\nPATH LIN\nSPEED 100\nMOVE (1000.,1000.,-400.,0.,0.)\nMOVE "
            "(1100.,1000.,-400.,0.,0.)\n",
            {.override_percent = 145.0}}),
    NameOf);

// OPT-E.7408, OPT-E.7409, OPT-E.7411
INSTANTIATE_TEST_SUITE_P(
    Laser, OnlyWarns,
    ::testing::Values(
        Row{"work_at_end", 7408, 1, "WORK 0,0/ON\n"},
        Row{"gas", 7409, 2, "OL[8]=ON\nOL[9]=ON\n", {.parameters = {{"GAS_CHANNELS", "3"}}}},
        Row{"schedule_off", 7411, 3,
            "WORKDEF 2,5 (15)\nWORK 0,0/ON\nWORK 2,5/OFF\nWORK 0,0/OFF\n"}),
    NameOf);

// OPT-E.7303, OPT-B.56: a fatal error, and an alarm, are not caught by ERR.
TEST(ErrorRules, FatalErrorsAreNotCaught) {
  const Ran ran =
      RunText("ERR 900\n" + kAbsolThere +
                  "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nCOORD ROBOT\nENDTASK\n900 VI[2]=1\n",
              {.variables = {"VI[2]"}});
  EXPECT_EQ(CodeOf(ran), 7303);
  EXPECT_EQ(ran.variables.at("VI[2]"), "0");
  EXPECT_EQ(CodeOf(RunText("ERR 900\n10 GOSUB 10\n900 VI[2]=1\n")), 7503);
  EXPECT_EQ(CodeOf(RunText("ERR 900\nMOVE (9000.,0.,0.,0.,0.)\n900 VI[2]=1\n")), 7301);
}

// OPT-B.68: the failing instruction was executed, too, and counts, whatever its error.
TEST(ErrorRules, AFailingStepCounts) {
  const std::string three = "COORD ABSOL\nPATH LIN\nMOVE (121.02,2201.2,-350.,0.,0.)";
  for (const std::string& text :
       {three + "/FLY\nCOORD ROBOT\n", three + "\nWORK 1,3/ON\n", three + "\nVR[0]=1/0\n",
        three + "\nMOVE (9000.,0.,0.,0.,0.)\n", three + "/FLY\nMOVE (9000.,0.,0.,0.,0.)\n",
        three + "/FLY\nGOTO 77\n"}) {
    const Ran ran = RunText(text);
    EXPECT_EQ(ran.outcome.place.step, 4) << text;
    EXPECT_EQ(ran.steps, 4U) << text;
    EXPECT_EQ(ran.steps_begun.size(), 4U) << text;
  }
}

// OPT-3.59, OPT-E.60: an ERR whose label is missing is an error of its own, and fatal; it is told
// behind the one that it should have caught.
TEST(ErrorRules, AMissingHandlerIsAFindingOfItsOwn) {
  const Ran ran = RunText("ERR 5\nVI[2]=1\nFUNCTION 44\n", {.programs = {{44, "VR[0]=1/0\n"}}});
  EXPECT_EQ(CodeOf(ran), 60);
  ASSERT_EQ(ran.findings.size(), 2U);
  EXPECT_EQ(ran.findings[0].code, ErrorCode::kDivisionByZero);
  EXPECT_EQ(ran.findings[0].severity, Severity::kProgram);
  EXPECT_EQ(ran.findings[1].code, ErrorCode::kLabelNotFound);
  EXPECT_EQ(ran.findings[1].severity, Severity::kFatal);
  EXPECT_EQ(ran.findings[1].program, 44);
  EXPECT_EQ(ran.findings[1].step, 1);
  EXPECT_EQ(ran.outcome.place.program, 44);
}

// OPT-E.7403, OPT-3.53, OPT-B.36: a literal schedule out of range is an error of the compiler, a
// computed one a program error of the WORKDEF, which ERR catches.
TEST(ErrorRules, AComputedScheduleOutOfRangeIsCaught) {
  const std::string by_number =
      "ERR 9\nVR[30]=64.\nWORKDEF 2,0 (VR[30])\nENDTASK\n9 VI[1]=VI[99]\n";
  EXPECT_EQ(Value(by_number, "VI[1]"), "7403");
  EXPECT_EQ(CodeOf(RunText(by_number)), 0);
  EXPECT_EQ(RunText(by_number).Finding(7403).severity, Severity::kProgram);
  EXPECT_EQ(Value("ERR 9\nVR[30]=0.\nWORKDEF 1,0 (8.,75.,1.,50.,VR[30])\nENDTASK\n9 VI[1]=VI[99]\n",
                  "VI[1]"),
            "7403");
}

// OPT-B.56: a program that cannot be linked is a fatal error of the run, whatever the reason.
TEST(ErrorRules, ADamagedProgramIsFatal) {
  machine::RunSetup setup = SetupOf("ERR 9\nCALL 45\nENDTASK\n9 VI[1]=1\n");
  setup.programs[45] = {.name = "damaged", .object = machine::Bytes::Of("no object")};
  std::vector<Diagnostic> findings;
  struct Listener final : machine::RunObserver {
    explicit Listener(std::vector<Diagnostic>& list) : found(list) {}
    void OnDiagnostic(SimTime, const Diagnostic& diagnostic) override {
      found.push_back(diagnostic);
    }
    std::vector<Diagnostic>& found;
  } listener(findings);
  Result<std::unique_ptr<machine::Run>> run = OptimoFamily().NewRun(std::move(setup), listener);
  ASSERT_TRUE(bool(run));
  EXPECT_EQ((*run)->Advance(FromSeconds(1.0)), machine::RunPhase::kFinished);
  EXPECT_EQ((*run)->outcome().code, ErrorCode::kObjectCorrupt);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].severity, Severity::kFatal);
}

// OPT-7.103, OPT-B.71: a group that ends beyond 99 is refused in an object that comes from
// elsewhere as well, before anything runs.
TEST(ErrorRules, AGroupBeyondTheLastIndexInAForeignObject) {
  for (const auto& [index, code] : {std::pair{96, 0}, {97, 7034}}) {
    machine::RunSetup setup = SetupOf("VI[1]=0\nASSIGN VL[90]=VI[1] /4\n");
    Result<Module> module = DecodeObject(*setup.programs[1].object);
    ASSERT_TRUE(module);
    for (ExprNode& node : module->nodes) {
      if (node.index == 90) node.index = static_cast<std::uint8_t>(index);
    }
    setup.programs[1].object = machine::Bytes::Of(EncodeObject(*module));
    machine::RunObserver nobody;
    const auto run = OptimoFamily().NewRun(std::move(setup), nobody);
    ASSERT_TRUE(bool(run));
    EXPECT_EQ((*run)->Advance(FromSeconds(1.0)), machine::RunPhase::kFinished);
    const std::optional<ErrorCode> found = (*run)->outcome().code;
    EXPECT_EQ(found ? Lookup(*found).number : 0, code) << index;
  }
}

// The numbers of the Optimo for what a motion cannot do; any other error is as it was.
TEST(ErrorRules, ErrorsOfMotionHaveTheirNumbers) {
  for (const auto& [of_motion, wanted] :
       {std::pair{ErrorCode::kCellHoleRadius, 348}, std::pair{ErrorCode::kCellTargetUnusable, 7301},
        std::pair{ErrorCode::kCellArcUndefined, 7305}, std::pair{ErrorCode::kCellNoMotion, 7307},
        std::pair{ErrorCode::kCellHoleNormal, 7309}, std::pair{ErrorCode::kDivisionByZero, 7201}}) {
    const Error made = OnOptimo({of_motion, "why", {}});
    EXPECT_EQ(Lookup(made.code).number, wanted);
    EXPECT_EQ(made.detail, "why");
  }
}

// optimo.md section C: a computed schedule is an error of the program; what is found when a program
// is linked or loaded is fatal. OPT-B.36, OPT-B.56
TEST(ErrorRules, SomeCodesHaveAnotherSeverityInARun) {
  EXPECT_EQ(SeverityInRun(ErrorCode::kScheduleRange), Severity::kProgram);
  EXPECT_EQ(SeverityInRun(ErrorCode::kCmosFull), Severity::kFatal);
  EXPECT_EQ(SeverityInRun(ErrorCode::kObjectCorrupt), Severity::kFatal);
  EXPECT_EQ(SeverityInRun(ErrorCode::kDivisionByZero), Severity::kProgram);
  EXPECT_EQ(SeverityInRun(ErrorCode::kFlyCancelled), Lookup(ErrorCode::kFlyCancelled).severity);
  EXPECT_EQ(SeverityInRun(ErrorCode::kTargetOutOfTravel), Severity::kAlarm);
}

// OPT-E.7310, OPT-6.22: a simulated MOVE needs no zero; ZERO makes the machine ready.
TEST(ErrorRules, ZeroMakesTheMachineReady) {
  const RunOptions cold{.machine_state = NotZeroed()};
  EXPECT_EQ(CodeOf(RunText("ZERO\nMOVE (10.,0.,0.,0.,0.)\n", cold)), 0);
  RunOptions dry = cold;
  dry.simul = machine::ProgramStep{.program = 1, .step = 3};
  EXPECT_EQ(CodeOf(RunText("ZERO\nMOVE (10.,0.,0.,0.,0.)\nVI[2]=1\n", dry)), 0);
  const Ran real = RunText("ZERO\nVI[2]=1\nMOVE (10.,0.,0.,0.,0.)\n", dry);
  EXPECT_EQ(CodeOf(real), 7310);
  EXPECT_EQ(real.outcome.place.step, 3);
}

// OPT-E.7610: the emergency stop ends the run where it is: motion, beam, shutter.
TEST(ErrorRules, EmergencyStop) {
  const Ran ran =
      RunText("COORD ABSOL\nPATH LIN\nSPEED 10\nWORK 0,0/ON\nMOVE (521.02,2201.2,-350.,0.,0.)\n",
              {.inputs = {{FromSeconds(2.0), InputKind::kEmergencyStop}}, .variables = {"VI[99]"}});
  EXPECT_EQ(CodeOf(ran), 7610);
  EXPECT_EQ(ran.outcome.place.step, 5);
  EXPECT_NEAR(ran.time_s, 2.0, 1e-9);
  EXPECT_EQ(ran.variables.at("VI[99]"), "7610");
  EXPECT_EQ(ran.Count("beam off"), 1);
  EXPECT_EQ(ran.Count("shutter closed"), 1);
  // 2 s at 50 mm/s, less half of the ramp.
  EXPECT_NEAR(ran.end.tip.tip.x(), 21.02 + 100.0 - 50.0 * std::sqrt(50.0 / 40000.0), 1e-6);
}

// OPT-E.7901, OPT-E.7902, OPT-E.7904: what the cell ends: beam off and shutter closed.
TEST(ErrorRules, BudgetsAndCancelling) {
  const Ran steps = RunText("WORK 0,0/ON\n10 GOTO 10\n", {.budget = {.steps = 1000}});
  EXPECT_EQ(steps.outcome.kind, OutcomeKind::kBudgetExceeded);
  EXPECT_EQ(CodeOf(steps), 7901);
  EXPECT_EQ(steps.steps, 1000U);
  EXPECT_EQ(steps.outcome.place.step, 2);
  EXPECT_EQ(steps.Count("shutter closed"), 1);
  const Ran time =
      RunText("WORK 0,0/ON\nDELAY 100\n", {.budget = {.virtual_time = std::chrono::seconds(5)}});
  EXPECT_EQ(CodeOf(time), 7902);
  EXPECT_NEAR(time.time_s, 5.0, 1e-9);
  EXPECT_EQ(time.Count("shutter closed"), 1);

  machine::RunObserver nobody;
  Result<std::unique_ptr<machine::Run>> run = OptimoFamily().NewRun(SetupOf("DELAY 100\n"), nobody);
  ASSERT_TRUE(bool(run));
  (*run)->Advance(std::chrono::seconds(3));
  (*run)->End(OutcomeKind::kCancelled, ErrorCode::kCancelled);
  EXPECT_EQ((*run)->Advance(std::chrono::seconds(9)), machine::RunPhase::kFinished);
  EXPECT_EQ(Lookup(*(*run)->outcome().code).number, 7904);
  EXPECT_EQ((*run)->state().time, std::chrono::seconds(3));
}

// OPT-E.7205, OPT-3.08: the old value stays when a computed one is refused.
TEST(ErrorRules, ARefusedValueChangesNothing) {
  const Ran ran = RunText(
      "COORD ABSOL\nPATH LIN\nSPEED 10\nVR[64]=150.\nERR 900\nSPEED VR[64]\nENDTASK\n900 MOVE "
      "(221.02,2201.2,-350.,0.,0.)\n");
  ASSERT_EQ(ran.parts.size(), 1U);
  EXPECT_NEAR(ran.parts[0].SpeedAt(ran.parts[0].duration_s() / 2), 50.0, 1e-9);
}

// A delay or a time beyond all figures is a long one, not a short one.
TEST(ErrorRules, EndlessTimesAreLong) {
  const machine::RunBudget hour{.steps = 1000, .virtual_time = std::chrono::hours(1)};
  EXPECT_EQ(CodeOf(RunText("VR[0]=9E18\nDELAY VR[0]\n", {.budget = hour})), 7902);
  EXPECT_EQ(CodeOf(RunText("VR[0]=9E18\nTIMER (VR[0],900) /AUTO\nDELAY 1\n900 VI[2]=1\n",
                           {.budget = hour})),
            0);
  EXPECT_EQ(
      CodeOf(RunText(kAbsolThere + "VR[0]=9E18\nMOVE (1100.,1000.,-400.,0.,0.)/TIME (VR[0],900)\n",
                     {.budget = hour})),
      0);
}

// OPT-7.79, OPT-B.55: whichever value of an instruction cannot be had, it is the error of that
// step, and nothing behind it is carried out.
TEST(ErrorRules, EachValueOfAnInstructionMayFail) {
  const RunOptions options{.programs = {{44, "VI[3]=1\n"}, {45, "VI[3]=1\n"}},
                           .variables = {"VI[3]"}};
  for (const std::string statement :
       {"CALL 45 (1/VR[0])", "FUNCTION 44 (1/VR[0])", "TIMER (1/VR[0],900)", "DELAY 1/VR[0]",
        "SETERR 1/VR[0]", "WORKDEF 1,0 (8.,75.,1/VR[0],50.)", "WORK 0,0/ON/START (1/VR[0])",
        "PATH HOLE (1/VR[0])", "SPEED 1/VR[0]", "MOVE (100.,2201.2,-50.,0.,1/VR[0])",
        "MOVE (100.,2201.2,-50.,0.,0.)/TIME (1/VR[0],900)",
        "MOVE (100.,2201.2,-50.,0.,0.)/START (1/VR[0])",
        "MOVE (100.,2201.2,-50.,0.,0.)/END (1/VR[0])"}) {
    const Ran ran = RunText("VI[2]=1\n" + statement + "\nVI[3]=1\nENDTASK\n900 RETURN\n", options);
    EXPECT_EQ(CodeOf(ran), 7201) << statement;
    EXPECT_EQ(ran.outcome.place.program, 1) << statement;
    EXPECT_EQ(ran.outcome.place.step, 2) << statement;
    EXPECT_EQ(ran.variables.at("VI[3]"), "0") << statement;
    EXPECT_TRUE(ran.parts.empty()) << statement;
  }
  for (const std::string path : {"CIR", "HOLE (5.)"}) {
    const Ran ran = RunText("COORD ABSOL\nPATH " + path +
                            "\nMOVE (100.,2201.2,-350.,0.,0.)/VIA (1/VR[0],0.,0.,0.,0.)\n");
    EXPECT_EQ(CodeOf(ran), 7201) << path;
    EXPECT_EQ(ran.outcome.place.step, 3) << path;
  }
}

// OPT-7.102, OPT-E.7203, OPT-E.931: so it is with the value of ASSIGN, and with an output of its
// group that is not fitted: OL[9], of two gas channels.
TEST(ErrorRules, AnAssignMayFail) {
  EXPECT_EQ(CodeOf(RunText("VR[1]=40000.\nASSIGN VL[20]=VR[1] /16\n")), 7203);
  const Ran gas =
      RunText("VR[1]=2.\nASSIGN OL[8]=VR[1] /2\nVI[3]=1\n", {.variables = {"OL[9]", "VI[3]"}});
  EXPECT_EQ(CodeOf(gas), 931);
  EXPECT_EQ(gas.outcome.place.step, 2);
  EXPECT_EQ(gas.variables.at("OL[9]") + gas.variables.at("VI[3]"), "10");
}

// OPT-4.49, OPT-B.60: half a millimetre off its zero an axis moves, too.
TEST(ErrorRules, ZeroMovesTheShortestWay) {
  MachineState state = NewMachine(Resolve(machine::Parameters(OptimoParameterTable())));
  state.axes = {.column = {0.5, 0.0, 0.0}, .a_rad = 0.0, .b_rad = 0.0};
  const Ran ran = RunText("ZERO\n", {.machine_state = EncodeMachineState(state)});
  ASSERT_EQ(ran.parts.size(), 1U);
  EXPECT_GT(ran.parts[0].duration_s(), 0.0);
  EXPECT_NEAR(ran.end.axes.column.x(), 0.0, 1e-9);
}

}  // namespace
}  // namespace rmlcell::optimo::testing
