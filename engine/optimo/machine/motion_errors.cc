#include "engine/optimo/machine/motion_errors.h"

#include <algorithm>
#include <array>
#include <utility>

namespace rmlcell::optimo {
namespace {

constexpr std::array kNumbers = {
    std::pair{ErrorCode::kCellHoleRadius, ErrorCode::kHoleRadiusZero},
    std::pair{ErrorCode::kCellTargetUnusable, ErrorCode::kTargetOutOfTravel},
    std::pair{ErrorCode::kCellArcUndefined, ErrorCode::kArcUndefined},
    std::pair{ErrorCode::kCellNoMotion, ErrorCode::kNoMotion},
    std::pair{ErrorCode::kCellHoleNormal, ErrorCode::kHoleNormalUndefined},
};

}  // namespace

Error OnOptimo(Error of_motion) {
  const auto* const row =
      std::ranges::find(kNumbers, of_motion.code, &decltype(kNumbers)::value_type::first);
  if (row != kNumbers.end()) of_motion.code = row->second;
  return of_motion;
}

}  // namespace rmlcell::optimo
