#include "tests/fuzz/machine_state_input.h"

#include "engine/families/families.h"
#include "engine/machine/machine.h"
#include "engine/machine/parameters.h"

namespace rmlcell::machine {
namespace {

std::string TryOn(const MachineFamily& family, std::string_view program, std::string_view bytes) {
  const std::string id(family.info().id);
  const Parameters parameters =
      *MakeParameters(family, std::string(family.info().default_profile), {});
  RunObserver nobody;
  MachineMemory memory;
  Translation made = family.Translate({.name = "a", .bytes = program}, parameters, {});
  memory.programs[1].object = Bytes::Of(ObjectOf(std::move(made), program));
  const auto read = Machine::Make(family, parameters, memory, bytes, nobody);
  if (!read) {
    const bool known = read.error().code == ErrorCode::kCellBadText ||
                       read.error().code == ErrorCode::kCellInvalidArgument;  // a breakpoint
    return known ? "" : id + ": refused with " + CodeText(read.error().code);
  }
  Machine& machine = **read;
  const std::string saved = machine.Save();
  const auto again = Machine::Make(family, parameters, memory, saved, nobody);
  if (!again || (*again)->Save() != saved) return id + ": what it saves is not what it reads";
  (void)machine.Apply(ChangeMode{Mode::kRemote});
  (void)machine.Apply(StartRun{.program = 1, .unzeroed = true});
  const SimTime now = machine.time();
  if (now > kForever / 2) return {};
  machine.Advance(now + SimTime(1));
  return {};
}

}  // namespace

std::string TryMachineState(std::string_view bytes) {
  const std::string wrong =
      TryOn(*families::FindFamily("optimo"), "COORD ABSOL\nMOVE (10.,20.,-400.,0.,0.)\n", bytes);
  if (!wrong.empty()) return wrong;
  return TryOn(*families::FindFamily("rml1"), "PU100,100;PD200,200;", bytes);
}

}  // namespace rmlcell::machine
