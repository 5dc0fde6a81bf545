#include "server/host/key_desk.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace rmlcell::server {

using std::chrono::nanoseconds;

KeyDesk::Turn KeyDesk::Look(std::int64_t number, bool lets_go) const {
  if (answers_.contains(number)) return Turn::kAnswered;
  if (number <= last_ || ahead_.contains(number)) return Turn::kTooLate;
  if (lets_go || number == last_ + 1) return Turn::kActs;
  return number - last_ - 1 > kAheadMax ? Turn::kTooLate : Turn::kWaits;
}

bool KeyDesk::IsReleased(const std::string& key, std::int64_t number) const {
  for (const std::string& one : {key, std::string()}) {
    const auto found = released_.find(one);
    if (found != released_.end() && found->second > number) return true;
  }
  return false;
}

void KeyDesk::Release(const std::string& key, std::int64_t number) {
  std::int64_t& newest = released_[key];
  newest = std::max(newest, number);
}

void KeyDesk::Take(std::int64_t number, const v1::HostOrderAnswer& answer) {
  answers_[number] = answer;
  if (answers_.size() > kAnswersKept) answers_.erase(answers_.begin());
  if (number > last_ && ahead_.size() < kAnswersKept) ahead_.insert(number);
  while (!ahead_.empty() && *ahead_.begin() == last_ + 1) {
    ++last_;
    ahead_.erase(ahead_.begin());
  }
}

void DeadMan::Press(const std::string& key, const HostTime& now) {
  down_.insert(key);
  heard_ = now.steady;
}

void DeadMan::Release(const std::string& key) {
  if (key.empty()) {
    down_.clear();
    stopped_.clear();
  }
  down_.erase(key);
  stopped_.erase(key);
}

bool DeadMan::Hear(std::int64_t number, const std::set<std::string>& keys_down, nanoseconds sent,
                   const HostTime& now) {
  if (number <= newest_) return false;
  newest_ = number;
  const nanoseconds delay = now.wall.time_since_epoch() - sent;
  least_delay_ = any_delay_ ? std::min(least_delay_, delay) : delay;
  any_delay_ = true;
  if (delay - least_delay_ > kLateBy) return false;
  heard_ = now.steady;
  std::ranges::set_difference(down_, keys_down, std::inserter(missed_, missed_.end()));
  return true;
}

std::vector<std::string> DeadMan::LetGo(const HostTime& now) {
  std::set<std::string> gone = std::exchange(missed_, {});
  if (now.steady - heard_ > kSilence) {
    gone = down_;
    stopped_.insert(down_.begin(), down_.end());
  }
  std::vector<std::string> keys;
  for (const std::string& key : gone) {
    if (down_.erase(key) > 0) keys.push_back(key);
  }
  return keys;
}

}  // namespace rmlcell::server
