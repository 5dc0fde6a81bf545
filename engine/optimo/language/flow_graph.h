#pragma once

#include <cstdint>
#include <optional>
#include <span>
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

// Which instructions an edge leads from to each one, those with several edges several times.
class Predecessors {
 public:
  explicit Predecessors(const class FlowGraph& graph);

  // `to` may be the number of instructions: the end of the program.
  std::span<const std::uint32_t> Of(std::uint32_t to) const {
    return {sources_.data() + first_[to], first_[to + 1U] - first_[to]};
  }

 private:
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> sources_;
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

  // Where a GOSUB, /TIME or TIMER goes; nothing for other instructions, and when the program does
  // not have the sequence number.
  std::optional<std::uint32_t> Called(std::uint32_t instruction) const;

  // What can be reached from `from` on one GOSUB level: calls are stepped over.
  std::vector<bool> ReachOnLevel(std::uint32_t from) const;
  // From where one of the `goals` (by instruction) can be reached on one GOSUB level; with `calls`,
  // also inside what is called on the way.
  std::vector<bool> LeadingTo(const std::vector<bool>& goals, bool calls) const;

 private:
  const Module& module_;
  ModuleIndex index_;
  std::vector<bool> leaders_;
  std::vector<std::uint32_t> subroutines_;
};

}  // namespace rmlcell::optimo
