// libFuzzer target of the reader of profile files.
//   build/fuzz/bin/profile_fuzz -max_len=4096 tests/fuzz/corpus/profile
#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "tests/fuzz/profile_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string wrong =
      rmlcell::machine::TryProfile(std::string_view(reinterpret_cast<const char*>(data), size));
  if (wrong.empty()) return 0;
  std::fprintf(stderr, "%s\n", wrong.c_str());
  __builtin_trap();
}
