#include "engine/optimo/editing/word_facts.h"

#include <array>

#include "engine/core/check.h"

namespace rmlcell::optimo::editing {
namespace {

constexpr std::string_view kUnavailable =
    "Not available on the Optimo: an error wherever it stands.";
constexpr std::string_view kWithoutEffect =
    "Accepted without effect; the rest of the line is not looked at.";
constexpr std::string_view kHalts =
    "Halts; START goes on, except when the program was started from outside: then the run ends. "
    "The "
    "beam is off meanwhile.";  // PAUSE and STOP are the same, OPT-3.51

// clang-format off
constexpr auto kWordFacts = std::to_array<WordFact>({
    {Word::kAccel, "ACCEL percent", "Acceleration in percent of the machine's largest, 0 to 100. Holds until it is changed; 100 when a program starts."},
    {Word::kAssign, "ASSIGN first = value /n", "Writes a whole number in binary to n (1 to 16) logical outputs or variables in a row, lowest bit first."},
    {Word::kBreak, "BREAK step [, program]", "Sets the breakpoint of the control behind a step."},
    {Word::kCall, "CALL program [(values)]", "Runs another stored program and comes back; up to eight values become its PAR[0] to PAR[7]. At most four levels. What holds in the caller (COORD, PATH, SPEED, WORKDEF) comes back with it."},
    {Word::kCont, "", kWithoutEffect},
    {Word::kCoord, "COORD ABSOL | ROBOT", "What the coordinates of MOVE mean: ABSOL the tip of the tool, with all kinds of PATH; ROBOT the column, PTP only."},
    {Word::kDeclare, "DECLARE name = value", "Names a number, a logical constant, PI or a variable. No step. Eight characters of a name count, and it belongs to this program alone."},
    {Word::kDefine, "DEFINE PAR[n] = FLOAT | INT | LOGIC", "Type of a parameter, before its first use; FLOAT without it."},
    {Word::kDelay, "DELAY seconds", "Waits, whatever the override. The machine stands still, so a /FLY before it is cancelled."},
    {Word::kDisable, "", kWithoutEffect},
    {Word::kElse, "IF condition THEN sequence number ELSE sequence number", "Where IF goes on when its condition is false."},
    {Word::kEnable, "", kWithoutEffect},
    {Word::kEndtask, "", "Ends the program; in a FUNCTION it returns. Assumed at the end of the text."},
    {Word::kErr, "ERR sequence number", "From here on a program error goes on at this sequence number in place of stopping. Taken once; NOERR cancels it."},
    {Word::kExtern, "", kWithoutEffect},
    {Word::kFunction, "FUNCTION program [(values)]", "Runs a program that is contained in this one's executable: the number is fixed, the program shares COORD, PATH, SPEED and processes, and up to eight values become its PAR[0] to PAR[7]. At most four levels."},
    {Word::kGet, "", kUnavailable},
    {Word::kGo, "GO program [/C | /R | /S]", "Ends this program and starts another; what waits for a return is dropped."},
    {Word::kGoto, "GOTO sequence number | GOTO variable (sequence number, sequence number ...)", "Goes on at a sequence number of this program; with a list at the one that the variable counts to, and nowhere when it has none."},
    {Word::kGosub, "GOSUB sequence number", "Runs from a sequence number to RETURN, then goes on behind. At most 16 levels."},
    {Word::kIf, "IF condition THEN sequence number [ELSE sequence number]", "Goes on at a sequence number. A number is true when it is not zero."},
    {Word::kImage, "IMAGE [group, ...]", "Inputs and outputs of the groups (all without one) are simulated: only their images are read and written, until REAL."},
    {Word::kInclude, "", kUnavailable},
    {Word::kLet, "[LET] variable = value", "Assigns; the word may be left out. Logical goes to logical, numeric to numeric; VI truncates."},
    {Word::kMachine, "", kUnavailable},
    {Word::kMove, "MOVE (X, Y, Z, A, B) [/attributes]", "Moves to a point, never by a distance: X Y Z in mm, A B in rad. How is decided by COORD, PATH, SPEED and the attributes VIA, FLY, START, END, TIME, NEXT."},
    {Word::kNobreak, "", kWithoutEffect},
    {Word::kNoerr, "", "Cancels ERR of this program."},
    {Word::kNotrace, "", kUnavailable},
    {Word::kOversh, "OVERSH percent", "Share of the speed that is kept in a /FLY passage, 0 to 100. At 0 the corner is reached; 100 when a program starts."},
    {Word::kPath, "PATH PTP | LIN | CIR | HOLE (radius)", "How MOVE gets to its target. Holds until it is changed."},
    {Word::kPause, "", kHalts},
    {Word::kReal, "REAL [group, ...]", "Connects inputs and outputs of the groups (all without one) again after IMAGE."},
    {Word::kReturn, "", "Back behind the GOSUB that came here; in a FUNCTION without one it ends the function."},
    {Word::kSend, "", kUnavailable},
    {Word::kSensdef, "", kUnavailable},
    {Word::kSensor, "", kUnavailable},
    {Word::kSeterr, "SETERR number", "Shows ERROR and a number from 1 to 9999 on the handbox, and does nothing else."},
    {Word::kSignal, "", kUnavailable},
    {Word::kSimul, "SIMUL step [, program]", "Arms a dry run, without the beam, up to a step for the next start."},
    {Word::kSpeed, "SPEED percent", "Speed in percent of the machine's largest, 0 to 100. Holds until it is changed; 70 when a program starts."},
    {Word::kStop, "", kHalts},
    {Word::kSysdef, "SYSDEF [(dx, dy, dz, rz, ry, rx)]", "Shifts and turns the coordinates of ABSOL moves: mm and rad. A new one replaces the old; without values it is cancelled. It outlives the program."},
    {Word::kTask, "TASK 1", "Where the program begins; what stands before it is skipped. Other numbers have no meaning."},
    {Word::kTcp, "TCP (x0, y0, z0 / x1, y1, z1)", "The tip of the tool against the calibrated one, as two points of its axis in mm. It outlives the program."},
    {Word::kThen, "IF condition THEN sequence number", "Where IF goes on when its condition is true."},
    {Word::kTimer, "TIMER (seconds, sequence number) [/AUTO] | TIMER /DIS", "GOSUB to a sequence number when the time is over, between two instructions; /AUTO again and again, /DIS cancels."},
    {Word::kTrace, "", kUnavailable},
    {Word::kUpdate, "UPDATE group, ... /ON | /OFF", "Whether the images of inputs and outputs follow the machine. All do when a program starts."},
    {Word::kWait, "WAIT condition", "Stands still until the condition is true."},
    {Word::kWeav, "", kWithoutEffect},
    {Word::kWeavdef, "", kWithoutEffect},
    {Word::kWeaving, "", kWithoutEffect},
    {Word::kWork, "WORK kind,process /ON | /OFF", "Beam and laser schedule. Kind 0 switches the beam; 1 pierces and then ramps the power with the speed; 2 selects a laser schedule. Kinds 1 and 2 need their WORKDEF first."},
    {Word::kWorkdef, "WORKDEF kind,process (values)", "Defines a process 0 to 9. Kind 0: no values. Kind 1: speed %, power %, delay s, peak % [, schedule]. Kind 2: the laser schedule 1 to 63."},
    {Word::kZero, "", "The zero procedure of the axes: Z, then A and B, then X and Y."},
    {Word::kAbsol, "COORD ABSOL", "Coordinates are those of the tool tip."},
    {Word::kRobot, "COORD ROBOT", "Coordinates are those of the column; only PATH PTP."},
    {Word::kPtp, "PATH PTP", "All axes start and stop together; the slowest one sets the time. The speed of the tip is not controlled."},
    {Word::kLin, "PATH LIN", "The tip goes on a straight line at the programmed speed; A and B turn in proportion."},
    {Word::kCir, "PATH CIR", "The tip goes on the arc through the /VIA point to the target; straight without /VIA."},
    {Word::kHole, "PATH HOLE (radius)", "MOVE gives the centre and /VIA a point of the axis: straight to the nearest point of the circle, once round it, counter-clockwise as seen from that point."},
    {Word::kFre, "PATH FRE", kUnavailable},
    {Word::kVia, "/VIA (X, Y, Z, A, B)", "The point that a CIR arc passes, or a point of the axis of a HOLE. Its head angles do not count."},
    {Word::kFly, "/FLY", "Passes near the target without a stop, at the speed that OVERSH sets. For this MOVE only."},
    {Word::kStart, "/START (condition)", "Begins when the condition becomes true."},
    {Word::kEnd, "/END (condition)", "Ends early when the condition becomes true; the program goes on from there."},
    {Word::kTime, "/TIME (seconds, sequence number)", "GOSUB to a sequence number when the MOVE is not complete in time; the rest of the MOVE is given up."},
    {Word::kNext, "/NEXT", "The next instruction starts at once, while this one goes on. IL[95] is 1 as long as it moves."},
    {Word::kInf, "/INF", "Accepted without effect."},
    {Word::kAuto, "TIMER (seconds, sequence number) /AUTO", "The timer starts again whenever it ran out."},
    {Word::kDis, "TIMER /DIS", "Cancels the timer of this program."},
    {Word::kClock, "", kUnavailable},
    {Word::kIntr, "", kUnavailable},
    {Word::kC, "GO program /C", "The program that is gone to runs in CYCLE mode."},
    {Word::kR, "GO program /R", "The program that is gone to runs in REPEAT mode."},
    {Word::kS, "GO program /S", "The program that is gone to runs in SINGLE mode."},
    {Word::kOn, "", "Logical 1."},
    {Word::kTrue, "", "Logical 1, as ON."},
    {Word::kYes, "", "Logical 1, as ON."},
    {Word::kOff, "", "Logical 0."},
    {Word::kFalse, "", "Logical 0, as OFF."},
    {Word::kNo, "", "Logical 0, as OFF."},
    {Word::kSin, "SIN (rad)", "Sine."},
    {Word::kCos, "COS (rad)", "Cosine."},
    {Word::kTan, "TAN (rad)", "Tangent."},
    {Word::kAsin, "ASIN (x)", "Arc sine in rad; x from -1 to 1."},
    {Word::kAcos, "ACOS (x)", "Arc cosine in rad; x from -1 to 1."},
    {Word::kAtan, "ATAN (x)", "Arc tangent in rad."},
    {Word::kSqrt, "SQRT (x)", "Square root; x from 0."},
    {Word::kExp, "EXP (x)", "e to the power of x; x from -32 to 32."},
    {Word::kLn, "LN (x)", "Natural logarithm; x above 0."},
    {Word::kLog, "LOG (x)", "Logarithm to base 10; x above 0."},
    {Word::kAbs, "ABS (x)", "The value without its sign."},
    {Word::kInt, "INT (x)", "The value without its decimals, towards zero; behind DEFINE the whole-number type of a parameter."},
    {Word::kMod, "a MOD b", "Remainder of a / b, with the sign of a."},
    {Word::kAnd, "a AND b", "True when both are. Binds tighter than OR and XOR; relations bind tighter still. Both sides are always computed."},
    {Word::kOr, "a OR b", "True when one is. OR and XOR bind alike, from the left."},
    {Word::kXor, "a XOR b", "True when exactly one is. OR and XOR bind alike, from the left."},
    {Word::kNot, "NOT a", "True when a is not. NOT VR[1] = 2. is NOT (VR[1] = 2.)."},
    {Word::kPi, "", "The constant 3.14159."},
    {Word::kVr, "VR[0] to VR[99]", "Real variables; seven digits. They outlive programs and power-off."},
    {Word::kVi, "VI[0] to VI[99]", "Whole-number variables, -32768 to 32767. They outlive programs and power-off."},
    {Word::kVl, "VL[0] to VL[99]", "Logical variables. They outlive programs and power-off."},
    {Word::kIl, "IL[0] to IL[99]", "Logical inputs; read only. Reading one needs standstill, so a /FLY before it is cancelled."},
    {Word::kOl, "OL[0] to OL[99]", "Logical outputs. What is read is the image, not the wire."},
    {Word::kIa, "IA[0] to IA[99]", "Analogue inputs; read only. IA[0] to IA[4] are the machine coordinates X Y Z A B."},
    {Word::kOa, "OA[0] to OA[99]", "Analogue outputs; images only. OA[0] is the speed, read only."},
    {Word::kPar, "PAR[0] to PAR[7]", "What CALL or FUNCTION passed, a copy; 0 when nothing was."},
    {Word::kFloat, "DEFINE PAR[n] = FLOAT", "A real parameter; what it is without DEFINE."},
    {Word::kLogic, "DEFINE PAR[n] = LOGIC", "A logical parameter: passed numbers are true when not zero."},
});
// clang-format on

constexpr bool IsIndexedByWord() {
  for (std::size_t row = 0; row < kWordFacts.size(); ++row) {
    if (static_cast<std::size_t>(kWordFacts[row].word) != row + 1) return false;
  }
  return kWordFacts.size() == static_cast<std::size_t>(Word::kLogic);
}
static_assert(IsIndexedByWord(), "one row per word, in the order of words.def");

}  // namespace

std::span<const WordFact> WordFacts() { return kWordFacts; }

const WordFact& FactOf(Word word) {
  RMLCELL_CHECK(word != Word::kNone);
  return kWordFacts[static_cast<std::size_t>(word) - 1];
}

}  // namespace rmlcell::optimo::editing
