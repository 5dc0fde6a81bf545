#include "tests/engine/rml1/run_support.h"

#include <fstream>
#include <sstream>

#include "engine/core/check.h"
#include "engine/rml1/rml1_family.h"

namespace rmlcell::rml1 {

machine::RunSetup SetupOf(const machine::Parameters& parameters, std::string stream) {
  machine::RunSetup setup(parameters);
  setup.main_program = 1;
  setup.programs[1] = {
      .name = "test", .object = machine::Bytes::Of(std::move(stream)), .executable = nullptr};
  return setup;
}

TestRun::TestRun(machine::RunSetup setup)
    : run_(Rml1Family().NewRun(std::move(setup), record_).value()) {}

TestRun::TestRun(const machine::Parameters& parameters, std::string stream,
                 machine::InputScript inputs)
    : TestRun([&] {
        machine::RunSetup setup = SetupOf(parameters, std::move(stream));
        setup.inputs = std::move(inputs);
        return setup;
      }()) {}

machine::Parameters ParametersOf(std::string_view profile_id) {
  const machine::MachineFamily& family = Rml1Family();
  machine::Parameters parameters(family.parameters());
  for (const machine::MachineProfile& profile : family.profiles()) {
    if (profile.id == profile_id) {
      RMLCELL_CHECK(parameters.Apply(profile).ok());
      return parameters;
    }
  }
  CheckFailed("no such profile", __FILE__, __LINE__);
}

std::string ReadFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

}  // namespace rmlcell::rml1
