#include "engine/rml1/board/joined_traces.h"

#include <algorithm>
#include <vector>

namespace rmlcell::rml1 {
namespace {

// Pixels of a row, one beside the other, that are below a level.
struct Run {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::size_t piece = 0;
};

// What is below a level, row by row from the bottom up: which runs belong to one piece.
class PiecesBelow {
 public:
  PiecesBelow(const DistanceField& field, double level) : field_(field), level_(level) {}

  void TakeRow(std::size_t y) {
    below_.swap(runs_);
    runs_.clear();
    for (std::size_t x = 0; x < field_.width; ++x) {
      if (!Inside(x, y)) continue;
      const std::size_t begin = x;
      while (x < field_.width && Inside(x, y)) ++x;
      runs_.push_back({begin, x, parents_.size()});
      parents_.push_back(parents_.size());
    }
    auto from = below_.begin();
    for (const Run& run : runs_) {
      while (from != below_.end() && from->end < run.begin) ++from;
      for (auto one = from; one != below_.end() && one->begin <= run.end; ++one) {
        if (Touch(*one, run, y)) parents_[RootOf(one->piece)] = RootOf(run.piece);
      }
    }
  }

  const std::vector<Run>& runs() const { return runs_; }  // of the last row
  std::size_t count() const { return parents_.size(); }
  std::size_t RootOf(std::size_t piece) {
    while (parents_[piece] != piece) piece = parents_[piece] = parents_[parents_[piece]];
    return piece;
  }

 private:
  bool Inside(std::size_t x, std::size_t y) const { return field_.at(x, y) < level_; }

  // Two that have only a corner in common are one where the middle of the four pixels around it is
  // below the level: as lines go around them (ContoursAt).
  bool Touch(const Run& lower, const Run& upper, std::size_t y) const {
    if (lower.begin < upper.end && upper.begin < lower.end) return true;
    const std::size_t x = std::max(lower.begin, upper.begin);
    const double middle =
        (field_.at(x - 1, y - 1) + field_.at(x, y - 1) + field_.at(x - 1, y) + field_.at(x, y)) /
        4.0;
    return middle < level_;
  }

  const DistanceField& field_;
  double level_;
  std::vector<Run> below_;
  std::vector<Run> runs_;
  std::vector<std::size_t> parents_;  // a run's, or of what it was joined with
};

}  // namespace

JoinedTraces CountJoined(const DistanceField& field, double edge, double level) {
  PiecesBelow copper(field, edge);
  PiecesBelow within(field, level);
  std::vector<std::size_t> around;  // of each run of copper, the run that it lies in
  for (std::size_t y = 0; y < field.height; ++y) {
    copper.TakeRow(y);
    within.TakeRow(y);
    auto outer = within.runs().begin();
    for (const Run& run : copper.runs()) {
      while (outer->end < run.end) ++outer;
      around.push_back(outer->piece);
    }
  }
  JoinedTraces counted;
  std::vector<std::size_t> traces_in(within.count());
  for (std::size_t piece = 0; piece < copper.count(); ++piece) {
    if (copper.RootOf(piece) != piece) continue;
    ++counted.traces;
    ++traces_in[within.RootOf(around[piece])];
  }
  for (const std::size_t traces : traces_in) {
    if (traces > 1) counted.joined += traces;
  }
  return counted;
}

}  // namespace rmlcell::rml1
