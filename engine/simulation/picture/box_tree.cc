#include "engine/simulation/picture/box_tree.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace rmlcell::simulation {
namespace {

constexpr std::uint32_t kLeafMax = 8;

bool Touch(const machine::Box& a, const machine::Box& b, double reach) {
  return a.min.x() <= b.max.x() + reach && b.min.x() <= a.max.x() + reach &&
         a.min.y() <= b.max.y() + reach && b.min.y() <= a.max.y() + reach &&
         a.min.z() <= b.max.z() + reach && b.min.z() <= a.max.z() + reach;
}

}  // namespace

BoxTree::BoxTree(std::vector<machine::Box> boxes, double reach)
    : boxes_(std::move(boxes)), reach_(reach), order_(boxes_.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  if (!order_.empty()) Build(0, static_cast<std::uint32_t>(order_.size()));
}

void BoxTree::Build(std::uint32_t begin, std::uint32_t end) {
  const std::size_t here = nodes_.size();
  nodes_.emplace_back();
  machine::Box box;
  for (std::uint32_t i = begin; i < end; ++i) box.Add(boxes_[order_[i]]);
  nodes_[here].box = box;
  if (end - begin <= kLeafMax) {
    nodes_[here].begin = begin;
    nodes_[here].end = end;
    nodes_[here].behind = static_cast<std::uint32_t>(nodes_.size());
    return;
  }
  const motion::MachineVector size = box.max - box.min;
  const double longest = std::max({size.x(), size.y(), size.z()});
  const auto middle = [&](std::uint32_t index) {
    const machine::Box& one = boxes_[index];
    if (longest == size.x()) return one.min.x() + one.max.x();
    return longest == size.y() ? one.min.y() + one.max.y() : one.min.z() + one.max.z();
  };
  const std::uint32_t half = begin + (end - begin) / 2;
  const auto at = [&](std::uint32_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(half), at(end), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(middle(a), a) < std::pair(middle(b), b);
  });
  Build(begin, half);
  Build(half, end);
  nodes_[here].behind = static_cast<std::uint32_t>(nodes_.size());
}

void BoxTree::Visit(const machine::Box& box,
                    const std::function<bool(std::size_t index)>& visit) const {
  for (std::uint32_t here = 0; here < nodes_.size();) {
    const Node& node = nodes_[here];
    if (!Touch(node.box, box, reach_)) {
      here = node.behind;
      continue;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      if (Touch(boxes_[order_[i]], box, reach_) && !visit(order_[i])) return;
    }
    ++here;  // its first half, or what is behind a leaf
  }
}

}  // namespace rmlcell::simulation
