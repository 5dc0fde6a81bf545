// libFuzzer target of the language server.
//   build/fuzz/bin/lsp_fuzz -max_len=4096 tests/fuzz/corpus/lsp
#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "tests/fuzz/lsp_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string wrong =
      rmlcell::lsp::TryLsp(std::string_view(reinterpret_cast<const char*>(data), size));
  if (wrong.empty()) return 0;
  std::fprintf(stderr, "%s\n", wrong.c_str());
  __builtin_trap();
}
