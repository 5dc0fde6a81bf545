#include "engine/rml1/board/contours.h"

#include <array>

namespace rmlcell::rml1 {
namespace {

// A square between four places of the grid. Its corners go round counterclockwise from the lower
// left one, and edge k leads from corner k to the next.
struct Cell {
  std::size_t x = 0;
  std::size_t y = 0;
};
constexpr int kCorners = 4;
constexpr int kBottom = 0;

class Tracer {
 public:
  Tracer(const DistanceField& field, double level)
      : field_(field), level_(level), taken_(field.values.size()) {}

  // Every closed line goes up through the bottom of some cell.
  std::vector<Loop> All() {
    std::vector<Loop> loops;
    for (std::size_t y = 0; y + 1 < field_.height; ++y) {
      for (std::size_t x = 0; x + 1 < field_.width; ++x) {
        if (!taken_[y * field_.width + x] && Inside(x, y) && !Inside(x + 1, y))
          loops.push_back(Trace({x, y}));
      }
    }
    return loops;
  }

 private:
  bool Inside(std::size_t x, std::size_t y) const { return field_.at(x, y) < level_; }
  static std::size_t CornerX(const Cell& cell, int corner) {
    return cell.x + (corner == 1 || corner == 2 ? 1 : 0);
  }
  static std::size_t CornerY(const Cell& cell, int corner) {
    return cell.y + (corner >= 2 ? 1 : 0);
  }
  double Value(const Cell& cell, int corner) const {
    return field_.at(CornerX(cell, corner), CornerY(cell, corner));
  }
  bool Inside(const Cell& cell, int corner) const { return Value(cell, corner) < level_; }

  // Where the level is on an edge.
  PlanePoint PointOn(const Cell& cell, int edge) const {
    const int next = (edge + 1) % kCorners;
    const double a = Value(cell, edge);
    const double b = Value(cell, next);
    const double share = (level_ - a) / (b - a);
    const auto x = static_cast<double>(CornerX(cell, edge));
    const auto y = static_cast<double>(CornerY(cell, edge));
    return {x + share * (static_cast<double>(CornerX(cell, next)) - x),
            y + share * (static_cast<double>(CornerY(cell, next)) - y)};
  }

  // A line comes into a cell through an edge that goes round from inside to outside, and leaves it
  // through one that does the opposite. Of two such, the middle of the cell tells which.
  int ExitOf(const Cell& cell, int entry) const {
    double middle = 0.0;
    for (int corner = 0; corner < kCorners; ++corner) middle += Value(cell, corner) / kCorners;
    const int way = middle < level_ ? 1 : kCorners - 1;
    for (int edge = (entry + way) % kCorners; edge != entry; edge = (edge + way) % kCorners) {
      if (!Inside(cell, edge) && Inside(cell, (edge + 1) % kCorners)) return edge;
    }
    return entry;
  }

  Loop Trace(Cell cell) {
    Loop loop;
    int entry = kBottom;
    for (;;) {
      if (entry == kBottom) {
        const std::size_t place = cell.y * field_.width + cell.x;
        if (taken_[place]) return loop;
        taken_[place] = true;
      }
      loop.push_back(PointOn(cell, entry));
      const int exit = ExitOf(cell, entry);
      constexpr std::array<int, kCorners> kAcrossX = {0, 1, 0, -1};
      constexpr std::array<int, kCorners> kAcrossY = {-1, 0, 1, 0};
      cell.x = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(cell.x) +
                                        kAcrossX[static_cast<std::size_t>(exit)]);
      cell.y = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(cell.y) +
                                        kAcrossY[static_cast<std::size_t>(exit)]);
      entry = (exit + 2) % kCorners;
    }
  }

  const DistanceField& field_;
  double level_;
  std::vector<bool> taken_;  // bottoms of cells through which a line goes up
};

}  // namespace

std::vector<Loop> ContoursAt(const DistanceField& field, double level) {
  return Tracer(field, level).All();
}

double SignedArea(const Loop& loop) {
  double twice = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const PlanePoint& a = loop[i];
    const PlanePoint& b = loop[(i + 1) % loop.size()];
    twice += a.x * b.y - b.x * a.y;
  }
  return twice / 2.0;
}

}  // namespace rmlcell::rml1
