#include "engine/optimo/language/flow_advice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <string>
#include <utility>

#include "engine/optimo/language/flow_graph.h"
#include "engine/optimo/language/flow_state.h"
#include "engine/optimo/language/fly_chain.h"
#include "engine/optimo/language/gosub_depth.h"
#include "engine/optimo/language/move_advice.h"

namespace rmlcell::optimo {
namespace {

constexpr std::uint64_t kSubroutineWorkMax =
    20'000'000;  // instructions looked at; beyond: nothing known

std::string ProcessText(const Instruction& i) {
  return std::to_string(i.numbers[0]) + "," + std::to_string(i.numbers[1]);
}

class FlowAdviser {
 public:
  FlowAdviser(const ParsedProgram& program, Findings& findings)
      : p_(program), module_(program.module), findings_(findings), graph_(module_) {}

  void Run() {
    FollowSubroutines();
    FollowStates();
    hole_moves_.resize(graph_.size());
    ForEachReached([&](std::uint32_t at, const FlowState& state) {
      hole_moves_[at] = module_.instructions[at].op == Op::kMove && state.path == PathType::kHole;
    });
    const FlyChain chain(module_, graph_, hole_moves_);
    MoveAdviser moves(p_, findings_, chain);
    FindAssigned();
    ForEachReached([&](std::uint32_t at, const FlowState& state) {
      AdviseProcesses(at, state);
      AdviseGas(at, state);
      AdviseReads(at, state);
      if (module_.instructions[at].op == Op::kMove) moves.Advise(at, state);
    });
    moves.AdviseRobotMoves();
    AdviseEnds();
    AdviseUnreachable();
    AdviseReturns();
    AdviseNesting();
  }

 private:
  void FollowSubroutines();
  void FollowStates();
  void FindAssigned();
  void AdviseProcesses(std::uint32_t at, const FlowState& state);
  void AdviseLeaving(std::uint32_t at, const FlowState& state, ErrorCode code,
                     const std::string& what);
  void AdviseGas(std::uint32_t at, const FlowState& state);
  void AdviseReads(std::uint32_t at, const FlowState& state);
  void AdviseEnds();
  void AdviseUnreachable();
  void AdviseReturns();
  void AdviseNesting();

  // Calls visit(instruction, state before it) for everything that can be reached, in program order.
  template <class Visit>
  void ForEachReached(Visit visit) {
    FlowState state;
    for (std::uint32_t at = 0; at < graph_.size(); ++at) {
      if (graph_.IsLeader(at)) state = states_[at];
      if (!state.reached) continue;
      visit(at, std::as_const(state));
      const bool flows_on = Pass(at, state);
      if (!flows_on) state.reached = false;
    }
  }

  // Over one instruction; false when nothing goes on to the next one.
  bool Pass(std::uint32_t at, FlowState& state) {
    const Instruction& i = module_.instructions[at];
    Step(module_, at, state);
    if (i.op == Op::kGosub) {
      Forget(TouchedInSubroutine(at), state);
      state.set.set();
    }
    for (const Successor& s : graph_.From(at, room_)) {
      if (s.edge == Edge::kNext) return true;
    }
    return false;
  }

  // The subroutine that a GOSUB calls; nothing for other instructions and missing numbers.
  std::optional<std::size_t> Called(std::uint32_t at) const {
    if (module_.instructions[at].op != Op::kGosub) return std::nullopt;
    std::vector<Successor> room;
    for (const Successor& s : graph_.From(at, room)) {
      if (s.edge != Edge::kCall) continue;
      const auto found = std::ranges::lower_bound(graph_.subroutines(), s.to);
      return static_cast<std::size_t>(found - graph_.subroutines().begin());
    }
    return std::nullopt;
  }

  std::uint16_t TouchedInSubroutine(std::uint32_t gosub) const {
    const auto called = Called(gosub);
    if (!called) return 0;
    return touched_.empty() ? std::uint16_t{kTouchesAll} : touched_[*called];
  }

  void Warn(const Instruction& i, ErrorCode code, std::string detail, std::string_view rule) {
    findings_.AddAs(Severity::kWarning, code, p_.At(i), std::move(detail), rule);
  }
  void Note(const Instruction& i, ErrorCode code, std::string detail, std::string_view rule) {
    findings_.AddAs(Severity::kAdvice, code, p_.At(i), std::move(detail), rule);
  }

  const ParsedProgram& p_;
  const Module& module_;
  Findings& findings_;
  FlowGraph graph_;
  std::vector<FlowState> states_;              // of leaders; the last one is the end of the program
  std::vector<std::uint16_t> touched_;         // by subroutine; empty: not known
  std::vector<bool> returns_;                  // by subroutine: it reaches a RETURN
  std::vector<std::vector<GosubCall>> calls_;  // by subroutine
  std::vector<bool> hole_moves_;
  std::bitset<kOwnVariables> assigned_;  // somewhere in the program
  std::vector<Successor> room_;
};

// What a GOSUB may change, its own GOSUBs included.
void FlowAdviser::FollowSubroutines() {
  const auto& subroutines = graph_.subroutines();
  if (subroutines.size() * std::uint64_t{graph_.size()} > kSubroutineWorkMax) return;
  calls_.resize(subroutines.size());
  for (std::size_t s = 0; s < subroutines.size(); ++s) {
    std::uint16_t touched = 0;
    bool returns = false;
    const std::vector<bool> reached = graph_.ReachOnLevel(subroutines[s]);
    for (std::uint32_t at = 0; at < graph_.size(); ++at) {
      if (!reached[at]) continue;
      const Instruction& i = module_.instructions[at];
      touched |= TouchedBy(i);
      returns = returns || i.op == Op::kReturn;
      if (const auto called = Called(at)) calls_[s].push_back({at, *called});
    }
    touched_.push_back(touched);
    returns_.push_back(returns);
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t s = 0; s < calls_.size(); ++s) {
      for (const GosubCall& call : calls_[s]) {
        const auto merged = static_cast<std::uint16_t>(touched_[s] | touched_[call.to]);
        changed = changed || merged != touched_[s];
        touched_[s] = merged;
      }
    }
  }
}

void FlowAdviser::FollowStates() {
  states_.resize(graph_.size() + 1U);
  std::deque<std::uint32_t> open;
  std::vector<bool> waiting(states_.size());
  const auto enter = [&](std::uint32_t at, const FlowState& state) {
    if (!Merge(states_[at], state) || waiting[at]) return;
    waiting[at] = true;
    open.push_back(at);
  };
  enter(graph_.entry(), FlowState::AtStart());
  while (!open.empty()) {
    std::uint32_t at = open.front();
    open.pop_front();
    waiting[at] = false;
    FlowState state = states_[at];
    while (at < graph_.size()) {
      const std::vector<Successor> successors = graph_.From(at, room_);
      const FlowState before = state;
      const bool flows_on = Pass(at, state);
      for (const Successor& s : successors) {
        if (s.edge == Edge::kJump) enter(s.to, state);
        if (s.edge == Edge::kCall) enter(s.to, before);
        if (s.edge == Edge::kHandler) enter(s.to, FlowState::InErrorHandler());
        if (s.edge == Edge::kTimed) enter(s.to, FlowState::Nothing());
      }
      if (!flows_on) break;
      ++at;
      if (at == graph_.size() || graph_.IsLeader(at)) {
        enter(at, state);
        break;
      }
    }
  }
}

// OPT-3.09, OPT-3.24, OPT-3.33
void FlowAdviser::AdviseProcesses(std::uint32_t at, const FlowState& state) {
  const Instruction& i = module_.instructions[at];
  if (i.op == Op::kGo || i.op == Op::kCall) {
    return AdviseLeaving(at, state, ErrorCode::kWorkActiveAtCall, i.op == Op::kGo ? "GO" : "CALL");
  }
  if (i.op == Op::kEndtask) return AdviseLeaving(at, state, ErrorCode::kWorkActiveAtEnd, "the end");
  if (i.op != Op::kWork) return;
  const ProcessSet bit = ProcessBit(i);
  if (i.Has(kOn)) {
    const bool needs = bit != 1 && state.processes_known;  // 0,0 needs none, OPT-3.10
    if (needs && (state.defined_some & bit) == 0) {
      Warn(i, ErrorCode::kWorkdefMissing,
           "no WORKDEF " + ProcessText(i) +
               " comes before this WORK, unless the program runs as a FUNCTION",
           "OPT-3.09");
    } else if (needs && (state.defined_all & bit) == 0) {
      Warn(i, ErrorCode::kWorkdefMissing,
           "on one path no WORKDEF " + ProcessText(i) + " comes before this WORK", "OPT-3.09");
    }
    const bool cuts = i.numbers[0] != 2;
    if (cuts && state.sensor == Known::kNo) {
      Warn(i, ErrorCode::kPracticeAdvice, "the sensor OL[11] is off while the beam cuts",
           "OPT-5.47");
    }
  } else if (i.numbers[0] == 2 && state.beam == Known::kYes) {
    Warn(i, ErrorCode::kBeamOffBySchedule, "WORK 2 OFF switches the beam off, too", "OPT-3.24");
  }
}

void FlowAdviser::AdviseLeaving(std::uint32_t at, const FlowState& state, ErrorCode code,
                                const std::string& what) {
  if (!state.processes_known || state.on_some == 0) return;
  const std::string path =
      state.on_all != 0 ? "a process is ON at " : "on one path a process is ON at ";
  const char* rule = code == ErrorCode::kWorkActiveAtCall ? "OPT-3.33" : "OPT-3.34";
  if (at < graph_.size()) return Warn(module_.instructions[at], code, path + what, rule);
  // The implied ENDTASK: reported at the last instruction.
  if (graph_.size() > 0)
    Warn(module_.instructions.back(), code, path + what + " of the program", rule);
}

void FlowAdviser::AdviseEnds() {
  const FlowState& end = states_.back();
  if (end.reached) AdviseLeaving(graph_.size(), end, ErrorCode::kWorkActiveAtEnd, "the end");
}

// OPT-5.40: one assist gas at a time.
void FlowAdviser::AdviseGas(std::uint32_t at, const FlowState& state) {
  const Instruction& i = module_.instructions[at];
  if (i.op != Op::kLet) return;
  const ExprNode& target = module_.Value(i, 0)[0];
  const auto value = LiteralValueOf(module_.Value(i, 1));
  if (target.op != Node::kVariable || target.group != VariableGroup::kOl || !value ||
      *value == 0.0F)
    return;
  const bool second = (target.index == 8 && state.gas_3 == Known::kYes) ||
                      (target.index == 9 && state.gas_2 == Known::kYes);
  if (second) Warn(i, ErrorCode::kGasConflict, "the other assist gas is on", "OPT-5.40");
}

void FlowAdviser::FindAssigned() {
  for (const Instruction& i : module_.instructions) {
    if (i.op != Op::kLet) continue;
    if (const auto variable = OwnVariable(module_.Value(i, 0)[0])) assigned_.set(*variable);
  }
}

// A variable that the program sets itself, but not on every path before it reads it. OPT-1.17
void FlowAdviser::AdviseReads(std::uint32_t at, const FlowState& state) {
  const Instruction& i = module_.instructions[at];
  if (i.op == Op::kDeclare) return;
  const std::uint32_t first = i.op == Op::kLet || i.op == Op::kAssign ? 1 : 0;
  for (std::uint32_t e = first; e < module_.ExpressionCount(i); ++e) {
    for (const ExprNode& node : module_.expression(i.first_expression + e)) {
      const auto variable = OwnVariable(node);
      if (!variable || !assigned_.test(*variable) || state.set.test(*variable)) continue;
      return Note(i, ErrorCode::kPracticeAdvice,
                  std::string(GroupName(node.group)) + "[" + std::to_string(node.index) +
                      "] is read before the program sets it",
                  "OPT-1.17");
    }
  }
}

void FlowAdviser::AdviseUnreachable() {
  std::vector<bool> reached(graph_.size());
  ForEachReached([&](std::uint32_t at, const FlowState&) { reached[at] = true; });
  bool reported = false;  // of this run of instructions
  for (std::uint32_t at = 0; at < graph_.size(); ++at) {
    const Instruction& i = module_.instructions[at];
    if (i.op == Op::kDeclare || i.op == Op::kDefine) continue;
    if (reached[at]) {
      reported = false;
    } else if (i.op != Op::kEndtask && !std::exchange(reported, true)) {
      Note(i, ErrorCode::kPracticeAdvice, "this is never reached", "OPT-3.47");
    }
  }
}

// OPT-7.20 to 7.22
void FlowAdviser::AdviseReturns() {
  const std::vector<bool> level = graph_.ReachOnLevel(graph_.entry());
  bool calls = false;
  for (const Instruction& i : module_.instructions) calls = calls || i.op == Op::kGosub;
  for (std::uint32_t at = 0; calls && at < graph_.size(); ++at) {
    if (!level[at] || module_.instructions[at].op != Op::kReturn) continue;
    Note(module_.instructions[at], ErrorCode::kReturnWithoutGosub,
         "the program can run into this RETURN without GOSUB; ENDTASK may be missing before the "
         "subroutine",
         "OPT-7.22");
  }
  for (std::size_t s = 0; s < returns_.size(); ++s) {
    const std::uint32_t at = graph_.subroutines()[s];
    if (returns_[s] || at == graph_.size()) continue;
    Note(module_.instructions[at], ErrorCode::kPracticeAdvice,
         "this subroutine never comes to a RETURN", "OPT-7.20");
  }
}

// OPT-7.21. The depth of a ring depends on its conditions, so that is only said.
void FlowAdviser::AdviseNesting() {
  if (returns_.size() != graph_.subroutines().size()) return;  // not followed
  std::vector<GosubCall> main;
  const std::vector<bool> level = graph_.ReachOnLevel(graph_.entry());
  for (std::uint32_t at = 0; at < graph_.size(); ++at) {
    if (!level[at]) continue;
    if (const auto called = Called(at)) main.push_back({at, *called});
  }
  const GosubNesting nesting = FindNesting(main, calls_);
  for (const std::uint32_t at : nesting.too_deep) {
    Warn(module_.instructions[at], ErrorCode::kGosubTooDeep,
         "this GOSUB can be the " + std::to_string(kGosubDepthStandard + 1) + "th inside another",
         "OPT-7.21");
  }
  for (const std::uint32_t at : nesting.recursive) {
    Note(module_.instructions[at], ErrorCode::kGosubTooDeep,
         "the subroutine calls itself here; at most " + std::to_string(kGosubDepthStandard) +
             " GOSUBs run inside each other",
         "OPT-7.21");
  }
}

}  // namespace

void AdviseOnFlow(const ParsedProgram& program, Findings& findings) {
  const std::size_t count = program.module.instructions.size();
  if (count == 0 || count > kFlowInstructionsMax || findings.error_count() > 0) return;
  FlowAdviser(program, findings).Run();
}

}  // namespace rmlcell::optimo
