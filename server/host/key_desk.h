#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "rmlcell/v1/host.pb.h"
#include "server/host/host_time.h"

namespace rmlcell::server {

// Keys as they come over a line: each with a number, from 1 on, without a gap. What lets go acts at
// once, whatever is missing before it; a press that comes behind it moves nothing. LIVE-7.04
class KeyDesk {
 public:
  static constexpr std::int64_t kAheadMax = 8;  // so many numbers may be missing
  static constexpr std::chrono::milliseconds kPatience{100};
  static constexpr std::size_t kAnswersKept = 64;

  enum class Turn {
    kActs,
    kAnswered,  // it has acted before: the same answer
    kWaits,     // for those before it
    kTooLate,   // its answer is not known any more, or too many are missing
  };
  Turn Look(std::int64_t number, bool lets_go) const;
  // Precondition: kAnswered.
  const v1::HostOrderAnswer& AnswerOf(std::int64_t number) const { return answers_.at(number); }

  // It has been released, by a key with a higher number.
  bool IsReleased(const std::string& key, std::int64_t number) const;
  void Release(const std::string& key, std::int64_t number);  // empty: every key
  void Take(std::int64_t number, const v1::HostOrderAnswer& answer);

 private:
  std::int64_t last_ = 0;         // all up to this have acted
  std::set<std::int64_t> ahead_;  // behind a gap
  std::map<std::int64_t, v1::HostOrderAnswer> answers_;
  std::map<std::string, std::int64_t> released_;
};

// Whoever holds a key down says so again and again. Who is not heard for a while, or whose line has
// become slow, holds it no more: what it moves stops. LIVE-7.05
class DeadMan {
 public:
  static constexpr std::chrono::milliseconds kSilence{150};
  static constexpr std::chrono::milliseconds kLateBy{100};  // beyond the least delay

  void Press(const std::string& key, const HostTime& now);
  void Release(const std::string& key);  // empty: every key
  // A silence has stopped it, and it was not released since: it moves nothing. LIVE-7.06
  bool IsStopped(const std::string& key) const { return stopped_.contains(key); }
  // `sent`: by the clock of the client, which may be any. False: it was overtaken, or is so late
  // that it counts for nothing.
  bool Hear(std::int64_t number, const std::set<std::string>& keys_down,
            std::chrono::nanoseconds sent, const HostTime& now);

  // Whatever is down is let go, as after a silence.
  void Lose();
  // Keys that nobody holds any more: all of them after a silence, else those that a beat left out.
  std::vector<std::string> LetGo(const HostTime& now);
  bool holds() const { return !down_.empty(); }
  const std::set<std::string>& down() const { return down_; }

 private:
  std::set<std::string> down_;
  std::set<std::string> missed_;   // by the newest beat
  std::set<std::string> stopped_;  // by a silence
  std::chrono::nanoseconds heard_{0};
  std::int64_t newest_ = 0;
  bool any_delay_ = false;
  std::chrono::nanoseconds least_delay_{0};  // of both clocks together, and so of any sign
};

// Whether a line is fast enough for keys that move a machine as long as they are down: 40 ms each
// way. By the fastest of the newest beats, so that one that was late for once makes no slow line.
// LIVE-7.05
class LineSpeed {
 public:
  static constexpr std::chrono::milliseconds kDelayMax{40};
  static constexpr std::chrono::seconds kClocksAgree{1};  // clocks that differ by more tell nothing
  static constexpr std::chrono::seconds kKnownFor{2};     // behind the newest beat
  static constexpr std::size_t kBeatsLooked = 8;
  static constexpr std::size_t kBeatsNeeded = 3;

  // `delay`: by both clocks, which may differ. `round_trip`: where the client told it.
  void Hear(std::chrono::nanoseconds delay, std::optional<std::chrono::nanoseconds> round_trip,
            const HostTime& now);
  // How slow it is, for people to read; nothing: fast enough, or not known.
  std::optional<std::string> WhySlow(const HostTime& now) const;

 private:
  struct Newest {
    void Add(std::chrono::nanoseconds value);
    std::optional<std::chrono::nanoseconds> least() const;  // nothing: too few

    std::array<std::chrono::nanoseconds, kBeatsLooked> values{};
    std::size_t count = 0;
  };
  Newest delays_;
  Newest round_trips_;
  std::chrono::nanoseconds heard_{0};
};

}  // namespace rmlcell::server
