#include "engine/rml1/offline/to_gcode.h"

#include <cmath>
#include <optional>

#include "engine/core/number_text.h"
#include "engine/machine/program_file.h"
#include "engine/rml1/offline/phrase_words.h"
#include "engine/rml1/offline/stream_walk.h"
#include "engine/rml1/offline/text_parts.h"

namespace rmlcell::rml1 {
namespace {

class GcodeWriter final : public PhraseListener {
 public:
  GcodeWriter(const machine::Bytes& stream, const Profile& profile, const ByteSink& sink)
      : stream_(stream), profile_(profile), text_(sink) {
    text_.Add(
        "(made of an RML-1 stream; X0 Y0 is its work origin, Z0 its Z0)\n"
        "G21 G90 G17 G94\n");
  }

  bool OnPhrase(const Phrase& phrase) override {
    for (const Finding& finding : phrase.findings) Note(ToDiagnostic(finding, *stream_, lines_));
    if (phrase.kind == Phrase::Kind::kIncomplete) {
      NoteAt(phrase.begin, ErrorCode::kRml1IncompleteCommand,
             "the data ends inside a command, which is not carried out");
    }
    Point at = phrase.physical_before;
    for (const Action& action : phrase.actions) {
      if (action.kind != Action::Kind::kMotion) {
        Add(action);
        continue;
      }
      if (std::abs(action.to.a - at.a) > kSameAngle_deg) {
        error_ = Error{ErrorCode::kRml1RotaryMotion,
                       "A goes to " + ToldShort("angle", action.to.a, "deg") + " degrees",
                       lines_.At(*stream_, phrase.begin, 1)};
        return false;
      }
      NoteFeed(action, phrase);
      AddMotion(action, at);
      at = action.to;
    }
    return true;
  }

  Result<ToGcodeNotes> Finish() {
    if (error_) return *error_;
    if (spindle_turns_) {
      NoteAt(static_cast<std::int64_t>(stream_->size()), ErrorCode::kRml1SpindleLeftOn,
             "the spindle goes on turning at the end, where M30 stops it");
    }
    text_.Add("M30\n");
    text_.HandOver();
    return std::move(notes_);
  }

 private:
  // For who makes the G-code, and in it for who reads it.
  void Note(Diagnostic finding) {
    if (notes_.findings.size() == machine::kDiagnosticsMax) {
      notes_.findings_dropped.Add(finding);
      return;
    }
    std::string comment = CodeText(finding.code) + " in the stream: " + finding.detail;
    for (char& c : comment) {
      if (c < ' ' || c > '~') c = '?';
      if (c == '(') c = '[';
      if (c == ')') c = ']';
    }
    text_.Add("(" + comment + ")\n");
    notes_.findings.push_back(std::move(finding));
  }
  void NoteAt(std::int64_t offset, ErrorCode code, Detail detail) {
    Note({.code = code,
          .severity = Lookup(code).severity,
          .detail = std::move(detail),
          .where = lines_.At(*stream_, offset, 1)});
  }

  // The F of a cut that the program gave no speed for is that of this machine.
  void NoteFeed(const Action& action, const Phrase& phrase) {
    const bool cuts =
        action.use == machine::MotionUse::kCut || action.use == machine::MotionUse::kPlunge;
    const bool given = action.chain == Chain::kToolDown ? phrase.after->xy_speed_given
                                                        : phrase.after->z_speed_given;
    if (!cuts || given || feed_noted_ || !phrase.after->IsBelowSurface(action.to.z)) return;
    feed_noted_ = true;
    NoteAt(phrase.begin, ErrorCode::kRml1FeedNotGiven,
           "a cut without a feed rate: F is the default of this machine");
  }

  void Add(const Action& action) {
    spindle_turns_ = action.kind == Action::Kind::kSpindleStart ||
                     (spindle_turns_ && action.kind != Action::Kind::kSpindleStop);
    switch (action.kind) {
      case Action::Kind::kSpindleStart:
        text_.Add("S" + std::to_string(action.rpm) + " M3\n");
        break;
      case Action::Kind::kSpindleSpeed:
        text_.Add("S" + std::to_string(action.rpm) + "\n");
        break;
      case Action::Kind::kSpindleStop:
        text_.Add("M5\n");
        break;
      case Action::Kind::kDwell:
        text_.Add("G4 P" + ShortNumber(action.dwell_ms / 1000.0) + "\n");
        break;
      case Action::Kind::kPause:
        text_.Add("M0\n");
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
    text_.Add(line + "\n");
  }

  const machine::Bytes& stream_;
  const Profile& profile_;
  TextParts text_;
  ToGcodeNotes notes_;
  std::optional<Error> error_;
  LineCounter lines_;
  double feed_mm_s_ = 0.0;
  bool knows_xy_ = false;
  bool feed_noted_ = false;
  bool spindle_turns_ = false;
};

}  // namespace

Result<ToGcodeNotes> ToGcode(const machine::Bytes& stream, const machine::Parameters& parameters,
                             const ByteSink& sink) {
  if (stream->empty()) return Error{ErrorCode::kCellEmptyProgram, "the stream has no bytes", {}};
  const Result<Profile> profile = MakeProfile(parameters);
  if (!profile) return profile.error();
  GcodeWriter writer(stream, *profile, sink);
  StreamWalk walk(*profile, writer);
  if (walk.Run(stream)) {
    if (const Status known = CheckIsStream(walk.device()); !known) return known.error();
  }
  return writer.Finish();
}

}  // namespace rmlcell::rml1
