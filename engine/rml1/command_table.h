#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace rmlcell::rml1 {

// Every command of RML-1, in the order of the table. The last ones are names of other machines that
// a profile may have skipped with their parameters (RML1-9.48).
enum class Op : std::uint8_t {
  kD,
  kF,
  kH,
  kI,
  kM,
  kR,
  kV,
  kW,
  kZ,
  kAt,
  kCall,
  kDF,
  kIN,
  kPA,
  kPD,
  kPR,
  kPU,
  kVS,
  kDW,
  kMC,
  kNR,
  kPZ,
  kRC,
  kVZ,
  kZM,
  kZO,
  kZZ,
  kZE,
  kToolChange,
  kVendorCO,
  kVendorSL,
  kVendorSP,
  kVendorRD,
  kVendorOne,
  kVendorZero,
};
inline constexpr int kOpCount = static_cast<int>(Op::kVendorZero) + 1;

// Which setting of the command set knows a command (RML1-1.01 to 1.04).
enum class Family : std::uint8_t { kMode1, kMode2, kCommon };

// How parameters are read and when the command runs (rml1.md 0.4).
enum class Shape : std::uint8_t {
  kFixed,  // up to `values` numbers; runs when the list is over
  kSets,   // sets of `values` numbers; each runs as soon as it is complete
  kAxes,   // !ZE: axis letters with numbers, in groups
  kCall,   // ^: the next mode-2 command
  kAny,    // numbers that are read and dropped
};

// What a command does to the coordinate mode and the tool state (guideline 5-3).
enum class ModeChange : std::uint8_t { kNone, kAbsolute, kRelative };
enum class ToolChange : std::uint8_t { kNone, kUp, kDown };

// Names that a profile may skip, as bits.
enum : std::uint8_t { kSkipNothing = 0, kSkipToolChange = 1, kSkipVPanel = 2, kSkipPnc3000 = 4 };

struct CommandRow {
  Op op;
  std::string_view name;
  Family family;
  Shape shape;
  std::uint8_t values;
  ModeChange mode;
  ToolChange tool;
  std::uint8_t skip_set;  // not 0: known only when the profile skips this set
  std::string_view rule;
};

// One row per Op, in the order of Op.
std::span<const CommandRow> CommandTable();
const CommandRow& RowOf(Op op);

// Names in upper case; nullptr when there is no such command. `skipped` are the sets that the
// profile skips.
const CommandRow* FindMode1(char letter, std::uint8_t skipped);
const CommandRow* FindMode2(char first, char second);
bool BeginsMode2(char letter);  // D, I, P, V
const CommandRow* FindCommon(char first, char second, std::uint8_t skipped);
const CommandRow* FindCommonDigit(char digit, std::uint8_t skipped);  // !1 and !0 of older machines

}  // namespace rmlcell::rml1
