// libFuzzer: fuzz_web_decode tests/server/web/corpus
#include <cstddef>
#include <cstdint>

#include "tests/server/web/decode_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rmlcell::web::testing::DecodeAnything({reinterpret_cast<const char*>(data), size});
  return 0;
}
