#include "engine/motion/jog/jog_drive.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "engine/core/check.h"
#include "engine/motion/kinematics/axes.h"

namespace rmlcell::motion {
namespace {

constexpr double kNoWay = 1e-9;  // mm or rad: shorter ways are none
constexpr double kRunOn = 1e9;   // the way of what is stopped in time by other means
constexpr double kLookAhead_s = 0.008;
constexpr double kOnLimit = 1e-10;  // mm or rad beyond an end: rounding, and cut off
constexpr std::size_t kA = 3;
constexpr std::size_t kB = 4;

AxisValues ValuesOf(const AxisPose& pose) {
  return {pose.column.x(), pose.column.y(), pose.column.z(), pose.a_rad, pose.b_rad};
}
AxisPose PoseOf(const AxisValues& values) {
  return {{values[0], values[1], values[2]}, values[3], values[4]};
}
TipPose TipOfValues(const AxisValues& values) {
  return {{values[0], values[1], values[2]}, values[3], values[4]};
}
MachineVector LinearOf(const AxisValues& values) { return values.head<3>(); }

double LeastOfLinear(const AxisValues& values) { return LinearOf(values).minCoeff(); }

// How fast R(A, B) y changes while the head turns.
MachineVector TurnOf(const AxisValues& at, double a_rate, double b_rate, const MachineVector& y) {
  const Rotation turned = ToolRotation(at[kA], at[kB]);
  const MachineVector about_a = turned * y;
  const MachineVector about_b = turned * MachineVector(0.0, -y.z(), y.y());
  return a_rate * MachineVector(-about_a.y(), about_a.x(), 0.0) + b_rate * about_b;
}

}  // namespace

// Whether it can still stand at `end` when its acceleration is first brought to zero.
bool JogDrive::Channel::Fits(const PathState& now, double end, const PathLimits& within) const {
  double s = now.s;
  double speed = now.speed;
  if (std::isfinite(within.jerk)) {
    const double t = std::abs(now.acceleration) / within.jerk;
    s += t * (speed + t * now.acceleration / 3.0);
    speed += 0.5 * t * now.acceleration;
  }
  return speed >= 0.0 && s + RampLength(speed, 0.0, within) <= end;
}

// At `wanted`, and to rest at `end_place`. What moves the other way brakes first, and what is
// already about to stand goes on with that.
void JogDrive::Channel::Aim(double t_s, double end_place) {
  if (wanted == 0.0) return;
  const double towards = std::copysign(1.0, wanted);
  PathState now = StateAt(t_s);
  const bool stands = !(now.speed > 0.0);
  if (stands) {
    from = PlaceAt(t_s);
    sense = towards;
    profile = SpeedProfile();
    begun_s = t_s;
    now = {};
  } else if (towards != sense) {
    return Stop(t_s, 0.0);
  }
  due = !stands;
  const double end = std::min((end_place - from) * sense, kRunOn);
  PathLimits within = limits;
  within.speed = std::abs(wanted);
  if (end - now.s <= kNoWay || !Fits(now, end, within)) {
    if (profile.end().s > end + kNoWay) Stop(t_s, 0.0);
    return;
  }
  profile = SpeedProfile::From(now, end, 0.0, within);
  begun_s = t_s;
  due = true;
}

void JogDrive::Channel::Stop(double t_s, double least) {
  if (!MovesAt(t_s)) return;
  const double farthest = profile.end().s;
  SpeedProfile stop = profile.StopFrom(t_s - begun_s, limits);
  if (stop.end().s < least) {
    PathLimits within = limits;
    within.speed = std::max(profile.peak_speed(), kNoWay);
    stop = SpeedProfile::From(profile.At(t_s - begun_s), std::min(least, farthest), 0.0, within);
  }
  profile = stop;
  begun_s = t_s;
}

JogDrive::JogDrive(const JogMachine& machine, JogMode mode, const AxisPose& at)
    : machine_(machine), mode_(mode), most_(machine.axes.speed) {
  const AxisValues values = ValuesOf(at);
  low_ = machine.axes.travel_min.cwiseMin(values);
  high_ = machine.axes.travel_max.cwiseMax(values);
  anchor_ = {.at_s = 0.0, .axes = at, .places = values};
  if (mode == JogMode::kAbsolute) {
    const TipPose tip = machine.head.TipOf(at);
    anchor_.places = {tip.tip.x(), tip.tip.y(), tip.tip.z(), at.a_rad, at.b_rad};
  }
  const double slowest = LeastOfLinear(machine.axes.acceleration);
  const double softest = LeastOfLinear(machine.axes.jerk);
  for (const std::size_t k : kAxes) {
    Channel& channel = channels_[k];
    channel.from = anchor_.places[static_cast<int>(k)];
    double acceleration = machine.axes.acceleration[static_cast<int>(k)];
    double jerk = machine.axes.jerk[static_cast<int>(k)];
    if (mode == JogMode::kTool && k < kA) {
      acceleration = std::min(slowest, machine.tip_acceleration_mm_s2);
      jerk = std::min(softest, machine.tip_jerk_mm_s3);
    } else if (mode == JogMode::kAbsolute && k >= kA) {
      // The column swings around the tip: half of what its axes can is for keeping to the circle.
      const double reach = std::max(machine.head.reach_mm(), kNoWay);
      acceleration = std::min(acceleration, 0.5 * slowest / reach);
      jerk = std::min(jerk, softest / reach);
    }
    channel.limits = {.speed = 0.0, .acceleration = acceleration, .jerk = jerk};
  }
}

bool JogDrive::Turns(const AxisValues& speeds) const {
  return speeds[kA] != 0.0 || speeds[kB] != 0.0 || channels_[kA].MovesAt(now_s_) ||
         channels_[kB].MovesAt(now_s_);
}

// Along the axes of the tool: no axis above its speed, nor asked for more than half of its
// acceleration by a tool that turns meanwhile.
double JogDrive::ShareOfTool(const AxisValues& speeds) const {
  const bool turns = Turns(speeds);
  const Rotation along = ToolRotation(anchor_.axes.a_rad, anchor_.axes.b_rad);
  const double turning = std::abs(speeds[kA]) + std::abs(speeds[kB]);
  const double all = LinearOf(speeds).lpNorm<1>();
  double share = 1.0;  // what is not asked for, 0, is no bound
  for (const std::size_t axis : kLinearAxes) {
    double speed = 0.0;
    for (const std::size_t k : kLinearAxes)
      speed += (turns ? 1.0 : std::abs(along(axis, k))) * std::abs(speeds[k]);
    share = std::min(share, most_[axis] / speed);
    share = std::min(share, 0.5 * machine_.axes.acceleration[axis] / (all * turning));
  }
  return share;
}

// With the tip held the column goes round it, as far away as the head is long; about A alone as
// far as it stands aside.
double JogDrive::ShareOfHeldTip(const AxisValues& speeds) const {
  const double reach = machine_.head.reach_mm();
  const double a = std::max(std::abs(speeds[kA]), std::abs(channels_[kA].RateAt(now_s_)));
  const double b = std::max(std::abs(speeds[kB]), std::abs(channels_[kB].RateAt(now_s_)));
  const double radius = b > 0.0 ? reach : RadiusAboutA();
  const double inward = a * a * radius + (2.0 * a + b) * b * reach;
  double share = 1.0;  // what is not asked for, 0, is no bound
  for (const std::size_t axis : kLinearAxes) {
    const double speed = std::abs(speeds[axis]) + (axis < 2 ? a * radius : 0.0) + b * reach;
    share = std::min(share, machine_.axes.speed[axis] / speed);
    share = std::min(share, std::sqrt(0.5 * machine_.axes.acceleration[axis] / inward));
  }
  return keeps_stop_ ? share * ShareOfStop(share * speeds, radius) : share;
}

// How far the column stands aside of the tip, which it goes round when A alone turns.
double JogDrive::RadiusAboutA() const {
  return LengthOf(PlanOf(anchor_.axes.column - machine_.head.TipOf(anchor_.axes).tip));
}

// Whether X, Y or Z goes no faster, with the tip held, than by its own key, and comes to rest as
// soon; as near, too, then: the way of a ramp to rest is half its speed by its time. Speeds are
// those along the circles: those of the axis are never more.
bool JogDrive::StopsAsItsKey(const AxisValues& speeds, double radius, int axis) const {
  const auto k = static_cast<std::size_t>(axis);
  const PathLimits& own = channels_[k].limits;
  const double a = std::abs(speeds[kA]);
  const double b = std::abs(speeds[kB]);
  const double reach = machine_.head.reach_mm();
  const double speed = std::abs(speeds[axis]) + (axis < 2 ? a * radius : 0.0) + b * reach;
  const double time =
      std::max(RampTime(a, 0.0, channels_[kA].limits), RampTime(b, 0.0, channels_[kB].limits));
  return speed <= most_[axis] && time <= RampTime(most_[axis], 0.0, own);
}

// A turn brakes more gently than an axis (the rest of the acceleration keeps the column on its
// circle), and so has to be slower than the axis. Of what is asked for: what still goes faster
// brakes. LIVE-8.01
double JogDrive::ShareOfStop(const AxisValues& speeds, double radius) const {
  const auto stops = [&](double share) {
    return StopsAsItsKey(share * speeds, radius, 0) && StopsAsItsKey(share * speeds, radius, 1) &&
           StopsAsItsKey(share * speeds, radius, 2);
  };
  if (stops(1.0)) return 1.0;
  double low = 0.0;
  double high = 1.0;
  constexpr int kHalvings = 52;  // to the last digits
  for (int n = 0; n < kHalvings; ++n) {
    const double middle = 0.5 * (low + high);
    (stops(middle) ? low : high) = middle;
  }
  return low;
}

// The speeds that no axis is too slow for.
AxisValues JogDrive::Within(AxisValues speeds) const {
  for (const std::size_t k : kAxes) {
    if (mode_ == JogMode::kTool && k < kA) continue;
    speeds[k] = std::clamp(speeds[k], -most_[k], most_[k]);
  }
  if (mode_ == JogMode::kTool) speeds.head<3>() *= ShareOfTool(speeds);
  if (mode_ == JogMode::kAbsolute && Turns(speeds)) speeds *= ShareOfHeldTip(speeds);
  return speeds;
}

bool JogDrive::Coupled() const {
  const auto acts = [this](std::size_t k) {
    return channels_[k].wanted != 0.0 || channels_[k].MovesAt(now_s_);
  };
  if (mode_ == JogMode::kTool) return acts(0) || acts(1) || acts(2);
  return mode_ == JogMode::kAbsolute && (acts(kA) || acts(kB));
}

// Where a channel that moves one axis alone comes to its end.
double JogDrive::EndOf(std::size_t channel) const {
  const int k = static_cast<int>(channel);
  const double end = std::signbit(channels_[channel].wanted) ? low_[k] : high_[k];
  return anchor_.places[k] + (end - ValuesOf(anchor_.axes)[k]);
}

void JogDrive::AimOne(std::size_t channel) {
  Channel& one = channels_[channel];
  const double far = std::copysign(kRunOn, one.wanted);
  one.Aim(now_s_, AsOne(channel) ? one.from + far : EndOf(channel));
}

void JogDrive::AimAll() {
  coupled_ = Coupled();
  for (const std::size_t k : kAxes) AimOne(k);
}

void JogDrive::KeepTo(const AxisValues& key_speeds) {
  most_ = machine_.axes.speed.cwiseMin(key_speeds);
  keeps_stop_ = true;
}

void JogDrive::Demand(const AxisValues& speeds, const AxisValues& least) {
  anchor_ = After(channels_, anchor_, now_s_);
  const AxisValues within = Within(speeds);
  for (const std::size_t k : kAxes) {
    Channel& channel = channels_[k];
    const int axis = static_cast<int>(k);
    channel.wanted = within[axis];
    if (channel.wanted == 0.0) channel.Stop(now_s_, least[axis]);
  }
  AimAll();
  Look();
}

void JogDrive::Brake() {
  anchor_ = After(channels_, anchor_, now_s_);
  for (Channel& channel : channels_) {
    channel.wanted = 0.0;
    channel.Stop(now_s_, 0.0);
  }
  Look();
}

// What moves axes as one, to rest as one.
void JogDrive::ComeAsOne() {
  for (const std::size_t k : kAxes) {
    if (!AsOne(k)) continue;
    channels_[k].wanted = 0.0;
    channels_[k].Stop(now_s_, 0.0);
  }
}

// For how long what moves as one is surely not so near to an end that it had to stop: by the
// highest speed that it comes to, to rest and all.
double JogDrive::SureFor() const {
  AxisValues speed;
  double stop_s = 0.0;
  const double reach = mode_ == JogMode::kAbsolute ? machine_.head.reach_mm() : 0.0;
  for (const std::size_t k : kAxes) {
    if (!AsOne(k) || !channels_[k].MovesAt(now_s_)) continue;
    const double most = channels_[k].profile.peak_speed();
    const PathLimits& within = channels_[k].limits;
    stop_s = std::max(stop_s, RampTime(most, 0.0, within) + within.acceleration / within.jerk);
    if (mode_ == JogMode::kTool) {
      speed.head<3>().array() += most;
    } else {
      speed[static_cast<int>(k)] += most;
      if (k >= kA) speed.head<3>().array() += most * reach;
    }
  }
  const AxisValues at = ValuesOf(anchor_.axes);
  double sure_s = kNever;
  for (const std::size_t axis : kAxes) {
    if (!(speed[axis] > 0.0)) continue;
    const double room = std::min(at[axis] - low_[axis], high_[axis] - at[axis]);
    sure_s = std::min(sure_s, room / speed[axis] - stop_s);
  }
  return sure_s;
}

// Whether what moves axes as one could still stop inside all travels a moment from now; if not, it
// stops at the latest instant at which it can.
void JogDrive::Look() {
  look_s_ = halt_s_ = kNever;
  const auto moves = [this](std::size_t k) { return AsOne(k) && channels_[k].MovesAt(now_s_); };
  if (std::ranges::none_of(kAxes, moves)) return;
  const auto goes = [this](std::size_t k) { return AsOne(k) && channels_[k].wanted != 0.0; };
  const bool turns = channels_[kA].MovesAt(now_s_) || channels_[kB].MovesAt(now_s_);
  const bool short_steps = mode_ == JogMode::kTool && turns;
  if (std::ranges::none_of(kAxes, goes)) {
    if (short_steps) look_s_ = now_s_ + kLookAhead_s;  // for the sake of the way, see After
    return;
  }
  double high = now_s_ + kLookAhead_s;
  const double sure_s = SureFor();
  if (sure_s > kLookAhead_s || ExcessOfStopAt(high) <= kOnLimit) {
    look_s_ = short_steps ? high : std::max(high, now_s_ + sure_s);
    return;
  }
  double low = now_s_;
  constexpr int kHalvings = 44;  // to the last digits of a time
  for (int n = 0; n < kHalvings; ++n) {
    const double middle = 0.5 * (low + high);
    (ExcessOfStopAt(middle) <= kOnLimit ? low : high) = middle;
  }
  halt_s_ = low;
}

// By how much an axis is beyond its travel at worst, when what moves as one stops at `t_s`.
double JogDrive::ExcessOfStopAt(double t_s) const {
  Channels stopped = channels_;
  double end_s = t_s;
  for (const std::size_t k : kAxes) {
    if (!AsOne(k)) continue;
    stopped[k].Stop(t_s, 0.0);
    end_s = std::max(end_s, stopped[k].ends_s());
  }
  constexpr int kLooks = 16;
  const double step_s = (end_s - t_s) / kLooks;
  // One look is just behind the begin and one just before the end: they show the sense of the way
  // there.
  constexpr double kAtOnce = 1.0 / 64.0;
  std::array<AxisValues, kLooks + 3> seen;
  Anchor at = After(channels_, anchor_, t_s);
  seen.front() = ValuesOf(at.axes);
  for (std::size_t n = 1; n < seen.size(); ++n) {
    const double looks = std::clamp(static_cast<double>(n) - 1.0, kAtOnce, kLooks - kAtOnce);
    at = After(stopped, at, n + 1 < seen.size() ? t_s + step_s * looks : end_s);
    seen[n] = ValuesOf(at.axes);
  }
  // In kTool A and B stop by themselves.
  const auto axes = mode_ == JogMode::kTool ? std::span<const std::size_t>(kLinearAxes)
                                            : std::span<const std::size_t>(kAxes);
  double worst = -kNever;
  for (const std::size_t axis : axes) {
    const auto keep = [&](double value, double room) {
      worst = std::max({worst, value + room - high_[axis], low_[axis] - value + room});
    };
    keep(seen.back()[axis], 0.0);
    // It may turn back between two looks: what it can go in that time.
    const double room = 0.25 * machine_.axes.acceleration[axis] * step_s * step_s;
    for (std::size_t n = 1; n + 1 < seen.size(); ++n) {
      const double before = seen[n][axis] - seen[n - 1][axis];
      const double behind = seen[n + 1][axis] - seen[n][axis];
      const bool turns_back = before * behind < 0.0 && std::abs(before) > kNoWay;
      keep(seen[n][axis], turns_back ? room : 0.0);
    }
  }
  return worst;
}

// The way along the tool is R(t) c(t) but for what the turning of R adds: with c counted from the
// anchor, less the integral of R'(t) c(t). Nothing turns, nothing is to be integrated.
JogDrive::Anchor JogDrive::After(const Channels& channels, const Anchor& anchor, double t_s) const {
  Anchor after{.at_s = t_s};
  for (const std::size_t k : kAxes) after.places[static_cast<int>(k)] = channels[k].PlaceAt(t_s);
  if (mode_ == JogMode::kRobot) {
    after.axes = PoseOf(after.places);
    return after;
  }
  if (mode_ == JogMode::kAbsolute) {
    after.axes = machine_.head.ColumnOf(TipOfValues(after.places));
    return after;
  }
  after.axes = {anchor.axes.column, after.places[3], after.places[4]};
  const MachineVector way = LinearOf(after.places) - LinearOf(anchor.places);
  after.axes.column += ToolRotation(after.axes.a_rad, after.axes.b_rad) * way;
  const bool turns = channels[kA].MovesAt(anchor.at_s) || channels[kB].MovesAt(anchor.at_s);
  if (!turns) return after;
  // Gauss of three points: the steps are short.
  const double half_s = 0.5 * (t_s - anchor.at_s);
  const double aside = std::sqrt(0.6);
  for (const auto& [place, weight] :
       {std::pair{-aside, 5.0 / 9.0}, {0.0, 8.0 / 9.0}, {aside, 5.0 / 9.0}}) {
    const double at_s = anchor.at_s + half_s * (1.0 + place);
    AxisValues places;
    for (const std::size_t k : kAxes) places[static_cast<int>(k)] = channels[k].PlaceAt(at_s);
    const MachineVector so_far = LinearOf(places) - LinearOf(anchor.places);
    after.axes.column -=
        weight * half_s *
        TurnOf(places, channels[kA].RateAt(at_s), channels[kB].RateAt(at_s), so_far);
  }
  return after;
}

void JogDrive::Advance(double until_s) {
  RMLCELL_CHECK(until_s >= now_s_);
  for (;;) {
    double next_s = std::min(look_s_, halt_s_);
    for (const Channel& channel : channels_) {
      if (channel.due) next_s = std::min(next_s, channel.ends_s());
    }
    if (next_s > until_s) break;
    now_s_ = std::max(now_s_, next_s);
    anchor_ = After(channels_, anchor_, now_s_);
    if (halt_s_ <= now_s_) ComeAsOne();
    for (const std::size_t k : kAxes) {
      Channel& channel = channels_[k];
      if (!channel.due || channel.MovesAt(now_s_)) continue;
      channel.due = false;
      if (channel.wanted != 0.0) AimOne(k);  // it had to brake first
    }
    // Without turning, X, Y and Z are by themselves again.
    if (coupled_ && !Coupled()) AimAll();
    Look();
  }
  now_s_ = until_s;
}

bool JogDrive::rests() const {
  return std::ranges::none_of(channels_,
                              [this](const Channel& channel) { return channel.MovesAt(now_s_); });
}

double JogDrive::RunsOn(int channel) const {
  const Channel& one = channels_[static_cast<std::size_t>(channel)];
  return RampLength(std::abs(one.wanted), 0.0, one.limits);
}

double JogDrive::LinearRunsOn(int channel) const {
  if (channel < 3) return RunsOn(channel);
  if (mode_ != JogMode::kAbsolute) return 0.0;
  return RunsOn(channel) * (channel == 3 ? RadiusAboutA() : machine_.head.reach_mm());
}

// Rounding may leave it a last digit beyond an end.
AxisValues JogDrive::Inside(const AxisPose& axes) const {
  return ValuesOf(axes).cwiseMax(low_).cwiseMin(high_);
}

AxisPose JogDrive::axes() const { return PoseOf(Inside(After(channels_, anchor_, now_s_).axes)); }

double JogDrive::tip_speed_mm_s() const {
  AxisValues rates;
  for (const std::size_t k : kAxes) rates[static_cast<int>(k)] = channels_[k].RateAt(now_s_);
  MachineVector linear = LinearOf(rates);
  if (mode_ == JogMode::kAbsolute) return linear.norm();
  const AxisPose at = axes();
  if (mode_ == JogMode::kTool) linear = ToolRotation(at.a_rad, at.b_rad) * linear;
  const AxisValues swing =
      machine_.head.Rates(at.a_rad, at.b_rad, {.tip = {}, .a = rates[kA], .b = rates[kB]});
  return (linear - LinearOf(swing)).norm();
}

}  // namespace rmlcell::motion
