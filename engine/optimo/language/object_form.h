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
// needs no end mark. Fields and counts follow from the operands of the instruction (operands.h):
// choice, numbers, name, the number of values and that of targets where they vary.
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

}  // namespace rmlcell::optimo
