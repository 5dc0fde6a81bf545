#pragma once

#include <chrono>
#include <set>
#include <string>
#include <vector>

#include "clients/cli/handbox_keys.h"
#include "rmlcell/v1/machine_control.pb.h"

namespace rmlcell::cli {

// What is done with a key of the handbox.
struct KeyStroke {
  std::string key;
  v1::KeyAction action{};

  bool operator==(const KeyStroke&) const = default;
};

// Which keys are down at a terminal, as far as there is a sign of it: a machine moves only while
// somebody is known to hold its key. LIVE-7.05, LIVE-7.11
//
// Of the keyboard a terminal tells no release. A key is down from its second byte on that comes as
// fast as a key repeats, until none comes for as long; before, it was tapped, which moves nothing.
// So a jog begins when the keyboard begins to repeat, some 0.3 to 0.7 s behind the press. To take
// it for down from the first byte on would move the axes all that time after a touch. Of the mouse
// it tells both. But a line that is cut tells nothing any more, so the terminal is asked again and
// again, and the key is up when it does not answer. Time is given from outside; any clock that
// never goes back.
class HeldKeys {
 public:
  using Time = std::chrono::steady_clock::time_point;
  // Keyboards repeat 10 to 40 times a second, and a line may hold up two or three of those.
  static constexpr std::chrono::milliseconds kRepeatsWithin{150};
  // A key that repeats has been typed again after that; the longest delay in use is 0.7 s.
  static constexpr std::chrono::milliseconds kFirstRepeatWithin{750};
  static constexpr std::chrono::milliseconds kAnswersWithin{200};

  // All of them: what is done for it, in this order. Another key lets go what is down.
  std::vector<KeyStroke> Typed(const HandboxKey& key, Time now);
  std::vector<KeyStroke> MouseDown(const HandboxKey& key, Time now);
  std::vector<KeyStroke> MouseUp();
  void TerminalAnswers(Time now) { answered_ = now; }
  std::vector<KeyStroke> LetGo();           // whatever is down
  std::vector<KeyStroke> Expire(Time now);  // what there is no sign of any more

  std::set<std::string> down() const;
  bool by_mouse() const { return !mouse_.empty(); }  // the terminal is to be asked
  // The last one that was let go for want of an answer: the terminal may know no answer at all.
  bool unanswered() const { return unanswered_; }

 private:
  std::string typed_{};  // the last one
  Time typed_at_{};
  std::string keyboard_{};  // this one repeats
  std::string mouse_{};     // is down on this one
  Time answered_{};
  bool unanswered_ = false;
};

}  // namespace rmlcell::cli
