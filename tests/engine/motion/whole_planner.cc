#include "tests/engine/motion/whole_planner.h"

#include <algorithm>
#include <cmath>

#include "engine/motion/ride/trajectory.h"

namespace rmlcell::motion {
namespace {

struct Knotted {
  double length;
  PathLimits limits;
  double cap;    // of the speed at its end
  double speed;  // there
};

double Reachable(double from, double length, const PathLimits& limits, double cap) {
  if (cap <= from) return cap;
  if (RampLength(from, cap, limits) <= length) return cap;
  return std::min(cap, Reach(from, length, limits));
}

// The two passes of 5.3.
void Pass(std::vector<Knotted>& knots) {
  double speed = 0.0;
  for (Knotted& knot : knots) {
    speed = knot.speed = Reachable(speed, knot.length, knot.limits, knot.cap);
  }
  for (std::size_t k = knots.size(); k-- > 1;) {
    knots[k - 1].speed =
        Reachable(knots[k].speed, knots[k].length, knots[k].limits, knots[k - 1].speed);
  }
}

bool Equal(double a, double b) { return a == b || std::abs(a - b) <= 1e-9 * std::abs(b); }

}  // namespace

WholePlan PlanWhole(const std::vector<MoveCommand>& chain, const MachineLimits& machine) {
  const std::size_t count = chain.size();
  WholePlan plan;
  plan.corners.resize(count);
  std::vector<PathLimits> limits;
  for (const MoveCommand& move : chain) limits.push_back(LimitsOf(move, machine));

  // Corners, and the speed wanted at each.
  std::vector<Corner> corners(count);
  std::vector<double> caps(count, 0.0);
  for (std::size_t k = 0; k < count; ++k) {
    Passage& passage = plan.corners[k].passage;
    passage = Passage::kStop;
    if (k + 1 == count || !chain[k].fly) continue;
    passage = Passage::kStopNoSpeed;
    if (chain[k].overshoot_fraction <= 0.0) continue;
    corners[k] = Corner::Between(chain[k].path, chain[k + 1].path);
    passage = corners[k].passage();
    if (IsStop(passage)) continue;
    caps[k] = chain[k].overshoot_fraction * std::min(limits[k].speed, limits[k + 1].speed);
  }
  const auto transparent = [&](std::size_t k) {
    return plan.corners[k].passage == Passage::kThrough &&
           Equal(limits[k].speed, limits[k + 1].speed) &&
           Equal(limits[k].acceleration, limits[k + 1].acceleration) &&
           Equal(limits[k].jerk, limits[k + 1].jerk) && Equal(caps[k], limits[k + 1].speed);
  };

  // First pair of passes, over the path as it is commanded: transparent corners are none.
  std::vector<Knotted> legs;
  std::vector<std::size_t> leg_end;  // move at whose end a leg ends
  double length = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    length += chain[k].path.length();
    if (k + 1 < count && transparent(k)) continue;
    legs.push_back({length, limits[k], caps[k], 0.0});
    leg_end.push_back(k);
    length = 0.0;
  }
  Pass(legs);
  // A run goes from one bend or stop to the next.
  std::vector<double> run_length(legs.size(), 0.0);  // of the run that a leg is part of
  for (std::size_t first = 0; first < legs.size();) {
    std::size_t last = first;
    double total = legs[first].length;
    while (plan.corners[leg_end[last]].passage == Passage::kThrough) total += legs[++last].length;
    for (; first <= last; ++first) run_length[first] = total;
  }

  // Size of each curve.
  std::vector<double> cut(legs.size(), 0.0);
  std::vector<double> cap(legs.size(), 0.0);
  for (std::size_t n = 0; n < legs.size(); ++n) {
    const std::size_t k = leg_end[n];
    CornerReport& report = plan.corners[k];
    report.wanted_speed = legs[n].speed;
    cap[n] = report.passage == Passage::kThrough ? legs[n].speed : 0.0;
    if (report.passage != Passage::kBlend) continue;
    const double want = corners[k].CutFor(legs[n].speed, machine);
    cut[n] = std::min({want, 0.5 * run_length[n], 0.5 * run_length[n + 1]});
    if (cut[n] < 1e-4) {
      cut[n] = 0.0;
      report.passage = Passage::kStopShort;
      continue;
    }
    cap[n] = legs[n].speed;
    if (cut[n] < want) {
      report.passage = Passage::kBlendCapped;
      cap[n] = std::min(cap[n], corners[k].PlainSpeed(cut[n], machine));
    }
    report.cut_mm = cut[n];
    report.deviation_mm = corners[k].PlainDeviation(cut[n]);
  }

  // What the curves leave of each leg. A point that a curve swallows lowers the curve's speed.
  std::vector<Knotted> spans;
  std::vector<std::size_t>
      span_leg;  // leg at whose end the span ends, or the last of those swallowed
  for (std::size_t first = 0; first < legs.size();) {
    std::size_t last = first;
    while (plan.corners[leg_end[last]].passage == Passage::kThrough) ++last;
    const double begin = first > 0 ? cut[first - 1] : 0.0;
    const double end = std::max(run_length[first] - cut[last], begin);
    double from = 0.0;
    for (std::size_t n = first; n <= last; ++n) {
      const double to = n == last ? run_length[first] : from + legs[n].length;
      const double left = std::min(to, end) - std::max(from, begin);
      if (n < last && to < end && left <= 0.0 && n + 1 <= last && !spans.empty()) {
        spans.back().cap = std::min(spans.back().cap, legs[n].speed);
      } else {
        const bool closes = n == last || to >= end;
        double closing = closes ? cap[last] : legs[n].speed;
        for (std::size_t swallowed = n; closes && swallowed < last; ++swallowed) {
          closing = std::min(closing, legs[swallowed].speed);
        }
        spans.push_back({std::max(left, 0.0), legs[n].limits, closing, 0.0});
        span_leg.push_back(closes ? last : n);
        if (closes) break;
      }
      from = to;
    }
    first = last + 1;
  }
  Pass(spans);

  double speed = 0.0;
  for (std::size_t k = 0; k < spans.size(); ++k) {
    const std::size_t move = leg_end[span_leg[k]];
    CornerReport& report = plan.corners[move];
    plan.duration_s +=
        SpeedProfile::Span(spans[k].length, speed, spans[k].speed, spans[k].limits).duration_s();
    plan.length_mm += spans[k].length;
    speed = report.speed = spans[k].speed;
    if (IsBlend(report.passage)) {
      const double curve = corners[move].PlainLength(report.cut_mm);
      plan.duration_s += curve / speed;
      plan.length_mm += curve;
    }
    if (report.passage == Passage::kStop) plan.duration_s += machine.settling_s;
  }
  return plan;
}

double Duration(const std::vector<PlannedMotion>& motions) {
  LongSum sum;
  for (const PlannedMotion& motion : motions) sum.Add(motion.duration_s());
  return sum.value();
}

}  // namespace rmlcell::motion
