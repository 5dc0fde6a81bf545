// libFuzzer target of the tools for streams.
//   build/fuzz/bin/rml1_png_fuzz -max_len=4096 tests/fuzz/corpus/rml1-png
#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "tests/fuzz/rml1_tools_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string wrong =
      rmlcell::rml1::TryPng(std::string_view(reinterpret_cast<const char*>(data), size));
  if (wrong.empty()) return 0;
  std::fprintf(stderr, "%s\n", wrong.c_str());
  __builtin_trap();
}
