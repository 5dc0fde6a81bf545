#include "server/host/recovered.h"

#include <cstdint>
#include <utility>

namespace rmlcell::server {

Recovered RecoveredFrom(const v1::HostWelcome& welcome, std::vector<v1::JournalEntry> journal) {
  using Number = std::pair<std::int64_t, std::int64_t>;
  Recovered found{.known = welcome.has_mark(), .mark = welcome.mark()};
  const Number stored{welcome.mark().fence(), welcome.mark().sequence()};
  Number newest = stored;
  for (const v1::JournalEntry& entry : journal) {
    const Number number{entry.fence(), entry.sequence()};
    if (!entry.has_mark() || (found.known && number <= newest)) continue;
    found.known = true;
    found.mark = entry.mark();
    newest = number;
  }
  for (const v1::JournalEntry& entry : journal) {
    const std::string& job = entry.intent().input().start().job();
    if (Number(entry.fence(), entry.sequence()) > newest && !job.empty()) found.begins = job;
  }
  for (v1::JournalEntry& entry : journal) {
    const Number number{entry.fence(), entry.sequence()};
    if (number > stored && number <= newest) found.untold.push_back(std::move(entry));
  }
  return found;
}

}  // namespace rmlcell::server
