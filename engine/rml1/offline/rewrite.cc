#include "engine/rml1/offline/rewrite.h"

#include <cmath>

#include "engine/rml1/offline/phrase_words.h"
#include "engine/rml1/offline/stream_mover.h"
#include "engine/rml1/offline/stream_scaler.h"

namespace rmlcell::rml1 {
namespace {

class Nobody final : public PhraseListener {
 public:
  bool OnPhrase(const Phrase&) override { return true; }
};

// What the tool would cut and does not, beyond the travel, in device units.
double LostCutOf(std::string_view stream, const Profile& profile) {
  Nobody nobody;
  StreamWalk walk(profile, nobody);
  walk.Run(stream);
  return walk.device().carriage().lost().length;
}

Result<Profile> ProfileFor(std::string_view stream, const machine::Parameters& parameters) {
  if (stream.empty()) return Error{ErrorCode::kCellEmptyProgram, "the stream has no bytes", {}};
  return MakeProfile(parameters);
}

}  // namespace

Result<RewrittenStream> MoveStream(std::string_view stream, const machine::Parameters& parameters,
                                   const std::array<double, 3>& by_mm) {
  const Result<Profile> profile = ProfileFor(stream, parameters);
  if (!profile) return profile.error();
  RewrittenStream made;
  UnitVector by{};
  for (std::size_t axis = 0; axis < by.size(); ++axis) {
    by[axis] = std::round(by_mm[axis] * profile->units_per_mm);
    if (!std::isfinite(by[axis])) return InvalidArgument("a distance that is no number");
    made.moved_mm[axis] = by[axis] / profile->units_per_mm;
  }
  StreamMover mover(stream, *profile, by, by, {0, static_cast<std::int64_t>(stream.size())});
  StreamWalk walk(*profile, mover);
  const bool whole = walk.Run(stream);
  if (whole) {
    if (const Status known = CheckIsStream(walk.device()); !known) return known.error();
  }
  Result<std::string> text = mover.Take();
  if (!text) return text.error();
  made.stream = *std::move(text);
  const double before = walk.device().carriage().lost().length;
  const double after = LostCutOf(made.stream, *profile);
  constexpr double kNoticed = 1e-3;
  if (after > before + kNoticed) {
    constexpr ErrorCode kCode = ErrorCode::kRml1Clipped;
    made.findings.push_back({.code = kCode,
                             .severity = Lookup(kCode).severity,
                             .detail = "the moved program leaves " +
                                       ShortNumber((after - before) / profile->units_per_mm) +
                                       " mm uncut beyond the travel"});
  }
  return made;
}

Result<RewrittenStream> ScaleStream(std::string_view stream, const machine::Parameters& parameters,
                                    double from_units_per_mm, double to_units_per_mm) {
  const Result<Profile> profile = ProfileFor(stream, parameters);
  if (!profile) return profile.error();
  constexpr double kUnitsMax = 10'000.0;
  for (const double units : {from_units_per_mm, to_units_per_mm}) {
    if (!(units >= 1.0 && units <= kUnitsMax))
      return InvalidArgument(ShortNumber(units) + " units in a mm; from 1 to 10000 are possible");
  }
  StreamScaler scaler(stream, to_units_per_mm / from_units_per_mm);
  StreamWalk walk(*profile, scaler);
  if (walk.Run(stream)) {
    if (const Status known = CheckIsStream(walk.device()); !known) return known.error();
  }
  Result<std::string> text = scaler.Take(static_cast<std::int64_t>(stream.size()));
  if (!text) return text.error();
  return RewrittenStream{.stream = *std::move(text)};
}

}  // namespace rmlcell::rml1
