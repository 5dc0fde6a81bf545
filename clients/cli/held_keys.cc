#include "clients/cli/held_keys.h"

#include <utility>

namespace rmlcell::cli {
namespace {

KeyStroke Tap(const HandboxKey& key) { return {std::string(key.name), v1::KEY_ACTION_TAP}; }

// Of what is down, if anything is.
void Release(std::string& key, std::vector<KeyStroke>& strokes) {
  if (key.empty()) return;
  strokes.push_back({std::exchange(key, {}), v1::KEY_ACTION_RELEASE});
}

}  // namespace

std::vector<KeyStroke> HeldKeys::Typed(const HandboxKey& key, Time now) {
  unanswered_ = false;
  const auto since = now - std::exchange(typed_at_, now);
  const bool again = std::exchange(typed_, std::string(key.name)) == key.name;
  if (again && keyboard_ == key.name) return {};
  if (key.holding == Holding::kHeld && mouse_ == key.name) return {};
  std::vector<KeyStroke> strokes = LetGo();
  if (key.holding == Holding::kHeld && again && since <= kRepeatsWithin) {
    keyboard_ = key.name;
    strokes.push_back({keyboard_, v1::KEY_ACTION_PRESS});
  } else if (key.holding != Holding::kOnce || !again || since > kFirstRepeatWithin) {
    strokes.push_back(Tap(key));
  }
  return strokes;
}

std::vector<KeyStroke> HeldKeys::MouseDown(const HandboxKey& key, Time now) {
  typed_.clear();
  unanswered_ = false;
  std::vector<KeyStroke> strokes = LetGo();
  if (key.holding != Holding::kHeld) {
    strokes.push_back(Tap(key));
    return strokes;
  }
  mouse_ = key.name;
  answered_ = now;  // as good as an answer: it was there
  strokes.push_back({mouse_, v1::KEY_ACTION_PRESS});
  return strokes;
}

std::vector<KeyStroke> HeldKeys::MouseUp() {
  std::vector<KeyStroke> strokes;
  Release(mouse_, strokes);
  return strokes;
}

std::vector<KeyStroke> HeldKeys::LetGo() {
  std::vector<KeyStroke> strokes;
  Release(keyboard_, strokes);
  Release(mouse_, strokes);
  return strokes;
}

std::vector<KeyStroke> HeldKeys::Expire(Time now) {
  std::vector<KeyStroke> strokes;
  if (!keyboard_.empty() && now - typed_at_ > kRepeatsWithin) Release(keyboard_, strokes);
  if (!mouse_.empty() && now - answered_ > kAnswersWithin) {
    unanswered_ = true;
    Release(mouse_, strokes);
  }
  return strokes;
}

std::set<std::string> HeldKeys::down() const {
  std::set<std::string> down;
  if (!keyboard_.empty()) down.insert(keyboard_);
  if (!mouse_.empty()) down.insert(mouse_);
  return down;
}

}  // namespace rmlcell::cli
