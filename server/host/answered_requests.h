#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rmlcell/v1/host.pb.h"
#include "server/host/host_time.h"

namespace rmlcell::server {

// What requests were answered, by their ids: a repeat gets the first answer and acts never again,
// also behind a crash of the host, since the journal has it. LIVE-3.27
class AnsweredRequests {
 public:
  static constexpr std::size_t kKept = 1'024;
  static constexpr std::chrono::minutes kKeptFor{10};

  // Of one caller, and of the same kind; empty: it has no id, or halts, which acts however often it
  // is asked for.
  static std::string KeyOf(const v1::HostOrder& order);

  // Of what is asked, whoever proves with which token that he may.
  static std::string DigestOf(const v1::HostOrder& order);

  const v1::HostOrderAnswer* Find(const std::string& key) const;
  // Whether it was something else that was asked under this key. Precondition: Find.
  bool IsAnother(const std::string& key, const std::string& digest) const;
  void Keep(const std::string& key, const std::string& digest, const v1::HostOrderAnswer& answer,
            const HostTime& now);

  // As the journal has it; nothing: nobody needs it behind a crash, or it is a secret.
  static std::optional<v1::AnsweredRequest> EntryOf(const v1::HostOrder& order,
                                                    const v1::HostOrderAnswer& answer);
  // What an earlier host answered, in order; of one that answered with its status by `status`.
  void Recover(const std::vector<v1::JournalEntry>& entries, const v1::MachineStatus& status,
               const HostTime& now);

 private:
  struct Answered {
    v1::HostOrderAnswer answer{};
    std::string digest{};
    std::chrono::nanoseconds at{0};
  };
  void Keep(const std::string& key, Answered answered, std::chrono::nanoseconds now);

  std::map<std::string, Answered> answered_;
  std::deque<std::string> order_;  // the oldest first
};

// Whether an earlier answer may still be asked for at this time.
bool IsAskedFor(const v1::JournalEntry& answered, WallTime now);

}  // namespace rmlcell::server
