#include "engine/simulation/picture/box_tree.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <vector>

namespace rmlcell::simulation {
namespace {

using motion::MachineVector;

machine::Box BoxFrom(const motion::MachinePoint& low, const MachineVector& size) {
  machine::Box box;
  box.Add(low);
  box.Add(low + size);
  return box;
}

std::vector<std::size_t> Touching(const BoxTree& tree, const machine::Box& box) {
  std::vector<std::size_t> found;
  tree.Visit(box, [&](std::size_t index) {
    found.push_back(index);
    return true;
  });
  return found;
}

// Boxes touch when they are not farther than `reach` from each other: along each axis, to each
// side, the limit itself included.
TEST(BoxTree, ReachesAsFarAsItIsTold) {
  const BoxTree tree({BoxFrom({0, 0, 0}, {1, 1, 1})}, 0.5);
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool above : {true, false}) {
      const auto found_at = [&](double gap) {
        motion::MachinePoint low;
        (axis == 0 ? low.x() : axis == 1 ? low.y() : low.z()) = above ? 1.0 + gap : -1.0 - gap;
        return Touching(tree, BoxFrom(low, {1, 1, 1})).size();
      };
      EXPECT_EQ(found_at(0.5), 1u) << axis << above;
      EXPECT_EQ(found_at(0.625), 0u) << axis << above;
    }
  }
}

TEST(BoxTree, OfNothingFindsNothing) {
  EXPECT_TRUE(Touching(BoxTree({}, 1.0), BoxFrom({}, {1, 1, 1})).empty());
}

// Each box that touches is found, once, and no other: as looking at all of them tells, along
// whichever axis the boxes lie.
TEST(BoxTree, FindsWhatLookingAtAllFinds) {
  for (const MachineVector& spread : {MachineVector{100, 3, 3}, MachineVector{3, 100, 3},
                                      MachineVector{3, 3, 100}, MachineVector{9, 9, 9}}) {
    std::uint32_t seed = 7;
    const auto next = [&] {
      seed = seed * 1664525U + 1013904223U;
      return static_cast<double>(seed >> 8) / (1 << 24);
    };
    const auto random_box = [&] {
      return BoxFrom({next() * spread.x(), next() * spread.y(), next() * spread.z()},
                     {next(), next(), next()});
    };
    std::vector<machine::Box> boxes;
    for (int k = 0; k < 300; ++k) boxes.push_back(random_box());
    constexpr double kReach = 0.25;
    const BoxTree tree(boxes, kReach);
    for (int k = 0; k < 50; ++k) {
      const machine::Box asked = random_box();
      std::set<std::size_t> expected;
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        const auto apart = [](double low_a, double high_a, double low_b, double high_b) {
          return std::max(low_a - high_b, low_b - high_a) > kReach;
        };
        const machine::Box& box = boxes[i];
        if (!apart(box.min.x(), box.max.x(), asked.min.x(), asked.max.x()) &&
            !apart(box.min.y(), box.max.y(), asked.min.y(), asked.max.y()) &&
            !apart(box.min.z(), box.max.z(), asked.min.z(), asked.max.z())) {
          expected.insert(i);
        }
      }
      const std::vector<std::size_t> found = Touching(tree, asked);
      EXPECT_EQ(std::set(found.begin(), found.end()), expected);
      EXPECT_EQ(found.size(), expected.size());
    }
  }
}

// Whoever has seen enough is told no more.
TEST(BoxTree, EndsWhenAsked) {
  const BoxTree tree(std::vector<machine::Box>(100, BoxFrom({}, {1, 1, 1})), 0.0);
  int seen = 0;
  tree.Visit(BoxFrom({}, {1, 1, 1}), [&](std::size_t) { return ++seen < 3; });
  EXPECT_EQ(seen, 3);
}

}  // namespace
}  // namespace rmlcell::simulation
