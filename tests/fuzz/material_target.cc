// libFuzzer target of what reads blocks, tools and targets of mills.
//   build/fuzz/bin/material_fuzz -max_len=4096 tests/fuzz/corpus/material
#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "tests/fuzz/material_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string wrong =
      rmlcell::simulation::TryMaterial(std::string_view(reinterpret_cast<const char*>(data), size));
  if (wrong.empty()) return 0;
  std::fprintf(stderr, "%s\n", wrong.c_str());
  __builtin_trap();
}
