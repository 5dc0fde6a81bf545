#pragma once

#include <cstdint>
#include <string>

#include "engine/rml1/offline/text_parts.h"
#include "engine/rml1/profile.h"

namespace rmlcell::rml1 {

// A place in the work in whole device units, from the XY work origin and from Z0.
struct Units {
  std::int64_t x = 0;
  std::int64_t y = 0;
  std::int64_t z = 0;

  bool operator==(const Units&) const = default;
};

// Writes a stream for one machine, motion by motion. It begins with DF, which moves nothing, and
// the spindle off, and expects the tool as after power-on: at the XY origin, Z at the top.
//
// Straight lines in X, Y and Z at the speeds wanted, of those that the machine has: the three-axis
// command for cuts, but the two-axis one where only that is fast enough; tool-up motion for rapids
// in X and Y at Z 0 or above, which go at the travel speed, and the three-axis command at the
// highest Z speed for all others. Names are those of the machine's command set setting.
class StreamWriter {
 public:
  StreamWriter(const Profile& profile, ByteSink sink);

  void Rapid(const Units& to);
  // Returns the speed that the machine will use.
  double Cut(const Units& to, double feed_mm_s);

  // Right before the next motion. At most kDwellMax_ms in all.
  void Dwell(int ms) { dwell_ms_ += ms; }
  static constexpr int kDwellMax_ms = 32767;  // RML1-3A.55
  int dwell_ms() const { return dwell_ms_; }

  // Turns from the next motion on (RML1-3C.04). The speed is 0 or one of SpindleSpeed.
  void SpindleOn();
  void SpindleOff();
  // Returns the speed that the machine will use; 0: it cannot be set by the stream.
  int SpindleSpeed(double rpm);
  void Pause() { Line("!NR"); }

  Units at() const { return at_; }
  std::size_t size() const { return text_.size(); }
  // With the spindle off.
  void Finish();

 private:
  void Line(const std::string& command);
  void SetZSpeed(double wanted_mm_s);
  void SetXYSpeed(double wanted_mm_s);
  void SetHeights(std::int64_t z1, std::int64_t z2);
  void GoThreeAxis(const Units& to);
  void BeginDwell();
  void EndDwell();

  const Profile& profile_;
  TextParts text_;
  Units at_;
  double z_speed_ = 0.0;  // 0: not set yet
  double xy_speed_ = 0.0;
  std::int64_t z1_ = 0;
  std::int64_t z2_ = -1;
  bool heights_set_ = false;
  bool spindle_on_ = false;
  int rpm_ = 0;
  int dwell_ms_ = 0;
};

// The nearest whole device unit; half away from zero (RML1-9.22).
std::int64_t NearestUnit(double mm, const Profile& profile);

}  // namespace rmlcell::rml1
