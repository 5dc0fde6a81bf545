#include "engine/simulation/picture/sketch_element.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

namespace rmlcell::simulation {
namespace {

using motion::MachinePoint;
using motion::MachineVector;

// Hash of what an element looks like at a resolution, the same from either end.
class LookKey {
 public:
  explicit LookKey(double cell) : per_cell_(1.0 / cell) {}

  std::uint64_t Of(const SketchElement& element) const {
    std::uint64_t a = Cell(element.from);
    std::uint64_t b = Cell(element.to);
    if (b < a) std::swap(a, b);
    const std::uint64_t look = static_cast<std::uint64_t>(element.use) * 1024 +
                               (element.skims ? 1024u * 1024 : 0u) + (element.lost ? 512u : 0u) +
                               (element.cuts ? 256u : 0u) + element.shade;
    const std::uint64_t key = Mix(Mix(a, b), look);
    return element.arc < 0 ? key : Mix(key, Cell(element.middle));
  }

 private:
  static std::uint64_t Mix(std::uint64_t a, std::uint64_t b) {
    std::uint64_t x = a * 0x9E3779B97F4A7C15u + b;  // splitmix64
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
  }
  std::uint64_t Coordinate(double value) const {
    constexpr double kFarthest = 9e15;  // cells; exact in a double
    return static_cast<std::uint64_t>(
        std::llround(std::clamp(value * per_cell_, -kFarthest, kFarthest)));
  }
  std::uint64_t Cell(const MachinePoint& p) const {
    return Mix(Mix(Coordinate(p.x()), Coordinate(p.y())), Coordinate(p.z()));
  }

  double per_cell_;
};

// What goes on straight: direction from its first element that is long enough.
class StraightRun {
 public:
  explicit StraightRun(double tolerance) : tolerance_(tolerance) {}

  void Begin(const SketchElement& element) {
    const MachineVector way = element.to - element.from;
    const double length = way.norm();
    direction_ = length > tolerance_ ? way * (1.0 / length) : MachineVector{};
  }

  // Whether `next` goes on straight from `last`, which grew so far.
  bool Takes(const SketchElement& last, const SketchElement& next) const {
    if (last.arc >= 0 || next.arc >= 0 || !last.SameLook(next)) return false;
    if (!((last.to - next.from).norm() <= tolerance_)) return false;
    const MachineVector way = next.to - last.from;
    if (direction_ == MachineVector{}) return way.norm() <= tolerance_;
    const double along = way.dot(direction_);
    return along >= (last.to - last.from).dot(direction_) &&
           (way - direction_ * along).norm() <= tolerance_;
  }

 private:
  double tolerance_;
  MachineVector direction_;
};

// A set of hashes in one piece of memory: a node for each would take four times as much.
class SeenKeys {
 public:
  explicit SeenKeys(std::size_t keys_max) : slots_(std::bit_ceil(keys_max + keys_max / 2 + 1)) {}

  // False: it was there.
  bool Insert(std::uint64_t key) {
    if (key == 0) key = 1;  // 0 is an empty slot
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t at = key & mask;; at = (at + 1) & mask) {
      if (slots_[at] == key) return false;
      if (slots_[at] != 0) continue;
      slots_[at] = key;
      return true;
    }
  }

 private:
  std::vector<std::uint64_t> slots_;
};

}  // namespace

void MergeStraight(std::vector<SketchElement>& elements, double tolerance) {
  StraightRun straight(tolerance);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    SketchElement element = elements[i];
    if (element.arc >= 0 && (element.from - element.middle).norm() <= tolerance) element.arc = -1;
    if (kept > 0 && straight.Takes(elements[kept - 1], element)) {
      elements[kept - 1].to = element.to;
      continue;
    }
    straight.Begin(element);
    elements[kept++] = element;
  }
  elements.resize(kept);
}

void DropAlike(std::vector<SketchElement>& elements, double cell) {
  const LookKey key(cell);
  SeenKeys seen(elements.size());
  std::erase_if(elements,
                [&](const SketchElement& element) { return !seen.Insert(key.Of(element)); });
}

}  // namespace rmlcell::simulation
