#include "engine/machine/hand_jog.h"

#include <algorithm>
#include <utility>

namespace rmlcell::machine {

bool HandJog::asks() const {
  if (way_) return !way_->brakes();
  return std::ranges::find(key_, Key::kDown) != key_.end();
}

// Keys add; along a tool that points the other way Z and, to stay right-handed, Y count backwards.
motion::AxisValues HandJog::Speeds(const HandMotion& how) const {
  motion::AxisValues speeds;
  for (int axis = 0; axis < motion::kAxisCount; ++axis) {
    const auto first = 2 * static_cast<std::size_t>(axis);
    if (key_[first] == Key::kDown) speeds[axis] += how.plus[axis];
    if (key_[first + 1] == Key::kDown) speeds[axis] -= how.minus[axis];
  }
  if (drive_->mode() == motion::JogMode::kTool && how.tool_z_down) {
    speeds[1] = -speeds[1];
    speeds[2] = -speeds[2];
  }
  return speeds;
}

void HandJog::Press(const PressJog& press, const HandMotion& how, const motion::AxisPose& at,
                    SimTime now) {
  Key& key = key_[IndexOf(press.key)];
  if (press.key.axis == JogAxis::kC) return;
  if (drive_ && (drive_->mode() != press.reference || fast_ != press.fast)) {
    key = Key::kDown;
    return Brake();
  }
  if (key == Key::kDown) return;
  if (!drive_) {
    drive_.emplace(how.machine, press.reference, at);
    fast_ = press.fast;
    begun_ = now;
  }
  key = Key::kDown;
  Ask(how);
}

void HandJog::Release(const JogKey& key, const HandMotion& how) {
  if (std::exchange(key_[IndexOf(key)], Key::kUp) != Key::kDown) return;
  drive_->KeepTo(how.key_speeds());
  drive_->Demand(Speeds(how), how.least);
  Settle();
}

void HandJog::ReleaseAll() {
  Brake();
  key_.fill(Key::kUp);
}

void HandJog::Ask(const HandMotion& how) {
  if (!drive_ || !asks()) return;
  drive_->KeepTo(how.key_speeds());
  drive_->Demand(Speeds(how));
}

void HandJog::Brake() {
  std::ranges::replace(key_, Key::kDown, Key::kSpent);
  if (drive_) drive_->Brake();
  if (way_) way_->Brake();
  Settle();
}

void HandJog::Freeze() {
  std::ranges::replace(key_, Key::kDown, Key::kSpent);
  drive_.reset();
  way_.reset();
}

void HandJog::Advance(SimTime until) {
  if (way_) way_->Advance(until);
  if (drive_) drive_->Advance(ToSeconds(until - begun_));
}

void HandJog::Settle() {
  if (way_ && way_->rests()) way_.reset();
  if (drive_ && !asks() && drive_->rests()) drive_.reset();
}

RunOn RunOnOf(const HandMotion& how, JogReference reference, const motion::AxisPose& at) {
  RunOn on;
  for (int axis = 0; axis < motion::kAxisCount; ++axis) {
    motion::JogDrive drive(how.machine, reference, at);
    motion::AxisValues speeds;
    speeds[axis] = std::max(how.plus[axis], how.minus[axis]);
    drive.KeepTo(how.key_speeds());
    drive.Demand(speeds);
    on.mm = std::max(on.mm, drive.LinearRunsOn(axis));
    if (axis >= 3) on.rad = std::max(on.rad, drive.RunsOn(axis));
  }
  return on;
}

}  // namespace rmlcell::machine
