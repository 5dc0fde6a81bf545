#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>

#include "engine/motion/geometry/frames.h"
#include "engine/rml1/command_table.h"
#include "engine/rml1/extent.h"
#include "engine/rml1/number.h"

namespace rmlcell::rml1 {

// What a program asks for, whatever machine runs it: command counts, extents and lengths in the
// units of the stream. It keeps a position and a mode of its own, fed with the commands that the
// device carries out, and knows no travel, no clipping and no limit of a model.
//
// Conventions (they are those of a plain splitter, so that programs can be compared across tools):
// the position starts at 0,0,0, absolute, tool up, both tool heights 0. D I PD and M R PU go to
// their tool height first and then to X and Y, PA and PR to that of the tool state; a motion of
// length zero counts nothing. DF and IN set the heights to 0 and absolute, IN also the tool up; H
// sets X = Y = 0, absolute, tool up and leaves Z; the ways of H, IN and !ZM do not count. Cut
// length is what has an end below Z 0, and two-axis motion with the tool down; the rest is travel.
// A statement, up to a semicolon or line end, that begins with or contains something that is no
// command (".. R", "MC0") counts as `other`, and nothing of it counts as a command; surplus behind
// the parameters of a command ("VS5,6") leaves the command as it is.
class Programmed {
 public:
  // A name was read, and the command behind it begins.
  void OnCommand(Op op) {
    ++counts_[static_cast<std::size_t>(op)];
    counted_ |= std::uint64_t{1} << static_cast<unsigned>(op);
  }

  // A complete set of a two-dimensional or three-axis command, as numbers of the stream.
  [[gnu::always_inline]] void OnSetXY(const CommandRow& row, double x, double y) {
    ApplyEffects(row);
    ToToolHeight();
    if (!now_.absolute) {
      x += way_.x;
      y += way_.y;
    }
    if (now_.x_extent.Add(x)) changed_ = true;
    if (now_.y_extent.Add(y)) changed_ = true;
    GoTo(x, y, way_.z, now_.tool_down);
  }
  [[gnu::always_inline]] void OnSetXYZ(double x, double y, double z) {
    if (!now_.absolute) {
      x += way_.x;
      y += way_.y;
      z += way_.z;
    }
    if (now_.x_extent.Add(x)) changed_ = true;
    if (now_.y_extent.Add(y)) changed_ = true;
    AddHeight(z);
    GoTo(x, y, z, false);
  }
  // !ZE: the axes that are named.
  struct AxisGroup {
    bool has_x = false;
    bool has_y = false;
    bool has_z = false;
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;
  };
  void OnGroup(const AxisGroup& group);

  // A command that ran without sets: D I M R PA PD PR PU with nothing, DF, IN, H.
  void OnBare(const CommandRow& row);
  // @ and !PZ with `count` parameters as written.
  void OnHeights(int count, const Number& z1, const Number& z2);

  // The command search discarded letters, or something else. A statement ended.
  void OnDiscarded(bool letters) { spoilt_ = spoilt_ || letters || counted_ == 0; }
  void OnStatementEnd() {
    if (counted_ != 0 || spoilt_) EndStatement();  // else it is empty
  }
  // The end of the data ends the last statement too.
  void Finish() { OnStatementEnd(); }

  std::uint64_t commands() const;  // without ^, which is counted beside them
  std::uint64_t count(Op op) const { return counts_[static_cast<std::size_t>(op)]; }
  std::uint64_t other() const { return other_; }
  const Extent& x() const { return now_.x_extent; }
  const Extent& y() const { return now_.y_extent; }
  const Extent& z() const { return now_.z_extent; }
  // Units that every height is a multiple of; 0: none but 0 was named.
  std::uint32_t z_grain() const { return now_.z_grain; }
  // The lowest way across above Z 0; 0: there is none.
  double lowest_lift() const { return now_.lowest_lift < kNone ? now_.lowest_lift : 0.0; }
  double cut_length() const { return way_.cut_length; }
  double travel_length() const { return way_.travel_length; }

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  // What every set changes, and what few do: most statements leave it as it was.
  struct Way {
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;
    double cut_length = 0.0;
    double travel_length = 0.0;
  };
  struct State {
    double z1 = 0.0;
    double z2 = 0.0;
    bool absolute = true;
    bool tool_down = false;
    Extent x_extent;
    Extent y_extent;
    Extent z_extent;
    std::uint32_t z_grain = 0;
    double lowest_lift = kNone;
  };
  using Counts = std::array<std::uint64_t, kOpCount>;

  void EndStatement() {
    if (spoilt_) return DropStatement();
    for (; counted_ != 0; counted_ &= counted_ - 1) {
      const auto op = static_cast<std::size_t>(std::countr_zero(counted_));
      counts_at_statement_[op] = counts_[op];
    }
    way_at_statement_ = way_;
    if (changed_) at_statement_ = now_;
    changed_ = false;
  }
  void DropStatement();
  void ApplyEffects(const CommandRow& row) {
    if (row.mode != ModeChange::kNone) Set(now_.absolute, row.mode == ModeChange::kAbsolute);
    if (row.tool != ToolChange::kNone) Set(now_.tool_down, row.tool == ToolChange::kDown);
  }
  template <typename T>
  void Set(T& value, T to) {
    if (value == to) return;
    value = to;
    changed_ = true;
  }
  void ToToolHeight() {
    const double z = now_.tool_down ? now_.z1 : now_.z2;
    if (z != way_.z) GoToHeight(z);
  }
  void GoToHeight(double z);
  void AddHeight(double z) {
    if (now_.z_extent.Add(z)) changed_ = true;
    if (now_.z_grain != 1 && z != way_.z) AddGrain(z);
  }
  void AddGrain(double z);
  [[gnu::always_inline]] void GoTo(double x, double y, double z, bool two_axis_cut) {
    const double length = motion::ProgramVector(x - way_.x, y - way_.y, z - way_.z).norm();
    const bool below = way_.z < 0.0 || z < 0.0;
    if (way_.z > 0.0 && z > 0.0 && (x != way_.x || y != way_.y)) AddLift(std::min(way_.z, z));
    (below || two_axis_cut ? way_.cut_length : way_.travel_length) += length;
    way_.x = x;
    way_.y = y;
    way_.z = z;
  }
  void AddLift(double z) { Set(now_.lowest_lift, std::min(now_.lowest_lift, z)); }

  Way way_;
  State now_;
  Way way_at_statement_;  // what a spoilt statement falls back to
  State at_statement_;
  bool changed_ = false;  // now_, since then
  Counts counts_{};
  Counts counts_at_statement_{};
  std::uint64_t counted_ = 0;  // commands of this statement: a bit for each Op
  static_assert(kOpCount <= 64);
  bool spoilt_ = false;  // it has something that is no command
  std::uint64_t other_ = 0;
};

}  // namespace rmlcell::rml1
