#include "engine/rml1/offline/from_gcode.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "engine/machine/program_file.h"
#include "engine/rml1/offline/gcode_arc.h"
#include "engine/rml1/offline/gcode_reader.h"
#include "engine/rml1/offline/gcode_words.h"
#include "engine/rml1/offline/phrase_words.h"
#include "engine/rml1/offline/stream_writer.h"

namespace rmlcell::rml1 {
namespace {

constexpr double kInch_mm = 25.4;
constexpr double kSecondsPerMinute = 60.0;
constexpr double kChordsMax = 100'000.0;  // of one arc

std::string WordText(const GcodeWord& word) {
  return std::string(1, word.letter) + ShortNumber(word.value, 6);
}

// The row of a G or M word; null: it is not in the subset.
const GcodeRow* RowOf(const GcodeWord& word) {
  const double tenths = word.value * 10.0;
  if (!(tenths >= 0.0 && tenths < 1e6) || std::round(tenths) != tenths) return nullptr;
  const auto row = std::ranges::find_if(kGcodeRows, [&](const GcodeRow& candidate) {
    return candidate.letter == word.letter && candidate.tenths == static_cast<int>(tenths);
  });
  return row == kGcodeRows.end() ? nullptr : &*row;
}

// One line, its words by what they say.
struct Orders {
  std::optional<GcodeUse> motion;  // a motion word of this line
  const GcodeWord* motion_word = nullptr;
  bool dwell = false;
  bool spindle_on = false;
  bool spindle_off = false;
  bool pause = false;
  bool end = false;
  std::map<char, const GcodeWord*> values;  // X Y Z I J R F S P

  const GcodeWord* Find(char letter) const {
    const auto found = values.find(letter);
    return found == values.end() ? nullptr : found->second;
  }
  const GcodeWord* AxisWord() const {
    for (const char letter : {'X', 'Y', 'Z', 'I', 'J', 'R'}) {
      if (const GcodeWord* word = Find(letter)) return word;
    }
    return nullptr;
  }
};

class Interpreter {
 public:
  Interpreter(const Profile& profile, const FromGcodeOptions& options)
      : profile_(profile), options_(options), writer_(profile) {
    z_ = static_cast<double>(writer_.at().z) / profile.units_per_mm;
  }

  void Run(std::string_view text) {
    GcodeReader reader(text);
    while (std::optional<Result<GcodeBlock>> block = reader.Next()) {
      if (!*block) {
        Refuse(block->error());
      } else if (ended_) {
        NoteBehindEnd(**block);
      } else if ((*block)->percent) {
        ended_ = std::exchange(begun_, true);
      } else if (!(*block)->words.empty()) {
        begun_ = true;
        Obey(**block);
      }
      if (made_.findings_dropped > 0 && !made_.ok) break;
    }
  }

  StreamOfGcode Take() {
    if (writer_.dwell_ms() > 0 && made_.ok)
      Note(ErrorCode::kRml1GcodeIgnored, "wait", "the wait behind the last motion", {});
    if (made_.ok) made_.stream = writer_.Take();
    return std::move(made_);
  }

 private:
  void Add(ErrorCode code, std::string detail, const SourceSpan& where) {
    if (made_.findings.size() == machine::kDiagnosticsMax) {
      ++made_.findings_dropped;
      return;
    }
    made_.findings.push_back({.code = code,
                              .severity = Lookup(code).severity,
                              .detail = std::move(detail),
                              .where = where});
  }
  void Refuse(const Error& error) {
    made_.ok = false;
    Add(error.code, error.detail, error.where.value_or(SourceSpan{}));
  }
  void Refuse(ErrorCode code, std::string detail, const SourceSpan& where) {
    Refuse(Error{code, std::move(detail), where});
  }
  // Of each key once: CAM tools write some words on every line.
  void Note(ErrorCode code, const std::string& key, const std::string& detail,
            const SourceSpan& where) {
    if (told_.insert(key).second) Add(code, detail, where);
  }

  void NoteBehindEnd(const GcodeBlock& block) {
    if (!block.words.empty())
      Note(ErrorCode::kRml1GcodeIgnored, "end", "what stands behind the end of the program",
           block.words.front().where);
  }

  std::optional<Orders> Sort(const GcodeBlock& block);
  bool SortCode(const GcodeWord& word, const GcodeRow& row, Orders& orders);
  bool SortValue(const GcodeWord& word, const GcodeBlock& block, Orders& orders);
  void Obey(const GcodeBlock& block);
  void SetFeed(const GcodeWord& word);
  void SetSpindleSpeed(const GcodeWord& word);
  void Wait(const Orders& orders, const GcodeBlock& block);
  void Move(const Orders& orders, const GcodeBlock& block);
  void MoveArc(const Orders& orders, GcodeUse motion, double x, double y, double z);
  std::optional<Units> UnitsOf(double x, double y, double z, const SourceSpan& where);
  void CutTo(double x, double y, double z, const SourceSpan& where);
  void NoteFeed(double used_mm_s, const SourceSpan& where);

  const Profile& profile_;
  const FromGcodeOptions& options_;
  StreamWriter writer_;
  StreamOfGcode made_{.ok = true};
  std::set<std::string> told_;  // bounded: the words of the subset, and a few of ours
  std::optional<GcodeUse> motion_;
  double unit_mm_ = 1.0;
  double x_ = 0.0;  // mm, as the program says and not rounded
  double y_ = 0.0;
  double z_ = 0.0;
  std::optional<double> feed_mm_s_;
  SourceSpan feed_where_;
  bool begun_ = false;
  bool moved_ = false;
  bool ended_ = false;
};

// A G or M word. False: it is refused.
bool Interpreter::SortCode(const GcodeWord& word, const GcodeRow& row, Orders& orders) {
  switch (row.use) {
    case GcodeUse::kRapid:
    case GcodeUse::kLine:
    case GcodeUse::kArcClockwise:
    case GcodeUse::kArcCounter:
      if (orders.motion_word != nullptr || orders.dwell) {
        Refuse(ErrorCode::kRml1GcodeForm, "two words that move or wait in one line", word.where);
        return false;
      }
      orders.motion = row.use;
      orders.motion_word = &word;
      return true;
    case GcodeUse::kDwell:
      if (orders.motion_word != nullptr || orders.dwell) {
        Refuse(ErrorCode::kRml1GcodeForm, "two words that move or wait in one line", word.where);
        return false;
      }
      orders.dwell = true;
      return true;
    case GcodeUse::kInch:
      unit_mm_ = kInch_mm;
      return true;
    case GcodeUse::kMetric:
      unit_mm_ = 1.0;
      return true;
    case GcodeUse::kDefault:
      return true;
    case GcodeUse::kIgnored:
      Note(ErrorCode::kRml1GcodeIgnored, WordText(word),
           WordText(word) + ", " + std::string(row.text), word.where);
      return true;
    case GcodeUse::kToolChange:
      if (moved_) {
        Refuse(ErrorCode::kRml1GcodeWord,
               WordText(word) + " behind the first motion: write a program for each tool",
               word.where);
        return false;
      }
      Note(ErrorCode::kRml1GcodeIgnored, "M6", WordText(word) + ", the tool is put in by hand",
           word.where);
      return true;
    case GcodeUse::kPause:
      orders.pause = true;
      return true;
    case GcodeUse::kEnd:
      orders.end = true;
      return true;
    case GcodeUse::kSpindleOn:
      orders.spindle_on = true;
      return true;
    case GcodeUse::kSpindleOff:
      orders.spindle_off = true;
      return true;
  }
  return false;
}

// A word of any other letter. False: it is refused.
bool Interpreter::SortValue(const GcodeWord& word, const GcodeBlock& block, Orders& orders) {
  if (word.letter == 'T') {
    Note(ErrorCode::kRml1GcodeIgnored, "T", "T, the tool is put in by hand", word.where);
    return true;
  }
  if (word.letter == 'O' && block.words.size() == 1) {
    Note(ErrorCode::kRml1GcodeIgnored, "O", WordText(word) + ", the number of the program",
         word.where);
    return true;
  }
  if (std::string_view("XYZIJRFSP").find(word.letter) == std::string_view::npos) {
    Refuse(ErrorCode::kRml1GcodeWord, WordText(word), word.where);
    return false;
  }
  if (!orders.values.emplace(word.letter, &word).second) {
    Refuse(ErrorCode::kRml1GcodeForm, std::string(1, word.letter) + " twice in one line",
           word.where);
    return false;
  }
  return true;
}

// Nothing: the line is refused.
std::optional<Orders> Interpreter::Sort(const GcodeBlock& block) {
  Orders orders;
  bool good = true;
  bool path_mode = false;  // G64 takes a P of its own
  for (const GcodeWord& word : block.words) {
    if (word.letter != 'G' && word.letter != 'M') {
      good = SortValue(word, block, orders) && good;
      continue;
    }
    const GcodeRow* row = RowOf(word);
    if (row == nullptr) {
      Refuse(ErrorCode::kRml1GcodeWord, WordText(word), word.where);
      good = false;
      continue;
    }
    path_mode = path_mode || (row->letter == 'G' && row->tenths == 640);
    good = SortCode(word, *row, orders) && good;
  }
  if (const GcodeWord* p = orders.Find('P'); p != nullptr && !orders.dwell) {
    if (!path_mode) {
      Refuse(ErrorCode::kRml1GcodeWord, WordText(*p) + " without G4", p->where);
      good = false;
    }
  }
  return good ? std::optional(std::move(orders)) : std::nullopt;
}

// In the order of execution that CAM tools rely on: speeds, spindle, wait, motion, pause, end.
void Interpreter::Obey(const GcodeBlock& block) {
  const std::optional<Orders> orders = Sort(block);
  if (!orders) return;
  if (const GcodeWord* feed = orders->Find('F')) SetFeed(*feed);
  if (const GcodeWord* speed = orders->Find('S')) SetSpindleSpeed(*speed);
  if (orders->spindle_on) writer_.SpindleOn();
  if (orders->spindle_off) writer_.SpindleOff();
  if (orders->motion) motion_ = orders->motion;
  if (orders->dwell) {
    Wait(*orders, block);
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
         WordText(word) + " becomes " + std::to_string(used) + " rpm", word.where);
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
                      ShortNumber(StreamWriter::kDwellMax_ms / 1000.0) + " s",
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
  const auto target = [&](char letter, double present) {
    const GcodeWord* word = orders.Find(letter);
    return word == nullptr ? present : word->value * unit_mm_;
  };
  const double x = target('X', x_);
  const double y = target('Y', y_);
  const double z = target('Z', z_);
  moved_ = true;
  const bool arc = *motion_ == GcodeUse::kArcClockwise || *motion_ == GcodeUse::kArcCounter;
  for (const char letter : {'I', 'J', 'R'}) {
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
    writer_.Rapid(*to);
  }
  x_ = x;
  y_ = y;
  z_ = z;
}

void Interpreter::MoveArc(const Orders& orders, GcodeUse motion, double x, double y, double z) {
  const SourceSpan where = orders.AxisWord()->where;
  const auto value = [&](char letter) -> std::optional<double> {
    const GcodeWord* word = orders.Find(letter);
    if (word == nullptr) return std::nullopt;
    return word->value * unit_mm_;
  };
  const Result<Arc> arc = ArcOf({.from = {x_, y_},
                                 .to = {x, y},
                                 .clockwise = motion == GcodeUse::kArcClockwise,
                                 .i = value('I'),
                                 .j = value('J'),
                                 .r = value('R')});
  if (!arc) return Refuse(arc.error().code, arc.error().detail, where);
  const double chords = arc->Chords(options_.tolerance_mm);
  if (chords > kChordsMax) {
    return Refuse(ErrorCode::kRml1ProductTooLarge,
                  "an arc of " + ShortNumber(chords, 0) + " chords", where);
  }
  const auto count = static_cast<int>(chords);
  for (int k = 1; k < count; ++k) {
    const double share = k / chords;
    const motion::PlanVector at = arc->At(share);
    CutTo(at.x(), at.y(), z_ + (z - z_) * share, where);
  }
  CutTo(x, y, z, where);
}

std::optional<Units> Interpreter::UnitsOf(double x, double y, double z, const SourceSpan& where) {
  for (const auto& [axis, mm] : {std::pair('X', x), {'Y', y}, {'Z', z}}) {
    const double units = mm * profile_.units_per_mm;
    if (units >= static_cast<double>(kFloatMin) && units <= static_cast<double>(kFloatMax))
      continue;
    Refuse(ErrorCode::kRml1GcodeRange, std::string(1, axis) + " " + ShortNumber(mm) + " mm", where);
    return std::nullopt;
  }
  if (writer_.size() > options_.bytes_max) {
    const bool first = std::exchange(made_.ok, false);
    if (first) Refuse(ErrorCode::kRml1ProductTooLarge, "the stream", where);
    return std::nullopt;
  }
  return Units{NearestUnit(x, profile_), NearestUnit(y, profile_), NearestUnit(z, profile_)};
}

void Interpreter::CutTo(double x, double y, double z, const SourceSpan& where) {
  const std::optional<Units> to = UnitsOf(x, y, z, where);
  if (to) NoteFeed(writer_.Cut(*to, *feed_mm_s_), feed_where_);
}

void Interpreter::NoteFeed(double used_mm_s, const SourceSpan& where) {
  constexpr double kSame = 1e-9;
  if (std::abs(used_mm_s - *feed_mm_s_) <= kSame * *feed_mm_s_) return;
  constexpr int kShownDecimals = 3;
  Note(ErrorCode::kRml1SpeedRounded, "F",
       ShortNumber(*feed_mm_s_, kShownDecimals) + " mm/s becomes " + ShortNumber(used_mm_s) +
           " mm/s, a speed of the machine",
       where);
}

}  // namespace

Result<StreamOfGcode> FromGcode(std::string_view text, const machine::Parameters& parameters,
                                const FromGcodeOptions& options) {
  if (!(options.tolerance_mm > 0.0 && std::isfinite(options.tolerance_mm)))
    return InvalidArgument("the tolerance is " + ShortNumber(options.tolerance_mm) +
                           " mm; it must be above 0");
  if (text.empty()) return Error{ErrorCode::kCellEmptyProgram, "the G-code has no bytes", {}};
  const Result<Profile> profile = MakeProfile(parameters);
  if (!profile) return profile.error();
  Interpreter interpreter(*profile, options);
  interpreter.Run(text);
  return interpreter.Take();
}

}  // namespace rmlcell::rml1
