#include "engine/optimo/language/dwells.h"

#include "engine/optimo/language/flow_state.h"

namespace rmlcell::optimo {

Dwells::Dwells(const Module& module) {
  std::array<bool, 10> some{}, none{};
  for (const Instruction& i : module.instructions) {
    if (i.op != Op::kWorkdef || i.numbers[0] != 1) continue;
    const auto delay = LiteralValueOf(module.Value(i, 2));
    const std::size_t process = i.numbers[1];
    some[process] = some[process] || !delay || *delay > 0.0F;
    none[process] = none[process] || !delay || *delay == 0.0F;
  }
  for (std::size_t p = 0; p < kinds_.size(); ++p) {
    kinds_[p] = some[p] == none[p] ? Kind::kNotKnown : some[p] ? Kind::kSome : Kind::kNone;
  }
}

}  // namespace rmlcell::optimo
