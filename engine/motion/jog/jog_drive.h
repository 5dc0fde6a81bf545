#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "engine/motion/geometry/frames.h"
#include "engine/motion/geometry/path.h"
#include "engine/motion/kinematics/kinematics.h"
#include "engine/motion/profile/speed_profile.h"

namespace rmlcell::motion {

// What is moved by hand.
struct JogMachine {
  Head head{};
  AxisLimits axes{};  // an infinite jerk makes trapezoids, an infinite travel has no end
  double tip_acceleration_mm_s2 = 2000.0;  // along the axes of the tool
  double tip_jerk_mm_s3 = 40000.0;
};

// Moves axes at the speeds that are asked for, until others are: speeds up and brakes with limited
// acceleration and jerk, and stands on the end of a travel, never beyond. motion.md section 6.
//
// In kRobot each axis is by itself, and so are A and B in kTool and X, Y and Z in kAbsolute: one
// that comes to its end stops there and the others go on. What moves several axes as one stops as
// one: X, Y and Z in kTool, which lie along the axes of the tool, and all five in kAbsolute while A
// or B turns and the tip is held (OPT-4.56, LIVE-8.02). Until other speeds are asked for it then
// stands.
//
// Where it would still stop is known for the speeds that are asked for. In kTool the way bends
// while A or B turns: where that is changed on the last millimetres before an end, an axis may be
// kept from going on by some tenths of a millimetre, and stands on the end before the others stand.
//
// Times are seconds since it began, never falling. How the caller divides them changes nothing. It
// allocates nothing.
class JogDrive {
 public:
  // It stands at `at`; an axis that stands outside its travel may go back, and no farther.
  JogDrive(const JogMachine& machine, JogMode mode, const AxisPose& at);

  // Of the demands behind it: what each axis is moved at by its own key. Whatever moves them, no
  // axis X, Y or Z goes faster than this, nor, along the axes of the tool or while the tip is held,
  // runs on farther; and with the tip held not longer either. None was told: as fast as it can.
  void KeepTo(const AxisValues& key_speeds);

  // From now on: X Y Z A B, or those of the tool, mm/s and rad/s with sign. Lowered so that no axis
  // goes faster than it can, together where they move axes as one. `least`: how far each goes at
  // least, from where it began to move, though its speed becomes 0: one step of a mill.
  void Demand(const AxisValues& speeds, const AxisValues& least = AxisValues::Zero());
  void Brake();  // as Demand of nothing, and nothing is gone on to

  void Advance(double until_s);

  bool rests() const;
  AxisPose axes() const;
  double tip_speed_mm_s() const;
  // How far one of them runs on from the speed that is asked for now, when it is asked for no more.
  double RunsOn(int channel) const;
  // And X, Y or Z at most with it: of a turn with the tip held along the circle, from here.
  double LinearRunsOn(int channel) const;
  JogMode mode() const { return mode_; }

 private:
  // One axis, or one direction along which the tool is moved.
  struct Channel {
    double wanted = 0.0;  // speed with sign
    PathLimits limits{};  // but for the speed
    SpeedProfile profile{};
    double begun_s = 0.0;  // the profile
    double from = 0.0;     // where s of the profile is 0: where it began to move
    double sense = 1.0;    // of s
    bool due = false;      // the end of the profile was not looked at yet

    double ends_s() const { return begun_s + profile.duration_s(); }
    bool MovesAt(double t_s) const { return t_s < ends_s(); }
    // By that alone, whatever rounding makes of the time since it began.
    PathState StateAt(double t_s) const {
      return MovesAt(t_s) ? profile.At(t_s - begun_s) : profile.end();
    }
    double PlaceAt(double t_s) const {
      return from + sense * (MovesAt(t_s) ? profile.PlaceAt(t_s - begun_s) : profile.end().s);
    }
    double RateAt(double t_s) const { return sense * StateAt(t_s).speed; }
    bool Fits(const PathState& now, double end, const PathLimits& within) const;
    void Aim(double t_s, double end_place);
    void Stop(double t_s, double least);
  };
  using Channels = std::array<Channel, kAxisCount>;
  // Where the axes are at a time: ways along the tool are counted from here.
  struct Anchor {
    double at_s = 0.0;
    AxisPose axes{};
    AxisValues places{};
  };

  AxisValues Within(AxisValues speeds) const;
  double ShareOfTool(const AxisValues& speeds) const;
  double ShareOfHeldTip(const AxisValues& speeds) const;
  double ShareOfStop(const AxisValues& speeds, double radius) const;
  bool StopsAsItsKey(const AxisValues& speeds, double radius, int axis) const;
  double RadiusAboutA() const;
  bool Turns(const AxisValues& speeds) const;
  bool Coupled() const;
  bool AsOne(std::size_t channel) const {
    return coupled_ && (mode_ == JogMode::kAbsolute || channel < 3);
  }
  double EndOf(std::size_t channel) const;
  void AimOne(std::size_t channel);
  void AimAll();
  void ComeAsOne();
  double SureFor() const;
  void Look();
  double ExcessOfStopAt(double t_s) const;
  Anchor After(const Channels& channels, const Anchor& anchor, double t_s) const;
  AxisValues Inside(const AxisPose& axes) const;

  const JogMachine machine_;
  const JogMode mode_;
  AxisValues most_;          // speed of each axis
  bool keeps_stop_ = false;  // the way and the time from there, too
  AxisValues low_;           // travel
  AxisValues high_;
  Channels channels_{};
  Anchor anchor_{};
  double now_s_ = 0.0;
  bool coupled_ = false;
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  double look_s_ = kNever;  // what moves as one: when to look again whether it could still stop
  double halt_s_ = kNever;  // and when it must
};

}  // namespace rmlcell::motion
