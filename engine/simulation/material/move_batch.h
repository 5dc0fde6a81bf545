#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/simulation/material/height_field.h"
#include "engine/simulation/material/parallel_for.h"

namespace rmlcell::simulation {

// Straight moves of a tool that are cut together: each thread cuts all of them, in their order, in
// rows of its own. Over each cell the same is done in the same order as by one thread, and the most
// of all rows is the most of the most of some: threads change no bit of what comes of it.
class MoveBatch {
 public:
  // What a move took off at most, and how deep shank or holder went into what was there before it.
  struct Taken {
    double most_mm = 0.0;
    double shank_depth_mm = 0.0;
  };

  MoveBatch(const HeightField& field, const MillTool& tool);

  void Add(const motion::MachinePoint& from, const motion::MachinePoint& to);
  bool full() const;

  // Cuts them and forgets them; one a move, in their order. Valid until the next call.
  std::span<const Taken> Cut(HeightField& field, ParallelFor& parallel);

 private:
  struct Move {
    motion::MachinePoint from;
    motion::MachinePoint to;
    HeightField::Rows rows;  // it comes over no others
  };
  std::vector<HeightField::Rows> Bands(std::size_t count) const;

  MillTool tool_;
  double widest_mm_;  // of tool, shank and holder: a radius
  Stock stock_;
  double rows_;
  double cells_ = 0.0;              // that all of them come over, about
  std::vector<double> cells_more_;  // in a row than in the one before it
  std::vector<Move> moves_;
  std::vector<Taken> taken_;
};

// What one move takes off, with nobody's help.
MoveBatch::Taken CutMove(HeightField& field, const MillTool& tool, const motion::MachinePoint& from,
                         const motion::MachinePoint& to, HeightField::Rows rows);

}  // namespace rmlcell::simulation
