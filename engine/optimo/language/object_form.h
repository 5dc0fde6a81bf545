#pragma once

#include <cstdint>
#include <string_view>

#include "engine/optimo/language/instruction_set.h"

// What the object holds of each instruction (OPT-B.69, OPT-B.70). Private to the folder; writer and
// reader go through the same rows.
//
//   object  = "LMR" version record-count name-table end-labels { record } checksum
//   record  = code [labels] [attributes] fields expressions targets
// The code byte has the instruction in its low six bits, bit 6: sequence numbers follow, bit 7:
// attributes follow. An expression is written root first, right operand before left one: so it
// needs no end mark.
namespace rmlcell::optimo {

inline constexpr std::string_view kObjectMagic = "LMR";
inline constexpr unsigned kObjectVersion = 1;
inline constexpr unsigned kLabelsFlag = 0x40, kAttributesFlag = 0x80, kCodeMask = 0x3F;

// Tags of expression parts.
inline constexpr unsigned kTagInteger = 1, kTagReal = 2, kTagOff = 3, kTagOn = 4, kTagPi = 5,
                          kTagName = 6,
                          kTagVariable = 0x10,  // + group; index byte
    kTagNamedIndex = 0x18,                      // + group; name
    kTagOperator = 0x20;                        // + Node

enum class ValueCount : std::uint8_t { kFixed, kCounted };
enum class TargetCount : std::uint8_t {
  kNone,
  kOne,
  kCounted,
  kWithValue
};  // kWithValue: one if it has values

struct ObjectForm {
  bool choice = false;
  std::uint8_t numbers = 0;
  bool name = false;
  ValueCount values = ValueCount::kFixed;
  std::uint8_t value_count = 0;  // fixed count, or the most
  TargetCount targets = TargetCount::kNone;
};

constexpr ObjectForm FormOf(Op op) {
  using enum ValueCount;
  switch (op) {
    case Op::kMove:
      return {.value_count = 5};
    case Op::kCoord:
    case Op::kUpdate:
    case Op::kImage:
    case Op::kReal:
      return {.choice = true};
    case Op::kPath:
      return {.choice = true, .values = kCounted, .value_count = 1};
    case Op::kSpeed:
    case Op::kAccel:
    case Op::kOversh:
    case Op::kDelay:
    case Op::kSeterr:
    case Op::kWait:
    case Op::kGo:
      return {.value_count = 1};
    case Op::kSysdef:
      return {.values = kCounted, .value_count = 6};
    case Op::kTcp:
      return {.value_count = 6};
    case Op::kWorkdef:
      return {.numbers = 2, .values = kCounted, .value_count = 5};
    case Op::kWork:
    case Op::kBreak:
    case Op::kSimul:
      return {.numbers = 2};
    case Op::kCall:
    case Op::kFunction:
      return {.values = kCounted, .value_count = 9};
    case Op::kGoto:
    case Op::kGosub:
    case Op::kErr:
      return {.targets = TargetCount::kOne};
    case Op::kGotoTable:
    case Op::kIf:
      return {.value_count = 1, .targets = TargetCount::kCounted};
    case Op::kTask:
      return {.numbers = 1};
    case Op::kTimer:
      return {.values = kCounted, .value_count = 1, .targets = TargetCount::kWithValue};
    case Op::kLet:
      return {.value_count = 2};
    case Op::kDeclare:
      return {.name = true, .value_count = 1};
    case Op::kDefine:
      return {.choice = true, .numbers = 1};
    case Op::kAssign:
      return {.numbers = 1, .value_count = 2};
    default:
      return {};
  }
}

}  // namespace rmlcell::optimo
