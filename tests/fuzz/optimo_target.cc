// libFuzzer targets of the Optimo language: one program each, chosen when it is compiled.
//   build/fuzz/bin/optimo_text_fuzz -max_len=4096 tests/fuzz/corpus/optimo-text
#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "tests/fuzz/optimo_language_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string wrong = rmlcell::optimo::RMLCELL_FUZZ_INPUT(
      std::string_view(reinterpret_cast<const char*>(data), size));
  if (wrong.empty()) return 0;
  std::fprintf(stderr, "%s\n", wrong.c_str());
  __builtin_trap();
}
