#pragma once

#include <array>
#include <optional>

#include "engine/optimo/control/data_access.h"
#include "engine/optimo/control/passage_effects.h"
#include "engine/optimo/control/program_counter.h"
#include "engine/optimo/control/waits.h"
#include "engine/optimo/machine/telling.h"

namespace rmlcell::optimo {

// Instructions that decide what is carried out next, and when: GOTO, GOSUB, IF, FUNCTION, CALL,
// ERR, NOERR, TIMER, DELAY, WAIT; SETERR. What they change is the program counter's and the waits':
// nothing is kept here.
class Flow {
 public:
  Flow(const Situation& situation, const OptimoParameters& parameters, SystemCycle cycle,
       const Telling& telling, ProgramCounter& counter, DataAccess& data, PassageEffects& effects,
       Waits& waits)
      : situation_(situation),
        parameters_(parameters),
        cycle_(cycle),
        telling_(telling),
        counter_(counter),
        data_(data),
        effects_(effects),
        waits_(waits) {}

  // Precondition: the instruction is one of those above. It may begin a wait.
  Status Execute(const Instruction& i);

  // Of CALL and GO. Errors: of the expression, IntegerOverflow, ProgramNumber.
  Result<int> ProgramNumber(Expression expression);

 private:
  using Parameters = std::array<float, kParameterCount>;

  Status GotoTable(const Instruction& i);
  Status If(const Instruction& i);
  Status CallFunction(const Instruction& i);
  Status CallProgram(const Instruction& i);
  Result<Parameters> PassParameters(const Instruction& i, const Module& callee);
  Status SetTimer(const Instruction& i);
  Status Delay(const Instruction& i);
  Status WaitFor(const Instruction& i);
  Status TellError(const Instruction& i);

  const Situation& situation_;
  const OptimoParameters& parameters_;
  const SystemCycle cycle_;
  const Telling& telling_;
  ProgramCounter& counter_;
  DataAccess& data_;
  PassageEffects& effects_;
  Waits& waits_;
};

}  // namespace rmlcell::optimo
