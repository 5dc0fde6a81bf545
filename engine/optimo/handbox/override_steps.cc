#include "engine/optimo/handbox/override_steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace rmlcell::optimo {
namespace {

constexpr double kFirst = 10.0;
constexpr double kApart = 15.0;
constexpr double kSame = 1e-9;

constexpr std::array kJogShares = {0.0005, 0.003, 0.01, 0.03, 0.09, 0.15, 0.21, 0.27, 0.33, 0.40};
constexpr double kLast = static_cast<double>(kJogShares.size() - 1);

double StepOf(double percent) { return (percent - kFirst) / kApart; }

}  // namespace

double NextOverride(double percent, bool up) {
  const double at = StepOf(percent);
  const double to = up ? std::floor(at + kSame) + 1.0 : std::ceil(at - kSame) - 1.0;
  return kFirst + kApart * std::clamp(to, 0.0, kLast);
}

double JogShareOf(double override_percent) {
  const double step = std::floor(StepOf(override_percent) + kSame);
  return kJogShares[static_cast<std::size_t>(std::clamp(step, 0.0, kLast))];
}

}  // namespace rmlcell::optimo
