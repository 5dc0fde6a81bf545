#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "engine/optimo/language/operands.h"
#include "engine/optimo/language/words.h"

// Every RML instruction, one row each. Parser, checker, object codec, printer, inch/metric
// converter and interpreter read this table: a new instruction is a row, and code where it acts.
namespace rmlcell::optimo {

enum class Op : std::uint8_t {
  kInvalid,  // a statement that could not be parsed; never in a module that was compiled
  kMove,
  kCoord,
  kPath,
  kSpeed,
  kAccel,
  kOversh,
  kDelay,
  kSysdef,
  kTcp,
  kWorkdef,
  kWork,
  kGo,
  kCall,
  kFunction,
  kGoto,
  kGotoTable,
  kGosub,
  kIf,
  kWait,
  kReturn,
  kEndtask,
  kPause,
  kStop,
  kErr,
  kNoerr,
  kSeterr,
  kTask,
  kTimer,
  kLet,
  kDeclare,
  kDefine,
  kAssign,
  kUpdate,
  kImage,
  kReal,
  kBreak,
  kSimul,
  kZero,
  kIgnored,  // kIgnored: CONT, EXTERN ...; Module::texts has word and parameters
};
inline constexpr int kOpCount = static_cast<int>(Op::kIgnored) + 1;

// Attributes behind '/', as bits of Instruction::attributes.
enum Attribute : std::uint16_t {
  kVia = 1 << 0,
  kFly = 1 << 1,
  kStart = 1 << 2,
  kEnd = 1 << 3,
  kTime = 1 << 4,
  kNext = 1 << 5,
  kInf = 1 << 6,
  kOn = 1 << 7,
  kOff = 1 << 8,
  kCycle = 1 << 9,    // GO /C
  kRepeat = 1 << 10,  // GO /R
  kSingle = 1 << 11,  // GO /S
  kAuto = 1 << 12,    // TIMER /AUTO
  kDis = 1 << 13,     // TIMER /DIS
};

struct AttributeInfo {
  Attribute bit;
  Word word;
};
// In the order in which the printer and the object have them, OPT-B.40.
inline constexpr std::array kAttributes = {
    AttributeInfo{kOn, Word::kOn},       AttributeInfo{kOff, Word::kOff},
    AttributeInfo{kVia, Word::kVia},     AttributeInfo{kFly, Word::kFly},
    AttributeInfo{kStart, Word::kStart}, AttributeInfo{kEnd, Word::kEnd},
    AttributeInfo{kTime, Word::kTime},   AttributeInfo{kNext, Word::kNext},
    AttributeInfo{kInf, Word::kInf},     AttributeInfo{kCycle, Word::kC},
    AttributeInfo{kRepeat, Word::kR},    AttributeInfo{kSingle, Word::kS},
    AttributeInfo{kAuto, Word::kAuto},   AttributeInfo{kDis, Word::kDis},
};

// What an instruction does to the machine.
enum class Effect : std::uint8_t {
  kNone,     // DECLARE, ignored words
  kMotion,   // MOVE, ZERO
  kModal,    // a value that holds until it is changed
  kTimed,    // takes virtual time or waits
  kProcess,  // laser
  kData,     // variables and images
  kFlow,     // decides what is executed next
};

// May it stand between a /FLY move and the next MOVE without a stop? OPT-2.48, OPT-2.49.
// For every class: an instruction that reads IL, IA or OA[0] (Instruction::reads_machine) is a
// stop.
enum class FlyClass : std::uint8_t {
  kTransparent,
  kStandstill,
  kDepends,  // MOVE: its /START; COORD: OPT-2.45; WORK: ON of kind 1 with a delay; TCP: if the tip
             // moves; ENDTASK, RETURN, GO, CALL: whether they end the program
};

struct InstructionInfo {
  Op op;
  Word word;                 // kNone for LET's short form, invalid and ignored
  std::string_view name;     // "MOVE"; for the handbox and listings "LET", "GOTO"
  std::uint16_t attributes;  // those that it may have
  Effect effect;
  FlyClass fly;
  std::uint8_t object_code;  // OPT-B.70; never changes meaning
  std::string_view rule;
  std::span<const Operand> operands{};  // empty: it stands alone, or is kInvalid or kIgnored
};

inline constexpr std::uint16_t kMoveAttributes = kVia | kFly | kStart | kEnd | kTime | kNext | kInf;
inline constexpr std::uint16_t kWorkAttributes = kOn | kOff | kStart | kEnd | kTime | kNext;

// clang-format off
inline constexpr std::array<InstructionInfo, kOpCount> kInstructionSet = {{
    {Op::kInvalid,   Word::kNone,     "",         0, Effect::kNone,    FlyClass::kStandstill,   0, ""},
    {Op::kMove,      Word::kMove,     "MOVE",     kMoveAttributes, Effect::kMotion, FlyClass::kDepends, 1, "OPT-2.01", operands::kPose},
    {Op::kCoord,     Word::kCoord,    "COORD",    0, Effect::kModal,   FlyClass::kDepends,      2, "OPT-2.06", operands::kCoord},
    {Op::kPath,      Word::kPath,     "PATH",     0, Effect::kModal,   FlyClass::kTransparent,  3, "OPT-2.12", operands::kPath},
    {Op::kSpeed,     Word::kSpeed,    "SPEED",    0, Effect::kModal,   FlyClass::kTransparent,  4, "OPT-2.34", operands::kValue},
    {Op::kAccel,     Word::kAccel,    "ACCEL",    0, Effect::kModal,   FlyClass::kTransparent,  5, "OPT-2.36", operands::kValue},
    {Op::kOversh,    Word::kOversh,   "OVERSH",   0, Effect::kModal,   FlyClass::kTransparent,  6, "OPT-2.38", operands::kValue},
    {Op::kDelay,     Word::kDelay,    "DELAY",    0, Effect::kTimed,   FlyClass::kStandstill,   7, "OPT-3.45", operands::kValue},
    {Op::kSysdef,    Word::kSysdef,   "SYSDEF",   0, Effect::kModal,   FlyClass::kTransparent,  8, "OPT-7.28", operands::kFrame},
    {Op::kTcp,       Word::kTcp,      "TCP",      0, Effect::kModal,   FlyClass::kDepends,      9, "OPT-4.64", operands::kTool},
    {Op::kWorkdef,   Word::kWorkdef,  "WORKDEF",  0, Effect::kProcess, FlyClass::kTransparent, 10, "OPT-3.01", operands::kWorkdef},
    {Op::kWork,      Word::kWork,     "WORK",     kWorkAttributes, Effect::kProcess, FlyClass::kDepends, 11, "OPT-3.13", operands::kProcess},
    {Op::kGo,        Word::kGo,       "GO",       kCycle | kRepeat | kSingle, Effect::kFlow, FlyClass::kStandstill, 12, "OPT-7.01", operands::kProgram},
    {Op::kCall,      Word::kCall,     "CALL",     0, Effect::kFlow,    FlyClass::kStandstill,  13, "OPT-7.07", operands::kCall},
    {Op::kFunction,  Word::kFunction, "FUNCTION", 0, Effect::kFlow,    FlyClass::kTransparent, 14, "OPT-9.01", operands::kFunction},
    {Op::kGoto,      Word::kGoto,     "GOTO",     0, Effect::kFlow,    FlyClass::kTransparent, 15, "OPT-7.15", operands::kLabel},
    {Op::kGotoTable, Word::kGoto,     "GOTO",     0, Effect::kFlow,    FlyClass::kTransparent, 16, "OPT-7.17", operands::kLabelTable},
    {Op::kGosub,     Word::kGosub,    "GOSUB",    0, Effect::kFlow,    FlyClass::kTransparent, 17, "OPT-7.20", operands::kLabel},
    {Op::kIf,        Word::kIf,       "IF",       0, Effect::kFlow,    FlyClass::kTransparent, 18, "OPT-7.23", operands::kIf},
    {Op::kWait,      Word::kWait,     "WAIT",     0, Effect::kTimed,   FlyClass::kStandstill,  19, "OPT-7.27", operands::kValue},
    {Op::kReturn,    Word::kReturn,   "RETURN",   0, Effect::kFlow,    FlyClass::kTransparent, 20, "OPT-7.22"},
    {Op::kEndtask,   Word::kEndtask,  "ENDTASK",  0, Effect::kFlow,    FlyClass::kDepends,     21, "OPT-3.46"},
    {Op::kPause,     Word::kPause,    "PAUSE",    0, Effect::kTimed,   FlyClass::kStandstill,  22, "OPT-3.49"},
    {Op::kStop,      Word::kStop,     "STOP",     0, Effect::kTimed,   FlyClass::kStandstill,  23, "OPT-3.49"},
    {Op::kErr,       Word::kErr,      "ERR",      0, Effect::kFlow,    FlyClass::kStandstill,  24, "OPT-3.53", operands::kLabel},
    {Op::kNoerr,     Word::kNoerr,    "NOERR",    0, Effect::kFlow,    FlyClass::kStandstill,  25, "OPT-3.56"},
    {Op::kSeterr,    Word::kSeterr,   "SETERR",   0, Effect::kData,    FlyClass::kStandstill,  26, "OPT-3.60", operands::kValue},
    {Op::kTask,      Word::kTask,     "TASK",     0, Effect::kFlow,    FlyClass::kTransparent, 27, "OPT-9.11", operands::kTask},
    {Op::kTimer,     Word::kTimer,    "TIMER",    kAuto | kDis, Effect::kFlow, FlyClass::kStandstill, 28, "OPT-B.59", operands::kTimer},
    {Op::kLet,       Word::kLet,      "LET",      0, Effect::kData,    FlyClass::kTransparent, 29, "OPT-7.91", operands::kLet},
    {Op::kDeclare,   Word::kDeclare,  "DECLARE",  0, Effect::kNone,    FlyClass::kTransparent, 30, "OPT-7.41", operands::kDeclare},
    {Op::kDefine,    Word::kDefine,   "DEFINE",   0, Effect::kData,    FlyClass::kTransparent, 31, "OPT-9.22", operands::kDefine},
    {Op::kAssign,    Word::kAssign,   "ASSIGN",   0, Effect::kData,    FlyClass::kTransparent, 32, "OPT-7.102", operands::kAssign},
    {Op::kUpdate,    Word::kUpdate,   "UPDATE",   kOn | kOff, Effect::kData, FlyClass::kStandstill, 33, "OPT-7.98", operands::kGroups},
    {Op::kImage,     Word::kImage,    "IMAGE",    0, Effect::kData,    FlyClass::kStandstill,  34, "OPT-7.100", operands::kGroupsOrAll},
    {Op::kReal,      Word::kReal,     "REAL",     0, Effect::kData,    FlyClass::kStandstill,  35, "OPT-7.100", operands::kGroupsOrAll},
    {Op::kBreak,     Word::kBreak,    "BREAK",    0, Effect::kModal,   FlyClass::kStandstill,  36, "OPT-6.11", operands::kStep},
    {Op::kSimul,     Word::kSimul,    "SIMUL",    0, Effect::kModal,   FlyClass::kStandstill,  37, "OPT-6.16", operands::kStep},
    {Op::kZero,      Word::kZero,     "ZERO",     0, Effect::kMotion,  FlyClass::kStandstill,  38, "OPT-B.60"},
    {Op::kIgnored,   Word::kNone,     "",         0, Effect::kNone,    FlyClass::kStandstill,  39, "OPT-E.7023"},
}};
// clang-format on

constexpr bool IsIndexedByOp() {
  for (int i = 0; i < kOpCount; ++i) {
    const InstructionInfo& row = kInstructionSet[static_cast<std::size_t>(i)];
    if (static_cast<int>(row.op) != i || row.object_code != i) return false;
  }
  return true;
}
static_assert(IsIndexedByOp(), "one row per Op, in the order of Op");

inline const InstructionInfo& Describe(Op op) {
  return kInstructionSet[static_cast<std::size_t>(op)];
}

// Of the operands of this instruction.
const OperandCounts& CountOf(Op op);

// The instruction that this word begins, or kInvalid. GOTO yields kGoto; the parser tells the forms
// apart.
Op OpOf(Word word);

}  // namespace rmlcell::optimo
