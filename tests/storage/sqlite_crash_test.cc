// What was acknowledged survives a kill at any instruction (issue 2; design.md section 3;
// conventions.md, "Crash test as a suite"). A child process works with a store and tells what was
// acknowledged; it is killed, and the store is looked at. RMLCELL_LONG=1: hundreds of rounds, and
// every single crash point.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include "engine/core/hex.h"
#include "storage/content.h"
#include "tests/storage/crash_scenario.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage {
namespace {

bool IsLongRun() {
  return std::getenv("RMLCELL_LONG") != nullptr;
}  // NOLINT(concurrency-mt-unsafe)

// A child process and the pipe from its standard output.
class Child {
 public:
  explicit Child(std::vector<std::string> arguments) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    arguments.insert(arguments.begin(), RMLCELL_CRASH_CHILD);
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    const int spawned =
        posix_spawn(&process_, RMLCELL_CRASH_CHILD, &actions, nullptr, pointers.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    output_ = ends[0];
    if (spawned != 0) throw std::runtime_error("no child");
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (!ended_) Kill();
    Wait();
    close(output_);
  }

  void Kill() { kill(process_, SIGKILL); }

  // Reads until the child has told so many lines, or has closed its end, that is, until it is gone.
  void ReadLines(std::int64_t lines) {
    for (; lines > std::ranges::count(text_, '\n');) {
      char bytes[256];  // few at a time, so that it is stopped in the middle of its work
      const ssize_t size = read(output_, bytes, sizeof(bytes));
      if (size <= 0) return;
      text_.append(bytes, static_cast<std::size_t>(size));
    }
  }
  void ReadAll() { ReadLines(std::numeric_limits<std::int64_t>::max()); }

  // How it ended, as waitpid() tells.
  int Wait() {
    if (!ended_) {
      waitpid(process_, &how_, 0);
      ended_ = true;
    }
    return how_;
  }

  const std::string& text() const { return text_; }

 private:
  pid_t process_ = 0;
  int output_ = -1;
  std::string text_;
  bool ended_ = false;
  int how_ = 0;
};

// Everything acknowledged so far, over all rounds on one store.
struct Acknowledged {
  std::map<std::string, std::int64_t> jobs;        // by request id
  std::map<std::int64_t, std::int64_t> sequences;  // by job
  std::map<std::int64_t, int> ends;                // by job: its state
  std::map<int, Revision> programs;                // by slot
  std::int64_t operations = 0;                     // of a child that came to its end

  void Read(const std::string& text) {
    std::istringstream lines(text);
    std::string line;
    while (std::getline(lines, line) && !lines.eof()) {  // a line without its end was not told
      std::istringstream words(line);
      std::string what;
      std::string name;
      std::int64_t number = 0;
      words >> what >> name >> number;
      if (what == "S") {
        const auto [known, is_new] = jobs.emplace(name, number);
        EXPECT_TRUE(is_new || known->second == number) << line;
      }
      if (what == "E") sequences[std::stoll(name)] = number;
      if (what == "F") ends[std::stoll(name)] = static_cast<int>(number);
      if (what == "P") programs[std::stoi(name)] = number;
      if (what == "D") operations = std::stoll(name);
      EXPECT_NE(what, "!") << line;
    }
  }
};

// The jobs that are there, by request id; each only once.
std::map<std::string, JobRecord> JobsOf(Store& store) {
  std::map<std::string, JobRecord> jobs;
  JobQuery query{.limit = 500};
  for (;;) {
    const std::vector<JobRecord> page = Must(store.ListJobs(query));
    if (page.empty()) return jobs;
    for (const JobRecord& job : page) EXPECT_TRUE(jobs.emplace(job.request_id, job).second);
    query.behind = PlaceOf(page.back());
  }
}

void ExpectJobIsWhole(Store& store, const JobRecord& job, const Acknowledged& told) {
  EXPECT_EQ(job.specification, "specification of " + job.request_id);
  EXPECT_EQ(Must(store.ReadArtifact(job.id, "program")), "program of " + job.request_id);
  const auto events = Must(store.JobEvents(job.id, job.events_gone_until, 1'000'000));
  std::int64_t sequence = job.events_gone_until;
  for (const EventRecord& event : events) EXPECT_EQ(event.sequence, ++sequence);
  EXPECT_EQ(job.last_sequence, sequence);
  if (const auto written = told.sequences.find(job.id); written != told.sequences.end()) {
    EXPECT_GE(job.last_sequence, written->second);
  }
  if (const auto end = told.ends.find(job.id); end != told.ends.end()) {
    EXPECT_EQ(static_cast<int>(job.state), end->second);
  }
  if (job.state == JobState::kSucceeded) {
    const ArtifactRecord report = Must(store.GetArtifact(job.id, "report"));
    const std::string bytes = Must(store.ReadArtifact(job.id, "report"));
    EXPECT_TRUE(bytes == crash::ReportOf(job.id));
    EXPECT_EQ(report.sha256, HexOf(Sha256(bytes)));
  }
}

// `keep`: finished jobs that the store was told to keep; 0: all.
void ExpectAllIsThere(const std::string& path, Acknowledged& told, int keep) {
  {
    SqliteOptions options{.path = path};
    options.keep_finished_jobs = 0;  // nothing more goes while it is looked at
    const std::unique_ptr<Store> store = Must(OpenSqliteStore(options));
    const std::map<std::string, JobRecord> jobs = JobsOf(*store);
    std::int64_t finished = 0;
    for (const auto& [request, job] : jobs) {
      finished += IsFinal(job.state) ? 1 : 0;
      ExpectJobIsWhole(*store, job, told);
    }
    for (const auto& [request, id] : told.jobs) {
      const auto found = jobs.find(request);
      if (found != jobs.end()) {
        EXPECT_EQ(found->second.id, id);
      } else {
        // Only a store that was told so may remove jobs, and only when as many that ended are
        // there.
        EXPECT_TRUE(keep > 0 && finished >= keep) << request << " is lost";
      }
    }
    // Whoever saw no answer repeats the request and gets the same job.
    int repeated = 0;
    for (const auto& [request, job] : jobs) {
      if (++repeated > 5) break;
      const SubmittedJob again = Must(store->SubmitAndWait(crash::JobOf(request)));
      EXPECT_TRUE(again.already_there);
      EXPECT_EQ(again.job.id, job.id);
    }
    for (const auto& [slot, revision] : told.programs) {
      const ProgramRecord program = Must(store->GetProgram("m", slot));
      EXPECT_GE(program.revision, revision);
      EXPECT_TRUE(program.object == crash::ObjectOf(slot, program.revision));
    }
  }
  ExpectSound(path);
}

// Issue 2, kill tests: every acknowledged job is there after the restart, none twice.
TEST(SqliteCrash, NothingAcknowledgedIsLostByAKillAtAnyTime) {
  constexpr int kRoundsOfOneStore = 12;
  std::mt19937 random(20'251'121);
  std::size_t submitted = 0;
  for (int store = 0; store < (IsLongRun() ? 25 : 1); ++store) {
    const TestDirectory directory;
    const std::string path = directory.File("cell.db");
    Acknowledged told;
    for (int round = 0; round < (IsLongRun() ? kRoundsOfOneStore : 6); ++round) {
      SCOPED_TRACE(round);
      Child child({path, Numbered("run", round), "0", "40"});
      child.ReadLines(static_cast<std::int64_t>(random() % 400));
      child.Kill();
      child.ReadAll();
      child.Wait();
      told.Read(child.text());
      ExpectAllIsThere(path, told, 0);
      if (testing::Test::HasFailure()) return;
    }
    submitted += told.jobs.size();
  }
  EXPECT_GT(submitted, 0U);
  RecordProperty("jobs_submitted", static_cast<int>(submitted));
}

// One crash at a chosen operation of the disk, on a store of its own. Returns the operations of a
// child that came to its end.
std::int64_t CrashOnce(const std::string& how, std::int64_t operation) {
  constexpr int kKeep = 5;  // so that housekeeping is in the middle of it all
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  Acknowledged told;
  {
    Child child({path, "run", std::to_string(kKeep), "4", how, std::to_string(operation)});
    child.ReadAll();
    const int ended = child.Wait();
    const bool came_to_its_end = WIFEXITED(ended) && WEXITSTATUS(ended) == 0;
    EXPECT_TRUE(came_to_its_end || (WIFSIGNALED(ended) && WTERMSIG(ended) == SIGKILL))
        << child.text();
    told.Read(child.text());
  }
  ExpectAllIsThere(path, told, kKeep);
  return told.operations;
}

void CrashAtOperations(const std::string& how) {
  // How many there are differs a little from run to run: the threads take turns as they like.
  const std::int64_t all = CrashOnce(how, 1'000'000'000);
  ASSERT_GT(all, 50);
  const std::int64_t step = IsLongRun() ? 1 : all / 25 + 1;
  int points = 0;
  for (std::int64_t operation = 1; operation <= all; operation += step) {
    SCOPED_TRACE(operation);
    CrashOnce(how, operation);
    ++points;
    if (testing::Test::HasFailure()) return;
  }
  testing::Test::RecordProperty("crash_points", points);
}

// The process dies in the middle of a write: what was written before is on the disk, synced or not.
TEST(SqliteCrash, ProcessMayDieAtAnyWrite) { CrashAtOperations("kill"); }

// The power goes: what was written since the last sync of its file is gone.
TEST(SqliteCrash, PowerMayGoAtAnyWrite) { CrashAtOperations("power"); }

}  // namespace
}  // namespace rmlcell::storage
