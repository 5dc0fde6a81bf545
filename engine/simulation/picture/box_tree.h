#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/machine/shape.h"

namespace rmlcell::simulation {

// Finds the boxes that a box touches, in the time of a logarithm and what is found. Built once.
class BoxTree {
 public:
  // Boxes that are not farther than `reach` from each other touch.
  BoxTree(std::vector<machine::Box> boxes, double reach);

  // Calls `visit` with the index of each box that touches; it says whether to go on.
  void Visit(const machine::Box& box, const std::function<bool(std::size_t index)>& visit) const;

 private:
  // Behind a node come its first half and all of that, then its second half.
  struct Node {
    machine::Box box;
    std::uint32_t begin = 0;  // of a leaf: its boxes in order_
    std::uint32_t end = 0;
    std::uint32_t behind = 0;  // the first node that is not within this one
  };
  void Build(std::uint32_t begin, std::uint32_t end);

  std::vector<machine::Box> boxes_;
  double reach_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace rmlcell::simulation
