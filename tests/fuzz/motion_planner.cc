// libFuzzer target: any bytes as a chain of moves give an error or a plan, never a hang or a number
// that is none.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/motion_planner_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (!rmlcell::motion::PlanBytes({data, size}).empty()) __builtin_trap();
  return 0;
}
