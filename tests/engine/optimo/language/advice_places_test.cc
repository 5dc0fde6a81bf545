#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "tests/engine/optimo/language/compile_text.h"
#include "tests/engine/optimo/language/marked_text.h"

// What advice says, of which statement, and by which rule. `says` begins the finding's text.
namespace rmlcell::optimo {
namespace {

struct AdviceRow {
  std::string_view text;
  int number;
  std::string_view rule;
  std::string_view says;
};

void ExpectAdvice(const AdviceRow& row) {
  const Marked marked = WithoutBraces(row.text);
  const Compilation compiled = Compile(marked.text, "", {.advice = true});
  EXPECT_TRUE(compiled.ok) << row.text;
  std::string all;
  const Diagnostic* found = nullptr;
  int count = 0;
  for (const Diagnostic& d : compiled.diagnostics) {
    all += FormatDiagnostic(d, marked.text) + "\n";
    if (Lookup(d.code).number != row.number || d.rule != row.rule) continue;
    found = &d;
    ++count;
  }
  ASSERT_EQ(count, 1) << row.text << all;
  EXPECT_EQ(found->where, marked.span) << row.text << all;
  EXPECT_TRUE(found->detail.starts_with(row.says)) << row.text << found->detail;
  EXPECT_FALSE(IsError(found->severity)) << row.text;
}

const std::string kAbsolLin = "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0.,0.,0.,0.,0.)\n";
const std::string kBeam = "OL[11]=ON\nWORK 0,0/ON\nDELAY 1\n";

// OPT-3.09, OPT-3.24, OPT-3.33, OPT-3.34
TEST(AdvicePlaces, OfProcesses) {
  const std::vector<AdviceRow> rows = {
      {"{WORK 1,3/ON}\n", 7401, "OPT-3.09", "no WORKDEF 1,3 comes before this WORK"},
      {"{WORK 2,7/ON}\n", 7401, "OPT-3.09", "no WORKDEF 2,7 comes before this WORK"},
      {"{WORK 0,1/ON}\n", 7401, "OPT-3.09", "no WORKDEF 0,1 comes before this WORK"},
      {"IF VL[1] THEN 10\nWORKDEF 1,4 (8.,75.,1.,50.)\n10 {WORK 1,4/ON}\n", 7401, "OPT-3.09",
       "on one path no WORKDEF 1,4 comes before"},
      {"WORKDEF 2,5 (15)\nWORK 0,0/ON\nWORK 2,5/ON\n{WORK 2,5/OFF}\n", 7411, "OPT-3.24",
       "WORK 2 OFF switches the beam off"},
      {"WORK 0,0/ON\n{CALL 2}\n", 7407, "OPT-3.33", "a process is ON at CALL"},
      {"WORK 0,0/ON\n{GO 46}\n", 7407, "OPT-3.33", "a process is ON at GO"},
      {"WORKDEF 2,9 (15)\nWORK 2,9/ON\n{GO 46 /C}\n", 7407, "OPT-3.33", "a process is ON at GO"},
      {"IF VL[1] THEN 10\nWORK 0,0/ON\n10 {CALL 2}\n", 7407, "OPT-3.33",
       "on one path a process is ON at CALL"},
      {"WORKDEF 2,5 (15)\n{WORK 2,5/ON}\n", 7408, "OPT-3.34",
       "WORK 2, which has no beam, is ON at the end of the program"},
      {"WORK 0,0/ON\n{ENDTASK}\n", 7408, "OPT-3.34", "a process is ON at the end"},
      {"IF VL[1] THEN 10\nWORK 0,0/ON\n10 {ENDTASK}\n", 7408, "OPT-3.34",
       "on one path a process is ON at the end"},
      {"WORK 0,0/ON\n{DELAY 1}\n", 7408, "OPT-3.34", "a process is ON at the end of the program"},
      {"{WORK 0,0/ON}\n", 7408, "OPT-3.34", "a process is ON at the end of the program"},
      {"IF VL[1] THEN 10\nWORK 0,0/ON\n10 {SPEED 5}\n", 7408, "OPT-3.34",
       "on one path a process is ON at the end of the program"},
      // Behind a CALL, and where an error leads, all processes are off.
      {"WORK 0,0/ON\nCALL 2\nIF VL[1] THEN 10\nWORK 0,0/ON\n10 {ENDTASK}\n", 7408, "OPT-3.34",
       "on one path a process is ON at the end"},
      {"ERR 900\nENDTASK\n900 IF VL[1] THEN 10\nWORK 0,0/ON\n10 {ENDTASK}\n", 7408, "OPT-3.34",
       "on one path a process is ON at the end"},
  };
  for (const AdviceRow& row : rows) ExpectAdvice(row);
  // OPT-3.23, OPT-3.26: a schedule alone is no warning.
  const auto severity = [](const std::string& text) {
    for (const Diagnostic& d : Compile(text, "", {.advice = true}).diagnostics) {
      if (d.code == ErrorCode::kWorkActiveAtEnd) return d.severity;
    }
    return Severity::kFatal;
  };
  EXPECT_EQ(severity("WORKDEF 2,5 (15)\nWORK 2,5/ON\n"), Severity::kAdvice);
  EXPECT_EQ(severity("WORKDEF 2,5 (15)\nWORK 2,5/ON\nENDTASK\n"), Severity::kAdvice);
  EXPECT_EQ(severity("WORKDEF 2,5 (15)\nWORK 2,5/ON\nWORK 0,0/ON\n"), Severity::kWarning);
}

// OPT-5.40, OPT-5.47: gases and the sensor.
TEST(AdvicePlaces, OfOutputs) {
  const std::vector<AdviceRow> rows = {
      {"OL[8]=ON\n{OL[9]=ON}\n", 7409, "OPT-5.40", "the other assist gas is on"},
      {"OL[9]=ON\n{OL[8]=ON}\n", 7409, "OPT-5.40", "the other assist gas is on"},
      {"IF VL[1] THEN 10\nOL[8]=ON\n10 {OL[9]=ON}\n", 7409, "OPT-5.40",
       "on one path the other assist gas is on"},
      {"IF VL[1] THEN 10\nOL[9]=ON\n10 {OL[8]=ON}\n", 7409, "OPT-5.40",
       "on one path the other assist gas is on"},
      {"{ASSIGN OL[8]=3 /2}\n", 7409, "OPT-5.40", "this switches both assist gases on"},
      {"OL[8]=ON\nASSIGN OL[8]=0 /2\nOL[9]=ON\n{ASSIGN OL[8]=1 /1}\n", 7409, "OPT-5.40",
       "the other assist gas is on"},
      {"{WORK 0,0/ON}\nWORK 0,0/OFF\n", 7033, "OPT-5.47", "the sensor OL[11] is off"},
      {"OL[11]=ON\nWORK 0,0/ON\nDELAY 1\nOL[11]=OFF\n{MOVE (1.,2.,3.,0.,0.)}\n", 7033, "OPT-5.47",
       "the sensor OL[11] is off"},
      {"OL[11]=ON\nWORK 0,0/ON\nDELAY 1\nOL[11]=OFF\nWORK 2,5/ON\n{MOVE (1.,2.,3.,0.,0.)}\n", 7033,
       "OPT-5.47", "the sensor OL[11] is off"},
      // What a FUNCTION did with the gas nobody knows.
      {"IF VL[1] THEN 10\nOL[8]=ON\nGOTO 20\n10 FUNCTION 44\n20 {OL[9]=ON}\n", 7409, "OPT-5.40",
       "on one path the other assist gas is on"},
  };
  for (const AdviceRow& row : rows) ExpectAdvice(row);
}

// OPT-1.17: what is read and not set.
TEST(AdvicePlaces, OfVariables) {
  const std::vector<AdviceRow> rows = {
      {"{VR[0] = VR[7]}\n", 7033, "OPT-1.17", "VR[7] is read, and nothing in this program sets it"},
      {"{VI[2] = VI[5]}\n", 7033, "OPT-1.17", "VI[5] is read, and nothing"},
      {"{VL[2] = VL[79]}\n", 7033, "OPT-1.17", "VL[79] is read, and nothing"},
      {"{VR[0] = VR[42]}\n", 7033, "OPT-1.17", "VR[42] is read, and nothing"},
      {"{VI[2] = VI[69]}\n", 7033, "OPT-1.17", "VI[69] is read, and nothing"},
      {"{VI[2] = VI[0]}\n", 7033, "OPT-1.17", "VI[0] is read, and nothing"},
      {"VR[0] = VR[43] + VI[1] + VI[70] + VR[64]\n{VR[1] = VR[3]}\n", 7033, "OPT-1.17",
       "VR[3] is read, and nothing"},
      {"VL[0] = VL[80]\n{VL[1] = VL[2]}\n", 7033, "OPT-1.17", "VL[2] is read, and nothing"},
      {"{SPEED VR[2]}\nVR[2] = 5.\n", 7033, "OPT-1.17", "VR[2] is read before the program sets it"},
      {"{VR[2] = VR[2] + 1.}\n", 7033, "OPT-1.17", "VR[2] is read before the program sets it"},
      {"IF IL[20] THEN 10\nVI[7] = 5\n10 {VI[8] = VI[7]}\n", 7033, "OPT-1.17",
       "VI[7] is read before the program sets it"},
      {"{MOVE (1.,2.,3.,0.,VR[9])}\n", 7033, "OPT-1.17", "VR[9] is read, and nothing"},
  };
  for (const AdviceRow& row : rows) ExpectAdvice(row);
}

// OPT-3.47, OPT-7.20, OPT-7.21, OPT-7.22: where the program leads.
TEST(AdvicePlaces, OfTheFlow) {
  std::string deep = "GOSUB 1\nENDTASK\n";
  for (int n = 1; n < 16; ++n)
    deep += std::to_string(n) + " GOSUB " + std::to_string(n + 1) + "\nRETURN\n";
  const std::string too_deep = deep + "16 {GOSUB 17}\nRETURN\n17 SPEED 5\nRETURN\n";
  const std::vector<AdviceRow> rows = {
      {"GOTO 20\n{SPEED 5}\nSPEED 6\n20 ENDTASK\n", 7033, "OPT-3.47", "this is never reached"},
      {"GOTO 20\nDECLARE X = 5.\n{SPEED 5}\n20 SPEED 6\n", 7033, "OPT-3.47",
       "this is never reached"},
      {"GOSUB 100\n100 SPEED 5\n{RETURN}\n", 7504, "OPT-7.22",
       "the program can run into this RETURN"},
      {"SPEED 5\n{RETURN}\n", 7504, "OPT-7.22", "no GOSUB leads to this RETURN"},
      {"GOSUB 100\nENDTASK\n100 {SPEED 5}\nENDTASK\n", 7033, "OPT-7.20",
       "this subroutine never comes to a RETURN"},
      {"GOSUB 100\nENDTASK\n100 {GOSUB 200}\nENDTASK\n200 RETURN\n", 7033, "OPT-7.20",
       "this subroutine never comes to a RETURN"},
      {too_deep, 7503, "OPT-7.21", "this GOSUB can be the 17th inside another"},
      {"GOSUB 100\nENDTASK\n100 IF IL[20] THEN 110\n{GOSUB 100}\n110 RETURN\n", 7503, "OPT-7.21",
       "the subroutine calls itself here; at most 16 GOSUBs"},
  };
  for (const AdviceRow& row : rows) ExpectAdvice(row);
}

// OPT-2.08, OPT-2.09, OPT-2.21, OPT-2.29, OPT-5.45: paths.
TEST(AdvicePlaces, OfPaths) {
  const std::string move = "{MOVE (10.,2.,3.,0.,0.)}\n";
  const std::string arc = "COORD ABSOL\nPATH CIR\n" + move,
                    hole = "COORD ABSOL\nPATH HOLE (5.)\n" + move,
                    some_arc = "COORD ABSOL\nIF IL[20] THEN 6\nPATH CIR\n6 " + move,
                    some_hole = "COORD ABSOL\nIF IL[20] THEN 6\nPATH HOLE (5.)\n6 " + move,
                    robot = "COORD ROBOT\nPATH LIN\n" + move,
                    some_robot = "IF IL[20] THEN 5\nCOORD ROBOT\nPATH LIN\n5 " + move,
                    no_coord = "PATH LIN\n" + move + "MOVE (20.,2.,3.,0.,0.)\n",
                    ptp = "COORD ABSOL\nPATH PTP\n" + kBeam + move,
                    no_path = "COORD ABSOL\n" + kBeam + move + "MOVE (20.,2.,3.,0.,0.)\n";
  const std::vector<AdviceRow> rows = {
      {robot, 7302, "OPT-2.08", "COORD ROBOT has PATH PTP only; this MOVE will fail"},
      {some_robot, 7302, "OPT-2.08", "on one path this MOVE is in COORD ROBOT"},
      {no_coord, 7302, "OPT-2.09", "no COORD was set: by default that is ROBOT"},
      {arc, 7308, "OPT-2.21", "CIR and HOLE without /VIA"},
      {hole, 7308, "OPT-2.29", "CIR and HOLE without /VIA"},
      {some_arc, 7308, "OPT-2.21", "on one path the PATH is CIR or HOLE: CIR and HOLE without"},
      {some_hole, 7308, "OPT-2.29", "on one path the PATH is CIR or HOLE: CIR and HOLE without"},
      {ptp, 7033, "OPT-5.45", "a contour in PATH PTP with the beam on"},
      {no_path, 7033, "OPT-5.45", "a contour with the beam on, and no PATH was set"},
  };
  for (const AdviceRow& row : rows) ExpectAdvice(row);
}

// OPT-B.22: what is known behind a loop, which comes by in ROBOT first and in ABSOL then, is not
// forgotten at a label that nobody jumps to.
TEST(AdvicePlaces, BehindALabelOfNobody) {
  const Compilation made = Compile(
      "COORD ROBOT\nPATH PTP\nSPEED 0\n10 MOVE (0.,0.,0.,0.,0.)\n20 MOVE (1.,0.,0.,0.,0.)\n"
      "COORD ABSOL\nIF VI[1] > 2 THEN 10\nENDTASK\n",
      "", {});
  EXPECT_TRUE(std::ranges::any_of(made.diagnostics, [](const Diagnostic& found) {
    return found.code == ErrorCode::kNoMotion && found.where.line == 5;
  }));
}

// OPT-3.20, OPT-3.21, OPT-5.46, OPT-5.48, OPT-B.22: speeds, piercing, holes.
TEST(AdvicePlaces, OfSpeeds) {
  const std::string cut = kAbsolLin + kBeam, move = "{MOVE (10.,2.,3.,0.,0.)}\n";
  const std::string slow = cut + "SPEED 4.5\n" + move, fast = cut + "SPEED 20\n" + move,
                    rapid = kAbsolLin + "SPEED 80.5\n" + move,
                    approach = kAbsolLin + "SPEED 30\n" + move + "WORK 0,0/ON\n",
                    leave = cut + "WORK 0,0/OFF\nSPEED 25\n" + move,
                    pierce = kAbsolLin + "WORK 0,0/ON\n" + move,
                    ramp = kAbsolLin + "WORKDEF 1,0 (8.,75.,0.,50.)\nWORK 1,0/ON\n" + move,
                    still = kAbsolLin + "SPEED 0\n" + move,
                    waits = kAbsolLin + "WAIT IL[20]\nSPEED 0\n" + move,
                    calls = kAbsolLin + "GOSUB 100\nSPEED 0\n" + move +
                            "ENDTASK\n100 OL[16]=ON\nRETURN\n",
                    defined = cut + "WORKDEF 1,5 (8.,75.,1.,50.)\nSPEED 30\n" + move,
                    function = "FUNCTION 44\n" + cut + "SPEED 30\n" + move,
                    // atan(3/4) = 36.87 degrees
      hole = "COORD ABSOL\nPATH HOLE (5.)\n{MOVE (20.,2.,3.,0.,0.)/VIA (23.,2.,7.,0.,0.)}\n";
  const std::vector<AdviceRow> rows = {
      {slow, 7033, "OPT-5.46", "SPEED 4.5 with the beam on; cutting takes 5 to 15 %"},
      {fast, 7033, "OPT-5.46", "SPEED 20 with the beam on; cutting takes 5 to 15 %"},
      {rapid, 7033, "OPT-5.46", "SPEED 80.5; rapid moves take at most 70 %"},
      {approach, 7033, "OPT-5.46", "SPEED 30 to the pierce point; the approach takes 10 %"},
      {leave, 7033, "OPT-5.46", "SPEED 25 away from the part; leaving takes at most 20 %"},
      {pierce, 7033, "OPT-3.20", "the beam was switched on without a dwell to pierce"},
      {ramp, 7033, "OPT-3.21", "WORKDEF 1 has a delay of 0: the beam was switched on without"},
      {still, 7307, "OPT-B.22", "SPEED is 0: this MOVE will fail"},
      {waits, 7307, "OPT-B.22", "SPEED is 0: this MOVE will fail"},
      {calls, 7307, "OPT-B.22", "SPEED is 0: this MOVE will fail"},
      {defined, 7033, "OPT-5.46", "SPEED 30 with the beam on; cutting takes 5 to 15 %"},
      {function, 7033, "OPT-5.46", "SPEED 30 with the beam on; cutting takes 5 to 15 %"},
      {hole, 7033, "OPT-5.48", "the axis of the hole is 36.87 degrees off the tool axis"},
  };
  for (const AdviceRow& row : rows) ExpectAdvice(row);
}

// OPT-2.45, OPT-2.47, OPT-2.48, OPT-2.51, OPT-2.53: /FLY.
TEST(AdvicePlaces, OfPassages) {
  const std::string fly = "{MOVE (10.,2.,3.,0.,0.)/FLY}\n", move = "MOVE (20.,2.,3.,0.,0.)\n";
  const std::string last = kAbsolLin + fly, ends = kAbsolLin + fly + "SPEED 5\nENDTASK\n",
                    delay = kAbsolLin + fly + "SPEED 5\nDELAY 1\n" + move,
                    wait = kAbsolLin + fly + "WAIT IL[20]\n" + move,
                    call = kAbsolLin + fly + "CALL 2\n" + move, go = kAbsolLin + fly + "GO 2\n",
                    coord = kAbsolLin + fly + "COORD ROBOT\nPATH PTP\n" + move,
                    same = kAbsolLin + fly + "COORD ABSOL\n" + move,
                    hole = kAbsolLin +
                           "PATH HOLE (5.)\n{MOVE (10.,2.,3.,0.,0.)/VIA "
                           "(10.,2.,9.,0.,0.)/FLY}\nPATH LIN\n" +
                           move,
                    to_hole = kAbsolLin + fly +
                              "PATH HOLE (5.)\nMOVE (20.,2.,3.,0.,0.)/VIA "
                              "(20.,2.,9.,0.,0.)\n",
                    small = kAbsolLin + "{MOVE (0.9,0.,0.,0.,0.)/FLY}\n" + move,
                    tiny = kAbsolLin +
                           "MOVE (.005,0.,0.,0.,0.)/FLY\nMOVE (.010,0.,0.,0.,0.)/FLY\n"
                           "{MOVE (.015,0.,0.,0.,0.)/FLY}\nMOVE (9.,0.,0.,0.,0.)/FLY\n" +
                           move;
  // A GOSUB that moves nothing leaves a row of moves going on; one that does begins it.
  const std::string sub = "ENDTASK\n100 OL[16]=ON\nRETURN\n",
                    small_sub =
                        kAbsolLin + "{MOVE (0.9,0.,0.,0.,0.)/FLY}\nGOSUB 100\n" + move + sub,
                    tiny_sub =
                        kAbsolLin +
                        "MOVE (.005,0.,0.,0.,0.)/FLY\nGOSUB 100\nMOVE (.010,0.,0.,0.,0.)/FLY\n"
                        "{MOVE (.015,0.,0.,0.,0.)/FLY}\n" +
                        move + sub,
                    begun =
                        "GOSUB 100\nMOVE (.005,0.,0.,0.,0.)/FLY\nMOVE (.010,0.,0.,0.,0.)/FLY\n"
                        "{MOVE (.015,0.,0.,0.,0.)/FLY}\n" +
                        move + "ENDTASK\n100 " + kAbsolLin + "RETURN\n";
  // What the GOSUB of a TIMER moves begins a new row of moves; what does not move leaves it going
  // on.
  const std::string ahead = "MOVE (.005,0.,0.,0.,0.)/FLY\n", back = "MOVE (0.,0.,0.,0.,0.)/FLY\n",
                    timer = kAbsolLin + ahead + back + "TIMER (9.,900)\nTIMER /DIS\n",
                    timed = timer + ahead + back + "{MOVE (.005,0.,0.,0.,0.)/FLY}\n" + move +
                            "ENDTASK\n900 MOVE (0.,0.,0.,0.,0.)\nRETURN\n",
                    quiet = timer + "{MOVE (.005,0.,0.,0.,0.)/FLY}\n" + move +
                            "ENDTASK\n900 VI[1]=1\nRETURN\n";
  const std::vector<AdviceRow> rows = {
      {last, 7032, "OPT-2.47", "/FLY on the last MOVE of the program"},
      {ends, 7032, "OPT-2.47", "/FLY on the last MOVE of the program"},
      {delay, 7032, "OPT-2.48", "/FLY, but DELAY at step 7 needs standstill"},
      {wait, 7032, "OPT-2.48", "/FLY, but WAIT at step 6 needs standstill"},
      {call, 7032, "OPT-2.47", "/FLY, but CALL at step 6 needs standstill"},
      {go, 7032, "OPT-2.47", "/FLY, but GO at step 6 needs standstill"},
      {coord, 7303, "OPT-2.45", "/FLY before the change of coordinates at step 6"},
      {same, 7032, "OPT-2.48", "/FLY, but COORD at step 6 needs standstill"},
      {hole, 7032, "OPT-2.53", "/FLY on a hole move"},
      {to_hole, 7032, "OPT-2.53", "/FLY on the move to a hole"},
      {small, 7314, "OPT-2.51", "/FLY on a move shorter than 1 mm, and the next move stops"},
      {tiny, 7314, "OPT-2.52", "/FLY on several moves in a row shorter than 0.01 mm"},
      {small_sub, 7314, "OPT-2.51", "/FLY on a move shorter than 1 mm, and the next move stops"},
      {tiny_sub, 7314, "OPT-2.52", "/FLY on several moves in a row shorter than 0.01 mm"},
      {begun, 7314, "OPT-2.52", "/FLY on several moves in a row shorter than 0.01 mm"},
      {timed, 7314, "OPT-2.52", "/FLY on several moves in a row shorter than 0.01 mm"},
      {quiet, 7314, "OPT-2.52", "/FLY on several moves in a row shorter than 0.01 mm"},
  };
  for (const AdviceRow& row : rows) ExpectAdvice(row);
}

// OPT-7.37, OPT-7.104, OPT-7.105, OPT-7.106, OPT-8.78: single instructions.
TEST(AdvicePlaces, OfSingleInstructions) {
  const std::vector<AdviceRow> rows = {
      {"{VR[43] = 1.}\n", 7413, "OPT-7.104", "VR[43] belongs to Amada's programs"},
      {"{VI[70] = 1}\n", 7413, "OPT-7.105", "VI[70] belongs to Amada's programs"},
      {"{ASSIGN VL[78] = 0 /4}\n", 7413, "OPT-7.105", "VL[80] belongs to Amada's programs"},
      {"{OL[20] = ON}\n", 7412, "OPT-7.106", "OL[20] is used by the system"},
      {"{OL[2] = ON}\n", 7412, "OPT-7.106", "OL[2] is used by the system, except on an EFA-51"},
      {"{ASSIGN OL[16] = 0 /2}\n", 7412, "OPT-7.106", "OL[17] is used by the system"},
      {"{ASSIGN OL[8] = 0 /3}\n", 7412, "OPT-7.106", "OL[10] is used by the system"},
      {"{ASSIGN OL[0] = 0 /4}\n", 7412, "OPT-7.106", "OL[0] is used by the system"},
      {"{SYSDEF (0,0,0,0,0,0)}\n", 7311, "OPT-7.37", "SYSDEF with six zeros"},
      {"{TCP (0,1,3/0,0,2)}\n", 7313, "OPT-4.70", "X and Y of TCP are zero"},
      {"{TCP (0,0,3/0,0,3)}\n", 7312, "OPT-4.71", "both points of TCP are equal"},
      {"{TCP (0,0,3/0,0,4)}\n", 7315, "OPT-4.55", "Z0 is below Z1"},
      {"{FUNCTION 99 (5., VR[3])}\n", 7033, "OPT-8.78", "FUNCTION 99 takes degrees"},
      {"{FUNCTION 99 (VR[3], VR[4])}\n", 7033, "OPT-8.78", "FUNCTION 99 takes degrees"},
      {"TASK 1\nSPEED 5\n{TASK 1}\n", 7033, "OPT-9.12", "TASK 1 stands above already"},
  };
  for (const AdviceRow& row : rows) ExpectAdvice(row);
}

// OPT-7.106, OPT-7.60: of an output nothing is said where its index has an error.
TEST(AdvicePlaces, OfAnOutputByName) {
  ExpectAdvice({"DECLARE NINE = 20\n{OL[NINE] = ON}\n", 7412, "OPT-7.106", "OL[20] is used"});
  ExpectAdvice({"DECLARE NONE = 0\n{OL[NONE] = ON}\n", 7412, "OPT-7.106", "OL[0] is used"});
  EXPECT_EQ(FindingsOf("OL[NINE] = ON\n", true), (std::vector<int>{7011}));
  EXPECT_EQ(FindingsOf("DECLARE NINE = 200\nOL[NINE] = ON\n", true), (std::vector<int>{7017}));
  EXPECT_EQ(FindingsOf("DECLARE NINE = 0.\nOL[NINE] = ON\n", true), (std::vector<int>{7017}));
}

// OPT-2.35, OPT-3.06, OPT-3.08, OPT-3.45, OPT-3.61: constants that are computed.
TEST(AdvicePlaces, OfConstantsOutsideTheirRange) {
  const std::string fails = "this fails whenever it is executed: a value that is not ";
  const std::string percent = fails + "0 to 100", above = fails + "above 0 to 100",
                    seconds = fails + "0 or more seconds", schedule = fails + "1 to 63",
                    error = fails + "1 to 9999";
  const std::vector<AdviceRow> rows = {
      {"SPEED 1-1\nSPEED .25+.25\n{SPEED 50*3}\n", 7205, "OPT-2.35", percent},
      {"ACCEL 1-1\nACCEL 50+50\n{ACCEL 1-2}\n", 7205, "OPT-2.35", percent},
      {"SPEED 50+50\n{OVERSH 50+50.5}\n", 7205, "OPT-2.35", percent},
      {"SPEED EXP(4)\n{SPEED EXP(5)}\n", 7205, "OPT-2.35", percent},  // 54.6 and 148.4
      {"DELAY 1-1\nDELAY .25+.25\n{DELAY 1-2}\n", 7205, "OPT-3.45", seconds},
      {"SETERR 1+0\n{SETERR 1-1}\n", 7505, "OPT-3.61", error},
      {"SETERR 9998+1\n{SETERR 9999+1}\n", 7505, "OPT-3.61", error},
      {"WORKDEF 1,0 (.25+.25, 1-1, 1-1, 1-1)\n{WORKDEF 1,0 (1-1, 80., 1., 90.)}\n", 7205,
       "OPT-3.08", above},
      {"WORKDEF 1,0 (50+50, 50+50, .25+.25, 50+50)\n{WORKDEF 1,0 (50+51, 80., 1., 90.)}\n", 7205,
       "OPT-3.08", above},
      {"{WORKDEF 1,0 (8., 100+1, 1., 90.)}\n", 7205, "OPT-3.08", percent},
      {"{WORKDEF 1,0 (8., 80., 1-2, 90.)}\n", 7205, "OPT-3.08", seconds},
      {"{WORKDEF 1,0 (8., 80., 1., 0-1)}\n", 7205, "OPT-3.08", percent},
      {"WORKDEF 1,0 (8., 80., 1., 90., 1+0)\n{WORKDEF 1,0 (8., 80., 1., 90., 63+1)}\n", 7403,
       "OPT-3.06", schedule},
      {"WORKDEF 2,0 (1+0)\nWORKDEF 2,0 (62+1)\n{WORKDEF 2,0 (1-1)}\n", 7403, "OPT-3.06", schedule},
  };
  for (const AdviceRow& row : rows) ExpectAdvice(row);
}

// OPT-7.27, OPT-7.62, OPT-7.78, OPT-7.79, OPT-7.83: constants that cannot be computed.
TEST(AdvicePlaces, OfConstantsThatFail) {
  const std::string fails = "this fails whenever it is executed: ";
  const std::vector<AdviceRow> rows = {
      {"{VR[0] = 1/0}\n", 7201, "OPT-7.79", fails},
      {"{VR[0] = 5 MOD 0}\n", 7201, "OPT-7.79", fails},
      {"{VR[0] = 1E18*10.}\n", 7202, "OPT-7.62", fails},
      {"{VR[0] = SQRT(-1)}\n", 7204, "OPT-7.83", fails},
      {"{VI[2] = 32768}\n", 7203, "OPT-7.78", fails},
      {"{VI[2] = 30000 + 2768}\n", 7203, "OPT-7.78", fails},
      {"{WAIT 1 > 2}\n", 7033, "OPT-7.27", "this waits for ever"},
      {"{WAIT OFF}\n", 7033, "OPT-7.27", "this waits for ever"},
      {"{SPEED 1/0}\n", 7201, "OPT-7.79", fails},
      {"{SPEED SQRT(-1)}\n", 7204, "OPT-7.83", fails},
      {"{CALL 6 (1, 1/0, SQRT(-1))}\n", 7201, "OPT-7.79", fails},
      {"{CALL 6 (1/0, 2/0)}\n", 7201, "OPT-7.79", fails},  // once a statement
      {"{CALL 6 (1+1, 1/0)}\n", 7201, "OPT-7.79", fails},  // whatever stands before it
  };
  for (const AdviceRow& row : rows) ExpectAdvice(row);
  // OPT-7.78: only what an INTEGER variable is to hold can be too large; a parameter has no type
  // yet.
  EXPECT_EQ(FindingsOf("CALL 6 (20000+20000)\n", true), std::vector<int>{});
}

}  // namespace
}  // namespace rmlcell::optimo
