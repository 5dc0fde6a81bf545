#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <optional>

#include "engine/optimo/language/ast.h"

// What a piece of a program makes of one thing that is known about the machine: how each value that
// it may have before is related to those that it may have behind. So the same type says what holds
// at a point (whatever was before, it is now 3) and what a subroutine does (as before, or 3). All
// are exact over all paths of the flow: joining two pieces and putting one behind the other loses
// nothing. Private to the folder.
namespace rmlcell::optimo {

// An enumeration of at most eight values, from 0.
template <class Value>
class Choice {
 public:
  using Values = std::uint8_t;  // bit: value
  static constexpr Values Bit(Value v) {
    return static_cast<Values>(1U << static_cast<unsigned>(v));
  }
  static constexpr Values Bits(std::initializer_list<Value> values) {
    Values bits = 0;
    for (const Value v : values) bits = static_cast<Values>(bits | Bit(v));
    return bits;
  }

  // No path comes here.
  constexpr Choice() = default;
  static constexpr Choice Kept() { return Choice(0x8040'2010'0804'0201ULL); }
  static constexpr Choice Of(Value v) { return Choice(kEach * Bit(v)); }

  // Those that it has on some path.
  Values values() const {
    std::uint64_t all = rows_ | rows_ >> 32;
    all |= all >> 16;
    return static_cast<Values>(all | all >> 8);
  }
  bool MayBe(Value v) const { return (values() & Bit(v)) != 0; }
  bool Is(Value v) const { return values() == Bit(v); }
  bool IsAmong(Values of) const { return values() != 0 && (values() & ~of) == 0; }

  // Each value becomes one of its row.
  void Map(const std::array<Values, 8>& to) {
    std::uint64_t mapped = 0;
    for (unsigned v = 0; v < to.size(); ++v) mapped |= (rows_ >> v & kEach) * to[v];
    rows_ = mapped;
  }
  void Then(const Choice& next) {
    std::uint64_t both = 0;
    for (unsigned v = 0; v < 8; ++v) both |= (rows_ >> v & kEach) * (next.rows_ >> (8 * v) & 0xFF);
    rows_ = both;
  }
  void Join(const Choice& other) { rows_ |= other.rows_; }
  bool operator==(const Choice&) const = default;

 private:
  static constexpr std::uint64_t kEach = 0x0101'0101'0101'0101ULL;  // one bit of each row
  explicit constexpr Choice(std::uint64_t rows) : rows_(rows) {}

  std::uint64_t rows_ = 0;  // byte: value before; bit: value behind
};

// Facts that may hold, as the bits of a set.
template <class Set>
struct Facts {
  Set made{};  // hold behind it on some path, whatever was before
  Set kept{};  // hold behind it when they did before

  void Then(const Facts& next) {
    made = next.made | (made & next.kept);
    kept = kept & next.kept;
  }
  void Join(const Facts& other) {
    made = made | other.made;
    kept = kept | other.kept;
  }
  bool operator==(const Facts&) const = default;
};

// A value of which only the one is of use that it has on all paths.
template <class T>
class Single {
 public:
  static Single Kept() {
    Single single;
    single.kept_ = true;
    return single;
  }

  // Nothing when it is not known.
  std::optional<T> known() const { return kept_ ? std::nullopt : value_; }
  void Set(const T& value) {
    value_ = value;
    kept_ = false;
  }
  void Forget() {
    value_.reset();
    kept_ = false;
  }
  void Then(const Single& next) {
    if (!next.kept_) {
      *this = next;
    } else if (next.value_) {
      Join(Single(*next.value_));
    }
  }
  void Join(const Single& other) {
    const bool unknown = (!value_ && !kept_) || (!other.value_ && !other.kept_) ||
                         (value_ && other.value_ && *value_ != *other.value_);
    if (unknown) return Forget();
    if (!value_) value_ = other.value_;
    kept_ = kept_ || other.kept_;
  }
  bool operator==(const Single&) const = default;

  Single() = default;  // not known
  explicit Single(const T& value) : value_(value) {}

 private:
  std::optional<T> value_;  // on some path; with neither of the two it is not known
  bool kept_ = false;       // on some path it is as before
};

// COORD and PATH, of which it matters what they are on the same path.
class Modes {
 public:
  // No path comes here.
  constexpr Modes() = default;
  static Modes Kept() { return Modes(Bit(kKept, kKept)); }
  static Modes AtStart() { return Modes(Bit(kDefault, kDefault)); }  // of the machine, OPT-B.53
  static Modes Unknown() { return Modes(Bit(kUnknown, kUnknown)); }

  void SetCoord(CoordType coord);
  void SetPath(PathType path);
  void Then(const Modes& next);
  void Join(const Modes& other) { pairs_ |= other.pairs_; }

  // Nothing when it is not known, or not the same on all paths.
  std::optional<CoordType> coord() const;
  std::optional<PathType> path() const;
  bool MayBe(PathType path) const;
  bool IsDefaultPath() const;  // on all paths: never set
  bool IsDefaultCoord() const;
  bool IsContour() const;  // on all paths: LIN, CIR or HOLE
  // A contour in COORD ROBOT: on all paths, on some.
  bool IsRobotContour() const { return pairs_ != 0 && (pairs_ & ~kRobotContours) == 0; }
  bool MayBeRobotContour() const { return (pairs_ & kRobotContours) != 0; }

  bool operator==(const Modes&) const = default;

 private:
  // Of either: as before, the machine's default, not known, then the values of its type.
  static constexpr unsigned kKept = 0, kDefault = 1, kUnknown = 2, kFirst = 3;
  static constexpr unsigned kPaths = kFirst + 4;
  static constexpr std::uint64_t kAllPaths = (1U << kPaths) - 1;
  static constexpr std::uint64_t Bit(unsigned coord, unsigned path) {
    return std::uint64_t{1} << (coord * kPaths + path);
  }
  static constexpr unsigned Of(CoordType coord) { return kFirst + static_cast<unsigned>(coord); }
  static constexpr unsigned Of(PathType path) { return kFirst + static_cast<unsigned>(path); }
  // LIN, CIR and HOLE, behind PTP.
  static constexpr std::uint64_t kRobotContours =
      std::uint64_t{0b111} << ((kFirst + static_cast<unsigned>(CoordType::kRobot)) * kPaths +
                               kFirst + static_cast<unsigned>(PathType::kLin));
  explicit constexpr Modes(std::uint64_t pairs) : pairs_(pairs) {}
  unsigned PathsSeen() const;  // as bits

  std::uint64_t pairs_ = 0;  // bit: COORD and PATH on one path
};

}  // namespace rmlcell::optimo
