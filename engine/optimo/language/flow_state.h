#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>

#include "engine/optimo/language/ast.h"

// What is known about the machine at a point of the program, over all paths that lead there.
// Private to the folder.
namespace rmlcell::optimo {

enum class Known : std::uint8_t { kNo, kYes, kMaybe };

using ProcessSet = std::uint32_t;  // bit n * 10 + p
inline ProcessSet ProcessBit(const Instruction& i) {
  return 1U << (i.numbers[0] * 10U + i.numbers[1]);
}
inline constexpr ProcessSet kBeamProcesses = (1U << 20) - 1;  // kinds 0 and 1

// VR, VI, VL in this order, a hundred each.
inline constexpr std::size_t kOwnVariables = 300;
std::optional<std::size_t> OwnVariable(const ExprNode& node);

struct FlowState {
  bool reached = false;
  std::optional<float> speed;
  std::optional<PathType> path;
  std::optional<CoordType> coord;
  Known beam = Known::kNo;
  Known gas_2 = Known::kNo, gas_3 = Known::kNo, sensor = Known::kNo;
  Known unpierced = Known::kNo;                  // beam on, no dwell yet and no motion
  Known rotated = Known::kNo;                    // SYSDEF turns the program's coordinates
  bool processes_known = true;                   // false: a FUNCTION or GOSUB may have changed them
  ProcessSet on_all = 0, on_some = 0;            // ON on all paths, on some
  ProcessSet defined_all = 0, defined_some = 0;  // WORKDEF executed
  std::optional<std::array<float, 3>> target;    // of the last MOVE in ABSOL, as programmed
  std::uint32_t short_fly = kNoIndex;            // the MOVE before, when it was short and had /FLY
  std::uint8_t tiny_moves = 0;                   // /FLY moves below 0.01 mm in a row
  Known after_off = Known::kNo;                  // the next MOVE leaves the part
  std::bitset<kOwnVariables> set;                // variables that were assigned on all paths

  bool operator==(const FlowState&) const = default;

  // What holds at the start of a program (OPT-B.53); COORD and PATH depend on the machine.
  static FlowState AtStart();
  static FlowState Nothing();         // reached, but nothing is known
  static FlowState InErrorHandler();  // beam off, all processes off (OPT-3.58)
};

// Makes `into` hold on both paths. True when it changed.
bool Merge(FlowState& into, const FlowState& other);

// Carries the state over one instruction. `at` is its index.
void Step(const Module& module, std::uint32_t at, FlowState& state);

// Parts of the state that instructions change, for what is not followed: subroutines.
enum Touched : std::uint16_t {
  kTouchesModal = 1,
  kTouchesProcess = 2,
  kTouchesOutput = 4,
  kTouchesMotion = 8,
  kTouchesOffset = 16,
  kTouchesAll = 31,
};
std::uint16_t TouchedBy(const Instruction& instruction);
void Forget(std::uint16_t touched, FlowState& state);

// The coordinates of a MOVE, when they are literals or constants.
std::optional<std::array<float, 3>> LiteralTarget(const Module& module, const Instruction& move);
std::optional<float> LiteralValueOf(Expression value);

double Distance(const std::array<float, 3>& a, const std::array<float, 3>& b);
inline constexpr double kShortFly_mm = 1.0;  // OPT-2.51
inline constexpr double kTinyFly_mm = 0.01;  // OPT-2.52

}  // namespace rmlcell::optimo
