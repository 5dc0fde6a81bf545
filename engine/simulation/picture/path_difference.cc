#include "engine/simulation/picture/path_difference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "engine/core/units.h"
#include "engine/simulation/picture/box_tree.h"

namespace rmlcell::simulation {
namespace {

using motion::MachinePoint;
using motion::MachineVector;

// A stretch of an element, mm from its beginning.
struct Stretch {
  double begin = 0.0;
  double end = 0.0;
};

double LengthOf(const SketchElement& element, const std::vector<SketchCircle>& circles) {
  if (element.arc < 0) return (element.from - element.to).norm();
  const SketchCircle& circle = circles[static_cast<std::size_t>(element.arc)];
  return circle.radius_mm * circle.sweep_rad;
}

// Boxes of elements that have a way in common touch. Arcs have one only with arcs of their circle,
// and those have its centre.
machine::Box BoxOf(const SketchElement& element, const std::vector<SketchCircle>& circles) {
  machine::Box box;
  if (element.arc >= 0) {
    box.Add(circles[static_cast<std::size_t>(element.arc)].centre);
  } else {
    box.Add(element.from);
    box.Add(element.to);
  }
  return box;
}

// Where on line `a` line `b` runs along it.
std::optional<Stretch> AlongLine(const SketchElement& a, double length, const SketchElement& b) {
  const MachineVector way = (a.to - a.from) * (1.0 / length);
  const double from = (b.from - a.from).dot(way);
  const double to = (b.to - a.from).dot(way);
  const Stretch both{std::max(0.0, std::min(from, to)), std::min(length, std::max(from, to))};
  if (!(both.end - both.begin > kSamePlace_mm) || from == to) return std::nullopt;
  for (const double at : {both.begin, both.end}) {
    const MachinePoint on_b = b.from + (b.to - b.from) * ((at - from) / (to - from));
    if ((on_b - (a.from + way * at)).norm() > kSamePlace_mm) return std::nullopt;
  }
  return both;
}

// Where on arc `a` arc `b` of the same circle lies: up to two stretches, as it may reach over the
// beginning.
std::array<std::optional<Stretch>, 2> AlongArc(const SketchElement& a, const SketchCircle& of_a,
                                               const SketchElement& b, const SketchCircle& of_b) {
  std::array<std::optional<Stretch>, 2> found;
  const double cosine = of_a.normal.dot(of_b.normal);
  const double tilt_mm = of_a.radius_mm * of_a.normal.cross(of_b.normal).norm();
  if ((of_a.centre - of_b.centre).norm() > kSamePlace_mm || tilt_mm > kSamePlace_mm ||
      std::abs(of_a.radius_mm - of_b.radius_mm) > kSamePlace_mm) {
    return found;
  }
  const MachineVector spoke = (a.from - of_a.centre) * (1.0 / of_a.radius_mm);
  const MachineVector side = of_a.normal.cross(spoke);
  const MachinePoint start = (cosine > 0.0 ? b.from : b.to) - of_a.centre;
  double begin = std::atan2(start.dot(side), start.dot(spoke));
  if (begin < 0.0) begin += kTurn;
  std::size_t count = 0;
  for (const double from : {begin, begin - kTurn}) {
    const Stretch both{std::max(0.0, from) * of_a.radius_mm,
                       std::min(of_a.sweep_rad, from + of_b.sweep_rad) * of_a.radius_mm};
    if (both.end - both.begin > kSamePlace_mm) found[count++] = both;
  }
  return found;
}

// Stretches that cover more and more of one element.
class Coverage {
 public:
  explicit Coverage(double length) : length_(length) {}

  void Add(const Stretch& stretch) { covered_.push_back(stretch); }
  // Whether one of them alone covers it all: nothing more needs to be looked for.
  bool whole() const {
    return !covered_.empty() && covered_.back().begin <= kSamePlace_mm &&
           covered_.back().end >= length_ - kSamePlace_mm;
  }

  // Calls take(begin, end, covered) for what the element consists of, in order.
  template <class Take>
  void Divide(Take take) {
    std::ranges::sort(covered_, {}, &Stretch::begin);
    double at = 0.0;
    for (std::size_t i = 0; i < covered_.size();) {
      Stretch joined = covered_[i++];
      while (i < covered_.size() && covered_[i].begin <= joined.end + kSamePlace_mm) {
        joined.end = std::max(joined.end, covered_[i++].end);
      }
      if (joined.begin - at <= kSamePlace_mm) {
        joined.begin = at;
      } else {
        take(at, joined.begin, false);
      }
      if (length_ - joined.end <= kSamePlace_mm) joined.end = length_;
      take(joined.begin, joined.end, true);
      at = joined.end;
    }
    if (at < length_) take(at, length_, false);
  }

 private:
  double length_;
  std::vector<Stretch> covered_;
};

void Append(PathShare& part, const SketchElement& element, const std::vector<SketchCircle>& circles,
            const Stretch& stretch, double length) {
  SketchElement piece = element;
  const double share_begin = stretch.begin / length, share_end = stretch.end / length;
  if (element.arc < 0) {
    const MachineVector way = element.to - element.from;
    piece.from = element.from + way * share_begin;
    piece.to = element.to - way * (1.0 - share_end);
  } else {
    SketchCircle circle = circles[static_cast<std::size_t>(element.arc)];
    const MachineVector spoke = element.from - circle.centre;
    const MachineVector side = circle.normal.cross(spoke);
    const auto at = [&](double share) -> MachinePoint {
      const double angle = share * circle.sweep_rad;
      return circle.centre + spoke * std::cos(angle) + side * std::sin(angle);
    };
    piece.from = at(share_begin);
    piece.to = at(share_end);
    piece.middle = at(0.5 * (share_begin + share_end));
    circle.sweep_rad *= share_end - share_begin;
    piece.arc = static_cast<std::int32_t>(part.circles.size());
    part.circles.push_back(circle);
  }
  (piece.cuts ? part.cut_mm : part.travel_mm) += stretch.end - stretch.begin;
  part.elements.push_back(piece);
}

class Comparison {
 public:
  Comparison(const PathSketch& other, std::uint64_t pairs_max)
      : other_(other), tree_(Boxes(other), kSamePlace_mm), pairs_left_(pairs_max) {}

  // Divides the elements of `path` by whether the other path runs there, too.
  void Divide(const PathSketch& path, PathShare* common, PathShare& alone) {
    for (const SketchElement& element : path.elements()) {
      const double length = LengthOf(element, path.circles());
      if (!(length > kSamePlace_mm)) continue;  // a place, no path
      Coverage coverage(length);
      Cover(path, element, length, coverage);
      coverage.Divide([&](double begin, double end, bool covered) {
        if (!covered) Append(alone, element, path.circles(), {begin, end}, length);
        if (covered && common != nullptr) {
          Append(*common, element, path.circles(), {begin, end}, length);
        }
      });
    }
  }

  bool exact() const { return exact_; }

 private:
  static std::vector<machine::Box> Boxes(const PathSketch& path) {
    std::vector<machine::Box> boxes;
    boxes.reserve(path.elements().size());
    for (const SketchElement& element : path.elements()) {
      boxes.push_back(BoxOf(element, path.circles()));
    }
    return boxes;
  }

  void Cover(const PathSketch& path, const SketchElement& element, double length,
             Coverage& coverage) {
    tree_.Visit(BoxOf(element, path.circles()), [&](std::size_t index) {
      exact_ = pairs_left_ > 0;
      if (!exact_) return false;
      --pairs_left_;
      const SketchElement& there = other_.elements()[index];
      if (there.cuts != element.cuts || (there.arc < 0) != (element.arc < 0)) return true;
      if (element.arc < 0) {
        if (const auto both = AlongLine(element, length, there)) coverage.Add(*both);
      } else {
        for (const auto& both :
             AlongArc(element, path.circle(element.arc), there, other_.circle(there.arc))) {
          if (both) coverage.Add(*both);
        }
      }
      return !coverage.whole();
    });
  }

  const PathSketch& other_;
  BoxTree tree_;
  std::uint64_t pairs_left_;
  bool exact_ = true;
};

// Dots of `path` that the other one has, and those that it has not.
void DivideDots(const PathSketch& path, const PathSketch& other, PathShare* common,
                PathShare& alone) {
  std::vector<SketchDot> there = other.dots();
  std::ranges::sort(there, {}, [](const SketchDot& dot) { return dot.at.x(); });
  for (const SketchDot& dot : path.dots()) {
    auto near = std::ranges::lower_bound(there, dot.at.x() - kSamePlace_mm, {},
                                         [](const SketchDot& d) { return d.at.x(); });
    while (near != there.end() && near->at.x() <= dot.at.x() + kSamePlace_mm &&
           (near->pierce != dot.pierce || (near->at - dot.at).norm() > kSamePlace_mm)) {
      ++near;
    }
    const bool found = near != there.end() && near->at.x() <= dot.at.x() + kSamePlace_mm;
    if (!found) alone.dots.push_back(dot);
    if (found && common != nullptr) common->dots.push_back(dot);
  }
}

}  // namespace

machine::Box PathShare::box() const {
  machine::Box box;
  for (const SketchElement& element : elements) {
    box.Add(element.from);
    box.Add(element.to);
    if (element.arc >= 0) box.Add(element.middle);
  }
  for (const SketchDot& dot : dots) box.Add(dot.at);
  return box;
}

PathDifference Compare(const PathSketch& before, const PathSketch& after, std::uint64_t pairs_max) {
  PathDifference difference;
  Comparison with_after(after, pairs_max);
  with_after.Divide(before, nullptr, difference.removed);
  Comparison with_before(before, pairs_max);
  with_before.Divide(after, &difference.common, difference.added);
  DivideDots(before, after, nullptr, difference.removed);
  DivideDots(after, before, &difference.common, difference.added);
  difference.exact = with_after.exact() && with_before.exact();
  return difference;
}

}  // namespace rmlcell::simulation
