#include "engine/rml1/offline/tile.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/rml1/offline/command_names.h"
#include "engine/rml1/offline/phrase_words.h"
#include "engine/rml1/offline/stream_mover.h"
#include "engine/rml1/programmed.h"

namespace rmlcell::rml1 {
namespace {

using machine::MotionUse;

// Finds the part of a stream that is repeated.
class BodyFinder final : public PhraseListener {
 public:
  explicit BodyFinder(const Profile& profile) : start_(profile), end_(profile) {}

  bool OnPhrase(const Phrase& phrase) override {
    bool works = false;
    bool travels = false;
    bool rises_only = true;
    Point at = phrase.physical_before;
    for (const Action& action : phrase.actions) {
      if (action.kind != Action::Kind::kMotion) continue;
      const bool across = action.to.x != at.x || action.to.y != at.y;
      travels = travels || across;
      rises_only = rises_only && !across && action.to.z > at.z;
      if (action.use == MotionUse::kCut || action.use == MotionUse::kPlunge) {
        works = true;
        for (const Point& p : {at, action.to}) {
          x_.Add(p.x);
          y_.Add(p.y);
        }
      }
      at = action.to;
    }
    if (phrase.command != command_) BeginCommand(phrase);
    // A command that only sets something is never the beginning.
    if (!begun_ && (works || travels)) {
      begun_ = true;
      part_.begin = phrase.name;
      start_ = command_start_;
      from_ = command_from_;
    }
    const bool same_command = phrase.command != 0 && phrase.command == last_command_;
    const bool lift = lifting_ && rises_only && !phrase.actions.empty() && phrase.findings.empty();
    if (works || (begun_ && (same_command || lift))) {
      lifting_ = true;
      last_command_ = phrase.command;
      part_.end = phrase.end;
      end_ = *phrase.after;
      to_ = phrase.logical;
      stands_ = phrase.physical;
      found_ = found_ || works;
    } else if (!phrase.actions.empty()) {
      lifting_ = false;  // a setting may stand between the last cut and its lift
    }
    return true;
  }

  bool found() const { return found_; }
  const StreamMover::Part& part() const { return part_; }
  const Registers& start() const { return start_; }
  const Registers& end() const { return end_; }
  const Point& from() const { return from_; }  // where commands stand at both ends
  const Point& to() const { return to_; }
  const Point& stands() const { return stands_; }  // the tool, at the end
  const Extent& x() const { return x_; }           // of the work, device units
  const Extent& y() const { return y_; }

 private:
  void BeginCommand(const Phrase& phrase) {
    command_ = phrase.command;
    command_start_ = *phrase.before;
    command_from_ = phrase.logical_before;
  }

  StreamMover::Part part_;
  Registers start_;
  Registers end_;
  Registers command_start_ = start_;
  Point from_;
  Point to_;
  Point stands_;
  Point command_from_;
  Extent x_;
  Extent y_;
  std::uint64_t command_ = 0;
  std::uint64_t last_command_ = 0;
  bool begun_ = false;
  bool found_ = false;
  bool lifting_ = false;
};

Error NotTiled(std::string detail) { return {ErrorCode::kRml1NotRewritten, std::move(detail), {}}; }

// The parameter of !RC that gives a speed again.
std::optional<std::string> SpindleParameter(int rpm, const Profile& profile) {
  if (profile.spindle_control == SpindleControl::kRpm) return std::to_string(rpm);
  constexpr int kStages = 16;
  const int span = profile.spindle_max_rpm - profile.spindle_min_rpm;
  for (int stage = 0; stage < kStages; ++stage) {
    if (profile.spindle_min_rpm + span * stage / (kStages - 1) == rpm) return std::to_string(stage);
  }
  return std::nullopt;
}

// Commands that follow a copy, and the coordinate mode behind them.
class Interlude {
 public:
  Interlude(const BodyFinder& body, const Profile& profile)
      : profile_(profile),
        names_(NamesFor(profile.commands.setting)),
        absolute_(body.end().absolute),
        lifted_z_(body.to().z) {}

  // Away from the work, where the copy does not end there.
  void Lift(const BodyFinder& body) {
    const Registers& end = body.end();
    if (!end.tool_down && body.stands().z > end.z0) return;
    if (end.z2 > 0.0) {
      Say(names_.up);
      if (profile_.commands.setting == CommandSetting::kMode1) absolute_ = true;  // so does M
      lifted_z_ = end.up_z(profile_);
    } else {
      SetMode(true);
      Say("!ZM0");
      lifted_z_ = profile_.z.high;
    }
  }
  Status Restore(const Registers& start, const Registers& end);
  void SetMode(bool absolute) {
    if (std::exchange(absolute_, absolute) != absolute)
      Say(absolute ? names_.absolute : names_.relative);
  }

  const std::string& text() const { return text_; }
  double lifted_z() const { return lifted_z_; }  // where commands stand

 private:
  void Say(const std::string& command) { text_ += command + ";\n"; }

  const Profile& profile_;
  CommandNames names_;
  bool absolute_;
  double lifted_z_;
  std::string text_ = ";\n";
};

// The settings of the beginning, but the tool state, which is up.
Status Interlude::Restore(const Registers& start, const Registers& end) {
  if (start.tool_down)
    return NotTiled("the tool is down where the first copy begins: lift it there");
  if (start.xy_speed != end.xy_speed) Say(names_.xy_speed + ShortNumber(start.xy_speed));
  if (start.z_speed != end.z_speed) Say("!VZ" + ShortNumber(start.z_speed));
  if (start.dwell_ms != end.dwell_ms) Say("!DW" + std::to_string(start.dwell_ms));
  if (start.rotation != end.rotation) Say(start.rotation ? "!MC1" : "!MC0");
  if (start.rpm != end.rpm) {
    const auto parameter = SpindleParameter(start.rpm, profile_);
    if (!parameter) return NotTiled("the spindle speed of the beginning is none of the stages");
    Say("!RC" + *parameter);
  }
  if (start.z0 != end.z0) {
    if (std::round(start.z0) != start.z0) return NotTiled("Z0 of the beginning is no whole unit");
    SetMode(true);
    Say("!ZO" + ShortNumber(start.z0));
  }
  if (start.z1 != end.z1 || start.z2 != end.z2)
    Say("!PZ" + ShortNumber(start.z1) + "," + ShortNumber(start.z2));
  SetMode(start.absolute);
  return {};
}

Status CheckFits(const BodyFinder& body, const Profile& profile, const TileOptions& options,
                 double pitch_x, double pitch_y) {
  const auto fit = [](const Extent& extent, const Travel& travel, double pitch) {
    constexpr double kRounding = 1e-6;
    if (pitch <= 0.0) return kTilesMax;
    const double more = std::floor((travel.high - extent.high) / pitch + kRounding);
    return 1 + static_cast<int>(std::clamp(more, 0.0, static_cast<double>(kTilesMax - 1)));
  };
  const int columns = fit(body.x(), profile.x, pitch_x);
  const int rows = fit(body.y(), profile.y, pitch_y);
  if (options.columns <= columns && options.rows <= rows) return {};
  return Error{ErrorCode::kRml1DoesNotFit,
               "at most " + std::to_string(columns) + " columns and " + std::to_string(rows) +
                   " rows fit, " + ShortNumber(pitch_x / profile.units_per_mm) + " mm and " +
                   ShortNumber(pitch_y / profile.units_per_mm) + " mm from copy to copy",
               {}};
}

// A copy of the body, so many units from the first; the tool comes from the copy before it.
Result<std::string> CopyOf(std::string_view stream, const Profile& profile, const BodyFinder& body,
                           const UnitVector& by, const UnitVector& before, double lifted_z) {
  const UnitVector owed = {body.from().x + by[0] - body.to().x - before[0],
                           body.from().y + by[1] - body.to().y - before[1],
                           body.from().z - lifted_z};
  StreamMover mover(stream, profile, by, owed, body.part());
  StreamWalk(profile, mover).Run(stream);
  return mover.Take();
}

Status CheckOptions(const TileOptions& options) {
  for (const int count : {options.columns, options.rows}) {
    if (count < 1 || count > kTilesMax)
      return InvalidArgument(std::to_string(count) + " copies; from 1 to " +
                             std::to_string(kTilesMax) + " are possible");
  }
  if (!(options.gap_mm >= 0.0 && std::isfinite(options.gap_mm)))
    return InvalidArgument("the gap is " + ShortNumber(options.gap_mm) + " mm");
  return {};
}

}  // namespace

Result<TiledStream> TileStream(std::string_view stream, const machine::Parameters& parameters,
                               const TileOptions& options) {
  if (const Status good = CheckOptions(options); !good) return good.error();
  if (stream.empty()) return Error{ErrorCode::kCellEmptyProgram, "the stream has no bytes", {}};
  const Result<Profile> profile = MakeProfile(parameters);
  if (!profile) return profile.error();
  BodyFinder body(*profile);
  StreamWalk walk(*profile, body);
  walk.Run(stream);
  if (const Status known = CheckIsStream(walk.device()); !known) return known.error();
  if (walk.device().pending())
    return NotTiled("the data ends inside a command: end it with a semicolon");
  if (!body.found()) return NotTiled("the tool never goes into the work");
  if (const double lost = walk.device().carriage().lost().length; lost > 0.0) {
    return Error{ErrorCode::kRml1DoesNotFit,
                 "the program alone cuts " + ShortNumber(lost / profile->units_per_mm) +
                     " mm beyond the travel: move it, or set its origin",
                 {}};
  }
  const double gap = std::ceil(options.gap_mm * profile->units_per_mm - 1e-6);
  const double pitch_x = std::ceil(body.x().high - body.x().low) + gap;
  const double pitch_y = std::ceil(body.y().high - body.y().low) + gap;
  if (const Status fits = CheckFits(body, *profile, options, pitch_x, pitch_y); !fits)
    return fits.error();
  Interlude between(body, *profile);
  between.Lift(body);
  if (const Status restored = between.Restore(body.start(), body.end()); !restored)
    return restored.error();

  const auto end = static_cast<std::size_t>(body.part().end);
  TiledStream made{.stream = std::string(stream.substr(0, end)),
                   .pitch_x_mm = pitch_x / profile->units_per_mm,
                   .pitch_y_mm = pitch_y / profile->units_per_mm};
  UnitVector before{};
  for (int row = 0; row < options.rows; ++row) {
    for (int column = 0; column < options.columns; ++column) {
      if (row == 0 && column == 0) continue;
      const UnitVector by = {column * pitch_x, row * pitch_y, 0.0};
      const Result<std::string> copy =
          CopyOf(stream, *profile, body, by, before, between.lifted_z());
      if (!copy) return copy.error();
      made.stream += between.text() + *copy;
      if (made.stream.size() > options.bytes_max) {
        return Error{ErrorCode::kRml1ProductTooLarge,
                     "more than " + std::to_string(options.bytes_max) + " bytes",
                     {}};
      }
      before = by;
    }
  }
  if (options.columns * options.rows > 1) {  // the ending goes back to the first copy
    Interlude ending(body, *profile);
    ending.Lift(body);
    ending.SetMode(body.end().absolute);
    made.stream += ending.text();
  }
  made.stream += stream.substr(end);
  return made;
}

}  // namespace rmlcell::rml1
