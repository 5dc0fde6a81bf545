#include "engine/optimo/control/waits.h"

#include <algorithm>

namespace rmlcell::optimo {

void Waits::Begin(const Pending& pending) {
  s_.pending = pending;
  s_.pending.since = situation_.now;
  s_.pending.told = situation_.now;
  s_.pending.place = situation_.place;
}

void Waits::BeginTime(double seconds, machine::WaitKind kind) {
  Begin({.kind = Pending::Kind::kTime, .until = After(situation_.now, seconds), .wait = kind});
}

void Waits::BeginCondition(ExprRange expression, bool of_move) {
  Begin({.kind = Pending::Kind::kCondition, .expression = expression, .of_move = of_move});
}

void Waits::Tell() {
  Pending& pending = s_.pending;
  const bool timed = pending.kind == Pending::Kind::kTime;
  const bool condition =
      pending.kind == Pending::Kind::kCondition || pending.kind == Pending::Kind::kNoMotion;
  if (!timed && !condition) return;
  if (ride_.under_way() == nullptr && situation_.now > pending.told) {
    telling_.observer().OnWait(
        {.start = pending.told,
         .end = situation_.now,
         .place = pending.place,
         .kind = timed ? pending.wait : machine::WaitKind::kCondition,
         .beam_on = beam_.on(),
         .power_percent = beam_.on() ? beam_.power().constant_percent : 0.0});
  }
  pending.told = situation_.now;
}

void Waits::End() {
  Tell();
  s_.pending = {};
}

void Waits::EndMet() {
  End();
  s_.condition_met = true;
}

void Waits::Shift(SimTime stood) {
  if (!waits()) return;
  s_.pending.since = situation_.now;
  s_.pending.told = situation_.now;
  s_.pending.until += stood;
}

bool Waits::PollingTakesTime(int slot, std::uint32_t instruction) {
  constexpr int kReadsAtOnce = 1000;     // loops that count to less are not slowed
  constexpr int kOthersMax = 1'000'000;  // no program has as many instructions
  Polling& polling = s_.polling;
  const bool same_instant = polling.at == situation_.now;
  if (polling.program != slot || polling.instruction != instruction) {
    if (same_instant && ++polling.others < polling.others_max) return false;
    // Of a loop with more of them than that one is counted in the end.
    const int others_max = same_instant ? 2 * polling.others_max : kReadsAtOnce;
    polling = {.program = slot,
               .instruction = instruction,
               .at = situation_.now,
               .count = 1,
               .others_max = std::min(others_max, kOthersMax)};
    return false;
  }
  polling.others = 0;
  if (!same_instant) {
    polling.at = situation_.now;
    polling.count = 0;
  }
  if (++polling.count > kReadsAtOnce) polling.slow = true;
  if (!polling.slow || polling.count == 1) return false;
  Begin({.kind = Pending::Kind::kTime,
         .until = cycle_.NextTick(situation_.now, SimTime(0)),
         .wait = machine::WaitKind::kCondition});
  return true;
}

}  // namespace rmlcell::optimo
