#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/machine/machine_state.h"
#include "engine/optimo/machine/optimo_parameters.h"
#include "tests/engine/optimo/control/run_text.h"

// The parameters of the machine, what it keeps from run to run, and what is counted over runs.
namespace rmlcell::optimo::testing::machine_rules {
namespace {

using ::testing::ElementsAre;

machine::Parameters Standard() { return machine::Parameters(OptimoParameterTable()); }

// OPT-B.01, OPT-B.02: the table of section B.1, with the limits of motion.md section 1.
TEST(MachineRules, StandardParameters) {
  const machine::Parameters p = Standard();
  const std::pair<const char*, double> figures[] = {{"VMAX", 500},
                                                    {"AMAX", 2000},
                                                    {"JMAX", 40'000},
                                                    {"AXIS_SPEED_X", 500},
                                                    {"AXIS_SPEED_Y", 500},
                                                    {"AXIS_SPEED_Z", 500},
                                                    {"AXIS_ACCEL_X", 2000},
                                                    {"AXIS_ACCEL_Y", 2000},
                                                    {"AXIS_ACCEL_Z", 2000},
                                                    {"AXIS_ACCEL_A", 20},
                                                    {"AXIS_ACCEL_B", 20},
                                                    {"AXIS_JERK_X", 40'000},
                                                    {"AXIS_JERK_Y", 40'000},
                                                    {"AXIS_JERK_Z", 40'000},
                                                    {"AXIS_JERK_A", 400},
                                                    {"AXIS_JERK_B", 400},
                                                    {"HEAD_LENGTH", 300},
                                                    {"TRAVEL_X_MIN", -600},
                                                    {"TRAVEL_X_MAX", 3600},
                                                    {"TRAVEL_Y_MIN", -600},
                                                    {"TRAVEL_Y_MAX", 3100},
                                                    {"TRAVEL_Z_MIN", -1300},
                                                    {"TRAVEL_Z_MAX", 1100},
                                                    {"TRAVEL_A_MIN", -12.6},
                                                    {"TRAVEL_A_MAX", 12.6},
                                                    {"TRAVEL_B_MIN", -2.4},
                                                    {"TRAVEL_B_MAX", 2.4},
                                                    {"HOME_X", 21.02},
                                                    {"HOME_Y", 2201.2},
                                                    {"HOME_Z", -50},
                                                    {"HOME_A", 0},
                                                    {"HOME_B", 0},
                                                    {"MECH_ZERO_X", 0},
                                                    {"MECH_ZERO_Y", 0},
                                                    {"MECH_ZERO_Z", 0},
                                                    {"MECH_ZERO_A", 0},
                                                    {"MECH_ZERO_B", 0},
                                                    {"SAFE_Z", -50},
                                                    {"CYCLE", 0.048},
                                                    {"SETTLE", 0.048},
                                                    {"GAS_CHANNELS", 2},
                                                    {"OBJECT_LIMIT", 34'000},
                                                    {"EXECUTABLE_LIMIT", 32'768},
                                                    {"CMOS_SIZE", 1'048'576},
                                                    {"GOSUB_DEPTH", 16},
                                                    {"CALL_TIME", 0},
                                                    {"SCHEDULES", 63},
                                                    {"LASER_POWER", 1500}};
  for (const auto& [name, value] : figures) EXPECT_EQ(p.Number(name), value) << name;
  EXPECT_NEAR(p.Number("AXIS_SPEED_A"), 6.283185, 1e-6);
  EXPECT_NEAR(p.Number("AXIS_SPEED_B"), 6.283185, 1e-6);
  const std::pair<const char*, const char*> words[] = {{"COORD_DEFAULT", "ROBOT"},
                                                       {"PATH_DEFAULT", "PTP"},
                                                       {"LASER", "ARROW"},
                                                       {"TEACH_SIM", "OFF"},
                                                       {"ROTARY_TABLE", "OFF"}};
  for (const auto& [name, value] : words) EXPECT_EQ(p.Word(name), value) << name;
}

// OPT-B.01: the profiles: mc-1000ipm is 1000 inch/min, pw-1993 begins in ABSOL and LIN.
TEST(MachineRules, Profiles) {
  const auto with = [](std::string_view id) {
    machine::Parameters p = Standard();
    for (const machine::MachineProfile& profile : OptimoProfiles()) {
      if (profile.id == id) {
        EXPECT_TRUE(p.Apply(profile).ok());
      }
    }
    return Resolve(p);
  };
  EXPECT_NEAR(with("mc-1000ipm").limits.tip_speed_mm_s, 1000.0 * 25.4 / 60.0, 1e-3);
  EXPECT_EQ(with("standard").limits.tip_speed_mm_s, 500.0);
  EXPECT_EQ(with("pw-1993").coord_default, CoordType::kAbsol);
  EXPECT_EQ(with("pw-1993").path_default, PathType::kLin);
  EXPECT_EQ(with("pw-1993").laser, Laser::kArrow);
  EXPECT_EQ(with("efa-51").laser, Laser::kEfa51);
  EXPECT_EQ(with("efa-51").coord_default, CoordType::kRobot);
}

// OPT-B.01: each parameter comes to its own place: all of them different.
TEST(MachineRules, EachParameterHasItsPlace) {
  machine::Parameters p = Standard();
  const std::string axes[] = {"X", "Y", "Z", "A", "B"};
  for (int n = 0; n < 5; ++n) {
    EXPECT_TRUE(p.Set("AXIS_SPEED_" + axes[n], 11.0 + n).ok());
    EXPECT_TRUE(p.Set("AXIS_ACCEL_" + axes[n], 21.0 + n).ok());
    EXPECT_TRUE(p.Set("AXIS_JERK_" + axes[n], 131.0 + n).ok());
    EXPECT_TRUE(p.Set("TRAVEL_" + axes[n] + "_MIN", -41.0 - n).ok());
    EXPECT_TRUE(p.Set("TRAVEL_" + axes[n] + "_MAX", 51.0 + n).ok());
    EXPECT_TRUE(p.Set("HOME_" + axes[n], 1.0 + n).ok());
    EXPECT_TRUE(p.Set("MECH_ZERO_" + axes[n], 7.0 + n).ok());
  }
  const std::pair<const char*, double> figures[] = {
      {"VMAX", 61},        {"AMAX", 62},       {"JMAX", 163},         {"SETTLE", 0.25},
      {"HEAD_LENGTH", 65}, {"CYCLE", 0.064},   {"OBJECT_LIMIT", 201}, {"EXECUTABLE_LIMIT", 202},
      {"CMOS_SIZE", 2003}, {"GOSUB_DEPTH", 5}, {"CALL_TIME", 1.5},    {"LASER_POWER", 204},
      {"GAS_CHANNELS", 3}, {"SAFE_Z", -71},    {"SCHEDULES", 11}};
  for (const auto& [name, value] : figures) EXPECT_TRUE(p.Set(name, value).ok()) << name;
  for (const char* name : {"TEACH_SIM", "ROTARY_TABLE"}) {
    EXPECT_TRUE(p.Set(name, std::string_view("ON")).ok());
  }
  const OptimoParameters made = Resolve(p);
  EXPECT_THAT(made.limits.axes.speed, ElementsAre(11, 12, 13, 14, 15));
  EXPECT_THAT(made.limits.axes.acceleration, ElementsAre(21, 22, 23, 24, 25));
  EXPECT_THAT(made.limits.axes.jerk, ElementsAre(131, 132, 133, 134, 135));
  EXPECT_THAT(made.limits.axes.travel_min, ElementsAre(-41, -42, -43, -44, -45));
  EXPECT_THAT(made.limits.axes.travel_max, ElementsAre(51, 52, 53, 54, 55));
  EXPECT_EQ(made.home, (motion::AxisPose{{1, 2, 3}, 4, 5}));
  EXPECT_EQ(made.mechanical_zero, (motion::AxisPose{{7, 8, 9}, 10, 11}));
  EXPECT_EQ(made.limits.tip_speed_mm_s, 61);
  EXPECT_EQ(made.limits.tip_acceleration_mm_s2, 62);
  EXPECT_EQ(made.limits.tip_jerk_mm_s3, 163);
  EXPECT_EQ(made.limits.settling_s, 0.25);
  EXPECT_EQ(made.head_length_mm, 65);
  EXPECT_EQ(made.cycle_s, 0.064);
  EXPECT_EQ(made.object_limit, 201);
  EXPECT_EQ(made.executable_limit, 202);
  EXPECT_EQ(made.cmos_bytes, 2003);
  EXPECT_EQ(made.gosub_depth, 5);
  EXPECT_EQ(made.call_time_s, 1.5);
  EXPECT_EQ(made.laser_w, 204);
  EXPECT_EQ(made.gas_channels, 3);
  EXPECT_TRUE(made.teach_simulator);
  EXPECT_TRUE(made.rotary_table);
  const OptimoParameters standard = Resolve(Standard());
  EXPECT_FALSE(standard.teach_simulator);
  EXPECT_FALSE(standard.rotary_table);

  const machine::MachineShape shape = OptimoFamily().Shape(p);
  EXPECT_TRUE(shape.five_axis);
  EXPECT_EQ(shape.travel.min, (motion::MachineVector{-41, -42, -43}));
  EXPECT_EQ(shape.travel.max, (motion::MachineVector{51, 52, 53}));
  ASSERT_TRUE(shape.limits.has_value());
  EXPECT_EQ(shape.limits->tip_speed_mm_s, 61);
  EXPECT_EQ(shape.laser_watts, 204);
}

// OPT-B.02: a new machine is zeroed, stands at home with the door closed, and has nothing set.
TEST(MachineRules, ANewMachine) {
  const MachineState state = NewMachine(Resolve(Standard()));
  EXPECT_TRUE(state.zeroed);
  EXPECT_FALSE(state.door_open);
  EXPECT_EQ(state.axes, (motion::AxisPose{{21.02, 2201.2, -50.0}, 0.0, 0.0}));
  EXPECT_FALSE(state.work_offset.active);
  EXPECT_EQ(state.outputs.schedule, 0);
  EXPECT_EQ(state.outputs.table_deg, 0.0);
  EXPECT_EQ(state.selected, 0);
  EXPECT_FALSE(state.breakpoint.has_value());
  EXPECT_FALSE(state.simul.has_value());
  EXPECT_EQ(Value("VR[0]=IA[0]\n", "VR[0]"), "21.02");
}

// What a machine keeps is written and read whole: every member, each a value of its own.
TEST(MachineRules, TheStateIsKeptWhole) {
  MachineState state = NewMachine(Resolve(Standard()));
  DataArea& data = state.data;
  for (std::size_t n = 0; n < 100; ++n) {
    const float f = static_cast<float>(n);
    data.vr[n] = f + 0.5F;
    data.vi[n] = -f;
    data.ia[n] = f + 1000.25F;
    data.oa[n] = f + 2000.25F;
    data.ia_physical[n] = f + 3000.25F;
    state.outputs.analogue[n] = f + 4000.25F;
    data.vl[n] = n % 2 == 0;
    data.il[n] = n % 3 == 0;
    data.ol[n] = n % 5 == 0;
    data.il_physical[n] = n % 7 == 0;
    state.outputs.logical[n] = n % 11 == 0;
  }
  state.axes = {{1.5, 2.5, 3.5}, 0.25, -0.5};
  state.tool = {.offset = {4.5, 5.5, 6.5}, .reference = {7.5, 8.5, 9.5}};
  state.work_offset = {.active = true, .values = {1, 2, 3, 4, 5, 6}};
  state.outputs.schedule = 63;
  state.outputs.table_deg = -90.5;
  state.zeroed = false;
  state.door_open = true;
  state.selected = 99;
  state.breakpoint = machine::ProgramStep{.program = 45, .step = 70'000};
  state.simul = machine::ProgramStep{.program = 46, .step = 8};
  const std::string bytes = EncodeMachineState(state);
  const Result<MachineState> read = DecodeMachineState(bytes);
  ASSERT_TRUE(bool(read));
  EXPECT_EQ(read->data.vr, data.vr);
  EXPECT_EQ(read->data.vi, data.vi);
  EXPECT_EQ(read->data.vl, data.vl);
  EXPECT_EQ(read->data.il, data.il);
  EXPECT_EQ(read->data.ol, data.ol);
  EXPECT_EQ(read->data.ia, data.ia);
  EXPECT_EQ(read->data.oa, data.oa);
  EXPECT_EQ(read->data.il_physical, data.il_physical);
  EXPECT_EQ(read->data.ia_physical, data.ia_physical);
  EXPECT_EQ(read->outputs.logical, state.outputs.logical);
  EXPECT_EQ(read->outputs.analogue, state.outputs.analogue);
  EXPECT_EQ(read->axes, state.axes);
  EXPECT_EQ(read->tool.offset, state.tool.offset);
  EXPECT_EQ(read->tool.reference, state.tool.reference);
  EXPECT_TRUE(read->work_offset.active);
  EXPECT_EQ(read->work_offset.values, state.work_offset.values);
  EXPECT_EQ(read->outputs.schedule, 63);
  EXPECT_EQ(read->outputs.table_deg, -90.5);
  EXPECT_FALSE(read->zeroed);
  EXPECT_TRUE(read->door_open);
  EXPECT_EQ(read->selected, 99);
  EXPECT_EQ(read->breakpoint->program, 45);
  EXPECT_EQ(read->breakpoint->step, 70'000);
  EXPECT_EQ(read->simul->program, 46);
  EXPECT_EQ(read->simul->step, 8);
}

// The three flags are kept apart, each both ways.
TEST(MachineRules, EachFlagOfTheStateIsItsOwn) {
  for (int bits = 0; bits < 8; ++bits) {
    MachineState state;
    state.work_offset.active = (bits & 1) != 0;
    state.zeroed = (bits & 2) != 0;
    state.door_open = (bits & 4) != 0;
    const Result<MachineState> read = DecodeMachineState(EncodeMachineState(state));
    ASSERT_TRUE(bool(read));
    EXPECT_EQ(read->work_offset.active, state.work_offset.active);
    EXPECT_EQ(read->zeroed, state.zeroed);
    EXPECT_EQ(read->door_open, state.door_open);
    EXPECT_FALSE(read->breakpoint.has_value());
  }
}

// Cells keep these bytes: what is on is one byte 1, a number lies in its own four, lowest first.
TEST(MachineRules, TheFormOfTheBytesStays) {
  const std::string off = EncodeMachineState(MachineState{});
  EXPECT_EQ(off.substr(0, 8), "OPTSTATE");
  for (const int number : {0, 98}) {
    MachineState state;
    state.outputs.logical[number] = true;
    std::string on = EncodeMachineState(state);
    ASSERT_EQ(on.size(), off.size());
    const auto at = static_cast<std::size_t>(std::ranges::mismatch(on, off).in1 - on.begin());
    ASSERT_LT(at, on.size());
    EXPECT_EQ(off[at], 0);
    EXPECT_EQ(on[at], 1);
    on[at] = 0;
    EXPECT_EQ(on, off);
  }
  MachineState state;
  state.data.vr[0] = 1.0F;  // 3F800000
  EXPECT_EQ(EncodeMachineState(state).substr(9, 4), std::string("\0\0\x80\x3F", 4));
  EXPECT_EQ(off[8], 2);  // the version
}

// Bytes of another kind or version, too few or too many of them, and "not a number" are refused.
TEST(MachineRules, ForeignBytesAreRefused) {
  const std::string good = EncodeMachineState(MachineState{});
  ASSERT_TRUE(bool(DecodeMachineState(good)));
  std::string other = good;
  other[0] = 'X';
  std::string version_0 = good;
  version_0[8] = 0;
  std::string version_3 = good;
  version_3[8] = 3;
  std::string nan = good;
  for (int k = 0; k < 4; ++k) nan[9 + k] = '\xFF';  // VR[0]
  const std::string wrong[] = {"",        "OPTSTATE", other,       version_0,
                               version_3, nan,        good + '\0', good.substr(0, good.size() - 1)};
  for (const std::string& bytes : wrong) {
    const Result<MachineState> read = DecodeMachineState(bytes);
    ASSERT_FALSE(bool(read)) << bytes.size();
    EXPECT_EQ(read.error().code, ErrorCode::kCellBadText);
  }
  machine::RunObserver nobody;
  machine::RunSetup setup = SetupOf("VI[2]=1\n");
  setup.machine_state = "no state";
  EXPECT_FALSE(bool(OptimoFamily().NewRun(std::move(setup), nobody)));
}

// OPT-B.63, OPT-7.70: 1 in the first run after a program was selected, one more with each start of
// it; another program begins at 1, and so does the first when it is selected again.
TEST(MachineRules, ExecutionsSinceSelection) {
  const auto run_of = [](int main, const std::string& state) {
    machine::RunSetup setup = SetupOf("VI[2]=VI[98]\n", {.programs = {{45, "VI[2]=VI[98]\n"}}});
    setup.main_program = main;
    setup.machine_state = state;
    machine::RunObserver nobody;
    Result<std::unique_ptr<machine::Run>> run = OptimoFamily().NewRun(std::move(setup), nobody);
    EXPECT_TRUE(bool(run));
    (*run)->Advance(At(1.0));
    return std::pair((*run)->ReadVariable("VI[2]")->text, (*run)->SaveMachine());
  };
  auto [first, state] = run_of(45, "");
  EXPECT_EQ(first, "1");
  const std::tuple<int, const char*> later[] = {
      {45, "2"}, {45, "3"}, {1, "1"}, {1, "2"}, {45, "1"}};
  for (const auto& [main, wanted] : later) {
    const auto [count, after] = run_of(main, state);
    EXPECT_EQ(count, wanted) << main;
    state = after;
  }
}

// OPT-7.70, OPT-B.63: a CALL is no execution of a main program, a GO is one of the other, also when
// it goes to itself.
TEST(MachineRules, GoSelectsAnew) {
  EXPECT_EQ(Value("CALL 45\nVI[2]=VI[98]\n", "VI[2]", {.programs = {{45, "VI[3]=1\n"}}}), "1");
  EXPECT_EQ(Value("VI[3]=VI[3]+1\nVI[2]=VI[98]\nIF VI[3] >= 3 THEN 9\nGO 1\n9 ENDTASK\n", "VI[2]"),
            "1");
}

// What a family says of itself, and its figures.
TEST(MachineRules, TheFamily) {
  const machine::MachineFamily& family = OptimoFamily();
  EXPECT_EQ(family.info().id, "optimo");
  EXPECT_TRUE(family.info().has_executables);
  EXPECT_EQ(family.info().schedules, 63);
  EXPECT_TRUE(family.info().checked_by_running);
  EXPECT_FALSE(family.info().hold_in_remote);  // OPT-4.17
  EXPECT_EQ(family.info().no_slot, ErrorCode::kProgramNumber);
  EXPECT_EQ(family.info().empty_slot, ErrorCode::kProgramMissing);
  EXPECT_TRUE(family.HasVariable(Standard(), "VR[99]"));
  EXPECT_FALSE(family.HasVariable(Standard(), "VR[100]"));
  machine::RunObserver nobody;
  Result<std::unique_ptr<machine::Run>> run =
      family.NewRun(SetupOf("CALL 45\n", {.programs = {{45, "VI[2]=1\n"}}}), nobody);
  ASSERT_TRUE(bool(run));
  (*run)->Advance(At(1.0));
  const std::vector<machine::Figure> figures = (*run)->figures();
  ASSERT_EQ(figures.size(), family.figures().size());
  for (std::size_t n = 0; n < figures.size(); ++n)
    EXPECT_EQ(figures[n].name, family.figures()[n].name);
  EXPECT_EQ(figures[1].value, 2.0);  // executables made: 1 and 45
}

// OPT-1.15: an executable is stored for the program that it was made of, and no other.
TEST(MachineRules, ExecutablesBelongToTheirSlot) {
  const std::string bytes =
      RunText("CALL 45\n", {.programs = {{45, "VI[2]=1\n"}}}).executables.at(45);
  EXPECT_TRUE(OptimoFamily().CheckExecutable(bytes, 45).ok());
  const Status other = OptimoFamily().CheckExecutable(bytes, 46);
  ASSERT_FALSE(other.ok());
  EXPECT_EQ(other.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_NE(other.error().detail.find("145"), std::string::npos) << other.error().detail;
  EXPECT_FALSE(OptimoFamily().CheckExecutable("no executable", 45).ok());
  // One that lies in another slot all the same runs, with a warning.
  const Ran ran = RunText(
      "CALL 46\n",
      {.programs = {{46, "VI[2]=2\n"}}, .variables = {"VI[2]"}, .executables = {{46, bytes}}});
  EXPECT_TRUE(ran.Told("E7110"));
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
  EXPECT_EQ(CodeOf(RunText("CALL 46\n", {.programs = {{46, "VI[2]=2\n"}},
                                         .executables = {{46, "no executable"}}})),
            7034);
}

// OPT-6.42, OPT-B.65: a suspended run keeps its executable: what is stored meanwhile is for the
// next start. A circle that was stopped goes on through its old via point to its old end.
TEST(MachineRules, ASuspendedRunKeepsItsSteps) {
  const auto arc = [](const std::string& end, const std::string& via) {
    return "COORD ABSOL\nPATH CIR\nSPEED 10\nMOVE (" + end + ",-350.,0.,0.)/VIA (" + via +
           ",-350.,0.,0.)\n";
  };
  machine::RunSetup stored = SetupOf(arc("221.02,2201.2", "121.02,2301.2"),
                                     {.inputs = {{At(1.0), machine::InputKind::kStop}}});
  machine::RunObserver nobody;
  Result<std::unique_ptr<machine::Run>> run = OptimoFamily().NewRun(stored, nobody);
  ASSERT_TRUE(bool(run));
  EXPECT_EQ((*run)->Advance(At(5.0)), machine::RunPhase::kHalted);
  stored.programs[1] = SetupOf(arc("21.02,2001.2", "121.02,2101.2")).programs.at(1);
  (*run)->Apply({(*run)->state().time, machine::InputKind::kStart});
  double top = 0.0;
  const SimTime begin = (*run)->state().time;
  for (int k = 0; (*run)->Advance(begin + At(0.1 * k)) == machine::RunPhase::kRunning; ++k) {
    top = std::max(top, (*run)->state().tip.tip.y());
  }
  EXPECT_NEAR(top, 2301.2, 0.1);
  EXPECT_NEAR((*run)->state().tip.tip.x(), 221.02, 1e-4);
  EXPECT_NEAR((*run)->state().tip.tip.y(), 2201.2, 1e-4);
}

// OPT-6.44, OPT-1.27: in the text of a program a sequence number stays with its instruction when
// others are put before it, and a number that is left alone goes to the instruction behind it.
TEST(MachineRules, SequenceNumbersStayWithTheirInstructions) {
  EXPECT_EQ(Value("GOTO 10\nVI[2]=1\n10 VI[3]=1\nVI[4]=VI[2]+10\n", "VI[4]"), "10");
  EXPECT_EQ(Value("GOTO 10\nVI[2]=1\nVI[2]=2\nVI[2]=3\n10 VI[3]=1\nVI[4]=VI[2]+10\n", "VI[4]"),
            "10");
  const Ran deleted = RunText("GOTO 10\nVI[2]=1\n10\nVI[4]=VI[2]+10\n", {.variables = {"VI[4]"}});
  EXPECT_EQ(deleted.variables.at("VI[4]"), "10");
  EXPECT_THAT(deleted.steps_begun, ElementsAre(1, 3));
}

// OPT-5.16: what a recorded MOVE would hold is the position in machine coordinates: of the tip and
// of the column. A SYSDEF makes no difference to it.
TEST(MachineRules, PositionsAreOfTheMachine) {
  const Ran ran = RunText(
      "COORD ABSOL\nSYSDEF (100.,100.,0.,0.5,0.,0.)\nTCP (0.,0.,5./0.,0.,-5.)\nSYSDEF\n"
      "MOVE (100.,200.,-500.,0.,0.)\nSYSDEF (50.,60.,0.,0.,0.,0.)\n");
  EXPECT_NEAR(ran.end.tip.tip.x(), 100.0, 1e-4);
  EXPECT_NEAR(ran.end.tip.tip.y(), 200.0, 1e-4);
  EXPECT_NEAR(ran.end.tip.tip.z(), -500.0, 1e-4);
  EXPECT_NEAR(ran.end.axes.column.z(), -205.0, 1e-4);
}

// OPT-5.20, OPT-2.21: points that were recorded as plain MOVEs run as straight moves, also in CIR.
TEST(MachineRules, PlainMovesAreStraight) {
  const Ran ran = RunText(
      "COORD ABSOL\nPATH CIR\nMOVE (121.02,2301.2,-350.,0.,0.)\n"
      "MOVE (221.02,2201.2,-350.,0.,0.)\n");
  EXPECT_EQ(ran.Count("E7308"), 2);
  EXPECT_LT(ran.DistanceTo({71.02, 2251.2, -350.0}), 1e-4);
  EXPECT_LT(ran.DistanceTo({171.02, 2251.2, -350.0}), 1e-4);
}

// OPT-5.25, OPT-2.44: /FLY belongs to its MOVE: without it the machine stops at every target.
TEST(MachineRules, WithoutFlyEveryTargetIsReached) {
  const Ran ran =
      RunText(kThere + "MOVE (1100.,1000.,-400.,0.,0.)\nMOVE (1100.,1100.,-400.,0.,0.)\n");
  EXPECT_LT(ran.DistanceTo({1100.0, 1000.0, -400.0}), 1e-9);
  EXPECT_EQ(ran.parts[1].SpeedAt(ran.parts[1].duration_s()), 0.0);
}

// OPT-5.21: the radius of a hole is that of the last PATH HOLE of the program.
TEST(MachineRules, TheRadiusIsThatOfThePathStep) {
  const Ran ran = RunText(
      "COORD ABSOL\nPATH HOLE (5.)\nPATH LIN\nPATH HOLE (12.7)\n"
      "MOVE (121.02,2201.2,-350.,0.,0.)/VIA (121.02,2201.2,-150.,0.,0.)\n");
  EXPECT_NEAR(ran.end.tip.tip.x(), 121.02 - 12.7, 1e-4);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::machine_rules
