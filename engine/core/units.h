#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>

// One unit system inside the engine: mm, mm/s, rad, s, W, J. Conversion happens once, at the edge
// that reads inches, degrees, percent or device steps. A bare double carries its unit last in its
// name.
namespace rmlcell {

// Virtual time since the start of a run. An integer, so that sums are exact everywhere.
using SimTime = std::chrono::nanoseconds;

inline constexpr SimTime kForever = SimTime::max();
inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTurn = 2.0 * std::numbers::pi;  // rad
inline constexpr double kMmPerInch = 25.4;
inline constexpr double kRadPerDegree = kPi / 180.0;

// The nearest nanosecond; saturates at kForever and -kForever, and NaN counts as kForever: a run
// never gets shorter by a figure that cannot be represented.
inline SimTime FromSeconds(double seconds) {
  constexpr double kLongest_s = 9.0e9;  // about 285 years, inside the range of 64-bit nanoseconds
  if (!(seconds < kLongest_s)) return kForever;
  if (seconds <= -kLongest_s) return -kForever;
  return SimTime(std::llround(seconds * 1e9));
}
inline double ToSeconds(SimTime time) { return static_cast<double>(time.count()) * 1e-9; }

// A place in the program memory of a machine. The executable of slot n lives at n + 100.
inline constexpr int kSlotMin = 1;
inline constexpr int kSlotMax = 99;
inline constexpr int kNoProgram = 0;  // in no slot: no instruction can name it
inline constexpr int kExecutableOffset = 100;
inline bool IsSlot(int number) { return number >= kSlotMin && number <= kSlotMax; }

}  // namespace rmlcell
