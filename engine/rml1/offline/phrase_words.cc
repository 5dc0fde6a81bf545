#include "engine/rml1/offline/phrase_words.h"

#include <algorithm>
#include <cmath>

#include "engine/core/number_text.h"

namespace rmlcell::rml1 {
namespace {

using machine::MotionUse;

class Words {
 public:
  explicit Words(const Profile& profile) : profile_(profile) {}

  void Add(const std::string& words) {
    if (words.empty()) return;
    if (!text_.empty()) text_ += "; ";
    text_ += words;
  }
  std::string mm(double units) const { return ShortNumber(units / profile_.units_per_mm); }
  std::string Take() { return std::move(text_); }

 private:
  const Profile& profile_;
  std::string text_;
};

std::string RpmText(int rpm) { return std::to_string(rpm) + " rpm"; }

std::string ModeText(bool absolute) {
  return absolute ? "absolute coordinates" : "relative coordinates";
}

// Settings, by what the register holds afterwards.
void AddSetting(const Phrase& phrase, const Profile& profile, Words& words) {
  const Registers& now = *phrase.after;
  switch (phrase.op) {
    case Op::kF:
    case Op::kVS:
      return words.Add("cutting speed in X and Y " + ShortNumber(now.xy_speed) + " mm/s");
    case Op::kV:
    case Op::kVZ:
      return words.Add("speed of Z and of three axes " + ShortNumber(now.z_speed) + " mm/s");
    case Op::kW:
    case Op::kDW:
      return words.Add(now.dwell_ms == 0
                           ? "no dwell before motions"
                           : "dwell of " + std::to_string(now.dwell_ms) + " ms before motions");
    case Op::kAt:
    case Op::kPZ:
      return words.Add("tool down is Z " + words.mm(now.z1) + " mm, tool up is Z " +
                       words.mm(now.z2) + " mm");
    case Op::kMC:
      return words.Add(now.rotation ? "the spindle may turn: it starts with the next motion"
                                    : "the spindle may not turn");
    case Op::kRC:
      if (profile.spindle_control == SpindleControl::kNone)
        return words.Add("no effect: the spindle speed of this machine is set by hand");
      return words.Add("spindle speed " + RpmText(now.rpm));
    case Op::kZO:
      return words.Add("Z0 is machine Z " + words.mm(now.z0) + " mm");
    case Op::kDF:
      return words.Add("defaults: absolute coordinates, " + ShortNumber(now.xy_speed) +
                       " mm/s in X and Y, " + ShortNumber(now.z_speed) +
                       " mm/s in Z, no dwell, the spindle may turn, tool down Z " +
                       words.mm(now.z1) + " mm, up Z " + words.mm(now.z2) + " mm");
    case Op::kIN:
      return words.Add("initialise: defaults as DF, tool up, spindle off, errors cleared");
    case Op::kH:
      return words.Add("home: up to the top, to the XY origin, spindle off, errors cleared");
    default:
      return;
  }
}

bool IsHeightOrPlace(const Finding& finding) {
  return finding.kind == FindingKind::kHeightRange || finding.kind == FindingKind::kValueRange ||
         finding.kind == FindingKind::kTravelRange;
}

bool IsMotion(Op op) {
  const CommandRow& row = RowOf(op);
  return row.shape == Shape::kSets || row.shape == Shape::kAxes || op == Op::kZM;
}

void AddChanges(const Phrase& phrase, Words& words) {
  const CommandRow& row = RowOf(phrase.op);
  if (row.shape != Shape::kSets) return;
  const bool told_by_itself = phrase.kind == Phrase::Kind::kBare;
  const bool mode_changes = phrase.before->absolute != phrase.after->absolute;
  if (row.mode != ModeChange::kNone && (mode_changes || told_by_itself))
    words.Add(ModeText(phrase.after->absolute));
  const bool tool_changes = phrase.before->tool_down != phrase.after->tool_down;
  if (row.tool != ToolChange::kNone && (tool_changes || told_by_itself))
    words.Add(phrase.after->tool_down ? "tool down" : "tool up");
}

// Where commands lead beyond the travel, the tool stays behind.
void AddClipping(const Phrase& phrase, const Profile& profile, Words& words) {
  constexpr double kNoticed = 1e-3;  // device units
  const bool behind = DistanceXYZ(phrase.logical, phrase.physical) > kNoticed;
  if (!behind || (phrase.kind != Phrase::Kind::kSet && phrase.kind != Phrase::Kind::kGroup)) return;
  words.Add("beyond the travel: the commands lead to X " +
            words.mm(phrase.logical.x - profile.origin_x) + " Y " +
            words.mm(phrase.logical.y - profile.origin_y) + " Z " +
            words.mm(phrase.logical.z - phrase.after->z0) + ", the tool does not follow");
}

std::string WaysOf(const Action& action, const Point& from, double z0, const Words& words,
                   const Profile& profile) {
  std::string ways;
  const auto add = [&](char axis, double before, double now, double origin, bool degrees) {
    if (std::abs(now - before) <= 1e-6) return;
    ways += std::string(" ") + axis + ' ' +
            (degrees ? ShortNumber(now) + " degrees" : words.mm(now - origin));
  };
  add('X', from.x, action.to.x, profile.origin_x, false);
  add('Y', from.y, action.to.y, profile.origin_y, false);
  add('Z', from.z, action.to.z, z0, false);
  add('A', from.a, action.to.a, 0.0, true);
  return ways;
}

}  // namespace

std::string ShortNumber(double value, int decimals) {
  std::string text = TrimmedText(value, decimals);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text;
}

Detail ToldShort(std::string_view name, double value, std::string_view unit, int decimals) {
  return Told(name, value, unit, ShortNumber(value, decimals));
}

std::string RangeOfRefused(const Phrase& phrase, const Profile& profile) {
  const auto refused = std::ranges::find_if(phrase.findings, IsHeightOrPlace);
  if (refused == phrase.findings.end()) return {};
  const Words words(profile);
  if (refused->kind == FindingKind::kTravelRange)
    return "machine Z may be from " + words.mm(profile.z.low) + " to 0 mm";
  if (refused->kind == FindingKind::kValueRange) {
    return "a coordinate may be from " + words.mm(static_cast<double>(kFloatMin)) + " to " +
           words.mm(static_cast<double>(kFloatMax)) + " mm";
  }
  const bool of_down = !phrase.values.empty() &&
                       static_cast<double>(phrase.values[0].number.truncated()) == refused->value;
  if (!of_down) return "the tool-up height may be from 0 mm";
  return "the tool-down height may be from " + words.mm(profile.z.low - phrase.before->z0) +
         " to 0 mm";
}

std::string WordsOf(const Action& action, const Point& from, double z0, const Profile& profile) {
  const Words words(profile);
  switch (action.kind) {
    case Action::Kind::kSpindleStart:
      return "spindle starts, " + RpmText(action.rpm);
    case Action::Kind::kSpindleStop:
      return "spindle stops";
    case Action::Kind::kSpindleSpeed:
      return "spindle changes to " + RpmText(action.rpm);
    case Action::Kind::kDwell:
      return "wait " + std::to_string(action.dwell_ms) + " ms";
    case Action::Kind::kPause:
      return action.outside ? "pause on the way back into the travel" : "pause until resumed";
    case Action::Kind::kMotion:
      break;
  }
  const std::string_view verb = action.use == MotionUse::kCut       ? "cut to"
                                : action.use == MotionUse::kPlunge  ? "down into the work to"
                                : action.use == MotionUse::kRetract ? "up to"
                                                                    : "go to";
  return std::string(verb) + WaysOf(action, from, z0, words, profile) + " at " +
         ShortNumber(action.speed_mm_s, 3) + " mm/s";
}

std::string WordsOf(const Phrase& phrase, const Profile& profile) {
  using Kind = Phrase::Kind;
  const std::int64_t bytes = phrase.end - phrase.begin;
  switch (phrase.kind) {
    case Kind::kDiscarded:
      return std::to_string(bytes) + (bytes == 1 ? " byte that is" : " bytes that are") +
             " no command";
    case Kind::kLinkError:
      return "a device control sequence that the machine refuses";
    case Kind::kAbort:
      return "ESC.K: what was received and not carried out is forgotten";
    case Kind::kIncomplete:
      return "the data ends inside a command, which is not carried out";
    case Kind::kSkipped:
      return "vendor command, skipped with its parameters";
    case Kind::kLeftOver:
      return "not carried out";
    default:
      break;
  }
  Words words(profile);
  AddSetting(phrase, profile, words);
  AddChanges(phrase, words);
  Point at = phrase.physical_before;
  for (const Action& action : phrase.actions) {
    words.Add(WordsOf(action, at, phrase.before->z0, profile));
    if (action.kind == Action::Kind::kMotion) at = action.to;
  }
  const bool moves = std::ranges::any_of(
      phrase.actions, [](const Action& action) { return action.kind == Action::Kind::kMotion; });
  if (!moves && phrase.findings.empty() && IsMotion(phrase.op) &&
      (phrase.kind != Kind::kBare || RowOf(phrase.op).tool != ToolChange::kNone)) {
    words.Add("the tool does not move");
  }
  AddClipping(phrase, profile, words);
  words.Add(RangeOfRefused(phrase, profile));
  std::string text = words.Take();
  return text.empty() ? "nothing happens" : text;
}

}  // namespace rmlcell::rml1
