#include "engine/optimo/language/flow_walk.h"

#include <deque>

namespace rmlcell::optimo {

FlowWalk::FlowWalk(const Module& module, const FlowGraph& graph, const Dwells& dwells,
                   const std::vector<bool>& faulty, bool any_error)
    : module_(module),
      graph_(graph),
      dwells_(dwells),
      faulty_(faulty),
      subroutines_(module, graph, dwells, faulty),
      leaders_(graph.size() + 1U),
      slots_(graph.size() + 1U) {
  FindTimer();
  std::uint32_t count = 0;
  for (std::uint32_t at = 0; at <= graph.size(); ++at) {
    leaders_[at] = at == graph.size() || graph.IsLeader(at) ||
                   (any_error && !module.Labels(module.instructions[at]).empty());
    if (leaders_[at]) slots_[at] = count++;
  }
  states_.resize(count);
  Follow(any_error);
}

// OPT-B.59
void FlowWalk::FindTimer() {
  std::vector<bool> arming(graph_.size());
  for (std::uint32_t at = 0; at < graph_.size(); ++at) {
    if (module_.instructions[at].op != Op::kTimer) continue;
    const auto called = graph_.Called(at);
    const FlowState* effect = called ? subroutines_.Of(*called) : nullptr;
    if (effect == nullptr) continue;
    if (!timer_) timer_.emplace();
    timer_->Join(*effect);
    arming[at] = true;
  }
  if (timer_) arms_ = graph_.LeadingTo(arming, true);
}

void FlowWalk::Pass(std::uint32_t at, FlowState& state) const {
  bool armed = state.timer.MayBe(Armed::kYes);
  if (faulty_[at]) {
    state = FlowState::Unknown();
  } else {
    Step(module_, dwells_, at, state);
  }
  const Op op = module_.instructions[at].op;
  if (const auto called = graph_.Called(at); called && op != Op::kTimer) {
    const FlowState* effect = subroutines_.Of(*called);
    armed = armed || (timer_ && arms_[*called]);
    if (op == Op::kMove) {
      if (effect != nullptr) {  // the time of /TIME may run out
        FlowState timed = state;
        timed.Then(*effect);
        state.Join(timed);
      }
    } else if (effect != nullptr) {
      state.Then(*effect);
    } else {
      state = FlowState::Unknown();  // it is told that it never comes back
    }
  }
  if (!timer_ || !(armed || state.timer.MayBe(Armed::kYes))) return;
  FlowState timed = state;
  timed.Then(*timer_);
  state.ForgetDifferences(timed);
}

// In the GOSUB of a /TIME, behind its MOVE; in that of a TIMER: it comes whenever it does.
FlowState FlowWalk::WhenTimeRanOut(std::uint32_t at, const FlowState& before) const {
  if (faulty_[at] || module_.instructions[at].op != Op::kMove) return FlowState::Unknown();
  FlowState state = before;
  Step(module_, dwells_, at, state);
  return state;
}

bool FlowWalk::FlowsOn(std::uint32_t at, std::vector<Successor>& room) const {
  for (const Successor& s : graph_.From(at, room)) {
    if (s.edge == Edge::kNext) return true;
  }
  return false;
}

void FlowWalk::Follow(bool any_error) {
  std::deque<std::uint32_t> open;
  std::vector<bool> waiting(graph_.size() + 1U);
  const auto enter = [&](std::uint32_t at, const FlowState& state) {
    if (!states_[slots_[at]].Join(state) || waiting[at]) return;
    waiting[at] = true;
    open.push_back(at);
  };
  enter(graph_.entry(), FlowState::AtStart());
  for (std::uint32_t at = 0; any_error && at < graph_.size(); ++at) {
    if (!module_.Labels(module_.instructions[at]).empty()) enter(at, FlowState::Unknown());
  }
  std::vector<Successor> room;
  while (!open.empty()) {
    std::uint32_t at = open.front();
    open.pop_front();
    waiting[at] = false;
    FlowState state = states_[slots_[at]];
    if (at == graph_.size()) continue;
    bool on = false;
    do {
      on = false;
      FlowState after = state;
      Pass(at, after);
      for (const Successor& s : graph_.From(at, room)) {
        if (s.edge == Edge::kNext) on = true;
        if (s.edge == Edge::kJump) enter(s.to, after);
        if (s.edge == Edge::kCall) enter(s.to, state);
        if (s.edge == Edge::kHandler) enter(s.to, FlowState::InErrorHandler());
        if (s.edge == Edge::kTimed) enter(s.to, WhenTimeRanOut(at, state));
      }
      ++at;
      state = after;
    } while (on && !leaders_[at]);
    if (on) enter(at, state);
  }
}

}  // namespace rmlcell::optimo
