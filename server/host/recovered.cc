#include "server/host/recovered.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>

#include "engine/families/families.h"
#include "proto/bridge/files.h"
#include "proto/bridge/findings.h"
#include "proto/recording/recording.h"
#include "server/base/secret.h"
#include "server/host/recording_file.h"
#include "server/host/unstored_entries.h"

namespace rmlcell::server {
namespace {

constexpr std::int64_t kRecordingFileMax = 2 * MachineRecorder::kBytesMax;  // with a last entry

using Number = std::pair<std::int64_t, std::int64_t>;  // fence, sequence

Number NumberOf(const v1::JournalEntry& entry) { return {entry.fence(), entry.sequence()}; }

// What a job begins with, or what nobody did: the queue has control, a host comes to rest.
bool IsOfBegin(const v1::JournalEntry& entry) {
  if (entry.has_run_over()) return false;
  if (entry.has_answered())
    return entry.answered().kind() == v1::HostOrder::kRunJob ||
           entry.answered().kind() == v1::HostOrder::kContinueJob;
  const v1::AppliedInput& input = entry.applied().input();
  return !entry.has_applied() || input.has_start() || input.has_control() ||
         entry.applied().caller().empty();
}

struct Begin {
  std::string job;
  std::size_t first = 0;  // its first entry, behind a mark
  bool begun = false;     // and not only about to
};

// The job that a host was about to begin when it ended, or had begun: as long as the store does not
// have that, nothing of it has moved (LIVE-5.04). Nothing: there is none, or somebody has done
// something since, which is not to be lost with it. LIVE-5.20
std::optional<Begin> BeginIn(std::span<const v1::JournalEntry> journal) {
  std::size_t count = journal.size();
  while (count > 0 && !journal[count - 1].has_mark()) --count;
  for (const v1::JournalEntry& entry : journal.subspan(count)) {
    const std::string& job = entry.intent().input().start().job();
    if (!job.empty()) return Begin{.job = job, .first = count};
  }
  std::size_t begun = count;
  while (begun > 0 && journal[begun - 1].fence() == journal[count - 1].fence() &&
         journal[begun - 1].run_begun().job().empty())
    --begun;
  if (begun == 0 || journal[begun - 1].run_begun().job().empty()) return std::nullopt;
  std::size_t first = begun - 1;
  while (first > 0 && !journal[first - 1].has_mark() &&
         journal[first - 1].fence() == journal[begun - 1].fence())
    --first;
  const bool stood = first == 0 || journal[first - 1].has_mark();
  if (!stood || !std::ranges::all_of(journal.subspan(first, count - first), IsOfBegin))
    return std::nullopt;
  return Begin{.job = journal[begun - 1].run_begun().job(), .first = first, .begun = true};
}

// The newest job of which a host had on its disk that it was about to begin, and nothing more.
std::string HadIn(std::span<const v1::JournalEntry> journal) {
  std::string had;
  std::int64_t fence = 0;
  for (const v1::JournalEntry& entry : journal) {
    const std::string& job = entry.intent().input().start().job();
    if (entry.has_mark() && entry.fence() == fence) had.clear();
    if (job.empty()) continue;
    had = job;
    fence = entry.fence();
  }
  return had;
}

}  // namespace

bool TakeBack(const v1::HostWelcome& welcome, std::vector<v1::JournalEntry>& journal) {
  const auto begin = BeginIn(journal);
  const Number stored{welcome.mark().fence(), welcome.mark().sequence()};
  const bool stood = begin && begin->begun && (begin->first > 0 || welcome.has_mark());
  if (!stood || NumberOf(journal[begin->first]) <= stored) return false;
  const auto first = journal.begin() + static_cast<std::ptrdiff_t>(begin->first);
  const auto intent = std::find_if(first, journal.end(), [&](const v1::JournalEntry& entry) {
    return entry.intent().input().start().job() == begin->job;
  });
  // That it had the job is told by whatever host comes next.
  if (intent != journal.end()) std::iter_swap(first, intent);
  journal.resize(begin->first + (intent != journal.end() ? 1 : 0));
  return true;
}

Recovered RecoveredFrom(const v1::HostWelcome& welcome, std::vector<v1::JournalEntry> journal) {
  Recovered found{.known = welcome.has_mark(), .mark = welcome.mark()};
  const Number stored{welcome.mark().fence(), welcome.mark().sequence()};
  Number newest = stored;
  TakeBack(welcome, journal);
  for (const v1::JournalEntry& entry : journal) {
    if (!entry.has_mark() || (found.known && NumberOf(entry) <= newest)) continue;
    found.known = true;
    found.mark = entry.mark();
    newest = NumberOf(entry);
  }
  for (v1::JournalEntry& entry : journal) {
    if (NumberOf(entry) > newest) continue;
    if (entry.has_answered()) {
      found.answered.push_back(std::move(entry));
    } else if (NumberOf(entry) > stored && entry.fence() == newest.first) {
      // A later host has told again what an earlier one had to tell, before its first mark.
      found.untold.push_back(std::move(entry));
    }
  }
  return found;
}

Result<std::string> KeepOfEarlierHost(const v1::HostWelcome& welcome,
                                      const std::vector<v1::JournalEntry>& entries,
                                      const std::string& journal) {
  const auto is_told = [](const v1::JournalEntry& entry) {
    return !entry.has_mark() && !entry.has_intent() && !entry.has_answered();
  };
  const bool another_had_it = !entries.empty() && entries.back().fence() < welcome.mark().fence();
  if (!another_had_it || std::ranges::none_of(entries, is_told)) return std::string();
  UnstoredEntries kept;
  kept.Add(entries);
  return kept.KeepAsOrphan(journal);
}

void AddNewestMark(const std::string& journal, v1::HostHello& hello) {
  const Result<Journal::Found> opened = Journal::Open(journal);
  if (!opened) return;  // OpenMachine says why
  const auto newest_of = [](std::span<const v1::JournalEntry> entries, v1::MachineMark& mark) {
    const auto newest = std::ranges::find_if(entries.rbegin(), entries.rend(),
                                             [](const auto& entry) { return entry.has_mark(); });
    if (newest == entries.rend()) return false;
    mark = newest->mark();
    mark.set_fence(newest->fence());
    mark.set_sequence(newest->sequence());
    mark.clear_state();
    mark.clear_base();
    return true;
  };
  const std::span<const v1::JournalEntry> entries = opened->entries;
  if (v1::MachineMark mark; newest_of(entries, mark))
    *hello.mutable_journal_mark() = std::move(mark);
  if (std::string had = HadIn(entries); !had.empty())
    hello.mutable_begin()->set_job(std::move(had));
  const auto begin = BeginIn(entries);
  if (!begin) return;
  hello.mutable_begin()->set_job(begin->job);
  hello.mutable_begin()->set_fence(entries[begin->first].fence());
  hello.mutable_begin()->set_sequence(entries[begin->first].sequence());
  if (v1::MachineMark mark; newest_of(entries.first(begin->first), mark))
    *hello.mutable_begin()->mutable_mark() = std::move(mark);
}

HostMachine::Setup SetupOf(Recovered found) {
  HostMachine::Setup setup;
  setup.state = found.mark.state();
  setup.control_lease = found.mark.control_lease();
  setup.factor = found.mark.factor();
  if (found.mark.has_last_run()) setup.last_run = found.mark.last_run();
  setup.untold = std::move(found.untold);
  setup.answered = std::move(found.answered);
  setup.cut_off = found.known && !found.mark.clean();
  setup.inspect_job = found.mark.job();
  if (found.mark.has_base()) setup.cut_off_base = found.mark.base();
  if (found.mark.has_run_time_ns()) setup.open_run = std::move(found.mark);
  return setup;
}

std::optional<MachineRecorder::OfJob> RecoverRecording(const Recovered& found,
                                                       const std::string& path) {
  if (::access(path.c_str(), F_OK) != 0) return {};
  Result<std::string> bytes = bridge::ReadFile(path, kRecordingFileMax);
  const auto durable = bytes
                           ? recording::DurableIn(*bytes, found.mark.fence(), found.mark.sequence())
                           : Result<recording::Durable>(bytes.error());
  const bool of_another = durable && !durable->whole && durable->job != found.mark.job();
  if (!durable || of_another || ::truncate(path.c_str(), static_cast<off_t>(durable->bytes)) != 0) {
    spdlog::warn("{}: {}", path, !durable ? durable.error().detail : "it is of another run");
    ::unlink(path.c_str());  // no later mark is to find it
    return {};
  }
  bytes->resize(durable->bytes);
  return MachineRecorder::OfJob{
      .job = durable->job, .file = *std::move(bytes), .whole = durable->whole};
}

Result<OpenedMachine> OpenMachine(const v1::HostWelcome& welcome, const HostOptions& options,
                                  const std::string& host, const HostTime& now) {
  const machine::MachineFamily* family = families::FindFamily(welcome.family());
  if (family == nullptr) return families::UnknownFamily(welcome.family());
  Result<Journal::Found> journal = Journal::Open(options.journal);
  if (!journal) return journal.error();
  if (journal->torn_bytes > 0)
    spdlog::warn("{}: {} bytes at its end were torn", options.journal, journal->torn_bytes);
  const auto orphan = KeepOfEarlierHost(welcome, journal->entries, options.journal);
  if (!orphan) spdlog::error("{}", bridge::ErrorText(orphan.error()));
  if (orphan && !orphan->empty()) {
    spdlog::warn("{}", bridge::ErrorText(Error{
                           ErrorCode::kCellMachineTaken,
                           "another host had the machine since: what one told here before, and "
                           "the log may have, is kept in " +
                               *orphan,
                           {}}));
    // Once is enough; answers may still be asked for.
    std::vector<v1::JournalEntry> answers = journal->entries;
    std::erase_if(answers, [](const v1::JournalEntry& entry) { return !entry.has_answered(); });
    if (const Status left = journal->journal->Replace(answers); !left) return left.error();
  }
  // For good: what was taken back is not to come alive for the host after this one.
  if (TakeBack(welcome, journal->entries)) {
    if (const Status left = journal->journal->Replace(journal->entries); !left) return left.error();
  }
  Recovered found = RecoveredFrom(welcome, std::move(journal->entries));
  auto recording = RecoverRecording(found, RecordingFile::PathBeside(options.journal));
  HostMachine::Setup setup = SetupOf(std::move(found));
  setup.recording = std::move(recording);
  setup.name = options.machine;
  setup.host = host;
  setup.fence = welcome.fence();
  setup.family = family;
  setup.profile = welcome.profile();
  setup.options = welcome.options();
  setup.parameters = {welcome.parameters().begin(), welcome.parameters().end()};
  auto made = HostMachine::Make(std::move(setup), now, RandomText);
  if (!made) return made.error();
  return OpenedMachine{.machine = *std::move(made), .journal = std::move(journal->journal)};
}

}  // namespace rmlcell::server
