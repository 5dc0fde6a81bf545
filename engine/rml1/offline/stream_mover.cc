#include "engine/rml1/offline/stream_mover.h"

#include <algorithm>

#include "engine/rml1/offline/command_names.h"
#include "engine/rml1/offline/phrase_words.h"

namespace rmlcell::rml1 {
namespace {

using machine::MotionUse;

bool GoesIntoWork(const Phrase& phrase) {
  return std::ranges::any_of(phrase.actions, [](const Action& action) {
    return action.kind == Action::Kind::kMotion &&
           (action.use == MotionUse::kCut || action.use == MotionUse::kPlunge);
  });
}

// What a phrase counts from where the tool stands.
struct CountsFromHere {
  bool xy = false;
  bool z = false;
};
CountsFromHere RelativeAxesOf(const Phrase& phrase) {
  CountsFromHere counts;
  if (phrase.kind == Phrase::Kind::kFixed && (phrase.op == Op::kZM || phrase.op == Op::kZO)) {
    counts.z = IsRelative(phrase) && !phrase.values.empty();
    return counts;
  }
  if (phrase.kind != Phrase::Kind::kSet && phrase.kind != Phrase::Kind::kGroup) return counts;
  if (!IsRelative(phrase)) return counts;
  for (std::size_t i = 0; i < phrase.values.size(); ++i) {
    const auto axis = AxisOf(phrase.values[i], i);
    if (!axis || phrase.values[i].number.decimal == 0.0) continue;
    (*axis == kAxisZ ? counts.z : counts.xy) = true;
  }
  // A motion in space leads from a height, whatever it does to it.
  counts.z = counts.z || (counts.xy && RowOf(phrase.op).values != 2);
  return counts;
}

}  // namespace

StreamMover::StreamMover(const machine::Bytes& stream, const Profile& profile, const UnitVector& by,
                         const UnitVector& owed, const Part& part, const ByteSink& sink)
    : profile_(profile), by_(by), owed_(owed), part_(part), copy_(stream, part.begin, sink) {}

bool StreamMover::OnPhrase(const Phrase& phrase) {
  // Behind the part a phrase in it may follow: a fault is told before the phrase that it stands in.
  if (phrase.begin < part_.begin || phrase.begin >= part_.end) return true;
  if (const auto why = WhyNotFollowed(phrase)) {
    copy_.Refuse(*why, phrase.begin);
    return false;
  }
  PayBefore(phrase);
  switch (phrase.kind) {
    case Phrase::Kind::kSet:
    case Phrase::Kind::kGroup:
      MoveSet(phrase);
      break;
    case Phrase::Kind::kBare:
      if (RowOf(phrase.op).tool != ToolChange::kNone) UseToolHeight(phrase);
      break;
    case Phrase::Kind::kFixed:
      MoveFixed(phrase);
      break;
    default:
      break;
  }
  return !copy_.failed();
}

void StreamMover::PayBefore(const Phrase& phrase) {
  const bool works = GoesIntoWork(phrase);
  const CountsFromHere counts = RelativeAxesOf(phrase);
  const bool pays_z = owed_[kAxisZ] != 0.0 && (works || counts.z);
  const bool owes_xy = owed_[kAxisX] != 0.0 || owed_[kAxisY] != 0.0;
  const bool pays_xy = owes_xy && (works || counts.xy);
  if (!pays_xy && !pays_z) return;
  const double dz = pays_z ? owed_[kAxisZ] : 0.0;
  // Across only above the work: up first, and down behind it.
  const double stands_z = phrase.logical_before.z + by_[kAxisZ] - owed_[kAxisZ];
  const bool in_work = pays_xy && stands_z <= phrase.before->z0;
  const double up = std::max({0.0, dz, in_work ? profile_.z.high - stands_z : 0.0});
  std::string sets;
  const auto go = [&sets](double x, double y, double z) {
    if (x == 0.0 && y == 0.0 && z == 0.0) return;
    sets +=
        (sets.empty() ? "" : ",") + ShortNumber(x) + "," + ShortNumber(y) + "," + ShortNumber(z);
  };
  go(0.0, 0.0, up);
  if (pays_xy) go(owed_[kAxisX], owed_[kAxisY], 0.0);
  go(0.0, 0.0, dz - up);
  const CommandNames names = NamesFor(profile_.commands.setting);
  std::string text = "!ZZ" + sets + ";";
  if (phrase.before->absolute)
    text = std::string(names.relative) + ";" + text + names.absolute + ";";
  copy_.Insert(phrase.name, text);
  if (pays_xy) owed_[kAxisX] = owed_[kAxisY] = 0.0;
  if (pays_z) owed_[kAxisZ] = 0.0;
}

void StreamMover::Shift(const Phrase::Value& value, std::size_t axis) {
  if (by_[axis] != 0.0) copy_.Replace(value, value.number.decimal + by_[axis]);
  owed_[axis] = 0.0;
}

void StreamMover::MoveSet(const Phrase& phrase) {
  if (RowOf(phrase.op).values == 2) UseToolHeight(phrase);
  if (IsRelative(phrase)) return;
  for (std::size_t i = 0; i < phrase.values.size(); ++i) {
    const auto axis = AxisOf(phrase.values[i], i);
    if (axis) Shift(phrase.values[i], *axis);
  }
}

void StreamMover::MoveFixed(const Phrase& phrase) {
  switch (phrase.op) {
    case Op::kAt:
    case Op::kPZ:
      return MoveHeights(phrase);
    case Op::kZO:
      if (by_[kAxisZ] != 0.0)
        copy_.Refuse("the program sets Z0 itself: change what it gives to !ZO", phrase.begin);
      return;
    case Op::kZM:
      if (phrase.before->absolute && !phrase.values.empty()) owed_[kAxisZ] = by_[kAxisZ];
      return;
    case Op::kDF:
      z1_given_ = z2_given_ = false;
      return;
    case Op::kIN:
      z1_given_ = z2_given_ = false;
      owed_[kAxisZ] = by_[kAxisZ];
      return;
    case Op::kH:
      owed_ = by_;
      return;
    default:
      return;
  }
}

void StreamMover::MoveHeights(const Phrase& phrase) {
  z1_given_ = !phrase.values.empty();
  z2_given_ = phrase.values.size() > 1 || (z2_given_ && z1_given_);
  if (by_[kAxisZ] == 0.0) return;
  for (std::size_t i = 0; i < phrase.values.size(); ++i) {
    const Phrase::Value& value = phrase.values[i];
    const double height = static_cast<double>(value.number.truncated()) + by_[kAxisZ];
    if (i == 0 ? height > 0.0 : height < 0.0) {
      copy_.Refuse(i == 0 ? "the tool-down height would come above Z0: move Z0 on the panel"
                          : "the tool-up height would come below Z0: move Z0 on the panel",
                   value.begin);
      return;
    }
    copy_.Replace(value, height);
  }
}

// A two-dimensional command goes to the height of its tool state.
void StreamMover::UseToolHeight(const Phrase& phrase) {
  const bool given = phrase.after->tool_down ? z1_given_ : z2_given_;
  if (by_[kAxisZ] != 0.0 && !given) {
    copy_.Refuse("the tool goes to a height that the program does not give: write !PZ before",
                 phrase.begin);
  }
  owed_[kAxisZ] = 0.0;
}

}  // namespace rmlcell::rml1
