#include "engine/rml1/programmed.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rmlcell::rml1 {
namespace {

constexpr double kHeightMax_units = 1e9;  // no machine is as high

}  // namespace

void Programmed::OnGroup(const AxisGroup& group) {
  const auto target = [this](bool named, double value, double present) {
    if (!named) return present;
    return now_.absolute ? value : present + value;
  };
  const double x = target(group.has_x, group.x, way_.x);
  const double y = target(group.has_y, group.y, way_.y);
  const double z = target(group.has_z, group.z, way_.z);
  if (group.has_x && now_.x_extent.Add(x)) changed_ = true;
  if (group.has_y && now_.y_extent.Add(y)) changed_ = true;
  if (group.has_z) AddHeight(z);
  GoTo(x, y, z, false);
}

void Programmed::OnBare(const CommandRow& row) {
  ApplyEffects(row);
  changed_ = true;
  if (row.op == Op::kDF || row.op == Op::kIN) {
    now_.z1 = now_.z2 = 0.0;
  } else if (row.op == Op::kH) {
    way_.x = way_.y = 0.0;
  } else if (row.shape == Shape::kSets && row.tool != ToolChange::kNone) {
    ToToolHeight();
  }
}

void Programmed::OnHeights(int count, const Number& z1, const Number& z2) {
  changed_ = true;
  if (count == 0) {
    now_.z1 = now_.z2 = 0.0;
    return;
  }
  if (z1.truncated() <= 0) now_.z1 = static_cast<double>(z1.truncated());
  if (count > 1 && z2.truncated() >= 0) now_.z2 = static_cast<double>(z2.truncated());
}

void Programmed::DropStatement() {
  for (; counted_ != 0; counted_ &= counted_ - 1) {
    const auto op = static_cast<std::size_t>(std::countr_zero(counted_));
    counts_[op] = counts_at_statement_[op];
  }
  way_ = way_at_statement_;
  now_ = at_statement_;
  ++other_;
  changed_ = spoilt_ = false;
}

std::uint64_t Programmed::commands() const {
  std::uint64_t sum = 0;
  for (const CommandRow& row : CommandTable()) {
    if (row.shape != Shape::kCall) sum += count(row.op);
  }
  return sum;
}

void Programmed::GoToHeight(double z) {
  AddHeight(z);
  GoTo(way_.x, way_.y, z, false);
}

void Programmed::AddGrain(double z) {
  const double units = std::abs(z);
  const bool whole = units == std::floor(units) && units < kHeightMax_units;
  Set(now_.z_grain, whole ? std::gcd(now_.z_grain, static_cast<std::uint32_t>(units)) : 1U);
}

}  // namespace rmlcell::rml1
