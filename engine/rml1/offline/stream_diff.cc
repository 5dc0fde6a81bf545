#include "engine/rml1/offline/stream_diff.h"

#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "engine/core/alignment.h"
#include "engine/rml1/offline/phrase_words.h"
#include "engine/rml1/offline/stream_walk.h"

namespace rmlcell::rml1 {
namespace {

using machine::StepChange;

// One thing that the device does, with where it begins.
struct Deed {
  Action action;
  Point from;
  double z0 = 0.0;
  int step = 0;

  bool moves() const { return action.kind == Action::Kind::kMotion; }
};

class Deeds final : public PhraseListener {
 public:
  bool OnPhrase(const Phrase& phrase) override {
    Point at = phrase.physical_before;
    for (const Action& action : phrase.actions) {
      if (all.size() == kComparedMax) return false;
      all.push_back({action, at, phrase.before->z0, static_cast<int>(phrase.command)});
      if (action.kind == Action::Kind::kMotion) at = action.to;
    }
    return true;
  }
  std::vector<Deed> all;
};

Result<std::vector<Deed>> DeedsOf(std::string_view stream, const Profile& profile) {
  Deeds deeds;
  StreamWalk walk(profile, deeds);
  if (!walk.Run(stream)) {
    return Error{ErrorCode::kRml1TooManyMotions,
                 "more than " + Told("most", kComparedMax) + " motions and other actions",
                 {}};
  }
  if (const Status known = CheckIsStream(walk.device()); !known) return known.error();
  return std::move(deeds.all);
}

// Places and speeds that differ by less are one: noise of decimals.
constexpr double kResolution = 1e4;  // of a device unit, a degree, a mm/s

std::uint64_t Mixed(std::uint64_t hash, double value) {
  constexpr std::uint64_t kPrime = 1099511628211U;  // FNV-1a, eight bytes at a time
  hash ^= static_cast<std::uint64_t>(std::llround(value * kResolution));
  hash *= kPrime;
  return hash ^ (hash >> 29U);
}

std::uint64_t KindOf(const Deed& deed) { return static_cast<std::uint64_t>(deed.action.kind) + 1; }

std::uint64_t MeaningOf(const Deed& deed) {
  constexpr std::uint64_t kBasis = 14695981039346656037U;
  const Action& action = deed.action;
  std::uint64_t hash = kBasis ^ KindOf(deed);
  for (const double value : {action.to.x, action.to.y, action.to.z, action.to.a, action.speed_mm_s,
                             static_cast<double>(action.rpm), static_cast<double>(action.dwell_ms)})
    hash = Mixed(hash, value);
  return hash;
}

unsigned AspectsOf(const Deed& deed) {
  switch (deed.action.kind) {
    case Action::Kind::kMotion:
      return machine::kAspectPath;
    case Action::Kind::kDwell:
      return machine::kAspectTime;
    case Action::Kind::kPause:
      return machine::kAspectFlow;
    default:
      return machine::kAspectPower;
  }
}

class StreamDiffer {
 public:
  StreamDiffer(const std::vector<Deed>& a, const std::vector<Deed>& b, const Profile& profile)
      : a_(a), b_(b), profile_(profile), partner_of_b_(b.size()) {}

  std::vector<StepChange> Run() {
    Pair();
    std::size_t next_a = 0;
    for (std::size_t i = 0; i < b_.size(); ++i) {
      if (!partner_of_b_[i]) {
        Add(nullptr, &b_[i]);
        continue;
      }
      for (; next_a < *partner_of_b_[i]; ++next_a) Add(&a_[next_a], nullptr);
      if (MeaningOf(a_[next_a]) != MeaningOf(b_[i])) Add(&a_[next_a], &b_[i]);
      ++next_a;
    }
    for (; next_a < a_.size(); ++next_a) Add(&a_[next_a], nullptr);
    return std::move(changes_);
  }

 private:
  using Key = std::uint64_t (*)(const Deed&);
  static std::vector<std::uint64_t> Keys(const std::vector<Deed>& deeds, Key key, std::size_t first,
                                         std::size_t last) {
    std::vector<std::uint64_t> keys;
    keys.reserve(last - first);
    for (std::size_t i = first; i < last; ++i) keys.push_back(key(deeds[i]));
    return keys;
  }

  // First what is equal, then between two equal stretches what is of a kind.
  void Pair() {
    std::size_t a = 0;
    std::size_t b = 0;
    const auto pair_gap = [&](std::size_t end_a, std::size_t end_b) {
      for (const AlignedPair& pair : Align(Keys(a_, KindOf, a, end_a), Keys(b_, KindOf, b, end_b)))
        partner_of_b_[b + pair.b] = a + pair.a;
    };
    for (const AlignedPair& pair :
         Align(Keys(a_, MeaningOf, 0, a_.size()), Keys(b_, MeaningOf, 0, b_.size()))) {
      pair_gap(pair.a, pair.b);
      partner_of_b_[pair.b] = pair.a;
      a = pair.a + 1;
      b = pair.b + 1;
    }
    pair_gap(a_.size(), b_.size());
  }

  // One of the two may be missing.
  void Add(const Deed* before, const Deed* after) {
    StepChange change;
    change.kind = before == nullptr  ? StepChange::Kind::kAdded
                  : after == nullptr ? StepChange::Kind::kRemoved
                                     : StepChange::Kind::kChanged;
    if (before != nullptr) change.step_a = before->step;
    if (after != nullptr) change.step_b = after->step;
    if (before == nullptr || after == nullptr) {
      change.aspects = AspectsOf(before == nullptr ? *after : *before);
    } else {
      Compare(*before, *after, change);
    }
    if (changes_.size() < kToldChangesMax) {
      if (before != nullptr) change.before = TextOf(*before);
      if (after != nullptr) change.after = TextOf(*after);
    } else {
      change.what.clear();
    }
    changes_.push_back(std::move(change));
  }

  std::string TextOf(const Deed& deed) const {
    return WordsOf(deed.action, deed.from, deed.z0, profile_);
  }

  void Compare(const Deed& before, const Deed& after, StepChange& change) const {
    const auto note = [&](const std::string& name, double a, double b, unsigned aspect) {
      if (std::llround(a * kResolution) == std::llround(b * kResolution)) return;
      change.aspects |= aspect;
      change.what.push_back(name + " " + ShortNumber(a, 5) + " -> " + ShortNumber(b, 5));
    };
    const Action& a = before.action;
    const Action& b = after.action;
    if (!before.moves()) {
      note("spindle speed", a.rpm, b.rpm, machine::kAspectPower);
      note("wait in ms", a.dwell_ms, b.dwell_ms, machine::kAspectTime);
      return;
    }
    const auto axis = [&](const char* name, double from, double to, double origin) {
      note(name, (from - origin) / profile_.units_per_mm, (to - origin) / profile_.units_per_mm,
           machine::kAspectPath);
    };
    axis("X", a.to.x, b.to.x, profile_.origin_x);
    axis("Y", a.to.y, b.to.y, profile_.origin_y);
    axis("Z", a.to.z, b.to.z, before.z0);
    note("A", a.to.a, b.to.a, machine::kAspectPath);
    note("mm/s", a.speed_mm_s, b.speed_mm_s, machine::kAspectTime);
    change.target_moved_mm = DistanceXYZ(a.to, b.to) / profile_.units_per_mm;
  }

  const std::vector<Deed>& a_;
  const std::vector<Deed>& b_;
  const Profile& profile_;
  std::vector<std::optional<std::size_t>> partner_of_b_;
  std::vector<StepChange> changes_;
};

std::vector<machine::FigureChange> CompareFigures(const std::vector<machine::Figure>& a,
                                                  const std::vector<machine::Figure>& b) {
  std::map<std::string, machine::FigureChange> by_name;
  // How a program is written is no difference of what it does.
  const auto counts = [](const machine::Figure& figure) {
    return !figure.name.starts_with("programmed.") && figure.name != "commands";
  };
  for (const machine::Figure& figure : a) {
    if (counts(figure)) by_name[figure.name] = {figure.name, figure.unit, figure.value, 0.0};
  }
  for (const machine::Figure& figure : b) {
    if (!counts(figure)) continue;
    machine::FigureChange& change = by_name[figure.name];
    change.name = figure.name;
    change.unit = figure.unit;
    change.after = figure.value;
  }
  constexpr double kSame = 1e-9;  // relative
  std::vector<machine::FigureChange> changes;
  for (auto& [name, change] : by_name) {
    const double size = std::max(std::fabs(change.before), std::fabs(change.after));
    if (std::fabs(change.after - change.before) > kSame * size)
      changes.push_back(std::move(change));
  }
  return changes;
}

}  // namespace

Result<machine::ProgramDiff> CompareStreams(const machine::ComparedObject& a,
                                            const machine::ComparedObject& b,
                                            const machine::Parameters& parameters) {
  const Result<Profile> profile = MakeProfile(parameters);
  if (!profile) return profile.error();
  const Result<std::vector<Deed>> deeds_a = DeedsOf(a.object, *profile);
  if (!deeds_a) return deeds_a.error();
  const Result<std::vector<Deed>> deeds_b = DeedsOf(b.object, *profile);
  if (!deeds_b) return deeds_b.error();
  machine::ProgramDiff diff;
  diff.steps = StreamDiffer(*deeds_a, *deeds_b, *profile).Run();
  diff.figures = CompareFigures(a.figures, b.figures);
  for (const StepChange& step : diff.steps) diff.aspects |= step.aspects;
  return diff;
}

}  // namespace rmlcell::rml1
