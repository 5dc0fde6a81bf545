#include "engine/optimo/language/flow_graph.h"

#include <algorithm>

namespace rmlcell::optimo {

FlowGraph::FlowGraph(const Module& module)
    : module_(module), index_(module), leaders_(module.instructions.size() + 1) {
  std::vector<Successor> room;
  leaders_[index_.entry()] = true;
  for (std::uint32_t i = 0; i < size(); ++i) {
    const std::vector<Successor>& successors = From(i, room);
    const bool straight = successors.size() == 1 && successors[0].edge == Edge::kNext;
    for (const Successor& successor : successors) {
      if (!straight) leaders_[successor.to] = true;
      if (successor.edge == Edge::kCall) subroutines_.push_back(successor.to);
    }
  }
  std::ranges::sort(subroutines_);
  subroutines_.erase(std::unique(subroutines_.begin(), subroutines_.end()), subroutines_.end());
}

const std::vector<Successor>& FlowGraph::From(std::uint32_t at,
                                              std::vector<Successor>& room) const {
  room.clear();
  const Instruction& i = module_.instructions[at];
  const auto jump = [&](std::uint16_t label, Edge edge) {
    if (const auto to = index_.FindLabel(label)) room.push_back({*to, edge});
  };
  const Successor next{at + 1, Edge::kNext};
  const auto targets = module_.Targets(i);
  switch (i.op) {
    case Op::kGoto:
      jump(targets[0], Edge::kJump);
      break;
    case Op::kGotoTable:
      room.push_back(next);
      for (const std::uint16_t label : targets) jump(label, Edge::kJump);
      break;
    case Op::kIf:
      jump(targets[0], Edge::kJump);
      if (targets.size() == 2) {
        jump(targets[1], Edge::kJump);
      } else {
        room.push_back(next);
      }
      break;
    case Op::kGosub:
      room.push_back(next);
      jump(targets[0], Edge::kCall);
      break;
    case Op::kErr:
      room.push_back(next);
      jump(targets[0], Edge::kHandler);
      break;
    case Op::kTimer:
      room.push_back(next);
      if (!targets.empty()) jump(targets[0], Edge::kTimed);
      break;
    case Op::kReturn:
    case Op::kEndtask:
    case Op::kGo:
      break;
    default:
      room.push_back(next);
      break;
  }
  if (i.Has(kTime) && i.op == Op::kMove) jump(module_.TimeLabel(i), Edge::kTimed);
  return room;
}

std::optional<std::uint32_t> FlowGraph::Called(std::uint32_t at) const {
  const Instruction& i = module_.instructions[at];
  if (i.op == Op::kMove && i.Has(kTime)) return index_.FindLabel(module_.TimeLabel(i));
  if ((i.op != Op::kGosub && i.op != Op::kTimer) || i.target_count == 0) return std::nullopt;
  return index_.FindLabel(module_.Targets(i)[0]);
}

std::vector<bool> FlowGraph::LeadingTo(const std::vector<bool>& goals, bool calls) const {
  const Predecessors predecessors(*this);
  std::vector<bool> reaches(size() + 1U);
  std::vector<std::uint32_t> open;
  const auto reach = [&](std::uint32_t at) {
    if (reaches[at]) return;
    reaches[at] = true;
    open.push_back(at);
  };
  for (std::uint32_t at = 0; at < size(); ++at) {
    if (goals[at]) reach(at);
  }
  std::vector<Successor> room;
  while (!open.empty()) {
    const std::uint32_t to = open.back();
    open.pop_back();
    for (const std::uint32_t from : predecessors.Of(to)) {
      if (reaches[from]) continue;
      for (const Successor& s : From(from, room)) {
        if (s.to == to && s.edge != Edge::kTimed && (calls || s.edge != Edge::kCall)) reach(from);
      }
    }
  }
  return reaches;
}

std::vector<bool> FlowGraph::ReachOnLevel(std::uint32_t from) const {
  std::vector<bool> reached(size() + 1U);
  std::vector<std::uint32_t> open;
  const auto reach = [&](std::uint32_t at) {
    if (reached[at]) return;
    reached[at] = true;
    open.push_back(at);
  };
  reach(from);
  std::vector<Successor> room;
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    if (at == size()) continue;
    for (const Successor& s : From(at, room)) {
      if (s.edge != Edge::kCall && s.edge != Edge::kTimed) reach(s.to);
    }
  }
  return reached;
}

Predecessors::Predecessors(const FlowGraph& graph) : first_(graph.size() + 2U) {
  std::vector<Successor> room;
  for (std::uint32_t i = 0; i < graph.size(); ++i) {
    for (const Successor& s : graph.From(i, room)) ++first_[s.to + 1U];
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  sources_.resize(first_.back());
  std::vector<std::uint32_t> fill(first_.begin(), first_.end() - 1);
  for (std::uint32_t i = 0; i < graph.size(); ++i) {
    for (const Successor& s : graph.From(i, room)) sources_[fill[s.to]++] = i;
  }
}

}  // namespace rmlcell::optimo
