// Steps put in and taken out, BREAK and SIMUL; what is stored, and what is not.
#include "tests/engine/optimo/handbox/handbox_bed.h"

namespace rmlcell::optimo {
namespace {

class EditingKeys : public HandboxTest {};

// OPT-6.39 OPT-4.28: before the step that is shown, which is shown again.
TEST_F(EditingKeys, RecInsertsBeforeTheStep) {
  Have({{12, "COORD ABSOL\nPATH LIN\nDELAY 1\nDELAY 2\nDELAY 3\n"}});
  Keys("JOB 1 2 NEXT 4 ENT");
  EXPECT_EQ(Shows(), "P=12S=0004I=DELAY");
  Keys("MOV ENT REC");
  EXPECT_EQ(Shows(), "P=12S=0005I=DELAY");
  EXPECT_THAT(Program(12), ElementsAre("COORD ABSOL", "PATH LIN", "DELAY 1", "SPEED 70.0",
                                       "DELAY 2", "DELAY 3"));
}

// OPT-6.40 OPT-4.60: at the end marker it is put behind all.
TEST_F(EditingKeys, RecAtTheEndMarker) {
  Have({{12, "DELAY 1\nDELAY 2\n"}});
  Keys("JOB 1 2 ENT REC");
  EXPECT_EQ(Shows(), "P=12S=0003I=ENDPRG");
  Keys("MOV ENT REC");
  EXPECT_EQ(Shows(), "P=12S=0004I=ENDPRG");
  EXPECT_THAT(Program(12), ElementsAre("DELAY 1", "DELAY 2", "SPEED 70.0"));
}

// OPT-6.40: with no step shown it is put behind all, before an ENDTASK there.
TEST_F(EditingKeys, RecWithNoStepShown) {
  Have({{12, "DELAY 1\nDELAY 2\n"}, {13, "DELAY 1\nENDTASK\n"}});
  Keys("JOB 1 2 ENT MOV ENT REC");
  EXPECT_EQ(Shows(), "P=12S=0004I=ENDPRG");
  EXPECT_THAT(Program(12), ElementsAre("DELAY 1", "DELAY 2", "SPEED 70.0"));
  Keys("JOB 1 3 ENT MOV ENT REC");
  EXPECT_EQ(Shows(), "P=13S=0003I=ENDTASK");
  EXPECT_THAT(Program(13), ElementsAre("DELAY 1", "SPEED 70.0", "ENDTASK"));
}

// OPT-6.38 OPT-4.25: asked first.
TEST_F(EditingKeys, DelDeletesTheStep) {
  Have({{12, "DELAY 1\nDELAY 2\nDELAY 3\nDELAY 4\nSPEED 5\n"}});
  Keys("JOB 1 2 NEXT 3 ENT DEL");
  EXPECT_EQ(Shows(), "DELETE Y / N ?");
  Keys("0");
  EXPECT_EQ(Shows(), "P=12S=0003I=DELAY");
  Keys("DEL 1");
  EXPECT_EQ(Shows(), "P=12S=0003I=DELAY");
  EXPECT_THAT(Program(12), ElementsAre("DELAY 1", "DELAY 2", "DELAY 4", "SPEED 5"));
  Keys("NEXT DEL 1");
  EXPECT_EQ(Shows(), "P=12S=0004I=ENDPRG");
  Keys("DEL");
  EXPECT_EQ(Said(), 7601);
  EXPECT_THAT(Program(12), testing::SizeIs(3));
  Keys("JOB ENT DEL");
  EXPECT_EQ(Said(), 7601);
}

// OPT-6.44: sequence numbers stay with their instruction, and go to the next step with one that is
// deleted.
TEST_F(EditingKeys, SequenceNumbersStay) {
  Have({{12, "GOTO 10\n10 SPEED 5\n20 DELAY 1\n"}});
  Keys("JOB 1 2 NEXT 2 ENT DLY ENT REC");
  EXPECT_THAT(Program(12), ElementsAre("GOTO 10", "DELAY 0.0", "10   SPEED 5", "20   DELAY 1"));
  Keys("DEL 1");
  EXPECT_THAT(Program(12), ElementsAre("GOTO 10", "DELAY 0.0", "10", "20   DELAY 1"));
  Keys("DEL 1");
  EXPECT_THAT(Program(12), ElementsAre("GOTO 10", "DELAY 0.0", "10", "20"));
}

// OPT-6.43: DECLAREs stay, and names are as they were.
TEST_F(EditingKeys, DeclaresAreNotDeleted) {
  Have({{12, "DECLARE A = VR[1]\nA = 1.5\nDELAY A\n"}});
  Keys("JOB 1 2 NEXT 1 ENT DEL 1");
  EXPECT_THAT(Program(12), ElementsAre("DECLARE A = VR[1]", "DELAY A"));
  Keys("DEL 1 DLY ENT REC");
  EXPECT_THAT(Program(12), ElementsAre("DECLARE A = VR[1]", "DELAY 0.0"));
}

// OPT-6.42: a run that is suspended goes on with its old steps.
TEST_F(EditingKeys, ASuspendedRunHasItsOldSteps) {
  Have({{12, "DELAY 1\nDELAY 2\nDELAY 3\n"}}, Mode::kSingle);
  Keys("JOB 1 2 ENT START");
  GoOn(At(2.0));
  Keys("MODE_LEFT MODE_LEFT MODE_LEFT NEXT");
  EXPECT_EQ(Shows(), "P=12S=0002I=DELAY");
  Keys("DEL 1");
  EXPECT_THAT(Program(12), ElementsAre("DELAY 1", "DELAY 3"));
  Keys("MODE_RIGHT MODE_RIGHT START");
  GoOn(At(10.0));
  const machine::RunOver over = Over();
  EXPECT_EQ(over.lasted, At(7.0));  // a second of standing, and the three old steps
}

// LIVE-7.08: the name flashes until it is stored; no other edit is asked for meanwhile.
TEST_F(EditingKeys, ItFlashesUntilItIsStored) {
  Have({{12, "DELAY 1\n"}});
  Keys("JOB 1 2 NEXT 1 ENT MOV ENT");
  stores = false;
  Keys("REC");
  EXPECT_EQ(Shows(), "*SPEED");
  Keys("REC");
  EXPECT_EQ(Said(), 7601);
  Keys("MOV");
  EXPECT_EQ(Said(), 7601);
  ASSERT_EQ(edits.size(), 1U);
  Good(machine::StoreProgram{.slot = 3, .program = Translated("DELAY 3\n")});
  EXPECT_EQ(Shows(), "*SPEED");
  Store(edits[0]);
  Keys("ERR");
  EXPECT_EQ(Shows(), "P=12S=0002I=DELAY");
}

// LIVE-7.08: it is not stored; the next REC asks again.
TEST_F(EditingKeys, ItGoesOnFlashingWhenItIsNotStored) {
  Have({{12, "DELAY 1\n"}});
  Keys("JOB 1 2 NEXT 1 ENT MOV ENT");
  stores = false;
  Keys("REC");
  Good(machine::RefuseEdit{ErrorCode::kCellStoreUnavailable});
  EXPECT_EQ(Shows(), "*SPEED");
  EXPECT_EQ(machine->panel().message, ErrorCode::kCellStoreUnavailable);
  EXPECT_THAT(Program(12), ElementsAre("DELAY 1"));
  stores = true;
  Keys("REC");
  EXPECT_EQ(Shows(), "P=12S=0002I=DELAY");
  EXPECT_THAT(Program(12), ElementsAre("SPEED 70.0", "DELAY 1"));
  Good(machine::RefuseEdit{ErrorCode::kCellStoreUnavailable});  // of nothing
  EXPECT_EQ(machine->panel().message, std::nullopt);
}

// LIVE-7.08: a new program is shown when it is stored.
TEST_F(EditingKeys, AProgramIsShownWhenItIsStored) {
  Have({});
  stores = false;
  Keys("JOB 7 7 ENT REC");
  EXPECT_EQ(Shows(), "P=77S=0000I=********");
  Store(edits.at(0));
  EXPECT_EQ(Shows(), "P=77S=0001I=ENDTASK");
}

// LIVE-7.08 OPT-E.7109 OPT-B.73: no room, and nothing is changed.
TEST_F(EditingKeys, CmosIsFull) {
  Have({{12, "DELAY 1\n"}});
  const std::string state = machine->Save();
  machine::MachineMemory memory = machine->memory();
  std::string text;
  for (int i = 0; i < 45; ++i) text += "MOVE (1.5, 2.5, 3.5, 0.5, 0.5)\n";
  memory.programs[13] = Translated(text);
  Result<std::unique_ptr<machine::Machine>> made = machine::Machine::Make(
      family_, *MakeParameters(family_, "standard", {{"CMOS_SIZE", "1000"}}), memory, state, heard);
  ASSERT_TRUE(made);
  machine = *std::move(made);
  Keys("JOB 1 2 NEXT 1 ENT MOV ENT REC");
  EXPECT_EQ(Said(), 7109);
  EXPECT_EQ(Shows(), "*SPEED");
  EXPECT_THAT(edits, IsEmpty());
  Keys("SHIFT DEL 1");  // which makes some
  EXPECT_EQ(edits.size(), 1U);
}

// OPT-1.08 OPT-B.73: an object may be as long as the limit, and objects and executables may fill
// the memory to its last byte.
TEST_F(EditingKeys, WhatJustFitsIsStored) {
  Have({{12, "DELAY 1\n"}});
  const std::string state = machine->Save();
  machine::MachineMemory memory = machine->memory();
  std::string text;
  for (int i = 0; i < 45; ++i) text += "MOVE (1.5, 2.5, 3.5, 0.5, 0.5)\n";
  memory.programs[12] = Translated(text);
  memory.programs[13] = Translated("DELAY 1\n");
  const auto said = [&](const std::string& name, std::size_t value) {
    Result<std::unique_ptr<machine::Machine>> made = machine::Machine::Make(
        family_, *MakeParameters(family_, "standard", {{name, std::to_string(value)}}), memory,
        state, heard);
    EXPECT_TRUE(made);
    machine = *std::move(made);
    Keys("JOB 1 2 NEXT 1 ENT MOV ENT REC");
    return Said();
  };
  const std::size_t longer = Translated("SPEED 70.\n" + text).object->size();
  EXPECT_EQ(said("OBJECT_LIMIT", longer), 0);
  EXPECT_EQ(said("OBJECT_LIMIT", longer - 1), 7031);
  const std::size_t all = longer + memory.programs[13].object->size();
  ASSERT_GT(all, 1000U);  // the least CMOS_SIZE
  EXPECT_EQ(said("CMOS_SIZE", all), 0);
  EXPECT_EQ(said("CMOS_SIZE", all - 1), 7109);
}

// LIVE-7.08: of an edit that was not stored nothing comes behind the next one.
TEST_F(EditingKeys, ARefusedHoleIsForgotten) {
  Have({{12, "DELAY 1\n"}});
  stores = false;
  Keys("JOB 1 2 NEXT 1 ENT PATH PREV ENT DEL 5 ENT REC");
  Good(machine::RefuseEdit{ErrorCode::kCellStoreUnavailable});
  stores = true;
  Keys("MOV ENT REC");
  EXPECT_EQ(Shows(), "P=12S=0002I=DELAY");
  Keys("PATH ENT ENT REC");
  EXPECT_EQ(Shows(), "*ENTER CENTER NORMAL");
}

// OPT-6.06 OPT-6.09: one breakpoint.
TEST_F(EditingKeys, DebSetsABreakpoint) {
  Have({{12, "DELAY 1\nDELAY 1\nDELAY 1\n"}});
  const auto at = [this] {
    std::string text;
    for (const machine::Breakpoint& one : machine->breakpoints())
      text += std::to_string(one.at.program) + "/" + std::to_string(one.at.step) + " ";
    return text;
  };
  Keys("JOB 1 2 ENT DEB NEXT");
  EXPECT_EQ(Shows(), "BREAK = ON");
  Keys("ENT");
  EXPECT_EQ(Shows(), "STEP = 000 PRG = 12");
  Keys("ENT");
  EXPECT_EQ(Said(), 7604);
  Keys("2 ENT");
  EXPECT_EQ(at(), "12/2 ");
  EXPECT_EQ(Shows(), "P=12S=0000I=********");
  Keys("MODE_RIGHT MODE_RIGHT START");
  GoOn(At(9.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(Shows(), "P=12S=0002I=DELAY");
  Keys("START");
  GoOn(At(19.0));
  Keys("MODE_LEFT MODE_LEFT DEB NEXT ENT 7 NEXT 4 5 ENT");
  EXPECT_EQ(at(), "45/7 ");
  Keys("DEB ENT");
  EXPECT_EQ(at(), "");
}

// OPT-6.12 OPT-6.15: program 0 is the present one, step 0 is none.
TEST_F(EditingKeys, F6ArmsTheSimulation) {
  Have({{12, "DELAY 1\n"}});
  Keys("JOB 1 2 ENT F6");
  EXPECT_EQ(machine->panel().display, "SIM PRG 12 STEP 0000");
  Keys("ENT");
  EXPECT_EQ(Said(), 7604);
  EXPECT_EQ(Shows(), "SIM PRG 12 STEP 0000");
  Keys("1 0 ENT");
  EXPECT_EQ(machine->simulation_until(), (machine::ProgramStep{.program = 12, .step = 10}));
  Keys("F6 4 5 NEXT 2 0 ENT");
  EXPECT_EQ(machine->simulation_until(), (machine::ProgramStep{.program = 45, .step = 20}));
  Keys("F6 DEL NEXT 3 ENT");
  EXPECT_EQ(machine->simulation_until(), (machine::ProgramStep{.program = 12, .step = 3}));
  Good(machine::SwitchPower{false});
  Good(machine::SwitchPower{true});
  EXPECT_EQ(machine->simulation_until(), std::nullopt);  // OPT-6.30
}

// OPT-1.08: an object has an end.
TEST_F(EditingKeys, AnObjectMayBeTooLong) {
  std::string text;
  for (int i = 0; i < 1290; ++i) text += "MOVE (1.5, 2.5, 3.5, 0.5, 0.5)\n";
  Have({{12, text}});
  Keys("JOB 1 2 ENT REC");
  for (int i = 0; i < 100 && Said() == 0; ++i) Keys("MOV ENT REC");
  EXPECT_EQ(Said(), 7031);
  EXPECT_LE(ObjectAt(12).size(), 34'000U);
  EXPECT_EQ(Shows(), "*SPEED");
}

// OPT-6.15 OPT-E.7602: with no program selected there is no present one.
TEST_F(EditingKeys, F6NeedsAProgram) {
  Have({});
  Keys("F6 NEXT 5 ENT");
  EXPECT_EQ(Said(), 7602);
  EXPECT_EQ(Shows(), "SIM PRG 00 STEP 0005");
  EXPECT_EQ(machine->simulation_until(), std::nullopt);
  Keys("PREV 4 5 ENT");
  EXPECT_EQ(Said(), 0);
  EXPECT_EQ(machine->simulation_until(), (machine::ProgramStep{.program = 45, .step = 5}));
}

// OPT-B.73: executables take room as well, to the last byte.
TEST_F(EditingKeys, ExecutablesTakeRoomToo) {
  Have({{12, "DELAY 1\n"}});
  const std::string state = machine->Save();
  machine::MachineMemory memory = machine->memory();
  memory.programs[13] = Translated("DELAY 1\n");
  memory.programs[13].executable = machine::Bytes::Of(std::string(2000, 'x'));
  const std::size_t all = Translated("SPEED 70.\nDELAY 1\n").object->size() +
                          memory.programs[13].object->size() +
                          memory.programs[13].executable->size();
  for (const auto& [room, said] : {std::pair{all, 0}, std::pair{all - 1, 7109}}) {
    Result<std::unique_ptr<machine::Machine>> made = machine::Machine::Make(
        family_, *MakeParameters(family_, "standard", {{"CMOS_SIZE", std::to_string(room)}}),
        memory, state, heard);
    ASSERT_TRUE(made);
    machine = *std::move(made);
    Keys("JOB 1 2 NEXT 1 ENT MOV ENT REC");
    EXPECT_EQ(Said(), said) << room;
  }
}

}  // namespace
}  // namespace rmlcell::optimo
