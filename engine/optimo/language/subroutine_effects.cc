#include "engine/optimo/language/subroutine_effects.h"

#include <algorithm>
#include <deque>

namespace rmlcell::optimo {

SubroutineEffects::SubroutineEffects(const Module& module, const FlowGraph& graph,
                                     const Dwells& dwells, const std::vector<bool>& faulty)
    : module_(module), graph_(graph), dwells_(dwells), faulty_(faulty) {
  FindRegion();
  if (effects_.size() > 1) Solve();
}

const FlowState* SubroutineEffects::Of(std::uint32_t target) const {
  const FlowState& effect = At(target);
  return effect.reached ? &effect : nullptr;
}

// Everything that a subroutine can come to.
void SubroutineEffects::FindRegion() {
  slots_.resize(graph_.size() + 1U);
  std::uint32_t count = 1;
  std::vector<std::uint32_t> open;
  const auto enter = [&](std::uint32_t at) {
    if (slots_[at] != 0) return;
    slots_[at] = count++;
    open.push_back(at);
  };
  for (std::uint32_t at = 0; at < graph_.size(); ++at) {
    if (const auto called = graph_.Called(at)) enter(*called);
  }
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    if (at == graph_.size()) continue;
    for (const Successor& s : graph_.From(at, room_)) enter(s.to);
  }
  effects_.resize(count);
}

void SubroutineEffects::Solve() {
  const Predecessors predecessors(graph_);
  std::deque<std::uint32_t> open;
  std::vector<bool> waiting(graph_.size() + 1U);
  for (std::uint32_t at = graph_.size(); at-- > 0;) {
    if (slots_[at] == 0) continue;
    open.push_back(at);
    waiting[at] = true;
  }
  while (!open.empty()) {
    const std::uint32_t at = open.front();
    open.pop_front();
    waiting[at] = false;
    if (!effects_[slots_[at]].Join(From(at))) continue;
    for (const std::uint32_t before : predecessors.Of(at)) {
      if (slots_[before] == 0 || waiting[before]) continue;
      waiting[before] = true;
      open.push_back(before);
    }
  }
}

FlowState SubroutineEffects::OwnEffect(std::uint32_t at) const {
  FlowState effect = faulty_[at] ? FlowState::Unknown() : FlowState::Kept();
  if (!faulty_[at]) Step(module_, dwells_, at, effect);
  return effect;
}

FlowState SubroutineEffects::From(std::uint32_t at) {
  ++work_;
  const Op op = module_.instructions[at].op;
  if (op == Op::kReturn) return FlowState::Kept();
  FlowState own = OwnEffect(at);
  if (const auto called = graph_.Called(at); called && op != Op::kTimer) {
    const FlowState& effect = At(*called);
    if (op == Op::kGosub) {
      if (!effect.reached) return {};
      own.Then(effect);
    } else if (effect.reached) {  // the time of a /TIME may run out
      FlowState timed = own;
      timed.Then(effect);
      own.Join(timed);
    }
  }
  FlowState all;
  for (const Successor& s : graph_.From(at, room_)) {
    if (s.edge == Edge::kCall || s.edge == Edge::kTimed || !At(s.to).reached) continue;
    FlowState path = s.edge == Edge::kHandler ? FlowState::InErrorHandler() : own;
    path.Then(At(s.to));
    all.Join(path);
  }
  return all;
}

}  // namespace rmlcell::optimo
