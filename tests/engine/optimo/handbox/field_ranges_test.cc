// What each field takes: both ends of its range, and what is beyond.
#include "tests/engine/optimo/handbox/handbox_bed.h"

namespace rmlcell::optimo {
namespace {

struct FieldRow {
  std::string keys;   // to ENT, from another field where that is possible: it goes to what is wrong
  std::string shows;  // behind them
};

class FieldRanges : public HandboxTest {
 protected:
  void Expect(const std::vector<FieldRow>& rows) {
    Have({{12, "SPEED 1\nENDTASK\n"}});
    Keys("JOB 1 2 NEXT 2 ENT");
    for (const FieldRow& row : rows) {
      Keys(row.keys);
      EXPECT_EQ(Shows(), row.shows) << row.keys;
    }
  }
};

// OPT-5.10 OPT-5.23: SPEED from 0 to 100, and five that are 0 or 1.
TEST_F(FieldRanges, OfMov) {
  Expect({{"MOV DEL 0 ENT", "*SPEED"},
          {"MOV DEL 1 0 0 ENT", "*SPEED"},
          {"MOV DEL 1 0 0 POINT 1 NEXT ENT", "SPEED 100.1"},
          {"MOV DEL MINUS 1 NEXT ENT", "SPEED -1"},
          {"MOV NEXT 2 PREV ENT", "FLY = 2"},
          {"MOV NEXT NEXT 2 PREV ENT", "START = 2"},
          {"MOV NEXT NEXT NEXT 2 PREV ENT", "TIME = 2"},
          {"MOV NEXT NEXT NEXT NEXT 2 PREV ENT", "END = 2"},
          {"MOV NEXT NEXT NEXT NEXT NEXT 2 PREV ENT", "NEXT = 2"}});
}

// OPT-5.10: what a MOVE asks for besides: any input, no time below 0.
TEST_F(FieldRanges, OfTheAttributesOfAMove) {
  Expect({{"MOV NEXT NEXT 1 ENT 0 0 ENT", "*SPEED"},
          {"MOV NEXT NEXT 1 ENT 9 9 ENT", "*SPEED"},
          {"MOV NEXT NEXT 0 NEXT 1 ENT DEL 0 ENT", "GOSUB 0000"},
          {"MOV NEXT NEXT NEXT 1 ENT DEL 9 9 9 9 9 9 ENT 9 9 9 9 ENT", "*SPEED"},
          {"MOV NEXT NEXT NEXT 1 ENT DEL 1 0 0 0 0 0 0 ENT", "TIME 1000000"},
          {"MOV NEXT NEXT NEXT 1 ENT DEL MINUS 1 ENT", "TIME -1"}});
}

// OPT-5.10 OPT-5.27: what is refused changes no mode.
TEST_F(FieldRanges, OfModes) {
  Expect({{"F2 DEL 0 ENT", "*OVERSH"},
          {"F2 DEL 1 0 0 ENT", "*OVERSH"},
          {"F2 DEL 1 5 0 ENT", "OVERSH 150"},
          {"ERR F2", "OVERSH 100"},
          {"MOV DEL 1 4 0 ENT ERR MOV", "SPEED 70.0"},
          {"PATH PREV ENT DEL 0 ENT", "*PATH"},
          {"PATH ENT DEL 9 9 9 9 9 ENT", "*PATH"},
          {"PATH ENT DEL 1 0 0 0 0 0 ENT", "RAD = 100000"},
          {"PATH ENT DEL MINUS 1 ENT", "RAD = -1"},
          {"DLY DEL 0 ENT", "*DELAY"},
          {"DLY DEL 9 9 9 9 9 9 ENT", "*DELAY"},
          {"DLY DEL 1 0 0 0 0 0 0 ENT", "DELAY 1000000"},
          {"DLY DEL MINUS 1 ENT", "DELAY -1"}});
}

// OPT-5.29 OPT-5.31 OPT-5.32: kinds 0 to 2, processes 0 to 9, schedules to 63.
TEST_F(FieldRanges, OfWork) {
  const std::string ramp = "WORK 1 ENT ENT ";
  Expect({{"WORK 2 NEXT 9 ENT", "WORK = DEF"},
          {"WORK 3 NEXT ENT", "TOOL = 3 PROGR = 00"},
          {"WORK 1 NEXT 1 0 PREV ENT", "TOOL = 1 PROGR = 10"},
          {ramp + "NEXT DEL 1 0 0 NEXT DEL 9 9 9 9 9 9 NEXT DEL 1 0 0 NEXT 6 3 ENT", "*WORKDEF"},
          {ramp + "DEL 1 0 0 NEXT DEL POINT 1 NEXT ENT", "*WORKDEF"},
          {ramp + "DEL 1 0 0 POINT 5 NEXT DEL 8 ENT", "POWER 100.5"},
          {ramp + "DEL MINUS 1 NEXT DEL 8 ENT", "POWER -1"},
          {ramp + "NEXT DEL 1 0 0 POINT 5 NEXT ENT", "SPEED 100.5"},
          {ramp + "NEXT DEL 8 NEXT DEL 1 0 0 0 0 0 0 NEXT ENT", "DELAY 1000000"},
          {ramp + "NEXT DEL 8 NEXT DEL MINUS 1 NEXT ENT", "DELAY -1"},
          {ramp + "NEXT DEL 8 NEXT NEXT DEL 1 0 0 POINT 5 NEXT ENT", "PEAK 100.5"},
          {ramp + "NEXT DEL 8 NEXT NEXT NEXT 6 4 PREV ENT", "PROG 64"},
          {"WORK 2 ENT ENT 1 ENT", "*WORKDEF"},
          {"WORK 2 ENT ENT ENT", "PROG 00"},
          {"WORK ENT NEXT ENT 2 ENT", "START = 2"},
          {"WORK ENT NEXT ENT 1 ENT 9 9 ENT", "*WORKON"}});
}

// OPT-5.37 OPT-5.43 OPT-6.06 OPT-6.12 OPT-9.33: numbers of outputs, programs and steps begin at 1.
TEST_F(FieldRanges, OfNumbers) {
  Expect({{"OUT 1 ENT", "*P=12S=0002I=LET"},
          {"OUT 9 9 NEXT 1 ENT", "*P=12S=0002I=LET"},
          {"OUT 1 NEXT 2 PREV ENT", "OUT 01 = 2"},
          {"START ENT 1 ENT", "*P=12 S=0002 GO"},
          {"START ENT 9 9 ENT", "*P=12 S=0002 GO"},
          {"START ENT ENT", "PROG 00"},
          {"DEB NEXT ENT 1 NEXT 0 1 ENT", "P=12S=0002I=ENDTASK"},
          {"DEB NEXT ENT 9 9 9 NEXT DEL PREV ENT", "STEP = 999 PRG = 00"},
          {"F3 1 ENT", "NUMBER PARAMETERS=0"},
          {"F6 NEXT 1 ENT", "P=12S=0002I=ENDTASK"},
          {"F6 NEXT 9 9 9 9 ENT", "P=12S=0002I=ENDTASK"},
          {"F8 9 9 9 9 ENT", "*GOSUB"},
          {"JOB DEL 1 NEXT 9 9 9 9 NEXT 9 NEXT 9 ENT", "P=01S=0000I=********"},
          {"JOB 9 9 ENT", "P=99S=0000I=********"},
          {"JOB DEL NEXT ENT", "P=00 S=0000 T=0 M=0"}});
}

// OPT-4.73: points and frames.
TEST_F(FieldRanges, OfPoints) {
  Expect({{"TCP DEL 9 9 9 9 9 9 ENT", "*TCP"},
          {"TCP DEL MINUS 9 9 9 9 9 9 ENT", "*TCP"},
          {"TCP DEL 1 0 0 0 0 0 0 NEXT ENT", "X0 = 1000000"},
          {"TCP DEL MINUS 1 0 0 0 0 0 0 NEXT ENT", "X0 = -1000000"}});
}

// OPT-9.35 OPT-9.37: numbers of functions are shown with two digits.
TEST_F(FieldRanges, FunctionsHaveTwoDigits) {
  for (const auto& [keys, name] :
       {std::pair{"F3 9 ENT", "09"}, std::pair{"F3 1 0 ENT", "10"}, std::pair{"F3 1 ENT", "01"}}) {
    Have({{12, "SPEED 1\nENDTASK\n"}, {1, "RETURN\n"}, {9, "RETURN\n"}, {10, "RETURN\n"}});
    Keys("JOB 1 2 NEXT 2 ENT " + std::string(keys) + " ENT 0");
    EXPECT_EQ(Shows(), "*FUNCTION = " + std::string(name));
    Keys(std::string(keys) + " ENT 1");
    GoOn(machine->time() + At(1.0));
    EXPECT_EQ(Shows(), "*P=12 S=0002 FUNC=" + std::string(name));
  }
}

}  // namespace
}  // namespace rmlcell::optimo
