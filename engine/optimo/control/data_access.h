#pragma once

#include <array>
#include <optional>

#include "engine/optimo/control/passage_effects.h"
#include "engine/optimo/control/plain_code.h"
#include "engine/optimo/control/program_counter.h"
#include "engine/optimo/language/evaluate.h"
#include "engine/optimo/ride/ride.h"

namespace rmlcell::optimo {

// Variables by NumberOf.
using WrittenVariables = std::array<bool, kVariableGroups * kVariablesOfGroup>;

struct DataState {
  DataArea area{};
  WrittenVariables written = WrittenByControl();  // by the run itself

  // VI[98] and VI[99], before any instruction.
  static constexpr WrittenVariables WrittenByControl() {
    WrittenVariables written{};
    written[NumberOf({VariableGroup::kVi, 98})] = true;
    written[NumberOf({VariableGroup::kVi, 99})] = true;
    return written;
  }
};

// Variables, the images of inputs and outputs, and the expressions that read them; the instructions
// LET, ASSIGN, UPDATE, IMAGE and REAL.
//
// An image follows the outside while it is connected: UPDATE ON and no IMAGE (OPT-7.98, 7.100). In
// simulation nothing outside is read or written (OPT-6.24, 6.25).
class DataAccess : private VariableAccess {
 public:
  DataAccess(DataState& state, const Situation& situation, const OptimoParameters& parameters,
             ProgramCounter& counter, const Ride& ride, PassageEffects& effects,
             machine::RunObserver& observer)
      : s_(state),
        situation_(situation),
        parameters_(parameters),
        counter_(counter),
        ride_(ride),
        effects_(effects),
        observer_(observer) {}

  // Precondition: the instruction is one of those above. Errors: of the expression,
  // IntegerOverflow, AssignGroup, Gas3NotFitted.
  Status Execute(const Instruction& i);

  // Of the module in execution. Errors: of Evaluate.
  Result<Value> Eval(Expression expression);
  Result<double> Real(Expression expression);
  // The first `count` of these expressions, in order; the rest of the array is 0.
  template <std::size_t N, class ExpressionAt>
  Result<std::array<double, N>> Reals(int count, ExpressionAt at) {
    std::array<double, N> values{};
    for (int n = 0; n < count; ++n) {
      const Expression expression = at(n);
      if (IsWrittenOut(expression)) {
        values[static_cast<std::size_t>(n)] = static_cast<double>(expression.front().number);
        continue;
      }
      const Result<double> value = Real(expression);
      if (!value) return value.error();
      values[static_cast<std::size_t>(n)] = *value;
    }
    return values;
  }
  Result<bool> Truth(ExprRange expression);
  ExprRange RangeOf(Expression expression) const;
  // To be tested later, with the PAR of now.
  Condition ConditionOf(Expression expression) const;
  Result<bool> Truth(const Condition& condition);

  // The image of an output.
  bool output(int index) const { return s_.area.ol[static_cast<std::size_t>(index)]; }
  // A value from outside, by no instruction: outputs that are connected follow now. Precondition:
  // Writable.
  void WriteFromOutside(Variable variable, float number);
  // Whether an expression of a person who watches holds, with the PAR of the module in execution.
  // Nothing is changed by it, and nobody told. An error in it: it holds, so that it is looked at.
  bool HoldsNow(const Condition& condition) const;
  // An input changes outside: IL[index], IA[index].
  void SetLogicalInput(std::size_t index, bool on) { s_.area.il_physical[index] = on; }
  void SetAnalogueInput(std::size_t index, float value) { s_.area.ia_physical[index] = value; }
  // VI[99], the number of the last error.
  void SetLastError(ErrorCode code);
  // VI[98], executions of the main program since it was selected: one more. OPT-7.70, OPT-B.63
  void CountExecution(bool selected_anew);

  // Physical outputs of these groups follow their images again: UPDATE ON, REAL, the end of a
  // simulation. Errors: Gas3NotFitted.
  Status ConnectOutputs(std::uint8_t groups);

 private:
  // Most numbers of a program stand there as they are.
  static bool IsWrittenOut(Expression expression) {
    return expression.size() == 1 && expression.front().op != Node::kVariable;
  }
  float Read(Variable variable) override;
  const float* Known(Variable variable) const;
  std::optional<float> SumOfKnown(Expression expression) const;
  float ValueOf(Variable variable);
  float Peek(Variable variable) const;
  bool IsOfTheRun(Variable variable) const;
  void TellAssumed(Variable variable, float value) const;
  Status Write(Variable variable, float number);
  Status Put(Variable variable, float number, PassageEffects::When when);
  Status SetOutput(int index, bool on, PassageEffects::When when = PassageEffects::When::kPassage);
  Status Let(const Instruction& i);
  Status Assign(const Instruction& i);
  Status SetGroups(const Instruction& i);
  double InputNow(VariableGroup group, int index) const;
  bool Connected(std::uint8_t group) const;

  DataState& s_;
  const Situation& situation_;
  const OptimoParameters& parameters_;
  ProgramCounter& counter_;
  const Ride& ride_;
  PassageEffects& effects_;
  machine::RunObserver& observer_;
};

}  // namespace rmlcell::optimo
