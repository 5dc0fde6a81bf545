#pragma once

#include <cstdint>
#include <vector>

#include "engine/optimo/language/dwells.h"
#include "engine/optimo/language/flow_graph.h"
#include "engine/optimo/language/flow_state.h"

namespace rmlcell::optimo {

// What running on from an instruction to the RETURN of its GOSUB level makes of the machine, its
// own GOSUBs included. One state for each instruction, found from the back: subroutines that share
// instructions share the work, and a chain of n of them costs n. Private to the folder.
class SubroutineEffects {
 public:
  // `faulty[i]`: instruction i has an error, so what it does is not known.
  SubroutineEffects(const Module& module, const FlowGraph& graph, const Dwells& dwells,
                    const std::vector<bool>& faulty);

  // Of what is called at `target`; null when it never comes to a RETURN. Precondition: a GOSUB,
  // /TIME or TIMER calls it.
  const FlowState* Of(std::uint32_t target) const;

  // How often an instruction was looked at.
  std::uint64_t work() const { return work_; }

 private:
  void FindRegion();
  void Solve();
  FlowState From(std::uint32_t at);
  FlowState OwnEffect(std::uint32_t at) const;
  const FlowState& At(std::uint32_t at) const { return effects_[slots_[at]]; }

  const Module& module_;
  const FlowGraph& graph_;
  const Dwells& dwells_;
  const std::vector<bool>& faulty_;
  std::vector<std::uint32_t> slots_;  // by instruction; 0: in no subroutine
  std::vector<FlowState> effects_;    // by slot; not reached: no way to a RETURN so far
  std::vector<Successor> room_;
  std::uint64_t work_ = 0;
};

}  // namespace rmlcell::optimo
