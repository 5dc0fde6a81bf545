#include "engine/machine/machine.h"
#include "engine/machine/program_file.h"

// What is put into the memory of a machine and taken out of it.
namespace rmlcell::machine {

Status Machine::Act(const StoreProgram& input) {
  if (!IsSlot(input.slot))
    return Error{family_.info().no_slot,
                 "program " + Told("program", input.slot) + ", allowed are 1 to 99",
                 {}};
  memory_.programs[input.slot] = input.program;
  memory_.deleted.erase(input.slot);
  changed_.insert(input.slot);
  const std::string_view object =
      input.program.object != nullptr ? *input.program.object : std::string_view();
  if (!EndEdit(input.slot, object)) ShowAgain(input.slot);
  return {};
}

Status Machine::Act(const DeleteProgram& input) {
  if (memory_.programs.erase(input.slot) == 0)
    return Error{family_.info().empty_slot,
                 "no program is stored in slot " + Told("program", input.slot),
                 {}};
  memory_.deleted.insert(input.slot);
  changed_.insert(input.slot);
  if (!EndEdit(input.slot, {})) ShowAgain(input.slot);
  return {};
}

Status Machine::Act(const SetSchedules& input) {
  memory_.schedules = input.schedules;
  return {};
}

std::set<int> Machine::loaded_programs() const {
  std::set<int> loaded;
  if (run_ == nullptr || (note_.by_hand && !Pauses())) return loaded;
  for (const Place& place : run_->stack()) loaded.insert(place.program);
  loaded.insert(note_.program);
  if (comes_along_) loaded.erase(note_.program);
  loaded.erase(0);
  return loaded;
}

}  // namespace rmlcell::machine
