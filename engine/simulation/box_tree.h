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
  struct Node {
    machine::Box box;
    std::uint32_t begin = 0;  // in order_
    std::uint32_t end = 0;
    std::uint32_t second = 0;  // its second half; the first is the next node. 0: a leaf
  };
  void Build(std::uint32_t begin, std::uint32_t end);

  std::vector<machine::Box> boxes_;
  double reach_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace rmlcell::simulation
