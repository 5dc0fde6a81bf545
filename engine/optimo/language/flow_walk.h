#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "engine/optimo/language/flow_graph.h"
#include "engine/optimo/language/flow_state.h"
#include "engine/optimo/language/subroutine_effects.h"

namespace rmlcell::optimo {

// The states of a program at every instruction, over all paths from its start. Private to the
// folder.
class FlowWalk {
 public:
  // `faulty[i]`: instruction i has an error, so what it does is not known; with `any_error` it is
  // not known either who jumps to which sequence number.
  FlowWalk(const Module& module, const FlowGraph& graph, const Dwells& dwells,
           const std::vector<bool>& faulty, bool any_error);

  // Calls visit(instruction, state before it) for everything that can be reached, in program order.
  template <class Visit>
  void ForEachReached(Visit visit) const {
    FlowState state;
    std::vector<Successor> room;
    for (std::uint32_t at = 0; at < graph_.size(); ++at) {
      if (leaders_[at]) state = states_[slots_[at]];
      if (!state.reached) continue;
      visit(at, std::as_const(state));
      Pass(at, state);
      if (!FlowsOn(at, room)) state.reached = false;
    }
  }

  // Over one instruction, a subroutine that it calls included.
  void Pass(std::uint32_t at, FlowState& state) const;

 private:
  void FindTimer();
  void Follow(bool any_error);
  FlowState WhenTimeRanOut(std::uint32_t at, const FlowState& before) const;
  bool FlowsOn(std::uint32_t at, std::vector<Successor>& room) const;

  const Module& module_;
  const FlowGraph& graph_;
  const Dwells& dwells_;
  const std::vector<bool>& faulty_;
  SubroutineEffects subroutines_;
  // What the GOSUB of a TIMER does. It comes between any two instructions while a TIMER may be
  // armed, so what it changes is not known there; before and behind it is.
  std::optional<FlowState> timer_;
  std::vector<bool> arms_;  // from here an instruction may be come to that arms one
  std::vector<bool> leaders_;
  std::vector<std::uint32_t> slots_;  // by leader
  std::vector<FlowState> states_;     // by slot
};

}  // namespace rmlcell::optimo
