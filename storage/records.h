#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/catalogue.h"

// What the cell keeps, as plain values. Bytes that only their writer understands (a job's
// specification, an event's payload, a project's body) are opaque here: storage knows no protobuf.
namespace rmlcell::storage {

using WallTime = std::chrono::sys_time<std::chrono::microseconds>;

// Counts the changes of one record, from 1. A record that was deleted and is made again goes on
// counting, so that what was expected of the old one never fits the new one. 0 as an expectation
// means "must not exist yet"; kAnyRevision means "whatever is there".
using Revision = std::int64_t;
inline constexpr Revision kAnyRevision = -1;

// The largest program that is taken, as source, object or executable (design.md section 6).
inline constexpr std::size_t kProgramBytesMax = std::size_t{256} << 20;
// A watcher gets an event in one message, and those of gRPC end at 4 MiB.
inline constexpr std::size_t kEventPayloadBytesMax = std::size_t{3} << 20;
inline constexpr int kScheduleMin = 1;
inline constexpr int kScheduleMax = 63;

struct MachineRecord {
  std::string id{};  // "optimo-1"
  std::string family{};
  std::string title{};
  std::string profile{};                            // empty: the defaults of the family
  std::map<std::string, std::string> parameters{};  // what differs from the profile
  std::string options{};                            // how it lives; opaque
  Revision revision = 0;
  WallTime created_at{};
  WallTime updated_at{};
};

// A change of a program by hand. LIVE-7.09
struct TeachRecord {
  std::string machine{};
  std::int64_t number = 0;  // counts from 1 within the machine
  int program = 0;          // slot
  std::string entry{};      // opaque
};
inline constexpr std::int64_t kTeachRecordsKept = 10'000;  // the newest, of a machine

// The right to be the host of a machine: to move it, and to say where it stands. LIVE-3.02
struct MachineLease {
  std::string machine{};
  std::string host{};         // the process that has it
  std::string server{};       // through which it was renewed last
  std::int64_t fence = 0;     // grows with every lease that this store ever gave
  std::int64_t renewals = 0;  // since it was taken
  std::chrono::milliseconds duration{0};
  bool pinned = false;  // of a device: only a person gives it to another host

  bool operator==(const MachineLease&) const = default;
};

// Where a machine stands, as its host said last. It lies beside the configuration of the machine
// and changes no revision of it.
struct MachineMark {
  std::int64_t fence = 0;
  std::int64_t sequence = 0;  // of the host's journal: grows under one fence
  std::string state{};        // engine bytes; empty: a new machine
  std::string note{};         // the host's own, opaque
  bool clean = true;          // no run was open
  WallTime at{};              // when it was stored
};
inline constexpr std::size_t kMachineMarkBytesMax = std::size_t{256} << 10;  // state and note

struct ProgramRecord {
  std::string machine{};
  int slot = 0;  // 1..99
  std::string name{};
  std::string object{};
  std::optional<std::string> source{};      // where the program was stored from text
  std::string source_name{};                // file name of the source
  std::optional<std::string> executable{};  // at slot + 100
  Revision revision = 0;  // of the object; an executable made of an older one is gone
  WallTime created_at{};
  WallTime updated_at{};
};

// A program without its bytes, for lists.
struct ProgramSummary {
  int slot = 0;
  std::string name{};
  std::string source_name{};
  std::int64_t object_bytes = 0;
  std::int64_t source_bytes = -1;      // -1: no source
  std::int64_t executable_bytes = -1;  // -1: no executable
  std::string object_sha256{};         // lower-case hexadecimal
  Revision revision = 0;
  WallTime created_at{};
  WallTime updated_at{};
};

struct ScheduleRecord {
  std::string machine{};
  int number = 0;  // 1..63
  std::string name{};
  std::string mode{};
  double power_percent = 100.0;
  Revision revision = 0;
  WallTime updated_at{};
};

struct ProjectRecord {
  std::string id{};
  std::string title{};
  std::string body{};  // opaque
  Revision revision = 0;
  WallTime created_at{};
  WallTime updated_at{};
};

inline constexpr std::string_view kCheckKind = "CHECK";
// The kind of the jobs that move a machine: they are never attempted again by themselves.
inline constexpr std::string_view kRunKind = "RUN";

enum class JobState { kQueued, kRunning, kSucceeded, kFailed, kCancelled, kInterrupted };
inline bool IsFinal(JobState state) {
  return state != JobState::kQueued && state != JobState::kRunning;
}

// Those of a higher priority start first.
inline constexpr int kPriorityMin = -100;
inline constexpr int kPriorityMax = 100;

// What a job waits for besides a worker.
enum class WaitReason {
  kNone,
  kHeld,            // until it is let go
  kNotBefore,       // its time has not come
  kAfterJob,        // another one has to succeed first
  kAfterJobFailed,  // another one did not succeed: a person decides
  kMachineBusy,     // RUN: its machine runs another one
};

struct JobOutcome {
  JobState state = JobState::kSucceeded;
  std::optional<ErrorCode> code{};
  std::string detail{};
  int program = 0;  // where it ended, 0: not known
  int step = 0;
  std::string judgement{};  // opaque; what the part will come out like, where that is known
  std::string verdict{};    // the word for it, to look for: "BAD"
};

struct JobRecord {
  std::int64_t id = 0;       // counts up; the order of submission
  std::string request_id{};  // unique; made by the store when the client gave none
  std::string
      request_hash{};  // of what was asked for: the same request_id with another request is refused
  std::string machine{};
  std::string family{};  // of the machine
  std::string kind{};    // "CHECK", "SIMULATE", kRunKind
  std::string pool{};    // of the workers that take it; may be empty
  std::string title{};
  std::string caller{};
  std::vector<std::string> labels{};  // words without blanks, to look for
  std::string specification{};        // opaque
  JobState state = JobState::kQueued;
  int priority = 0;
  double place = 0.0;  // in the queue, among those of its priority: less is earlier
  bool held = false;
  std::optional<WallTime> not_before{};
  std::vector<std::int64_t> after{};  // jobs that it waits for, those that have not succeeded
  bool blocked = false;  // it waits for a person, a time or other jobs, and has no turn yet
  WaitReason wait = WaitReason::kNone;
  std::int64_t waits_for = 0;  // the job of kAfterJob, kAfterJobFailed and kMachineBusy
  bool cancel_requested = false;
  int attempts = 0;  // begun and not handed back; the number of an attempt stands in its lease
  int attempts_max = 2;
  std::optional<JobOutcome> outcome{};
  std::int64_t last_sequence = 0;      // of its newest event
  std::int64_t events_gone_until = 0;  // its events up to this sequence number were removed
  WallTime created_at{};
  std::optional<WallTime> started_at{};  // of the first attempt
  std::optional<WallTime> finished_at{};
};

struct JobCounts {
  std::int64_t queued = 0;
  std::int64_t running = 0;
};

struct JobStateCount {
  JobState state = JobState::kQueued;
  std::int64_t jobs = 0;
};

// The jobs of one machine that wait or run.
struct MachineJobs {
  std::string machine{};
  std::int64_t unfinished = 0;
  std::int64_t oldest_running = 0;  // a job's id; 0: none runs
};

struct AttemptRecord {
  std::int64_t job = 0;
  int number = 0;  // from 1
  std::string worker{};
  std::int64_t fence = 0;
  WallTime started_at{};
  std::optional<WallTime> ended_at{};
  // "succeeded", "failed", "cancelled", "interrupted", "handed back", "abandoned", "lease ran out";
  // empty while it runs.
  std::string how_it_ended{};
};

// What was done with a machine, program, schedule or project: the kind of such an event.
inline constexpr std::string_view kCreated = "created";
inline constexpr std::string_view kUpdated = "updated";
inline constexpr std::string_view kDeleted = "deleted";

// One line of the durable log of a job.
struct NewEvent {
  std::string kind{};     // "state", "step", "alarm" ...: for filters and people
  std::string payload{};  // opaque
  std::string caller{};   // who did it; empty: nobody, it came of itself
};
// One line of the log of the cell, which is one over all its resources. Jobs tell what happens in
// them; of other records it is told that they were made, changed or deleted, and no more: what they
// are now is read where they are kept.
struct EventRecord {
  std::int64_t position = 0;  // over the whole cell, counts up, with gaps
  std::int64_t job = 0;       // 0: of another resource
  std::string resource{};     // of what is no job: "machines/optimo-1/programs/45"
  std::int64_t sequence = 0;  // within the job, from 1 without a gap
  int attempt = 0;            // 0: from the server, outside an attempt
  WallTime at{};
  std::string caller{};
  std::string kind{};
  std::string payload{};
};

// The names of resources, as the API has them.
inline std::string MachineName(std::string_view id) { return "machines/" + std::string(id); }
inline std::string ProjectName(std::string_view id) { return "projects/" + std::string(id); }
inline std::string JobName(std::int64_t id) { return "jobs/" + std::to_string(id); }
inline std::string NameOfProgram(std::string_view machine, int slot) {
  return MachineName(machine) + "/programs/" + std::to_string(slot);
}
inline std::string NameOfSchedule(std::string_view machine, int number) {
  return MachineName(machine) + "/laserSchedules/" + std::to_string(number);
}

// A product of a job: report, toolpath, picture. Bytes are kept compressed, large ones once for all
// jobs that have the same.
struct NewArtifact {
  std::string name{};  // "report", "toolpath", "picture.svg"
  std::string media_type{};
  std::string bytes{};
  std::string
      existing_sha256{};  // not empty: content that the store has already; `bytes` is not looked at
};
struct ArtifactRecord {
  std::int64_t job = 0;
  std::string name{};
  std::string media_type{};
  std::string sha256{};  // lower-case hexadecimal, of the uncompressed bytes
  std::int64_t size = 0;
};

}  // namespace rmlcell::storage
