#include "engine/simulation/verdict/cut_rules.h"

#include <array>

namespace rmlcell::simulation {
namespace {

using machine::Verdict;

constexpr double kSlowMax_percent = 20.0;
// A corner that is a stop has 1 mm at SPEED 10, and 2 mm at 15.
constexpr double kHotMax_mm = 5.0;
constexpr double kWeakMax_mm = 2.0;
constexpr double kStandMax_s = 0.1;     // twice the settling of a move
constexpr double kBurnt_s = 1.0;        // nobody pierces a plate longer, and here it is cut through
constexpr double kSwingMax_deg = 30.0;  // motion.md 2.5, OPT-E.7319
constexpr double kRoundingOfCut_mm = 0.01;

template <Extreme CutFigures::*kFigure>
Measured Of(const RunReport& r) {
  const Extreme& extreme = r.cut_figures.*kFigure;
  return {extreme.value, extreme.place};
}

Measured Swing(const RunReport& r) {
  const Extreme& extreme = r.cut_figures.singular_rad;
  return {extreme.value / kRadPerDegree, extreme.place};
}

template <std::size_t kAxis>
Measured NearEnd(const RunReport& r) {
  const Extreme& extreme = r.cut_figures.near_end[kAxis];
  return {extreme.value, extreme.place};
}

constexpr std::string_view kStandText =
    "longest time of the beam on a standing tip, with power, that is no piercing";

// clang-format off
constexpr std::array kCutRules = {
    MeasuredRule{{{ErrorCode::kCellBeamStands, "standing_beam_max", kBurnt_s, Verdict::kBad, "the beam stays # s on a tip that stands"}, "s", kStandText}, Of<&CutFigures::standing_s>},
    MeasuredRule{{{ErrorCode::kCellBeamStands, "standing_beam_max", kStandMax_s, Verdict::kDoubtful, "the beam stays # s on a tip that stands"}, "s", kStandText}, Of<&CutFigures::standing_s>},
    MeasuredRule{{{ErrorCode::kCellContourSlow, "slow_contour_max", kSlowMax_percent, Verdict::kDoubtful, "# % of a contour is cut below 0.8 of its SPEED"}, "%", "greatest share of a contour that is cut below 0.8 of its SPEED, its first and last ramp left out where it comes to it"}, Of<&CutFigures::slow_percent>},
    MeasuredRule{{{ErrorCode::kCellEnergyAboveProcess, "hot_stretch_max", kHotMax_mm, Verdict::kDoubtful, "# mm on end with more than 1.5 times the energy by length of the process"}, "mm", "longest stretch of a contour with more than 1.5 times the energy by length of the process"}, Of<&CutFigures::hot_mm>},
    MeasuredRule{{{ErrorCode::kCellEnergyBelowProcess, "weak_stretch_max", kWeakMax_mm, Verdict::kDoubtful, "# mm on end with less than 0.8 of the energy by length of the process"}, "mm", "longest stretch of a contour with less than 0.8 of the energy by length of the process"}, Of<&CutFigures::weak_mm>},
    MeasuredRule{{{ErrorCode::kCellCutInPtp, "ptp_cut_length", kRoundingOfCut_mm, Verdict::kDoubtful, "# mm cut in PATH PTP"}, "mm", "way with the beam on at a speed that no SPEED holds"}, Of<&CutFigures::uncontrolled_mm>},
    MeasuredRule{{{ErrorCode::kCellHeadSingular, "singular_swing_max", kSwingMax_deg, Verdict::kDoubtful, "A turns # degrees in a contour within 1 degree of B = 0"}, "deg", "most that A turns on end in a contour within 1 degree of B = 0"}, Swing},
    MeasuredRule{{{ErrorCode::kCellNearTravelEnd, "near_end_x", 0.0, Verdict::kDoubtful, "a contour goes # mm into the last 5 mm of X"}, "mm", "how far a contour goes into the last 5 mm of the travel of X"}, NearEnd<0>},
    MeasuredRule{{{ErrorCode::kCellNearTravelEnd, "near_end_y", 0.0, Verdict::kDoubtful, "a contour goes # mm into the last 5 mm of Y"}, "mm", "how far a contour goes into the last 5 mm of the travel of Y"}, NearEnd<1>},
    MeasuredRule{{{ErrorCode::kCellNearTravelEnd, "near_end_z", 0.0, Verdict::kDoubtful, "a contour goes # mm into the last 5 mm of Z"}, "mm", "how far a contour goes into the last 5 mm of the travel of Z"}, NearEnd<2>},
    MeasuredRule{{{ErrorCode::kCellNearTravelEnd, "near_end_a", 0.0, Verdict::kDoubtful, "a contour goes # rad into the last degree of A"}, "rad", "how far a contour goes into the last degree of the travel of A"}, NearEnd<3>},
    MeasuredRule{{{ErrorCode::kCellNearTravelEnd, "near_end_b", 0.0, Verdict::kDoubtful, "a contour goes # rad into the last degree of B"}, "rad", "how far a contour goes into the last degree of the travel of B"}, NearEnd<4>},
};
// clang-format on

}  // namespace

std::span<const MeasuredRule> CutRules() { return kCutRules; }

}  // namespace rmlcell::simulation
