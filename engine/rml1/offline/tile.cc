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
    bool moves = false;
    bool rises_only = true;
    Point at = phrase.physical_before;
    for (const Action& action : phrase.actions) {
      if (action.kind != Action::Kind::kMotion) continue;
      moves = true;
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
    const bool lift = lifting_ && moves && rises_only && phrase.findings.empty();
    if (works || lift || (begun_ && same_command)) {
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

Error NotTiled(Detail detail) { return {ErrorCode::kRml1NotRewritten, std::move(detail), {}}; }

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

  // Away from the work, where the copy does not end there. The work begins at the surface: of a Z0
  // that !ZO lowered the tool-up height may lie within.
  void Lift(const BodyFinder& body) {
    const Registers& end = body.end();
    if (!end.tool_down && body.stands().z > end.surface_z) return;
    if (end.up_z(profile_) > end.surface_z) {
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

// How many copies of an extent stand on a length, the first of them included.
int CopiesOn(double length, double extent, double pitch) {
  constexpr double kRounding = 1e-6;
  if (extent > length + kRounding) return 0;
  if (pitch <= 0.0) return kTilesMax;
  const double more = std::floor((length - extent) / pitch + kRounding);
  return 1 + static_cast<int>(std::clamp(more, 0.0, static_cast<double>(kTilesMax - 1)));
}

// Copies from where the first one stands to the end of the travel; it itself always counts.
int CopiesOnTravel(const Extent& extent, const Travel& travel, double pitch) {
  return std::max(1, CopiesOn(travel.high - extent.low, extent.high - extent.low, pitch));
}

Error DoesNotFit(const Tiling& most, const char* what, const Tiling& tiling) {
  return {ErrorCode::kRml1DoesNotFit,
          what + Told("columns", most.columns) + " columns and " + Told("rows", most.rows) +
              " rows fit, " + ToldShort("pitch_x", tiling.pitch_x_mm, "mm") + " mm and " +
              ToldShort("pitch_y", tiling.pitch_y_mm, "mm") + " mm from copy to copy",
          {}};
}

Error CopyIsTooLarge(const std::array<double, 2>& size_mm, const std::array<double, 2>& within_mm) {
  return {ErrorCode::kRml1DoesNotFit,
          "the paths of one copy take " + ToldShort("width", size_mm[0], "mm") + " by " +
              ToldShort("height", size_mm[1], "mm") + " mm, more than " +
              ToldShort("within_width", within_mm[0], "mm") + " by " +
              ToldShort("within_height", within_mm[1], "mm") + " mm",
          {}};
}

// Columns, rows and the way between them.
Result<Tiling> TilingOf(const BodyFinder& body, const Profile& profile,
                        const TileOptions& options) {
  const double units = profile.units_per_mm;
  const double gap = std::ceil(options.gap_mm * units - 1e-6);
  const double width = body.x().high - body.x().low;
  const double height = body.y().high - body.y().low;
  const double pitch_x = std::ceil(width) + gap;
  const double pitch_y = std::ceil(height) + gap;
  Tiling tiling{.columns = options.columns,
                .rows = options.rows,
                .pitch_x_mm = pitch_x / units,
                .pitch_y_mm = pitch_y / units};
  const Tiling most{.columns = CopiesOnTravel(body.x(), profile.x, pitch_x),
                    .rows = CopiesOnTravel(body.y(), profile.y, pitch_y)};
  if (options.within_mm) {
    tiling.columns = CopiesOn((*options.within_mm)[0] * units, width, pitch_x);
    tiling.rows = CopiesOn((*options.within_mm)[1] * units, height, pitch_y);
    if (tiling.columns == 0 || tiling.rows == 0)
      return CopyIsTooLarge({width / units, height / units}, *options.within_mm);
    if (options.force) return tiling;
    tiling.travel_is_less = most.columns < tiling.columns || most.rows < tiling.rows;
    tiling.columns = std::min(tiling.columns, most.columns);
    tiling.rows = std::min(tiling.rows, most.rows);
  }
  if (!options.force && (tiling.columns > most.columns || tiling.rows > most.rows))
    return DoesNotFit(most, "at most ", tiling);
  return tiling;
}

// A copy of the body, so many units from the first; the tool comes from the copy before it.
struct Place {
  UnitVector by{};
  UnitVector before{};
};
Status WriteCopy(const machine::Bytes& stream, const Profile& profile, const BodyFinder& body,
                 const Place& place, double lifted_z, const ByteSink& sink) {
  const UnitVector owed = {body.from().x + place.by[0] - body.to().x - place.before[0],
                           body.from().y + place.by[1] - body.to().y - place.before[1],
                           body.from().z - lifted_z};
  StreamMover mover(stream, profile, place.by, owed, body.part(), sink);
  StreamWalk(profile, mover).Run(stream);
  return mover.Finish();
}

Status CheckOptions(const TileOptions& options) {
  for (const int count : {options.columns, options.rows}) {
    if (count < 1 || count > kTilesMax)
      return InvalidArgument(Told("count", count) + " copies; from 1 to " +
                             Told("most", kTilesMax) + " are possible");
  }
  if (!(options.gap_mm >= 0.0 && std::isfinite(options.gap_mm)))
    return InvalidArgument("the gap is " + ToldShort("gap", options.gap_mm, "mm") +
                           " mm; it must be 0 or more");
  for (const double edge : options.within_mm.value_or(std::array<double, 2>{1.0, 1.0})) {
    if (!(edge > 0.0 && std::isfinite(edge)))
      return InvalidArgument("the field is " + ToldShort("edge", edge, "mm") +
                             " mm; it must be above 0");
  }
  return {};
}

// Portions, so that what is copied need not stay in memory.
void WritePart(const machine::Bytes& stream, std::size_t begin, std::size_t end,
               const ByteSink& sink) {
  while (begin < end) {
    const std::size_t part = std::min(end - begin, machine::kReleaseEvery);
    sink(stream->substr(begin, part));
    begin += part;
    stream.Release();
  }
}

// The copies behind the first one, row by row, each with what comes before it.
Status WriteCopies(const machine::Bytes& stream, const Profile& profile, const BodyFinder& body,
                   const Tiling& tiling, const TileOptions& options, const ByteSink& sink) {
  Interlude between(body, profile);
  between.Lift(body);
  if (const Status restored = between.Restore(body.start(), body.end()); !restored)
    return restored.error();
  std::size_t size = static_cast<std::size_t>(body.part().end);
  const ByteSink counted = [&](std::string_view part) {
    size += part.size();
    sink(part);
  };
  Place place;
  for (int row = 0; row < tiling.rows; ++row) {
    for (int column = 0; column < tiling.columns; ++column) {
      if (row == 0 && column == 0) continue;
      place.by = {column * std::round(tiling.pitch_x_mm * profile.units_per_mm),
                  row * std::round(tiling.pitch_y_mm * profile.units_per_mm), 0.0};
      counted(between.text());
      if (const Status copy = WriteCopy(stream, profile, body, place, between.lifted_z(), counted);
          !copy)
        return copy.error();
      if (size > options.bytes_max) {
        return Error{ErrorCode::kRml1ProductTooLarge,
                     "more than " +
                         Told("most", static_cast<double>(options.bytes_max), "bytes",
                              std::to_string(options.bytes_max)) +
                         " bytes",
                     {}};
      }
      place.before = place.by;
    }
  }
  return {};
}

}  // namespace

Result<Tiling> TileStream(const machine::Bytes& stream, const machine::Parameters& parameters,
                          const TileOptions& options, const ByteSink& sink) {
  if (const Status good = CheckOptions(options); !good) return good.error();
  if (stream->empty()) return Error{ErrorCode::kCellEmptyProgram, "the stream has no bytes", {}};
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
    return Error{ErrorCode::kRml1WorkBeyondTravel,
                 "of the program alone " +
                     ToldShort("length", lost / profile->units_per_mm, "mm", 3) +
                     " mm would not be cut: how large a copy is cannot be told",
                 {}};
  }
  const Result<Tiling> tiling = TilingOf(body, *profile, options);
  if (!tiling) return tiling.error();

  const auto end = static_cast<std::size_t>(body.part().end);
  WritePart(stream, 0, end, sink);
  if (const Status copied = WriteCopies(stream, *profile, body, *tiling, options, sink); !copied)
    return copied.error();
  if (tiling->columns * tiling->rows > 1) {  // the ending goes back to the first copy
    Interlude ending(body, *profile);
    ending.Lift(body);
    ending.SetMode(body.end().absolute);
    sink(ending.text());
  }
  WritePart(stream, end, stream->size(), sink);
  return tiling;
}

}  // namespace rmlcell::rml1
