#include "tests/server/engine_bytes.h"

#include <stdexcept>

#include "engine/families/families.h"
#include "engine/machine/observer.h"
#include "engine/machine/run.h"

namespace rmlcell::server {

std::string ObjectOf(const std::string& source) {
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  machine::Translation translation = family.Translate({.name = "a.S", .bytes = source},
                                                      machine::Parameters(family.parameters()), {});
  if (!translation.ok) throw std::runtime_error("does not compile: " + source);
  return std::move(translation.object);
}

std::string ExecutableOf(int slot, const std::string& source) {
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  machine::RunSetup setup{machine::Parameters(family.parameters())};
  setup.programs[slot].object = machine::Bytes::Of(ObjectOf(source));
  setup.main_program = slot;
  machine::RunObserver observer;
  auto run = family.NewRun(std::move(setup), observer);
  if (!run) throw std::runtime_error(run.error().detail);
  (*run)->Advance(kForever);
  return (*run)->made_executables().at(slot);
}

}  // namespace rmlcell::server
