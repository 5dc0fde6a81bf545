// libFuzzer target of messages of a server to a host, in the preset fuzz-server.
//   build/fuzz-server/bin/host_messages_fuzz -max_len=4096 tests/fuzz/corpus/host-messages
#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "tests/fuzz/host_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string wrong =
      rmlcell::server::TryHostMessages(std::string_view(reinterpret_cast<const char*>(data), size));
  if (wrong.empty()) return 0;
  std::fprintf(stderr, "%s\n", wrong.c_str());
  __builtin_trap();
}
