#include "engine/rml1/offline/rewrite.h"

#include <cmath>

#include "engine/rml1/offline/phrase_words.h"
#include "engine/rml1/offline/stream_mover.h"
#include "engine/rml1/offline/stream_scaler.h"

namespace rmlcell::rml1 {
namespace {

Result<Profile> ProfileFor(const machine::Bytes& stream, const machine::Parameters& parameters) {
  if (stream->empty()) return Error{ErrorCode::kCellEmptyProgram, "the stream has no bytes", {}};
  return MakeProfile(parameters);
}

}  // namespace

Result<std::array<double, 3>> MoveStream(const machine::Bytes& stream,
                                         const machine::Parameters& parameters,
                                         const std::array<double, 3>& by_mm, const ByteSink& sink) {
  const Result<Profile> profile = ProfileFor(stream, parameters);
  if (!profile) return profile.error();
  std::array<double, 3> moved_mm{};
  UnitVector by{};
  for (std::size_t axis = 0; axis < by.size(); ++axis) {
    by[axis] = std::round(by_mm[axis] * profile->units_per_mm);
    if (!std::isfinite(by[axis])) return InvalidArgument("a distance that is no number");
    moved_mm[axis] = by[axis] / profile->units_per_mm;
  }
  StreamMover mover(stream, *profile, by, by, {0, static_cast<std::int64_t>(stream->size())}, sink);
  StreamWalk walk(*profile, mover);
  if (walk.Run(stream)) {
    if (const Status known = CheckIsStream(walk.device()); !known) return known.error();
  }
  if (const Status copied = mover.Finish(); !copied) return copied.error();
  return moved_mm;
}

Status ScaleStream(const machine::Bytes& stream, const machine::Parameters& parameters,
                   double from_units_per_mm, double to_units_per_mm, const ByteSink& sink) {
  const Result<Profile> profile = ProfileFor(stream, parameters);
  if (!profile) return profile.error();
  constexpr double kUnitsMax = 10'000.0;
  for (const double units : {from_units_per_mm, to_units_per_mm}) {
    if (!(units >= 1.0 && units <= kUnitsMax))
      return InvalidArgument(ToldShort("units", units, {}) +
                             " units in a mm; from 1 to 10000 are possible");
  }
  StreamScaler scaler(stream, to_units_per_mm / from_units_per_mm, sink);
  StreamWalk walk(*profile, scaler);
  if (walk.Run(stream)) {
    if (const Status known = CheckIsStream(walk.device()); !known) return known.error();
  }
  return scaler.Finish(static_cast<std::int64_t>(stream->size()));
}

}  // namespace rmlcell::rml1
