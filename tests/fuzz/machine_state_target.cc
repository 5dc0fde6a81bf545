// libFuzzer target of the reader of machine states.
//   build/fuzz/bin/machine_state_fuzz -max_len=8192 tests/fuzz/corpus/machine-state
#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "tests/fuzz/machine_state_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string wrong = rmlcell::machine::TryMachineState(
      std::string_view(reinterpret_cast<const char*>(data), size));
  if (wrong.empty()) return 0;
  std::fprintf(stderr, "%s\n", wrong.c_str());
  __builtin_trap();
}
