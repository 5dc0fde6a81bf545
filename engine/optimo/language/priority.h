#pragma once

namespace rmlcell::optimo {

// Priorities of the operators, lowest first (optimo.md B.9). A sign binds tighter than all of two
// sides.
inline constexpr int kNoLevel = 0;  // no operator
inline constexpr int kOrLevel = 1;  // and XOR
inline constexpr int kAndLevel = 2;
inline constexpr int kNotLevel = 3;
inline constexpr int kRelationLevel = 4;
inline constexpr int kSumLevel = 5;
inline constexpr int kTermLevel = 6;
inline constexpr int kPowerLevel = 7;
inline constexpr int kSignedLevel = 8;
inline constexpr int kLeafLevel = 9;  // a literal, a variable, a function

}  // namespace rmlcell::optimo
