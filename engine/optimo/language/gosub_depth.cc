#include "engine/optimo/language/gosub_depth.h"

#include <algorithm>

namespace rmlcell::optimo {
namespace {

constexpr std::uint32_t kUnseen = 0xFFFF'FFFF;

void SortOnce(std::vector<std::uint32_t>& places) {
  std::ranges::sort(places);
  places.erase(std::unique(places.begin(), places.end()), places.end());
}

// Rings are what can come to itself (Tarjan's strongly connected components, with a stack of its
// own). The GOSUBs that lead back into the way that the walk is on close them.
class RingWalk {
 public:
  RingWalk(std::uint32_t count, const std::vector<LevelEdge>& edges)
      : edges_(edges),
        first_(count + 1U),
        order_(count, kUnseen),
        low_(count),
        ring_(count, kUnseen),
        on_way_(count) {
    for (const LevelEdge& edge : edges) ++first_[edge.from + 1U];
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  }

  void From(std::uint32_t entry) {
    Open(entry);
    while (!way_.empty()) {
      Frame& frame = way_.back();
      const std::uint32_t at = frame.at;
      if (frame.next == first_[at + 1U]) {
        Close(at);
        continue;
      }
      const LevelEdge& edge = edges_[frame.next++];
      if (order_[edge.to] == kUnseen) {
        Open(edge.to);
      } else if (ring_[edge.to] == kUnseen) {
        low_[at] = std::min(low_[at], order_[edge.to]);
        if (edge.gosub && on_way_[edge.to]) closing_.push_back(at);
      }
    }
  }

  // Rings are numbered from the last one that can be come to; kUnseen: `at` is not come to.
  std::uint32_t RingOf(std::uint32_t at) const { return ring_[at]; }
  std::uint32_t rings() const { return rings_; }
  const std::vector<std::uint32_t>& closing() const { return closing_; }

 private:
  struct Frame {
    std::uint32_t at = 0;
    std::uint32_t next = 0;  // edge
  };

  void Open(std::uint32_t at) {
    order_[at] = low_[at] = seen_++;
    on_way_[at] = true;
    way_.push_back({at, first_[at]});
    pending_.push_back(at);
  }

  void Close(std::uint32_t at) {
    way_.pop_back();
    on_way_[at] = false;
    if (!way_.empty()) low_[way_.back().at] = std::min(low_[way_.back().at], low_[at]);
    if (low_[at] != order_[at]) return;
    for (std::uint32_t member = kUnseen; member != at;) {
      member = pending_.back();
      pending_.pop_back();
      ring_[member] = rings_;
    }
    ++rings_;
  }

  const std::vector<LevelEdge>& edges_;
  std::vector<std::uint32_t> first_;  // edge, by its `from`
  std::vector<std::uint32_t> order_, low_, ring_;
  std::vector<bool> on_way_;
  std::vector<Frame> way_;
  std::vector<std::uint32_t> pending_;
  std::vector<std::uint32_t> closing_;
  std::uint32_t seen_ = 0, rings_ = 0;
};

}  // namespace

GosubNesting FindNesting(std::uint32_t count, std::uint32_t entry,
                         const std::vector<LevelEdge>& edges, int levels_max) {
  GosubNesting nesting;
  if (count == 0) return nesting;
  RingWalk walk(count, edges);
  walk.From(entry);
  nesting.recursive = walk.closing();

  // A ring that a jump closes has no such GOSUB: its last one is told.
  std::vector<bool> told(walk.rings());
  for (const std::uint32_t at : nesting.recursive) told[walk.RingOf(at)] = true;
  for (std::size_t e = edges.size(); e-- > 0;) {
    const std::uint32_t ring = walk.RingOf(edges[e].from);
    if (!edges[e].gosub || ring == kUnseen || ring != walk.RingOf(edges[e].to) || told[ring])
      continue;
    told[ring] = true;
    nesting.recursive.push_back(edges[e].from);
  }

  // The deepest level of each ring, those first that lead to others.
  std::vector<std::uint32_t> begin(walk.rings() + 1U), by_ring(edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const std::uint32_t ring = walk.RingOf(edges[e].from);
    if (ring != kUnseen && ring != walk.RingOf(edges[e].to)) ++begin[ring + 1U];
  }
  for (std::size_t r = 1; r < begin.size(); ++r) begin[r] += begin[r - 1];
  std::vector<std::uint32_t> fill(begin.begin(), begin.end() - 1);
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const std::uint32_t ring = walk.RingOf(edges[e].from);
    if (ring != kUnseen && ring != walk.RingOf(edges[e].to)) by_ring[fill[ring]++] = e;
  }
  std::vector<int> level(walk.rings());
  for (std::uint32_t ring = walk.rings(); ring-- > 0;) {
    for (std::uint32_t b = begin[ring]; b < begin[ring + 1U]; ++b) {
      const LevelEdge& edge = edges[by_ring[b]];
      const int deeper = level[ring] + (edge.gosub ? 1 : 0);
      if (edge.gosub && deeper > levels_max) nesting.too_deep.push_back(edge.from);
      int& of = level[walk.RingOf(edge.to)];
      of = std::max(of, deeper);
    }
  }
  SortOnce(nesting.recursive);
  SortOnce(nesting.too_deep);
  return nesting;
}

}  // namespace rmlcell::optimo
