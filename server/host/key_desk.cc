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

void DeadMan::Lose() {
  missed_ = down_;
  stopped_.insert(down_.begin(), down_.end());
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

void LineSpeed::Newest::Add(nanoseconds value) { values[count++ % kBeatsLooked] = value; }

std::optional<nanoseconds> LineSpeed::Newest::least() const {
  if (count < kBeatsNeeded) return std::nullopt;
  return *std::min_element(
      values.begin(), values.begin() + static_cast<std::ptrdiff_t>(std::min(count, kBeatsLooked)));
}

void LineSpeed::Hear(nanoseconds delay, std::optional<nanoseconds> round_trip,
                     const HostTime& now) {
  if (now.steady - heard_ > kKnownFor) delays_ = round_trips_ = {};
  heard_ = now.steady;
  delays_.Add(delay);
  if (round_trip) round_trips_.Add(*round_trip);
}

std::optional<std::string> LineSpeed::WhySlow(const HostTime& now) const {
  if (now.steady - heard_ > kKnownFor) return std::nullopt;
  const auto slow = [](nanoseconds took, nanoseconds allowed, const char* way) {
    using std::chrono::milliseconds;
    return std::to_string(std::chrono::ceil<milliseconds>(took).count()) + " ms " + way +
           ", at most " + std::to_string(std::chrono::ceil<milliseconds>(allowed).count()) + " ms";
  };
  const auto round_trip = round_trips_.least();
  const auto delay = delays_.least();
  if (round_trip && *round_trip > 2 * kDelayMax)
    return "the line: " + slow(*round_trip, 2 * kDelayMax, "there and back");
  const bool by_clocks = round_trips_.count == 0 && delay && *delay < kClocksAgree;
  if (by_clocks && *delay > kDelayMax)
    return "the line, or another clock: a heartbeat takes " + slow(*delay, kDelayMax, "to come") +
           "; one that tells round_trip needs no clock";
  return std::nullopt;
}

}  // namespace rmlcell::server
