// libFuzzer target of objects and executables that are run.
//   build/fuzz/bin/optimo_run_fuzz -max_len=4096 tests/fuzz/corpus/optimo-run
#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "tests/fuzz/optimo_run_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string wrong =
      rmlcell::optimo::TryObjectRun(std::string_view(reinterpret_cast<const char*>(data), size));
  if (wrong.empty()) return 0;
  std::fprintf(stderr, "%s\n", wrong.c_str());
  __builtin_trap();
}
