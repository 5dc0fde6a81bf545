#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "clients/cli/held_keys.h"
#include "clients/cli/remote_call.h"
#include "rmlcell/v1/handbox.grpc.pb.h"

namespace rmlcell::cli {

inline constexpr std::chrono::seconds kHandboxPatience{5};  // with an answer

// The clock of this computer, as a heartbeat says it.
google::protobuf::Timestamp SentNow();

// One that presses: opened with control of the machine, deleted with this.
class HandboxSession {
 public:
  // `patience`: with the answer that it is deleted.
  HandboxSession(const std::shared_ptr<grpc::Channel>& channel, const std::string& machine,
                 const std::string& token, std::chrono::seconds patience = kHandboxPatience);
  ~HandboxSession();
  HandboxSession(const HandboxSession&) = delete;
  HandboxSession& operator=(const HandboxSession&) = delete;

  const grpc::Status& status() const { return status_; }  // of opening it
  const v1::HandboxSession& session() const { return session_; }

 private:
  std::unique_ptr<v1::HandboxService::Stub> stub_;
  const std::chrono::seconds patience_;
  grpc::Status status_;
  v1::HandboxSession session_;
};

// What came of a key, or of a heartbeat.
struct KeyAnswer {
  std::string key{};  // empty: of a heartbeat
  grpc::Status status{};
  v1::PressKeyResponse response{};
};

// Presses keys of a session and says that somebody holds them, without ever waiting for an answer:
// whoever looks at keyboard and mouse must not miss that a key goes up. For one thread.
//
// Keys go one behind the other, each when the one before it is answered. What lets go or halts
// (RELEASE, STOP, HOLD, EMERGENCY_STOP) goes at once, and what waits before a halt is forgotten.
// LIVE-7.04
class HandboxHands {
 public:
  static constexpr std::size_t kWaitingMax = 32;  // more than anybody types ahead; then: forgotten

  // `answered` is called on threads of gRPC.
  HandboxHands(const std::shared_ptr<grpc::Channel>& channel, const std::string& session,
               const std::string& token, std::function<void()> answered,
               std::chrono::seconds patience = kHandboxPatience);
  ~HandboxHands();  // waits for what is under way, gives up what waits
  HandboxHands(const HandboxHands&) = delete;
  HandboxHands& operator=(const HandboxHands&) = delete;

  void Do(KeyStroke stroke);
  // Every 50 ms while a key is down. LIVE-7.05
  void Beat(const std::set<std::string>& down);
  // Those that came since, of heartbeats only what went wrong.
  std::vector<KeyAnswer> TakeAnswers();
  bool at_rest() const;  // nothing waits or is under way

 private:
  struct KeyCall;
  struct BeatCall;

  void Send(const KeyStroke& stroke, bool in_turn);
  void SendNext();
  void End(KeyAnswer answer, bool in_turn);

  std::unique_ptr<v1::HandboxService::Stub> stub_;
  const std::string session_;
  const std::string token_;
  const std::function<void()> answered_;
  const std::chrono::seconds patience_;
  std::int64_t sequence_ = 0;
  std::int64_t beats_ = 0;
  std::deque<KeyStroke> waiting_{};

  // Of the newest beat that is over; 0: none is.
  std::atomic<std::int64_t> round_trip_ns_ = 0;
  mutable std::mutex mutex_{};  // of what threads of gRPC write
  std::condition_variable ended_{};
  int under_way_ = 0;
  int beats_under_way_ = 0;
  bool turn_taken_ = false;  // by a key that is not answered yet
  std::vector<KeyAnswer> answers_{};
};

}  // namespace rmlcell::cli
