#include "tests/bench/bare_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace rmlcell::bench {
namespace {

constexpr double kSpeed = 25.0;
constexpr double kAcceleration = 3000.0;
constexpr double kJerk = 50000.0;
constexpr double kTolerance = 0.01;
constexpr int kHalvings = 20;

struct Ramp {
  double time = 0.0;
  double way = 0.0;
};
inline Ramp RampOf(double from, double to) {
  const double change = std::fabs(to - from);
  const double time = change >= kAcceleration * kAcceleration / kJerk
                          ? change / kAcceleration + kAcceleration / kJerk
                          : 2.0 * std::sqrt(change / kJerk);
  return {time, 0.5 * (from + to) * time};
}

}  // namespace

struct BarePlan::Arrays {
  std::size_t lines;
  std::size_t axes;
  std::array<std::vector<double>, 5> place{};
  std::array<std::vector<double>, 5> unit{};
  std::vector<double> length, junction2, entry2, time;

  void Geometry() {
    for (std::size_t i = 0; i < lines; ++i) {
      std::array<double, 5> way{};
      double sum = 0.0;
      for (std::size_t a = 0; a < axes; ++a) {
        way[a] = place[a][i + 1] - place[a][i];
        sum += way[a] * way[a];
      }
      length[i] = std::sqrt(sum);
      for (std::size_t a = 0; a < axes; ++a) unit[a][i] = way[a] / length[i];
    }
  }
  void Junctions() {
    junction2[0] = junction2[lines] = 0.0;
    for (std::size_t i = 1; i < lines; ++i) {
      double cosine = 0.0;
      for (std::size_t a = 0; a < axes; ++a) cosine -= unit[a][i - 1] * unit[a][i];
      const double sine = std::sqrt(std::max(0.5 * (1.0 - cosine), 1e-12));
      const double speed2 = kAcceleration * kTolerance * sine / std::max(1.0 - sine, 1e-9);
      junction2[i] = std::min(speed2, kSpeed * kSpeed);
    }
  }
  void Backward() {
    double speed2 = 0.0;
    for (std::size_t i = lines; i-- > 0;) {
      speed2 = std::min(junction2[i], speed2 + 2.0 * kAcceleration * length[i]);
      entry2[i] = speed2;
    }
    entry2[lines] = 0.0;
  }
  double Forward() {
    double from = 0.0, total = 0.0;
    for (std::size_t i = 0; i < lines; ++i) {
      double to = std::sqrt(entry2[i + 1]);
      if (RampOf(from, to).way > length[i]) {
        double low = from, high = to;
        for (int k = 0; k < kHalvings; ++k) {
          const double middle = 0.5 * (low + high);
          (RampOf(from, middle).way > length[i] ? high : low) = middle;
        }
        to = low;
      }
      double peak = kSpeed;
      if (RampOf(from, peak).way + RampOf(peak, to).way > length[i]) {
        double low = std::max(from, to), high = kSpeed;
        for (int k = 0; k < kHalvings; ++k) {
          const double middle = 0.5 * (low + high);
          (RampOf(from, middle).way + RampOf(middle, to).way > length[i] ? high : low) = middle;
        }
        peak = low;
      }
      const Ramp up = RampOf(from, peak), down = RampOf(peak, to);
      time[i] =
          up.time + down.time + std::max(0.0, length[i] - up.way - down.way) / std::max(peak, 1e-6);
      total += time[i];
      from = to;
    }
    return total;
  }
};

BarePlan::BarePlan(int lines, int axes)
    : arrays_(std::make_unique<Arrays>(Arrays{.lines = static_cast<std::size_t>(lines),
                                              .axes = static_cast<std::size_t>(axes)})) {
  Arrays& all = *arrays_;
  std::mt19937_64 dice(1);
  std::normal_distribution<double> turn(0.0, 0.35);
  std::uniform_real_distribution<double> step(0.05, 2.0), rise(-0.1, 0.1), swing(-1.0, 1.0);
  for (std::size_t a = 0; a < all.axes; ++a) {
    all.place[a].assign(all.lines + 1, 0.0);
    all.unit[a].assign(all.lines, 0.0);
  }
  for (std::vector<double>* each : {&all.length, &all.junction2, &all.entry2, &all.time})
    each->assign(all.lines + 1, 0.0);
  double heading = 0.0;
  for (std::size_t i = 0; i < all.lines; ++i) {
    heading += turn(dice);
    const double way = step(dice);
    all.place[0][i + 1] = all.place[0][i] + way * std::cos(heading);
    all.place[1][i + 1] = all.place[1][i] + way * std::sin(heading);
    all.place[2][i + 1] = all.place[2][i] + rise(dice);
    for (std::size_t a = 3; a < all.axes; ++a) all.place[a][i + 1] = all.place[a][i] + swing(dice);
  }
}
BarePlan::~BarePlan() = default;

double BarePlan::Run() {
  arrays_->Geometry();
  arrays_->Junctions();
  arrays_->Backward();
  return arrays_->Forward();
}

}  // namespace rmlcell::bench
