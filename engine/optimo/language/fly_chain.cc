#include "engine/optimo/language/fly_chain.h"

namespace rmlcell::optimo {
namespace {

constexpr std::uint8_t kEither = kMotionAhead | kStopAhead;

// WORK 1 ON stands still for its dwell; without one it does not. OPT-2.50
std::uint8_t OfDwell(Dwells::Kind kind) {
  switch (kind) {
    case Dwells::Kind::kNone:
      return 0;
    case Dwells::Kind::kSome:
      return kStopAhead;
    default:
      return kEither;
  }
}

}  // namespace

// What the instruction is by itself; 0: look behind it.
std::uint8_t FlyChain::OwnEffect(std::uint32_t at, const std::vector<bool>& hole_moves) const {
  const Instruction& i = module_.instructions[at];
  if (i.op == Op::kMove) {
    if (i.Has(kStart)) return kStopAhead;
    return static_cast<std::uint8_t>(kMotionAhead | (hole_moves[at] ? kHoleAhead : 0));
  }
  if (i.reads_machine) return kStopAhead;
  switch (i.op) {
    case Op::kWork:
      if (i.Has(kStart)) return kStopAhead;
      return i.numbers[0] == 1 && i.Has(kOn) ? OfDwell(dwells_.Of(i.numbers[1])) : std::uint8_t{0};
    case Op::kTcp:
      return kEither;  // whether the tip moves is known when it runs
    case Op::kReturn:
      return graph_.subroutines().empty() ? kEither : 0;
    case Op::kFunction:
      return kEither;  // its own moves are not seen here
    default:
      return Describe(i.op).fly == FlyClass::kTransparent ? 0 : kStopAhead;
  }
}

FlyChain::FlyChain(const Module& module, const FlowGraph& graph, const Dwells& dwells,
                   const std::vector<bool>& hole_moves, const std::vector<bool>& faulty)
    : module_(module),
      graph_(graph),
      dwells_(dwells),
      met_(graph.size() + 1U),
      stop_(graph.size() + 1U, kNoIndex) {
  for (std::uint32_t i = 0; i < graph.size(); ++i)
    own_.push_back(faulty[i] ? kEither : OwnEffect(i, hole_moves));
  // Predecessors in one array: those of i are at first[i] .. first[i + 1].
  std::vector<std::uint32_t> first(graph.size() + 2U);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;  // from, to
  std::vector<std::uint32_t> returns, return_points;
  std::vector<Successor> room;
  for (std::uint32_t i = 0; i < graph.size(); ++i) {
    const Op op = module.instructions[i].op;
    if (op == Op::kReturn) returns.push_back(i);
    if (op == Op::kGosub) return_points.push_back(i + 1);
    for (const Successor& s : graph.From(i, room)) {
      const bool own = s.edge == Edge::kNext || s.edge == Edge::kJump || s.edge == Edge::kCall;
      if (own && !(op == Op::kGosub && s.edge == Edge::kNext)) edges.push_back({i, s.to});
    }
  }
  // A RETURN may come back behind any GOSUB: one meeting place keeps the number of edges linear.
  const auto end = graph.size();
  std::uint8_t behind_return = 0;
  std::uint32_t return_stop = kNoIndex;
  for (const auto& [from, to] : edges) ++first[to + 1U];
  for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
  std::vector<std::uint32_t> sources(edges.size());
  std::vector<std::uint32_t> fill(first.begin(), first.end() - 1);
  for (const auto& [from, to] : edges) sources[fill[to]++] = from;

  std::vector<bool> is_return_point(graph.size() + 1U);
  for (const std::uint32_t point : return_points) is_return_point[point] = true;
  std::vector<std::uint32_t> open;
  const auto raise = [&](std::uint32_t at, std::uint8_t bits, std::uint32_t stop) {
    if ((met_[at] | bits) == met_[at]) return;
    met_[at] |= bits;
    if (stop_[at] == kNoIndex) stop_[at] = stop;
    open.push_back(at);
  };
  raise(end, kStopAhead, end);
  for (std::uint32_t i = 0; i < graph.size(); ++i) {
    if (own_[i] != 0) raise(i, own_[i], (own_[i] & kStopAhead) != 0 ? i : kNoIndex);
  }
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    for (std::uint32_t s = first[at]; s < first[at + 1U]; ++s) {
      const std::uint32_t from = sources[s];
      if (own_[from] == 0) raise(from, met_[at], stop_[at]);
    }
    if (!is_return_point[at] || (behind_return | met_[at]) == behind_return) continue;
    behind_return |= met_[at];
    if (return_stop == kNoIndex) return_stop = stop_[at];
    for (const std::uint32_t i : returns) {
      if (own_[i] == 0) raise(i, behind_return, return_stop);
    }
  }
}

std::uint8_t FlyChain::Behind(std::uint32_t at) const { return met_[at + 1U]; }
std::uint32_t FlyChain::StopBehind(std::uint32_t at) const { return stop_[at + 1U]; }

}  // namespace rmlcell::optimo
