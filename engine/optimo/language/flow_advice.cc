#include "engine/optimo/language/flow_advice.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "engine/optimo/language/dwells.h"
#include "engine/optimo/language/flow_graph.h"
#include "engine/optimo/language/flow_state.h"
#include "engine/optimo/language/flow_walk.h"
#include "engine/optimo/language/fly_chain.h"
#include "engine/optimo/language/gosub_depth.h"
#include "engine/optimo/language/move_advice.h"

namespace rmlcell::optimo {
namespace {

Detail ProcessText(const Instruction& i) {
  return Told("kind", i.numbers[0]) + "," + Told("process", i.numbers[1]);
}

// Customer variables (OPT-7.104, OPT-7.105): the others have a use that other programs know, VI[1]
// as the program to go on with.
bool IsFree(const ExprNode& node) {
  switch (node.group) {
    case VariableGroup::kVr:
      return node.index <= 42;
    case VariableGroup::kVi:
      return node.index <= 69 && node.index != 1;
    default:
      return node.index <= 79;
  }
}

// Instructions of which it is not known what they do: that have an error, or a name of which
// nothing is known.
std::vector<bool> FaultyInstructions(const ParsedProgram& program) {
  const Module& module = program.module;
  std::vector<bool> faulty(module.instructions.size());
  for (const std::uint32_t at : program.faulty) faulty[at] = true;
  for (std::size_t at = 0; at < faulty.size(); ++at) {
    const Instruction& i = module.instructions[at];
    if (i.op == Op::kInvalid) faulty[at] = true;
    for (std::uint32_t e = 0; e < module.ExpressionCount(i); ++e) {
      for (const ExprNode& node : module.expression(i.first_expression + e)) {
        const bool unknown_index =
            node.index_name != kNoName && !module.names[node.index_name].declared;
        if (node.op == Node::kName || unknown_index) faulty[at] = true;
      }
    }
  }
  return faulty;
}

class FlowAdviser {
 public:
  FlowAdviser(const ParsedProgram& program, const StartModes& start, Findings& findings)
      : p_(program),
        module_(program.module),
        start_(start),
        findings_(findings),
        any_error_(findings.error_count() > 0),
        faulty_(any_error_ ? FaultyInstructions(program)
                           : std::vector<bool>(program.module.instructions.size())),
        graph_(module_),
        dwells_(module_),
        walk_(module_, graph_, dwells_, faulty_, any_error_) {}

  void Run() {
    AdviseStates();
    if (any_error_) return;  // it is not known where all of the program leads
    AdviseUnreachable();
    AdviseReturns();
    AdviseNesting();
  }

 private:
  void AdviseStates();
  void AdviseProcesses(std::uint32_t at, const FlowState& state);
  void AdviseLeaving(std::uint32_t at, const FlowState& state, ErrorCode code,
                     const std::string& what);
  void AdviseEnding(std::uint32_t at, const FlowState& state, const std::string& what);
  void AdviseEnd(std::uint32_t at, const FlowState& state);
  void AdviseSensor(const Instruction& i, const FlowState& state);
  void AdviseGas(const Instruction& i, const FlowState& state);
  void AdviseReads(const Instruction& i, const FlowState& state);
  void AdviseUnreachable();
  void AdviseReturns();
  void AdviseNesting();

  void Warn(const Instruction& i, ErrorCode code, Detail detail, std::string_view rule) {
    findings_.AddAs(Severity::kWarning, code, p_.At(i), std::move(detail), rule);
  }
  void Note(const Instruction& i, ErrorCode code, Detail detail, std::string_view rule) {
    findings_.AddAs(Severity::kAdvice, code, p_.At(i), std::move(detail), rule);
  }

  const ParsedProgram& p_;
  const Module& module_;
  const StartModes start_;
  Findings& findings_;
  const bool any_error_;
  const std::vector<bool> faulty_;
  const FlowGraph graph_;
  const Dwells dwells_;
  const FlowWalk walk_;
  VariableSet assigned_;  // somewhere in the program
  VariableSet told_;      // read, and set nowhere in the program
  std::vector<Successor> room_;
};

void FlowAdviser::AdviseStates() {
  std::vector<bool> hole_moves(graph_.size()), absol_moves(graph_.size());
  walk_.ForEachReached([&](std::uint32_t at, const FlowState& state) {
    if (module_.instructions[at].op != Op::kMove) return;
    hole_moves[at] = state.modes.path() == PathType::kHole;
    absol_moves[at] = state.modes.coord() == CoordType::kAbsol;
  });
  const FlyChain chain(module_, graph_, dwells_, hole_moves, faulty_);
  MoveAdviser moves(p_, start_, findings_, chain);
  for (const Instruction& i : module_.instructions) assigned_ |= VariablesSetBy(module_, i);
  walk_.ForEachReached([&](std::uint32_t at, const FlowState& state) {
    const Instruction& i = module_.instructions[at];
    if (!faulty_[at]) {
      AdviseProcesses(at, state);
      AdviseSensor(i, state);
      AdviseGas(i, state);
      AdviseReads(i, state);
      if (i.op == Op::kMove) moves.Advise(at, state);
    }
    AdviseEnd(at, state);
  });
  moves.AdviseRobotMoves(graph_, graph_.LeadingTo(absol_moves, true));
}

// OPT-3.09, OPT-3.24, OPT-3.33
void FlowAdviser::AdviseProcesses(std::uint32_t at, const FlowState& state) {
  const Instruction& i = module_.instructions[at];
  if (i.op == Op::kGo || i.op == Op::kCall) {
    return AdviseLeaving(at, state, ErrorCode::kWorkActiveAtCall, i.op == Op::kGo ? "GO" : "CALL");
  }
  if (i.op == Op::kEndtask) return AdviseEnding(at, state, "the end");
  if (i.op != Op::kWork) return;
  const ProcessSet bit = ProcessBit(i);
  if (i.Has(kOn)) {
    const bool needs = bit != 1 && state.KnowsWorkdefs();  // 0,0 needs none, OPT-3.10
    if (needs && (state.defined.made & bit) == 0) {
      Warn(i, ErrorCode::kWorkdefMissing,
           "no WORKDEF " + ProcessText(i) +
               " comes before this WORK, unless the program runs as a FUNCTION",
           "OPT-3.09");
    } else if (needs && (state.undefined.made & bit) != 0) {
      Warn(i, ErrorCode::kWorkdefMissing,
           "on one path no WORKDEF " + ProcessText(i) + " comes before this WORK", "OPT-3.09");
    }
  } else if (i.numbers[0] == 2 && state.BeamIsOn()) {
    Warn(i, ErrorCode::kBeamOffBySchedule, "WORK 2 OFF switches the beam off, too", "OPT-3.24");
  }
}

void FlowAdviser::AdviseLeaving(std::uint32_t at, const FlowState& state, ErrorCode code,
                                const std::string& what) {
  const ProcessSet some = state.on.made & kAllProcesses;
  if (!state.KnowsProcesses() || some == 0) return;
  const bool always = (some & ~state.off.made) != 0;
  Warn(module_.instructions[at], code,
       (always ? "a process is ON at " : "on one path a process is ON at ") + what,
       code == ErrorCode::kWorkActiveAtCall ? "OPT-3.33" : "OPT-3.34");
}

// WORK 2 has no beam, and its schedule stays selected even behind its OFF: OPT-3.23, OPT-3.26.
void FlowAdviser::AdviseEnding(std::uint32_t at, const FlowState& state, const std::string& what) {
  const bool harmless = state.KnowsProcesses() && (state.on.made & kBeamProcesses) == 0;
  if (!harmless) return AdviseLeaving(at, state, ErrorCode::kWorkActiveAtEnd, what);
  if ((state.on.made & kAllProcesses) == 0) return;
  Note(module_.instructions[at], ErrorCode::kWorkActiveAtEnd,
       "WORK 2, which has no beam, is ON at " + what + ": it does no harm", "OPT-3.34");
}

// The implied ENDTASK: reported at what comes before it.
void FlowAdviser::AdviseEnd(std::uint32_t at, const FlowState& state) {
  for (const Successor& s : graph_.From(at, room_)) {
    if (s.to != graph_.size() || (s.edge != Edge::kNext && s.edge != Edge::kJump)) continue;
    FlowState end = state;
    walk_.Pass(at, end);
    return AdviseEnding(at, end, "the end of the program");
  }
}

// At the WORK ON, and where it was switched off since: at the next MOVE. OPT-5.47
void FlowAdviser::AdviseSensor(const Instruction& i, const FlowState& state) {
  const bool switched_on =
      i.op == Op::kWork && i.Has(kOn) && i.numbers[0] != 2 &&
      state.sensor.IsAmong(Choice<Sensor>::Bits({Sensor::kOff, Sensor::kOffSeen}));
  const bool cuts = i.op == Op::kMove && state.BeamIsOn() && state.sensor.Is(Sensor::kOff);
  if (!switched_on && !cuts) return;
  Warn(i, ErrorCode::kPracticeAdvice, "the sensor OL[11] is off while the beam cuts", "OPT-5.47");
}

// OPT-5.40: one assist gas at a time.
void FlowAdviser::AdviseGas(const Instruction& i, const FlowState& state) {
  const auto gas_2 = OutputSetBy(module_, i, kGas2Output);
  const auto gas_3 = OutputSetBy(module_, i, kGas3Output);
  if (gas_2 == Output::kOn && gas_3 == Output::kOn)
    return Warn(i, ErrorCode::kGasConflict, "this switches both assist gases on", "OPT-5.40");
  const auto tell = [&](const Choice<Output>& other) {
    if (!other.MayBe(Output::kOn)) return;
    Warn(i, ErrorCode::kGasConflict,
         other.Is(Output::kOn) ? "the other assist gas is on"
                               : "on one path the other assist gas is on",
         "OPT-5.40");
  };
  if (gas_2 == Output::kOn && !gas_3) tell(state.gas_3);
  if (gas_3 == Output::kOn && !gas_2) tell(state.gas_2);
}

// A variable that the program sets itself, but not on every path before it reads it; or that
// nothing in it sets. OPT-1.17
void FlowAdviser::AdviseReads(const Instruction& i, const FlowState& state) {
  if (i.op == Op::kDeclare) return;
  const std::uint32_t first = i.op == Op::kLet || i.op == Op::kAssign ? 1 : 0;
  for (std::uint32_t e = first; e < module_.ExpressionCount(i); ++e) {
    for (const ExprNode& node : module_.expression(i.first_expression + e)) {
      const auto variable = OwnVariable(node);
      if (!variable || !state.unset.made.test(*variable)) continue;
      if (assigned_.test(*variable)) {
        return Note(i, ErrorCode::kPracticeAdvice,
                    ToldVariable(node.variable()) + " is read before the program sets it",
                    "OPT-1.17");
      }
      if (!IsFree(node) || told_.test(*variable)) continue;
      told_.set(*variable);
      Note(i, ErrorCode::kPracticeAdvice,
           ToldVariable(node.variable()) + " is read, and nothing in this program sets it",
           "OPT-1.17");
    }
  }
}

void FlowAdviser::AdviseUnreachable() {
  std::vector<bool> reached(graph_.size());
  walk_.ForEachReached([&](std::uint32_t at, const FlowState&) { reached[at] = true; });
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
  const auto has = [&](auto is) { return std::ranges::any_of(module_.instructions, is); };
  const bool calls = has([](const Instruction& i) { return i.op == Op::kGosub; });
  const bool entry = has([](const Instruction& i) { return i.op == Op::kTask; });
  for (std::uint32_t at = 0; at < graph_.size(); ++at) {
    if (!level[at] || module_.instructions[at].op != Op::kReturn) continue;
    if (calls) {
      Note(module_.instructions[at], ErrorCode::kReturnWithoutGosub,
           "the program can run into this RETURN without GOSUB; ENDTASK may be missing before the "
           "subroutine",
           "OPT-7.22");
    } else if (!entry) {  // TASK 1 is the mark of a FUNCTION, OPT-9.11
      Note(module_.instructions[at], ErrorCode::kReturnWithoutGosub,
           "no GOSUB leads to this RETURN: it ends a FUNCTION, and is an error in other programs",
           "OPT-7.22");
    }
  }
  std::vector<bool> is_return;
  for (const Instruction& i : module_.instructions) is_return.push_back(i.op == Op::kReturn);
  const std::vector<bool> returns = graph_.LeadingTo(is_return, false);
  for (const std::uint32_t at : graph_.subroutines()) {
    if (returns[at] || at == graph_.size()) continue;
    Note(module_.instructions[at], ErrorCode::kPracticeAdvice,
         "this subroutine never comes to a RETURN", "OPT-7.20");
  }
}

// OPT-7.21. The depth of a ring depends on its conditions, so that is only said.
void FlowAdviser::AdviseNesting() {
  if (graph_.subroutines().empty()) return;
  std::vector<LevelEdge> edges;
  for (std::uint32_t at = 0; at < graph_.size(); ++at) {
    for (const Successor& s : graph_.From(at, room_)) {
      if (s.edge != Edge::kTimed) edges.push_back({at, s.to, s.edge == Edge::kCall});
    }
  }
  const GosubNesting nesting = FindNesting(graph_.size() + 1U, graph_.entry(), edges);
  for (const std::uint32_t at : nesting.too_deep) {
    Warn(module_.instructions[at], ErrorCode::kGosubTooDeep,
         "this GOSUB can be the " + Told("level", kGosubDepthStandard + 1) + "th inside another",
         "OPT-7.21");
  }
  for (const std::uint32_t at : nesting.recursive) {
    Note(module_.instructions[at], ErrorCode::kGosubTooDeep,
         "the subroutine calls itself here; at most " + Told("limit", kGosubDepthStandard) +
             " GOSUBs run inside each other",
         "OPT-7.21");
  }
}

}  // namespace

void AdviseOnFlow(const ParsedProgram& program, const StartModes& start, Findings& findings) {
  const std::size_t count = program.module.instructions.size();
  if (count == 0 || count > kFlowInstructionsMax) return;
  FlowAdviser(program, start, findings).Run();
}

}  // namespace rmlcell::optimo
