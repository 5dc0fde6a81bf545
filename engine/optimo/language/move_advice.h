#pragma once

#include <vector>

#include "engine/optimo/language/flow_graph.h"
#include "engine/optimo/language/flow_state.h"
#include "engine/optimo/language/fly_chain.h"
#include "engine/optimo/language/program.h"
#include "engine/optimo/language/start_modes.h"

namespace rmlcell::optimo {

// Advice about single MOVEs, given what is known where they stand (chapter 5.5, OPT-2.45 to 2.53,
// OPT-7.109). Private to the folder.
class MoveAdviser {
 public:
  MoveAdviser(const ParsedProgram& program, const StartModes& start, Findings& findings,
              const FlyChain& chain)
      : p_(program), module_(program.module), start_(start), findings_(findings), chain_(chain) {}

  void Advise(std::uint32_t at, const FlowState& state);
  // After all moves: ROBOT moves between ABSOL moves in a program that uses SYSDEF. `to_absol`:
  // from where an ABSOL move can be reached, calls included.
  void AdviseRobotMoves(const FlowGraph& graph, const std::vector<bool>& to_absol);

 private:
  void AdvisePath(const Instruction& i, const FlowState& state);
  void AdviseSpeed(std::uint32_t at, const FlowState& state);
  void AdviseFly(std::uint32_t at, const FlowState& state);
  void AdviseShortFly(std::uint32_t at, const FlowState& state);
  void AdviseHole(const Instruction& i, const FlowState& state);
  void Warn(const Instruction& i, ErrorCode code, Detail detail, std::string_view rule);
  void Note(const Instruction& i, ErrorCode code, Detail detail, std::string_view rule);
  std::vector<Fix> RemoveAttribute(const Instruction& i, Word word) const;

  const ParsedProgram& p_;
  const Module& module_;
  const StartModes start_;
  Findings& findings_;
  const FlyChain& chain_;
  struct Placed {
    std::uint32_t at;
    CoordType coord;
  };
  std::vector<Placed> placed_;  // MOVEs whose COORD is known, in program order
  bool default_path_told_ = false;
  bool default_coord_told_ = false;
};

}  // namespace rmlcell::optimo
