#include "engine/rml1/programmed.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "engine/motion/geometry/frames.h"

namespace rmlcell::rml1 {
namespace {

constexpr double kHeightMax_units = 1e9;  // no machine is as high

}  // namespace

void Programmed::OnSetXY(const CommandRow& row, double x, double y) {
  ApplyEffects(row);
  ToToolHeight();
  const double to_x = now_.absolute ? x : now_.x + x;
  const double to_y = now_.absolute ? y : now_.y + y;
  now_.x_extent.Add(to_x);
  now_.y_extent.Add(to_y);
  GoTo(to_x, to_y, now_.z, now_.tool_down);
}

void Programmed::OnSetXYZ(double x, double y, double z) {
  OnGroup({.has_x = true, .has_y = true, .has_z = true, .x = x, .y = y, .z = z});
}

void Programmed::OnGroup(const AxisGroup& group) {
  const auto target = [this](bool named, double value, double present) {
    if (!named) return present;
    return now_.absolute ? value : present + value;
  };
  const double x = target(group.has_x, group.x, now_.x);
  const double y = target(group.has_y, group.y, now_.y);
  const double z = target(group.has_z, group.z, now_.z);
  if (group.has_x) now_.x_extent.Add(x);
  if (group.has_y) now_.y_extent.Add(y);
  if (group.has_z) AddHeight(z);
  GoTo(x, y, z, false);
}

void Programmed::OnBare(const CommandRow& row) {
  ApplyEffects(row);
  if (row.op == Op::kDF || row.op == Op::kIN) {
    now_.z1 = now_.z2 = 0.0;
  } else if (row.op == Op::kH) {
    now_.x = now_.y = 0.0;
  } else if (row.shape == Shape::kSets && row.tool != ToolChange::kNone) {
    ToToolHeight();
  }
}

void Programmed::OnHeights(int count, const Number& z1, const Number& z2) {
  if (count == 0) {
    now_.z1 = now_.z2 = 0.0;
    return;
  }
  if (z1.truncated() <= 0) now_.z1 = static_cast<double>(z1.truncated());
  if (count > 1 && z2.truncated() >= 0) now_.z2 = static_cast<double>(z2.truncated());
}

void Programmed::EndStatement() {
  for (; counted_ != 0; counted_ &= counted_ - 1) {
    const auto op = static_cast<std::size_t>(std::countr_zero(counted_));
    (spoilt_ ? counts_ : counts_at_statement_)[op] = (spoilt_ ? counts_at_statement_ : counts_)[op];
  }
  if (spoilt_) {
    now_ = at_statement_;
    ++other_;
    spoilt_ = false;
  } else {
    at_statement_ = now_;
  }
  begun_ = false;
}

std::uint64_t Programmed::commands() const {
  std::uint64_t sum = 0;
  for (const CommandRow& row : CommandTable()) {
    if (row.shape != Shape::kCall) sum += count(row.op);
  }
  return sum;
}

void Programmed::ApplyEffects(const CommandRow& row) {
  if (row.mode != ModeChange::kNone) now_.absolute = row.mode == ModeChange::kAbsolute;
  if (row.tool != ToolChange::kNone) now_.tool_down = row.tool == ToolChange::kDown;
}

void Programmed::ToToolHeight() {
  const double z = now_.tool_down ? now_.z1 : now_.z2;
  if (z == now_.z) return;
  AddHeight(z);
  GoTo(now_.x, now_.y, z, false);
}

void Programmed::AddHeight(double z) {
  now_.z_extent.Add(z);
  if (now_.z_grain == 1 || z == now_.z) return;
  const double units = std::abs(z);
  const bool whole = units == std::floor(units) && units < kHeightMax_units;
  now_.z_grain = whole ? std::gcd(now_.z_grain, static_cast<std::uint32_t>(units)) : 1;
}

void Programmed::GoTo(double x, double y, double z, bool two_axis_cut) {
  const double length = motion::ProgramVector(x - now_.x, y - now_.y, z - now_.z).norm();
  const bool below = now_.z < 0.0 || z < 0.0;
  if (now_.z > 0.0 && z > 0.0 && (x != now_.x || y != now_.y))
    now_.lowest_lift = std::min({now_.lowest_lift, now_.z, z});
  (below || two_axis_cut ? now_.cut_length : now_.travel_length) += length;
  now_.x = x;
  now_.y = y;
  now_.z = z;
}

}  // namespace rmlcell::rml1
