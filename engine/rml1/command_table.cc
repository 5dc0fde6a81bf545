#include "engine/rml1/command_table.h"

#include <array>

namespace rmlcell::rml1 {
namespace {

using enum Family;
using enum Shape;

constexpr auto kKeep = ModeChange::kNone;
constexpr auto kAbs = ModeChange::kAbsolute;
constexpr auto kRel = ModeChange::kRelative;
constexpr auto kStay = ToolChange::kNone;
constexpr auto kUp = ToolChange::kUp;
constexpr auto kDown = ToolChange::kDown;

// clang-format off
constexpr std::array kCommands = {
    //         op               name   family   shape    n  mode   tool   skipped set     rule
    CommandRow{Op::kD,          "D",   kMode1,  kSets,   2, kAbs,  kDown, kSkipNothing,    "RML1-3A.12"},
    CommandRow{Op::kF,          "F",   kMode1,  kFixed,  1, kKeep, kStay, kSkipNothing,    "RML1-3A.44"},
    CommandRow{Op::kH,          "H",   kMode1,  kFixed,  0, kAbs,  kUp,   kSkipNothing,    "RML1-3A.37"},
    CommandRow{Op::kI,          "I",   kMode1,  kSets,   2, kRel,  kDown, kSkipNothing,    "RML1-3A.17"},
    CommandRow{Op::kM,          "M",   kMode1,  kSets,   2, kAbs,  kUp,   kSkipNothing,    "RML1-3A.21"},
    CommandRow{Op::kR,          "R",   kMode1,  kSets,   2, kRel,  kUp,   kSkipNothing,    "RML1-3A.24"},
    CommandRow{Op::kV,          "V",   kMode1,  kFixed,  1, kKeep, kStay, kSkipNothing,    "RML1-3A.49"},
    CommandRow{Op::kW,          "W",   kMode1,  kFixed,  1, kKeep, kStay, kSkipNothing,    "RML1-3A.53"},
    CommandRow{Op::kZ,          "Z",   kMode1,  kSets,   3, kKeep, kStay, kSkipNothing,    "RML1-3A.63"},
    CommandRow{Op::kAt,         "@",   kMode1,  kFixed,  2, kKeep, kStay, kSkipNothing,    "RML1-3A.01"},
    CommandRow{Op::kCall,       "^",   kMode1,  kCall,   0, kKeep, kStay, kSkipNothing,    "RML1-3A.28"},
    CommandRow{Op::kDF,         "DF",  kMode2,  kFixed,  0, kAbs,  kStay, kSkipNothing,    "RML1-3B.01"},
    CommandRow{Op::kIN,         "IN",  kMode2,  kFixed,  0, kAbs,  kUp,   kSkipNothing,    "RML1-3B.03"},
    CommandRow{Op::kPA,         "PA",  kMode2,  kSets,   2, kAbs,  kStay, kSkipNothing,    "RML1-3B.09"},
    CommandRow{Op::kPD,         "PD",  kMode2,  kSets,   2, kKeep, kDown, kSkipNothing,    "RML1-3B.13"},
    CommandRow{Op::kPR,         "PR",  kMode2,  kSets,   2, kRel,  kStay, kSkipNothing,    "RML1-3B.24"},
    CommandRow{Op::kPU,         "PU",  kMode2,  kSets,   2, kKeep, kUp,   kSkipNothing,    "RML1-3B.13"},
    CommandRow{Op::kVS,         "VS",  kMode2,  kFixed,  1, kKeep, kStay, kSkipNothing,    "RML1-3B.27"},
    CommandRow{Op::kDW,         "!DW", kCommon, kFixed,  1, kKeep, kStay, kSkipNothing,    "RML1-3C.01"},
    CommandRow{Op::kMC,         "!MC", kCommon, kFixed,  1, kKeep, kStay, kSkipNothing,    "RML1-3C.02"},
    CommandRow{Op::kNR,         "!NR", kCommon, kFixed,  0, kKeep, kStay, kSkipNothing,    "RML1-3C.08"},
    CommandRow{Op::kPZ,         "!PZ", kCommon, kFixed,  2, kKeep, kStay, kSkipNothing,    "RML1-3C.12"},
    CommandRow{Op::kRC,         "!RC", kCommon, kFixed,  1, kKeep, kStay, kSkipNothing,    "RML1-3C.15"},
    CommandRow{Op::kVZ,         "!VZ", kCommon, kFixed,  1, kKeep, kStay, kSkipNothing,    "RML1-3C.23"},
    CommandRow{Op::kZM,         "!ZM", kCommon, kFixed,  1, kKeep, kStay, kSkipNothing,    "RML1-3C.25"},
    CommandRow{Op::kZO,         "!ZO", kCommon, kFixed,  1, kKeep, kStay, kSkipNothing,    "RML1-3C.32"},
    CommandRow{Op::kZZ,         "!ZZ", kCommon, kSets,   3, kKeep, kStay, kSkipNothing,    "RML1-3E.01"},
    CommandRow{Op::kZE,         "!ZE", kCommon, kAxes,   0, kKeep, kStay, kSkipNothing,    "RML1-3D.01"},
    CommandRow{Op::kToolChange, "J",   kMode1,  kAny,    0, kKeep, kStay, kSkipToolChange, "RML1-9.48"},
    CommandRow{Op::kVendorCO,   "!CO", kCommon, kAny,    0, kKeep, kStay, kSkipVPanel,     "RML1-9.48"},
    CommandRow{Op::kVendorSL,   "!SL", kCommon, kAny,    0, kKeep, kStay, kSkipVPanel,     "RML1-9.48"},
    CommandRow{Op::kVendorSP,   "!SP", kCommon, kAny,    0, kKeep, kStay, kSkipVPanel,     "RML1-9.48"},
    CommandRow{Op::kVendorRD,   "!RD", kCommon, kAny,    0, kKeep, kStay, kSkipVPanel,     "RML1-9.48"},
    CommandRow{Op::kVendorOne,  "!1",  kCommon, kAny,    0, kKeep, kStay, kSkipPnc3000,    "RML1-9.48"},
    CommandRow{Op::kVendorZero, "!0",  kCommon, kAny,    0, kKeep, kStay, kSkipPnc3000,    "RML1-9.48"},
};
// clang-format on

constexpr bool IsIndexedByOp() {
  for (std::size_t i = 0; i < kCommands.size(); ++i) {
    if (static_cast<std::size_t>(kCommands[i].op) != i) return false;
  }
  return kCommands.size() == static_cast<std::size_t>(kOpCount);
}
static_assert(IsIndexedByOp(), "one row per Op, in the order of Op");

constexpr std::size_t kLetters = 26;
constexpr std::int8_t kNone = -1;
using LetterIndex = std::array<std::int8_t, kLetters>;
using PairIndex = std::array<std::int8_t, kLetters * kLetters>;

constexpr bool IsLetter(char c) { return c >= 'A' && c <= 'Z'; }
constexpr std::size_t PairKey(char first, char second) {
  return static_cast<std::size_t>(first - 'A') * kLetters + static_cast<std::size_t>(second - 'A');
}

// The scanner asks for every name: these answer in one look instead of a search through the rows.
constexpr LetterIndex MakeLetterIndex() {
  LetterIndex index{};
  index.fill(kNone);
  for (std::size_t i = 0; i < kCommands.size(); ++i) {
    const CommandRow& row = kCommands[i];
    if (row.family != kMode1 || !IsLetter(row.name[0])) continue;
    index[static_cast<std::size_t>(row.name[0] - 'A')] = static_cast<std::int8_t>(i);
  }
  return index;
}
constexpr PairIndex MakePairIndex(Family family) {
  PairIndex index{};
  index.fill(kNone);
  for (std::size_t i = 0; i < kCommands.size(); ++i) {
    const CommandRow& row = kCommands[i];
    if (row.family != family || row.name.size() < 2) continue;
    const std::string_view pair = row.name.substr(row.name.size() - 2);
    if (!IsLetter(pair[0]) || !IsLetter(pair[1])) continue;
    index[PairKey(pair[0], pair[1])] = static_cast<std::int8_t>(i);
  }
  return index;
}
constexpr LetterIndex kMode1Index = MakeLetterIndex();
constexpr PairIndex kMode2Index = MakePairIndex(kMode2);
constexpr PairIndex kCommonIndex = MakePairIndex(kCommon);

const CommandRow* RowAt(std::int8_t index, std::uint8_t skipped) {
  if (index == kNone) return nullptr;
  const CommandRow& row = kCommands[static_cast<std::size_t>(index)];
  return row.skip_set == kSkipNothing || (row.skip_set & skipped) != 0 ? &row : nullptr;
}

}  // namespace

std::span<const CommandRow> CommandTable() { return kCommands; }
const CommandRow& RowOf(Op op) { return kCommands[static_cast<std::size_t>(op)]; }

const CommandRow* FindMode1(char letter, std::uint8_t skipped) {
  return RowAt(kMode1Index[static_cast<std::size_t>(letter - 'A')], skipped);
}
const CommandRow* FindMode2(char first, char second) {
  return RowAt(kMode2Index[PairKey(first, second)], kSkipNothing);
}
bool BeginsMode2(char letter) {
  return letter == 'D' || letter == 'I' || letter == 'P' || letter == 'V';
}
const CommandRow* FindCommon(char first, char second, std::uint8_t skipped) {
  return RowAt(kCommonIndex[PairKey(first, second)], skipped);
}
const CommandRow* FindCommonDigit(char digit, std::uint8_t skipped) {
  if ((skipped & kSkipPnc3000) == 0) return nullptr;
  if (digit == '1') return &RowOf(Op::kVendorOne);
  if (digit == '0') return &RowOf(Op::kVendorZero);
  return nullptr;
}

}  // namespace rmlcell::rml1
