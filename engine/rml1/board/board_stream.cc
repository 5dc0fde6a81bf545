#include "engine/rml1/board/board_stream.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/rml1/board/contours.h"
#include "engine/rml1/board/joined_traces.h"
#include "engine/rml1/board/nearest_order.h"
#include "engine/rml1/board/simplify.h"
#include "engine/rml1/offline/phrase_words.h"
#include "engine/rml1/offline/stream_writer.h"

namespace rmlcell::rml1 {
namespace {

// What lines keep away from the copper beyond the radius of the tool, in pixels: the corners of a
// pixel are this far from its centre, and straight interpolation between pixels errs by less than
// the rest, because distances of two pixels and more bend by at most 1 / (8 * 2).
constexpr double kPixelCorner = std::numbers::sqrt2 / 2.0;
constexpr double kInterpolation = 0.2;
constexpr double kLevelMin = 2.0;  // pixels

struct Range {
  const char* name;
  double value;
  double low;
  double high;
  std::string_view unit;
};

Status CheckOptions(const BoardOptions& options) {
  constexpr double kLong_mm = 1000.0;
  const Range ranges[] = {{"the edge of a pixel", options.pixel_mm, 1e-4, 10.0, "mm"},
                          {"the diameter of the tool", options.tool_mm, 0.01, 50.0, "mm"},
                          {"the depth", options.depth_mm, 1e-3, kLong_mm, "mm"},
                          {"the depth of a step", options.step_mm, 0.0, kLong_mm, "mm"},
                          {"the number of passes", static_cast<double>(options.passes), 1.0,
                           static_cast<double>(kPassesMax), ""},
                          {"the overlap", options.overlap, 0.0, 0.95, ""},
                          {"the feed rate", options.feed_mm_s, 0.01, kLong_mm, "mm/s"},
                          {"the plunge rate", options.plunge_mm_s, 0.01, kLong_mm, "mm/s"},
                          {"the spindle speed", options.rpm, 0.0, 1e6, "rpm"},
                          {"the clearance", options.clearance_mm, 1e-3, kLong_mm, "mm"},
                          {"the tolerance", options.tolerance_mm, 0.0, 1.0, "mm"},
                          {"the place in X", options.at_x_mm, -kLong_mm, kLong_mm, "mm"},
                          {"the place in Y", options.at_y_mm, -kLong_mm, kLong_mm, "mm"}};
  for (const Range& range : ranges) {
    if (range.value >= range.low && range.value <= range.high) continue;
    return InvalidArgument(Told("name", range.name) + " is " +
                           ToldShort("value", range.value, range.unit) + "; from " +
                           ToldShort("least", range.low, range.unit) + " to " +
                           ToldShort("most", range.high, range.unit) + " is possible");
  }
  return {};
}

// Steps of less than a unit would go around again at the same depth.
Status CheckStep(const BoardOptions& options, const Profile& profile) {
  const double unit_mm = 1.0 / profile.units_per_mm;
  if (options.step_mm == 0.0 || options.step_mm >= unit_mm) return {};
  return InvalidArgument("the depth of a step is " + ToldShort("value", options.step_mm, "mm") +
                         " mm; a unit of this machine is " + ToldShort("least", unit_mm, "mm") +
                         " mm");
}

// How far from the centres of copper the lines of each pass lie, in pixels.
std::vector<double> LevelsOf(const BoardOptions& options, const Profile& profile) {
  const double radius = options.tool_mm / 2.0;
  const double rounding = kPixelCorner / profile.units_per_mm;
  const double first =
      (radius + options.tolerance_mm + rounding) / options.pixel_mm + kPixelCorner + kInterpolation;
  const double pitch = options.tool_mm * (1.0 - options.overlap) / options.pixel_mm;
  std::vector<double> levels;
  const int passes = options.outline ? 1 : options.passes;
  for (int pass = 0; pass < passes; ++pass)
    levels.push_back(std::max(first, kLevelMin) + pass * pitch);
  return levels;
}

class BoardMiller {
 public:
  BoardMiller(const Profile& profile, const BoardOptions& options, const ByteSink& sink)
      : profile_(profile), options_(options), writer_(profile, sink) {}

  void Begin() {
    if (options_.rpm > 0.0) {
      const int used = writer_.SpindleSpeed(options_.rpm);
      if (used != options_.rpm)
        Note(used == 0 ? Detail("the spindle speed of this machine is set by hand")
                       : ToldShort("wanted", options_.rpm, "rpm") + " rpm becomes " +
                             Told("speed", used, "rpm", std::to_string(used)));
    }
    writer_.SpindleOn();
    clear_ = std::max<std::int64_t>(1, NearestUnit(options_.clearance_mm, profile_));
    const Units at = writer_.at();
    if (at.z > clear_) writer_.Rapid({at.x, at.y, clear_});
  }

  // Around it once for each step of the depth, without a lift between. False: there is no room.
  bool Mill(const Loop& loop) {
    const Units start = At(loop.front(), clear_);
    writer_.Rapid({start.x, start.y, writer_.at().z});
    double depth = 0.0;
    const double step = options_.step_mm > 0.0 ? options_.step_mm : options_.depth_mm;
    constexpr double kRest_mm = 1e-6;
    while (depth < options_.depth_mm - kRest_mm) {
      depth = std::min(depth + step, options_.depth_mm);
      const std::int64_t z = -NearestUnit(depth, profile_);
      Cut({start.x, start.y, z}, options_.plunge_mm_s);
      for (std::size_t i = 1; i < loop.size(); ++i) Cut(At(loop[i], z), options_.feed_mm_s);
      Cut({start.x, start.y, z}, options_.feed_mm_s);
      if (writer_.size() > options_.bytes_max) return false;
    }
    writer_.Rapid({start.x, start.y, clear_});
    return true;
  }

  void Finish(BoardLines& made) {
    writer_.Finish();
    for (Diagnostic& note : notes_) made.findings.push_back(std::move(note));
  }

 private:
  Units At(const PlanePoint& p, std::int64_t z) const {
    return {NearestUnit(p.x, profile_), NearestUnit(p.y, profile_), z};
  }
  void Cut(const Units& to, double feed_mm_s) {
    const double used = writer_.Cut(to, feed_mm_s);
    if (std::abs(used - feed_mm_s) > 1e-9 * feed_mm_s)
      Note(ToldShort("wanted", feed_mm_s, "mm/s") + " mm/s becomes " +
           ToldShort("feed_rate", used, "mm/s") + " mm/s");
  }
  void Note(const Detail& detail) {
    constexpr ErrorCode kCode = ErrorCode::kRml1SpeedRounded;
    if (std::ranges::find(notes_, detail, &Diagnostic::detail) == notes_.end())
      notes_.push_back({.code = kCode, .severity = Lookup(kCode).severity, .detail = detail});
  }

  const Profile& profile_;
  const BoardOptions& options_;
  StreamWriter writer_;
  std::int64_t clear_ = 0;
  std::vector<Diagnostic> notes_;  // two feeds and a spindle speed at most
};

// The loops of all passes, in mm, those that lie in others first when a board is cut out.
std::vector<std::vector<Loop>> GroupsOf(const DistanceField& field,
                                        const std::vector<double>& levels, std::size_t margin,
                                        const BoardOptions& options) {
  std::vector<std::vector<Loop>> groups(options.outline ? 2 : 1);
  const auto to_mm = [&](double place, double at_mm) {
    return (place - static_cast<double>(margin) + 0.5) * options.pixel_mm + at_mm;
  };
  for (const double level : levels) {
    for (const Loop& loop : ContoursAt(field, level)) {
      const bool around = options.outline && SignedArea(loop) > 0.0;
      Loop simple = Simplified(loop, options.tolerance_mm / options.pixel_mm);
      for (PlanePoint& p : simple) p = {to_mm(p.x, options.at_x_mm), to_mm(p.y, options.at_y_mm)};
      groups[around ? 1 : 0].push_back(std::move(simple));
    }
  }
  return groups;
}

Error NothingToMill(const char* why) { return {ErrorCode::kRml1NothingToMill, why, {}}; }

void NoteJoined(const DistanceField& field, double level, BoardLines& made) {
  constexpr double kEdge = 0.5;  // between a pixel of copper and the next one without
  const JoinedTraces counted = CountJoined(field, kEdge, level);
  made.joined = counted.joined;
  if (counted.joined == 0) return;
  constexpr ErrorCode kCode = ErrorCode::kRml1GapTooNarrow;
  made.findings.push_back({.code = kCode,
                           .severity = Lookup(kCode).severity,
                           .detail = "of " + Told("traces", counted.traces) + " traces " +
                                     Told("joined", counted.joined) +
                                     " stay joined with a neighbour"});
}

}  // namespace

Error InTermsOfPicture(Error found, const BoardLines& board) {
  if (found.code != ErrorCode::kRml1WorkBeyondTravel) return found;
  return {ErrorCode::kRml1PictureBeyondTravel,
          "the picture is " + ToldShort("width", board.width_mm, "mm", 2) + " by " +
              ToldShort("height", board.height_mm, "mm", 2) + " mm: " + found.detail,
          {}};
}

Result<BoardLines> StreamOfBoard(const Bitmap& bitmap, const machine::Parameters& parameters,
                                 const BoardOptions& options, const ByteSink& sink) {
  if (const Status good = CheckOptions(options); !good) return good.error();
  const Result<Profile> profile = MakeProfile(parameters);
  if (!profile) return profile.error();
  if (const Status good = CheckStep(options, *profile); !good) return good.error();
  if (std::ranges::find(bitmap.copper, 1) == bitmap.copper.end())
    return NothingToMill("the picture has no copper");
  if (!options.outline && std::ranges::find(bitmap.copper, 0) == bitmap.copper.end())
    return NothingToMill(
        "all of the picture is copper; to cut out a board of its size give --outline");
  const std::vector<double> levels = LevelsOf(options, *profile);
  const auto margin = static_cast<std::size_t>(std::ceil(levels.back())) + 2;
  const std::size_t pixels = (bitmap.width + 2 * margin) * (bitmap.height + 2 * margin);
  if (pixels > 2 * kPixelsMax) {
    return Error{ErrorCode::kRml1PictureTooLarge,
                 Told("pixels", pixels) + " pixels with room for the tool around it",
                 {}};
  }
  const DistanceField field = DistanceToCopper(bitmap, margin);
  BoardLines made{.width_mm = static_cast<double>(bitmap.width) * options.pixel_mm,
                  .height_mm = static_cast<double>(bitmap.height) * options.pixel_mm};
  if (!options.outline) NoteJoined(field, levels.front(), made);

  BoardMiller miller(*profile, options, sink);
  miller.Begin();
  PlanePoint at;
  for (const std::vector<Loop>& group : GroupsOf(field, levels, margin, options)) {
    std::vector<PlanePoint> starts;
    for (const Loop& loop : group) starts.push_back(loop.front());
    for (const std::size_t next : NearestOrder(starts, at)) {
      if (!miller.Mill(group[next])) {
        return Error{ErrorCode::kRml1ProductTooLarge,
                     "more than " + Told("most", options.bytes_max) + " bytes",
                     {}};
      }
      at = starts[next];
    }
    made.loops += group.size();
  }
  if (made.loops == 0) return NothingToMill("no line around the copper");
  miller.Finish(made);
  return made;
}

}  // namespace rmlcell::rml1
