#include "engine/optimo/control/passage_effects.h"

namespace rmlcell::optimo {

void PassageEffects::Show(const PassageEffect& effect, When when) {
  if (!ride_.passing() || when == When::kNow) return actuators_.Carry(effect);
  ShowBehind(effect);
}

void PassageEffects::ShowBehind(const PassageEffect& effect) {
  s_.effects.emplace_back(ride_.AppendMark(), effect);
}

void PassageEffects::OnMark(std::uint64_t tag) {
  auto& effects = s_.effects;
  while (!effects.empty() && effects.front().first < tag) effects.pop_front();
  if (effects.empty() || effects.front().first != tag) return;
  const PassageEffect effect = effects.front().second;
  effects.pop_front();
  // An error has switched the beam off: it stays so while the machine comes to rest. OPT-3.58
  if (ride_.ends_here() && effect.kind == PassageEffect::Kind::kBeamOn) return;
  actuators_.Carry(effect);
}

}  // namespace rmlcell::optimo
