#include "engine/rml1/offline/from_gcode.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/rml1/offline/gcode_arc.h"
#include "engine/rml1/offline/gcode_orders.h"
#include "engine/rml1/offline/gcode_reader.h"
#include "engine/rml1/offline/phrase_words.h"
#include "engine/rml1/offline/stream_writer.h"

namespace rmlcell::rml1 {
namespace {

constexpr double kSecondsPerMinute = 60.0;
constexpr double kChordsMax = 100'000.0;  // of one arc

class Interpreter {
 public:
  Interpreter(const Profile& profile, const FromGcodeOptions& options, const ByteSink& sink)
      : profile_(profile), options_(options), writer_(profile, sink), top_(writer_.at().z) {
    z_ = static_cast<double>(top_) / profile.units_per_mm;
  }

  void Run(const machine::Bytes& text) {
    GcodeReader reader(*text);
    std::size_t released = 0;
    while (std::optional<Result<GcodeBlock>> block = reader.Next()) {
      if (reader.offset() - released > machine::kReleaseEvery) {
        text.Release();
        released = reader.offset();
      }
      if (!*block) {
        findings_.Refuse(block->error());
      } else if (ended_) {
        NoteBehindEnd(**block);
      } else if ((*block)->percent) {
        ended_ = std::exchange(begun_, true);
      } else if (!(*block)->words.empty()) {
        begun_ = true;
        Obey(**block);
      }
      if (findings_.full() && !findings_.ok()) break;
    }
  }

  FromGcodeOutcome Finish() {
    if (writer_.dwell_ms() > 0 && findings_.ok())
      Note(ErrorCode::kRml1GcodeIgnored, "wait", "the wait behind the last motion", {});
    TellStands(before_on_, "before M3 turns the spindle on");
    TellStands(behind_off_, "behind M5, which stops the spindle");
    TellRapids(across_, "across");
    TellRapids(down_, "down");
    if (findings_.ok()) writer_.Finish();
    FromGcodeOutcome outcome = findings_.Take();
    outcome.beyond_travel = beyond_travel_;
    return outcome;
  }

 private:
  // Lines of one kind that a person should look at: CAM tools repeat their habits on every line.
  struct LinesInWork {
    std::uint64_t count = 0;
    SourceSpan first;
    Detail InMore() const {
      return count > 1 ? ", here and in " + Told("lines", count - 1) +
                             (count > 2 ? " more lines" : " more line")
                       : Detail();
    }
  };

  void Refuse(ErrorCode code, Detail detail, const SourceSpan& where) {
    findings_.Refuse(code, std::move(detail), where);
  }
  void Note(ErrorCode code, const std::string& key, const Detail& detail, const SourceSpan& where) {
    findings_.Note(code, key, detail, where);
  }

  void NoteBehindEnd(const GcodeBlock& block) {
    if (!block.words.empty())
      Note(ErrorCode::kRml1GcodeIgnored, "end", "what stands behind the end of the program",
           block.words.front().where);
  }

  void Obey(const GcodeBlock& block);
  void SetFeed(const GcodeWord& word);
  void SetSpindleSpeed(const GcodeWord& word);
  void TurnSpindle(bool on);
  void Wait(const Orders& orders, const GcodeBlock& block);
  void Move(const Orders& orders, const GcodeBlock& block);
  void MoveRapid(const Units& to, const SourceSpan& where);
  void TellRapids(const LinesInWork& rapids, const char* way);
  void NoteStanding(const Units& to, const SourceSpan& where);
  void TellStands(const LinesInWork& lines, const char* when);
  void ChangeTool(const Orders& orders);
  void GoHome(const Orders& orders, const GcodeBlock& block);
  void MoveArc(const Orders& orders, GcodeUse motion, double x, double y, double z);
  std::optional<Units> UnitsOf(double x, double y, double z, const SourceSpan& where);
  void CutTo(double x, double y, double z, const SourceSpan& where);
  void NoteFeed(double used_mm_s, const SourceSpan& where);

  const Profile& profile_;
  const FromGcodeOptions& options_;
  StreamWriter writer_;
  const std::int64_t top_;  // of the travel, from Z 0
  GcodeFindings findings_;
  std::optional<SourceSpan> beyond_travel_;
  std::optional<GcodeUse> motion_;
  double unit_mm_ = 1.0;
  ArcPlane plane_;
  double x_ = 0.0;  // mm, as the program says and not rounded
  double y_ = 0.0;
  double z_ = 0.0;
  std::optional<double> feed_mm_s_;
  SourceSpan feed_where_;
  bool begun_ = false;
  bool relative_ = false;  // G91: good for G28 alone
  bool cut_ = false;
  std::optional<double> tool_;  // the last T, and the one of the first cut
  std::optional<double> cutting_tool_;
  LinesInWork across_;  // rapids
  LinesInWork down_;
  bool spindle_on_ = false;
  bool stopped_ = false;   // by M5, since the last M3 at the latest
  LinesInWork before_on_;  // cuts while the spindle stands
  LinesInWork behind_off_;
  int last_standing_line_ = 0;
  bool ended_ = false;
};

// In the order of execution that CAM tools rely on: speeds, spindle, wait, motion, pause, end.
void Interpreter::Obey(const GcodeBlock& block) {
  const std::optional<Orders> orders = OrdersOf(block, findings_);
  if (!orders) return;
  unit_mm_ = orders->unit_mm.value_or(unit_mm_);
  relative_ = orders->relative.value_or(relative_);
  plane_ = orders->plane.value_or(plane_);
  if (orders->tool) tool_ = orders->tool;
  if (const GcodeWord* feed = orders->Find('F')) SetFeed(*feed);
  if (const GcodeWord* speed = orders->Find('S')) SetSpindleSpeed(*speed);
  if (orders->tool_change != nullptr) ChangeTool(*orders);
  if (orders->spindle_on) TurnSpindle(true);
  if (orders->spindle_off) TurnSpindle(false);
  if (orders->motion) motion_ = orders->motion;
  if (orders->dwell) {
    Wait(*orders, block);
  } else if (orders->home) {
    GoHome(*orders, block);
  } else if (orders->AxisWord() != nullptr) {
    Move(*orders, block);
  }
  if (orders->pause) writer_.Pause();
  ended_ = orders->end;
}

void Interpreter::SetFeed(const GcodeWord& word) {
  if (!(word.value > 0.0)) {
    return Refuse(ErrorCode::kRml1GcodeFeed, WordText(word) + " is no speed", word.where);
  }
  feed_mm_s_ = word.value * unit_mm_ / kSecondsPerMinute;
  feed_where_ = word.where;
}

void Interpreter::SetSpindleSpeed(const GcodeWord& word) {
  if (word.value < 0.0)
    return Refuse(ErrorCode::kRml1GcodeForm, WordText(word) + " is no speed", word.where);
  if (word.value == 0.0) return;  // some write it beside M5
  const int used = writer_.SpindleSpeed(word.value);
  if (used == 0) {
    Note(ErrorCode::kRml1GcodeIgnored, "S", "S, the spindle speed of this machine is set by hand",
         word.where);
  } else if (used != word.value) {
    Note(ErrorCode::kRml1SpeedRounded, "S",
         WordText(word) + " becomes " + Told("speed", used, "rpm", std::to_string(used) + " rpm"),
         word.where);
  }
}

void Interpreter::TurnSpindle(bool on) {
  stopped_ = !on && (stopped_ || spindle_on_);
  spindle_on_ = on;
  if (on) {
    writer_.SpindleOn();
  } else {
    writer_.SpindleOff();
  }
}

void Interpreter::Wait(const Orders& orders, const GcodeBlock& block) {
  const SourceSpan& where = block.words.front().where;
  if (const GcodeWord* axis = orders.AxisWord())
    return Refuse(ErrorCode::kRml1GcodeWord, WordText(*axis) + " with G4: P gives the seconds",
                  axis->where);
  const GcodeWord* seconds = orders.Find('P');
  if (seconds == nullptr || seconds->value < 0.0)
    return Refuse(ErrorCode::kRml1GcodeForm, "G4 without a P of seconds", where);
  const double ms = std::round(seconds->value * 1000.0);
  if (ms + writer_.dwell_ms() > StreamWriter::kDwellMax_ms) {
    return Refuse(ErrorCode::kRml1GcodeRange,
                  WordText(*seconds) + ": a wait is at most " +
                      ToldShort("most", StreamWriter::kDwellMax_ms / 1000.0, "s") + " s",
                  seconds->where);
  }
  writer_.Dwell(static_cast<int>(ms));
}

void Interpreter::Move(const Orders& orders, const GcodeBlock& block) {
  const SourceSpan& where = block.words.front().where;
  if (!motion_) {
    return Refuse(ErrorCode::kRml1GcodeForm,
                  WordText(*orders.AxisWord()) + " before any of G0 G1 G2 G3",
                  orders.AxisWord()->where);
  }
  if (relative_)
    return Refuse(
        ErrorCode::kRml1GcodeWord,
        WordText(*orders.AxisWord()) + " under G91: post-process for absolute coordinates",
        orders.AxisWord()->where);
  const auto target = [&](char letter, double present) {
    const GcodeWord* word = orders.Find(letter);
    return word == nullptr ? present : word->value * unit_mm_;
  };
  const double x = target('X', x_);
  const double y = target('Y', y_);
  const double z = target('Z', z_);
  const bool arc = *motion_ == GcodeUse::kArcClockwise || *motion_ == GcodeUse::kArcCounter;
  for (const char letter : {'I', 'J', 'K', 'R'}) {
    const GcodeWord* word = orders.Find(letter);
    if (!arc && word != nullptr)
      return Refuse(ErrorCode::kRml1GcodeWord, WordText(*word) + " without G2 or G3", word->where);
  }
  if (*motion_ != GcodeUse::kRapid && !feed_mm_s_)
    return Refuse(ErrorCode::kRml1GcodeFeed, "no F so far", where);
  if (arc) {
    MoveArc(orders, *motion_, x, y, z);
  } else if (*motion_ == GcodeUse::kLine) {
    CutTo(x, y, z, where);
  } else if (const auto to = UnitsOf(x, y, z, where)) {
    MoveRapid(*to, where);
  }
  x_ = x;
  y_ = y;
  z_ = z;
}

void Interpreter::MoveRapid(const Units& to, const SourceSpan& where) {
  const Units from = writer_.at();
  const bool across = (to.x != from.x || to.y != from.y) && std::min(from.z, to.z) < 0;
  const bool down = to.z < std::min<std::int64_t>(from.z, 0);
  if (across || down) {
    LinesInWork& rapids = across ? across_ : down_;
    if (rapids.count++ == 0) rapids.first = where;
  }
  writer_.Rapid(to);
}

void Interpreter::NoteStanding(const Units& to, const SourceSpan& where) {
  if (spindle_on_ || std::min(to.z, writer_.at().z) >= 0 || where.line == last_standing_line_)
    return;
  last_standing_line_ = where.line;
  LinesInWork& lines = stopped_ ? behind_off_ : before_on_;
  if (lines.count++ == 0) lines.first = where;
}

void Interpreter::TellStands(const LinesInWork& lines, const char* when) {
  if (lines.count == 0 || !findings_.ok()) return;
  findings_.Add(ErrorCode::kRml1GcodeSpindleStands,
                "a cut below Z 0 " + std::string(when) + lines.InMore(), lines.first);
}

void Interpreter::TellRapids(const LinesInWork& rapids, const char* way) {
  if (rapids.count == 0 || !findings_.ok()) return;
  findings_.Add(
      ErrorCode::kRml1GcodeRapidInWork,
      "G0 leads " + std::string(way) + " below Z 0" + rapids.InMore() +
          ": the stream goes there at " +
          ToldShort("speed", profile_.z_speeds.Nearest(profile_.z_speeds.maximum_mm_s), "mm/s") +
          " mm/s",
      rapids.first);
}

// The tool is put in by hand before the program begins, and stays.
void Interpreter::ChangeTool(const Orders& orders) {
  const GcodeWord& word = *orders.tool_change;
  if (cut_ && (!tool_ || tool_ != cutting_tool_)) {
    return Refuse(ErrorCode::kRml1GcodeWord,
                  WordText(word) + " behind the first cut: write a program for each tool",
                  word.where);
  }
  Note(ErrorCode::kRml1GcodeIgnored, "M6", WordText(word) + ", the tool is put in by hand",
       word.where);
}

// Home of a mill is the top, and its XY work origin; as with its command H, Z goes first. Without
// G91 a G28 goes by way of the place that it names, which may be inside the work.
void Interpreter::GoHome(const Orders& orders, const GcodeBlock& block) {
  const SourceSpan& where = block.words.front().where;
  if (!relative_)
    return Refuse(ErrorCode::kRml1GcodeWord, "G28 without G91: write G28 G91 Z0", where);
  bool any = false;
  for (const char letter : {'X', 'Y', 'Z', 'I', 'J', 'K', 'R'}) {
    const GcodeWord* word = orders.Find(letter);
    if (word == nullptr) continue;
    if (word->value != 0.0 || std::string_view("XYZ").find(letter) == std::string_view::npos)
      return Refuse(ErrorCode::kRml1GcodeWord, WordText(*word) + " with G28: zeros alone are taken",
                    word->where);
    any = true;
  }
  Units to = writer_.at();
  to.z = top_;
  writer_.Rapid(to);
  z_ = static_cast<double>(top_) / profile_.units_per_mm;
  if (!any || orders.Find('X') != nullptr) x_ = 0.0;
  if (!any || orders.Find('Y') != nullptr) y_ = 0.0;
  if (const auto home = UnitsOf(x_, y_, z_, where)) writer_.Rapid(*home);
}

// Chords in the plane of the arc, with the third axis in equal steps.
void Interpreter::MoveArc(const Orders& orders, GcodeUse motion, double x, double y, double z) {
  const SourceSpan where = orders.AxisWord()->where;
  for (const char letter : {'I', 'J', 'K'}) {
    const GcodeWord* word = orders.Find(letter);
    if (word != nullptr && std::ranges::find(plane_.centre, letter) == plane_.centre.end())
      return Refuse(ErrorCode::kRml1GcodeArc, WordText(*word) + " is not in the plane of the arc",
                    word->where);
  }
  const auto value = [&](char letter) -> std::optional<double> {
    const GcodeWord* word = orders.Find(letter);
    if (word == nullptr) return std::nullopt;
    return word->value * unit_mm_;
  };
  const std::array<double, 3> from{x_, y_, z_};
  const std::array<double, 3> to{x, y, z};
  const auto index = [&](std::size_t k) { return static_cast<std::size_t>(plane_.axes[k] - 'X'); };
  const std::size_t first = index(0), second = index(1), third = index(2);
  const Result<Arc> arc = ArcOf({.from = {from[first], from[second]},
                                 .to = {to[first], to[second]},
                                 .clockwise = motion == GcodeUse::kArcClockwise,
                                 .i = value(plane_.centre[0]),
                                 .j = value(plane_.centre[1]),
                                 .r = value('R')});
  if (!arc) return Refuse(arc.error().code, arc.error().detail, where);
  const double chords = arc->Chords(options_.tolerance_mm);
  if (chords > kChordsMax) {
    return Refuse(ErrorCode::kRml1ProductTooLarge,
                  "an arc of " + ToldShort("chords", chords, {}, 0) + " chords", where);
  }
  const auto count = static_cast<int>(chords);
  for (int k = 1; k < count; ++k) {
    const double share = k / chords;
    const motion::PlanVector in_plane = arc->At(share);
    std::array<double, 3> at{};
    at[first] = in_plane.x();
    at[second] = in_plane.y();
    at[third] = from[third] + (to[third] - from[third]) * share;
    CutTo(at[0], at[1], at[2], where);
  }
  CutTo(x, y, z, where);
}

std::optional<Units> Interpreter::UnitsOf(double x, double y, double z, const SourceSpan& where) {
  for (const auto& [axis, mm] : {std::pair('X', x), {'Y', y}, {'Z', z}}) {
    const double units = std::round(mm * profile_.units_per_mm);
    if (units >= static_cast<double>(kFloatMin) && units <= static_cast<double>(kFloatMax))
      continue;
    Refuse(ErrorCode::kRml1GcodeRange,
           Told("axis", {&axis, 1}) + " " + ToldShort("value", mm, "mm") + " mm", where);
    return std::nullopt;
  }
  if (writer_.size() > options_.bytes_max) {
    if (findings_.ok()) Refuse(ErrorCode::kRml1ProductTooLarge, "the stream", where);
    return std::nullopt;
  }
  const Units to{NearestUnit(x, profile_), NearestUnit(y, profile_), NearestUnit(z, profile_)};
  const auto beyond = [](std::int64_t at, double origin, const Travel& travel) {
    const double place = static_cast<double>(at) + origin;
    return place < travel.low || place > travel.high;
  };
  const bool below = static_cast<double>(to.z) + profile_.z0 < profile_.z.low;
  if (!beyond_travel_ && std::min(to.z, writer_.at().z) < 0 &&
      (below || beyond(to.x, profile_.origin_x, profile_.x) ||
       beyond(to.y, profile_.origin_y, profile_.y)))
    beyond_travel_ = where;
  return to;
}

void Interpreter::CutTo(double x, double y, double z, const SourceSpan& where) {
  if (!std::exchange(cut_, true)) cutting_tool_ = tool_;
  if (const std::optional<Units> to = UnitsOf(x, y, z, where)) {
    NoteStanding(*to, where);
    NoteFeed(writer_.Cut(*to, *feed_mm_s_), feed_where_);
  }
}

void Interpreter::NoteFeed(double used_mm_s, const SourceSpan& where) {
  constexpr double kSame = 1e-9;
  if (std::abs(used_mm_s - *feed_mm_s_) <= kSame * *feed_mm_s_) return;
  constexpr int kShownDecimals = 3;
  Note(ErrorCode::kRml1SpeedRounded, "F",
       ToldShort("wanted", *feed_mm_s_, "mm/s", kShownDecimals) + " mm/s becomes " +
           ToldShort("feed_rate", used_mm_s, "mm/s") + " mm/s, a speed of the machine",
       where);
}

}  // namespace

Result<FromGcodeOutcome> FromGcode(const machine::Bytes& text,
                                   const machine::Parameters& parameters,
                                   const FromGcodeOptions& options, const ByteSink& sink) {
  if (!(options.tolerance_mm > 0.0 && std::isfinite(options.tolerance_mm)))
    return InvalidArgument("the tolerance is " +
                           ToldShort("tolerance", options.tolerance_mm, "mm") +
                           " mm; it must be above 0");
  if (text->empty()) return Error{ErrorCode::kCellEmptyProgram, "the G-code has no bytes", {}};
  const Result<Profile> profile = MakeProfile(parameters);
  if (!profile) return profile.error();
  Interpreter interpreter(*profile, options, sink);
  interpreter.Run(text);
  return interpreter.Finish();
}

}  // namespace rmlcell::rml1
