#include "engine/rml1/offline/stream_writer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/rml1/offline/command_names.h"
#include "engine/rml1/offline/phrase_words.h"

namespace rmlcell::rml1 {
std::int64_t NearestUnit(double mm, const Profile& profile) {
  const double units = mm * profile.units_per_mm;
  // 0.0125 mm are half a unit of 0.025 although their product is a bit less.
  return std::llround(units + std::copysign(1e-9, units));
}

StreamWriter::StreamWriter(const Profile& profile, ByteSink sink)
    : profile_(profile),
      text_(std::move(sink)),
      at_{.z = static_cast<std::int64_t>(std::llround(profile.z.high - profile.z0))} {
  Line(NamesFor(profile.commands.setting).defaults);
  Line("!MC0");
}

void StreamWriter::Rapid(const Units& to) {
  if (to == at_) return;
  const bool level = to.z == at_.z && to.z >= 0 && dwell_ms_ == 0;
  if (!level) {
    SetZSpeed(profile_.z_speeds.maximum_mm_s);
    GoThreeAxis(to);
    return;
  }
  SetHeights(z1_, to.z);
  Line(NamesFor(profile_.commands.setting).up + std::to_string(to.x) + "," + std::to_string(to.y));
  at_ = to;
}

double StreamWriter::Cut(const Units& to, double feed_mm_s) {
  const double z_speed = profile_.z_speeds.Nearest(feed_mm_s);
  if (to == at_) return z_speed;
  const auto lowest = static_cast<std::int64_t>(std::ceil(profile_.z.low - profile_.z0));
  const bool level = to.z == at_.z && to.z <= 0 && to.z >= lowest;
  const double xy_speed = profile_.xy_speeds.Nearest(feed_mm_s);
  if (!level || feed_mm_s <= profile_.z_speeds.maximum_mm_s || xy_speed <= z_speed) {
    SetZSpeed(feed_mm_s);
    GoThreeAxis(to);
    return z_speed;
  }
  SetXYSpeed(feed_mm_s);
  SetHeights(to.z, std::max<std::int64_t>(z2_, 0));
  BeginDwell();
  Line(NamesFor(profile_.commands.setting).down + std::to_string(to.x) + "," +
       std::to_string(to.y));
  EndDwell();
  at_ = to;
  return xy_speed;
}

void StreamWriter::SpindleOn() {
  if (!spindle_on_) Line("!MC1");
  spindle_on_ = true;
}

void StreamWriter::SpindleOff() {
  if (spindle_on_) Line("!MC0");
  spindle_on_ = false;
}

int StreamWriter::SpindleSpeed(double rpm) {
  if (profile_.spindle_control == SpindleControl::kNone) return 0;
  const int low = profile_.spindle_min_rpm;
  const int high = profile_.spindle_max_rpm;
  const double wanted = std::clamp(rpm, static_cast<double>(low), static_cast<double>(high));
  int set = 0;
  std::string parameter;
  if (profile_.spindle_control == SpindleControl::kRpm) {
    const int step = profile_.spindle_step_rpm;
    set = std::clamp(static_cast<int>(wanted) / step * step, low, high);
    parameter = std::to_string(set);
  } else {
    constexpr int kLastStage = 15;  // RML1-9.31
    const double share = (wanted - low) / std::max(high - low, 1);
    const int stage = static_cast<int>(std::lround(share * kLastStage));
    set = low + static_cast<int>(std::int64_t{high - low} * stage / kLastStage);
    parameter = std::to_string(stage);
  }
  if (set != rpm_) Line("!RC" + parameter);
  rpm_ = set;
  return set;
}

void StreamWriter::Finish() {
  SpindleOff();
  text_.HandOver();
}

void StreamWriter::Line(const std::string& command) { text_.Add(command + ";\n"); }

void StreamWriter::SetZSpeed(double wanted_mm_s) {
  const double speed = profile_.z_speeds.Nearest(wanted_mm_s);
  if (speed == z_speed_) return;
  z_speed_ = speed;
  Line("!VZ" + ShortNumber(speed));
}

void StreamWriter::SetXYSpeed(double wanted_mm_s) {
  const double speed = profile_.xy_speeds.Nearest(wanted_mm_s);
  if (speed == xy_speed_) return;
  xy_speed_ = speed;
  Line(NamesFor(profile_.commands.setting).xy_speed + ShortNumber(speed));
}

void StreamWriter::SetHeights(std::int64_t z1, std::int64_t z2) {
  if (heights_set_ && z1 == z1_ && z2 == z2_) return;
  heights_set_ = true;
  z1_ = z1;
  z2_ = z2;
  Line("!PZ" + std::to_string(z1) + "," + std::to_string(z2));
}

void StreamWriter::GoThreeAxis(const Units& to) {
  BeginDwell();
  Line(NamesFor(profile_.commands.setting).three_axis + std::to_string(to.x) + "," +
       std::to_string(to.y) + "," + std::to_string(to.z));
  EndDwell();
  at_ = to;
}

void StreamWriter::BeginDwell() {
  if (dwell_ms_ > 0) Line("!DW" + std::to_string(dwell_ms_));
}

void StreamWriter::EndDwell() {
  if (dwell_ms_ > 0) Line("!DW0");
  dwell_ms_ = 0;
}

}  // namespace rmlcell::rml1
