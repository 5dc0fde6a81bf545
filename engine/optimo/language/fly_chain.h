#pragma once

#include <cstdint>
#include <vector>

#include "engine/optimo/language/dwells.h"
#include "engine/optimo/language/flow_graph.h"

// What comes behind each instruction: a motion, or something for which the machine must stand still
// (OPT-2.47 to 2.53). Private to the folder.
namespace rmlcell::optimo {

enum Ahead : std::uint8_t { kMotionAhead = 1, kStopAhead = 2, kHoleAhead = 4 };

class FlyChain {
 public:
  // `hole_moves[i]`: instruction i is a MOVE that is known to run a hole. `faulty[i]`: it has an
  // error, so what it does is not known.
  FlyChain(const Module& module, const FlowGraph& graph, const Dwells& dwells,
           const std::vector<bool>& hole_moves, const std::vector<bool>& faulty);

  // What may be met behind instruction `at`, as bits of Ahead.
  std::uint8_t Behind(std::uint32_t at) const;
  // Something that stops there, or kNoIndex; the number of instructions for the end of the program.
  std::uint32_t StopBehind(std::uint32_t at) const;

 private:
  std::uint8_t OwnEffect(std::uint32_t at, const std::vector<bool>& hole_moves) const;

  const Module& module_;
  const FlowGraph& graph_;
  const Dwells& dwells_;
  std::vector<std::uint8_t> own_;
  std::vector<std::uint8_t> met_;  // when execution comes to the instruction
  std::vector<std::uint32_t> stop_;
};

}  // namespace rmlcell::optimo
