// libFuzzer target of the keys of a handbox, over the time of the machine.
//   build/fuzz/bin/machine_keys_fuzz -max_len=512 tests/fuzz/corpus/machine-keys
#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "tests/fuzz/machine_acts_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string wrong =
      rmlcell::machine::TryKeys(std::string_view(reinterpret_cast<const char*>(data), size));
  if (wrong.empty()) return 0;
  std::fprintf(stderr, "%s\n", wrong.c_str());
  __builtin_trap();
}
