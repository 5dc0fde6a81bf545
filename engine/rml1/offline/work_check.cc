#include "engine/rml1/offline/work_check.h"

#include <algorithm>
#include <string>
#include <utility>

#include "engine/rml1/offline/phrase_words.h"
#include "engine/rml1/offline/stream_walk.h"

namespace rmlcell::rml1 {
namespace {

constexpr double kNoticed_mm = 0.01;

// Where the tool works, device units from the machine's zero.
class WorkDone final : public PhraseListener {
 public:
  explicit WorkDone(const Profile& profile) : profile_(profile) {}

  bool OnPhrase(const Phrase& phrase) override {
    if (possible.empty()) possible = RangeOfRefused(phrase, profile_);
    Point at = phrase.physical_before;
    for (const Action& action : phrase.actions) {
      if (action.kind != Action::Kind::kMotion) continue;
      if (action.use == machine::MotionUse::kCut || action.use == machine::MotionUse::kPlunge) {
        for (const Point& p : {at, action.to}) {
          x.Add(p.x);
          y.Add(p.y);
          z.Add(p.z);
        }
      }
      at = action.to;
    }
    return true;
  }

  Extent x;
  Extent y;
  Extent z;
  std::string possible;  // in place of the first number that is refused

 private:
  const Profile& profile_;
};

class LostText {
 public:
  explicit LostText(const Profile& profile) : profile_(profile) {}

  // "12 mm beyond the greatest X (203.2 mm)", with the face as the work counts.
  void Say(double beyond, const char* face, double at) {
    if (beyond / profile_.units_per_mm <= kNoticed_mm) return;
    faces_ += (faces_.empty() ? ": " : ", ") + Mm("beyond", beyond) + " mm " + face + " (" +
              Mm("limit", at) + " mm)";
  }
  // By how much the work must be moved along an axis where something is lost.
  void SayRemedy(const char* axis, Extent wanted, const Extent& lost, const Travel& travel) {
    if (!lost.known) return;
    wanted.Add(lost.low);
    wanted.Add(lost.high);
    const double least = travel.low - wanted.low;
    const double most = travel.high - wanted.high;
    const bool leaves = least > 0.0 || most < 0.0;
    if (!leaves) return;
    remedies_ +=
        "; in " + Told("axis", axis) +
        (least > most
             ? " it is " + Mm("too_large", least - most) + " mm too large for this machine"
             : " it fits moved by " + Mm("least", least) + " to " + Mm("most", most) + " mm");
  }
  Detail Take(double length) const {
    return Mm("length", length) + " mm of the work would not be cut" + faces_ + remedies_;
  }

 private:
  Detail Mm(std::string_view name, double units) const {
    return ToldShort(name, units / profile_.units_per_mm, "mm", 3);
  }

  const Profile& profile_;
  Detail faces_;
  Detail remedies_;
};

Detail TextOfLost(const Device& device, const WorkDone& done, const Profile& profile) {
  const LostCut& lost = device.carriage().lost();
  const double surface = device.registers().surface_z;  // !ZO moves no work
  LostText text(profile);
  text.Say(lost.x_low, "beyond the least X", profile.x.low - profile.origin_x);
  text.Say(lost.x_high, "beyond the greatest X", profile.x.high - profile.origin_x);
  text.Say(lost.y_low, "beyond the least Y", profile.y.low - profile.origin_y);
  text.Say(lost.y_high, "beyond the greatest Y", profile.y.high - profile.origin_y);
  text.Say(lost.z_low, "below the lowest Z", profile.z.low - surface);
  text.SayRemedy("X", done.x, lost.x, profile.x);
  text.SayRemedy("Y", done.y, lost.y, profile.y);
  // Of a plunge from above the surface that part alone is work.
  Extent depth = done.z;
  depth.high = std::min(depth.high, surface);
  text.SayRemedy("Z", depth, lost.z, profile.z);
  return text.Take(lost.length);
}

}  // namespace

Result<std::optional<Error>> CheckWork(const machine::Bytes& stream,
                                       const machine::Parameters& parameters) {
  const Result<Profile> profile = MakeProfile(parameters);
  if (!profile) return profile.error();
  WorkDone done(*profile);
  StreamWalk walk(*profile, done);
  walk.Run(stream);
  const Device& device = walk.device();
  LineCounter lines;
  const auto at = [&](const CommandPlace& place) { return lines.At(*stream, place.offset, 1); };
  if (const auto refused = device.positions_refused(); refused > 0) {
    return std::optional(
        Error{ErrorCode::kRml1PartRefused,
              "coordinates or tool heights that are refused: " + Told("count", refused) +
                  (done.possible.empty() ? "" : "; " + done.possible),
              at(device.first_refused())});
  }
  if (device.carriage().lost().length / profile->units_per_mm <= kNoticed_mm)
    return std::optional<Error>();
  return std::optional(Error{ErrorCode::kRml1WorkBeyondTravel, TextOfLost(device, done, *profile),
                             at(device.first_lost())});
}

}  // namespace rmlcell::rml1
