#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "engine/core/units.h"
#include "engine/machine/hand_motion.h"
#include "engine/machine/hand_way.h"
#include "engine/machine/machine_input.h"
#include "engine/motion/jog/jog_drive.h"

namespace rmlcell::machine {

// The jog keys of a machine and what they move; keys that send it somewhere move it alone. A key
// that was down when something else stopped the motion moves nothing until it was released
// (LIVE-7.06): it is spent. Keys are looked at when they change, and never remembered for later
// (LIVE-8.05).
class HandJog {
 public:
  bool asks() const;  // a key is down that moves something, or it was sent somewhere
  bool moves() const { return drive_ || way_; }  // asks, or does not stand yet
  // On which it was sent; null: it was not.
  const HandWay* way() const { return way_.get(); }
  HandWay* way() { return way_.get(); }
  bool IsSpent(const JogKey& key) const { return key_[IndexOf(key)] == Key::kSpent; }

  // Of keys that move together all have one reference, and all are fast or none: another one stops
  // them all, and is spent itself. `at`: where the machine stands, when nothing moves.
  // Precondition: it asks, or nothing moves.
  void Press(const PressJog& press, const HandMotion& how, const motion::AxisPose& at, SimTime now);
  // Precondition: nothing moves.
  void Send(std::unique_ptr<HandWay> way) { way_ = std::move(way); }
  void Release(const JogKey& key, const HandMotion& how);
  void ReleaseAll();
  void Ask(const HandMotion& how);  // the same keys, with these speeds
  void Brake();                     // keys are spent
  void Freeze();                    // the same, and it stands at once

  void Advance(SimTime until);
  void Settle();  // what stands and is asked for nothing moves no more

  // Precondition: moves().
  motion::AxisPose axes() const { return way_ ? way_->axes() : drive_->axes(); }
  double tip_speed_mm_s() const { return way_ ? way_->tip_speed_mm_s() : drive_->tip_speed_mm_s(); }
  bool fast() const { return fast_; }

 private:
  enum class Key : std::uint8_t { kUp, kDown, kSpent };
  static constexpr std::size_t kKeys = 12;
  static std::size_t IndexOf(const JogKey& key) {
    return 2 * static_cast<std::size_t>(key.axis) + (key.plus ? 0 : 1);
  }
  motion::AxisValues Speeds(const HandMotion& how) const;

  std::array<Key, kKeys> key_{};
  bool fast_ = false;
  SimTime begun_{0};
  std::optional<motion::JogDrive> drive_;
  std::unique_ptr<HandWay> way_;
};

RunOn RunOnOf(const HandMotion& how, JogReference reference, const motion::AxisPose& at);

}  // namespace rmlcell::machine
