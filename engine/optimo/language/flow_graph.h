#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/optimo/language/ast.h"

// Which instruction may follow which. Private to the folder.
namespace rmlcell::optimo {

// Larger programs are not followed along their flow: no object of 34,000 bytes has as many records.
inline constexpr std::size_t kFlowInstructionsMax = 40'000;

enum class Edge : std::uint8_t {
  kNext,     // the instruction behind it
  kJump,     // GOTO, IF
  kCall,     // GOSUB to its target
  kHandler,  // ERR: an error between here and NOERR continues there
  kTimed,    // /TIME, TIMER: a GOSUB that comes at any time
};
struct Successor {
  std::uint32_t to = 0;  // the number of instructions stands for the end of the program
  Edge edge = Edge::kNext;
};

class FlowGraph {
 public:
  explicit FlowGraph(const Module& module);

  // Precondition: instruction < size. Jumps to sequence numbers that do not exist have no
  // successor.
  const std::vector<Successor>& From(std::uint32_t instruction, std::vector<Successor>& room) const;

  std::uint32_t size() const { return static_cast<std::uint32_t>(module_.instructions.size()); }
  std::uint32_t entry() const { return index_.entry(); }
  // Where a basic block begins.
  bool IsLeader(std::uint32_t instruction) const { return leaders_[instruction]; }
  // Targets of GOSUB, each once, ascending.
  const std::vector<std::uint32_t>& subroutines() const { return subroutines_; }

  // What can be reached from `from` on one GOSUB level: calls are stepped over.
  std::vector<bool> ReachOnLevel(std::uint32_t from) const;

 private:
  const Module& module_;
  ModuleIndex index_;
  std::vector<bool> leaders_;
  std::vector<std::uint32_t> subroutines_;
};

}  // namespace rmlcell::optimo
