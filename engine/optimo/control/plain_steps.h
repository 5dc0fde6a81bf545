#pragma once

#include <cstdint>

#include "engine/optimo/control/data_access.h"
#include "engine/optimo/control/program_counter.h"
#include "engine/optimo/machine/telling.h"

namespace rmlcell::optimo {

// Plain steps one after the other (plain_code.h), as Fetch carries them out where there is nothing
// else to look at between them: no key, wait, motion or mode has anything to do with them. Whatever
// is not as usual is left to Fetch before anything of the step was done: an error, a variable that
// the run has not set, the end of a module.
class PlainSteps {
 public:
  PlainSteps(ProgramCounter& counter, DataState& data, Situation& situation,
             const OptimoParameters& parameters, const Telling& telling)
      : counter_(counter),
        data_(data),
        situation_(situation),
        parameters_(parameters),
        telling_(telling) {}

  // Whether the next instruction is one.
  bool come() const;

  struct Done {
    std::uint64_t steps = 0;
    Op last = Op::kInvalid;
  };
  // At most so many, from the next instruction on. Precondition: no TIMER of the program is set,
  // and no GOSUB of it is due.
  Done CarryOut(std::uint64_t most);

 private:
  ProgramCounter& counter_;
  DataState& data_;
  Situation& situation_;
  const OptimoParameters& parameters_;
  const Telling& telling_;
};

}  // namespace rmlcell::optimo
