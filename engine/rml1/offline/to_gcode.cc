#include "engine/rml1/offline/to_gcode.h"

#include <cmath>
#include <optional>

#include "engine/core/number_text.h"
#include "engine/machine/program_file.h"
#include "engine/rml1/offline/phrase_words.h"
#include "engine/rml1/offline/stream_walk.h"

namespace rmlcell::rml1 {
namespace {

class GcodeWriter final : public PhraseListener {
 public:
  GcodeWriter(std::string_view stream, const Profile& profile)
      : stream_(stream), profile_(profile) {
    gcode_.text =
        "(made of an RML-1 stream; X0 Y0 is its work origin, Z0 its Z0)\n"
        "G21 G90 G17 G94\n";
  }

  bool OnPhrase(const Phrase& phrase) override {
    for (const Finding& finding : phrase.findings) Note(finding);
    Point at = phrase.physical_before;
    for (const Action& action : phrase.actions) {
      if (action.kind != Action::Kind::kMotion) {
        Add(action);
        continue;
      }
      if (std::abs(action.to.a - at.a) > kSameAngle_deg) {
        error_ = Error{ErrorCode::kRml1RotaryMotion,
                       "A goes to " + ShortNumber(action.to.a) + " degrees",
                       lines_.At(stream_, phrase.begin, 1)};
        return false;
      }
      AddMotion(action, at);
      at = action.to;
    }
    return true;
  }

  Result<GcodeText> Take() {
    if (error_) return *error_;
    gcode_.text += "M30\n";
    return std::move(gcode_);
  }

 private:
  void Note(const Finding& finding) {
    if (gcode_.findings.size() < machine::kDiagnosticsMax) {
      gcode_.findings.push_back(ToDiagnostic(finding, stream_, lines_));
    } else {
      ++gcode_.findings_dropped;
    }
  }

  void Add(const Action& action) {
    switch (action.kind) {
      case Action::Kind::kSpindleStart:
        gcode_.text += "S" + std::to_string(action.rpm) + " M3\n";
        break;
      case Action::Kind::kSpindleSpeed:
        gcode_.text += "S" + std::to_string(action.rpm) + "\n";
        break;
      case Action::Kind::kSpindleStop:
        gcode_.text += "M5\n";
        break;
      case Action::Kind::kDwell:
        gcode_.text += "G4 P" + ShortNumber(action.dwell_ms / 1000.0) + "\n";
        break;
      case Action::Kind::kPause:
        gcode_.text += "M0\n";
        break;
      case Action::Kind::kMotion:
        break;
    }
  }

  // Words of axes that stay where they are are left out, but for the first word of X or Y: nobody
  // knows where the machine that reads this stands.
  void AddMotion(const Action& action, const Point& from) {
    std::string line = action.rapid ? "G0" : "G1";
    const bool x = action.to.x != from.x;
    const bool y = action.to.y != from.y;
    const auto word = [&](char axis, double units, double origin) {
      line += std::string(" ") + axis + ShortNumber((units - origin) / profile_.units_per_mm, 5);
    };
    if (x || (y && !knows_xy_)) word('X', action.to.x, profile_.origin_x);
    if (y || (x && !knows_xy_)) word('Y', action.to.y, profile_.origin_y);
    if (action.to.z != from.z) word('Z', action.to.z, profile_.z0);
    knows_xy_ = knows_xy_ || x || y;
    if (!action.rapid && action.speed_mm_s != feed_mm_s_) {
      feed_mm_s_ = action.speed_mm_s;
      constexpr double kPerMinute = 60.0;
      line += " F" + ShortNumber(feed_mm_s_ * kPerMinute);
    }
    gcode_.text += line + "\n";
  }

  std::string_view stream_;
  const Profile& profile_;
  GcodeText gcode_;
  std::optional<Error> error_;
  LineCounter lines_;
  double feed_mm_s_ = 0.0;
  bool knows_xy_ = false;
};

}  // namespace

Result<GcodeText> ToGcode(std::string_view stream, const machine::Parameters& parameters) {
  if (stream.empty()) return Error{ErrorCode::kCellEmptyProgram, "the stream has no bytes", {}};
  const Result<Profile> profile = MakeProfile(parameters);
  if (!profile) return profile.error();
  GcodeWriter writer(stream, *profile);
  StreamWalk walk(*profile, writer);
  if (walk.Run(stream)) {
    if (const Status known = CheckIsStream(walk.device()); !known) return known.error();
  }
  return writer.Take();
}

}  // namespace rmlcell::rml1
