#pragma once

#include <chrono>
#include <string>

#include "rmlcell/v1/job.pb.h"
#include "storage/records.h"
#include "storage/store.h"

// Between records of the store and messages of the API.
namespace rmlcell::server {

// The pool of simulations with a pace: they mostly wait for the time of the machine to pass, so
// workers of their own take them, and they hold no processor from jobs that compute, which are in
// no pool. A worker that takes only these says the other word.
inline constexpr std::string_view kPacedPool = "paced";
inline constexpr std::string_view kComputingWorkers = "computing";

google::protobuf::Timestamp ToProto(storage::WallTime time);

storage::WallTime FromProto(const google::protobuf::Timestamp& time);

v1::Job::State ToProto(storage::JobState state);
v1::WaitReason ToProto(storage::WaitReason reason);

// The slot that an inline program stands in for its job.
int InlineSlotOf(const v1::Job& job);

// Slot of the program that it starts.
int MainSlotOf(const v1::Job& job);

// A program that a job brought with it, in the message or by its bytes' name: what it is called and
// what its bytes are. Nothing: a stored one.
struct BroughtProgram {
  std::string file_name{};
  v1::ProgramForm form = v1::PROGRAM_FORM_UNSPECIFIED;
};
std::optional<BroughtProgram> ProgramBrought(const v1::Job& job);

// The job without its artifacts.
v1::Job ToProto(const storage::JobRecord& record);
v1::Artifact ToProto(const storage::ArtifactRecord& record);

// With sequence, job, attempt and time of the record.
v1::JobEvent ToProto(const storage::EventRecord& record);

// An event for the log; its kind follows from what it tells.
storage::NewEvent ToRecord(const v1::JobEvent& event);
storage::NewEvent StateEvent(storage::JobState state);
storage::NewEvent EndedEvent(const v1::Outcome& outcome);
// A job was held back, let go or given another place.
storage::NewEvent QueueEvent(bool held, int priority);
// The same event, told as what this caller did.
storage::NewEvent By(std::string_view caller, storage::NewEvent event);

// How a run ended, as the state of its job.
storage::JobOutcome OutcomeOf(const v1::Outcome& outcome);
v1::Outcome ToProto(const storage::JobOutcome& outcome);

// The outcome of a job whose worker died once more than its policy allows.
storage::JobOutcome WorkerDiedOutcome();
// The server stopped in order while a machine was moved (CELL-E9432).
storage::JobOutcome StoppedOutcome();
// The last event of a job that was cancelled.
storage::NewEvent CancelledEvent();

// What becomes of a job whose worker is lost, and what its watchers are told; `place` is where it
// was.
storage::LossPolicy LossOf(storage::JobOutcome outcome, const v1::SourcePlace& place,
                           const std::string& why);

}  // namespace rmlcell::server
