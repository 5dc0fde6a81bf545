#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/result.h"
#include "engine/machine/family.h"
#include "rmlcell/v1/job.pb.h"
#include "server/jobs/told_jobs.h"
#include "server/records/known_machines.h"
#include "storage/store.h"

namespace rmlcell::server {

struct Config;

// Submission, lists and products of jobs. What runs them is the Dispatcher.
// Thread-safe; reads block on the store.
class JobBook {
 public:
  // `store` and `config` outlive this.
  JobBook(storage::Store& store, const Config& config)
      : store_(store), config_(config), machines_(store) {}

  // Checks everything that can be checked before work begins, makes the job durable, then calls
  // `done`, from a thread of the store or before it returns. Bytes of programs are kept with the
  // job, and so are those of a target, so that a slot that is stored again meanwhile changes
  // nothing. Errors:
  // CellInvalidArgument, CellUnknownMachine, FamilyInfo::no_slot and empty_slot, CellEmptyProgram,
  // CellTooLarge, CellParameterRange, CellUnimplemented, CellRequestIdReused,
  // CellResourceExhausted. `more_come`: others are on their way from the same caller (NewJob).
  void Submit(const v1::SubmitJobRequest& request, const std::string& caller,
              std::function<void(Result<v1::Job>)> done, bool more_come = false) {
    Submit(request, caller, std::move(done), more_come, {});
  }

  // Called when a RUN may have become one that can begin, from any thread, and not for long. Set
  // before the first call of Submit().
  void OnRunWaits(std::function<void(const std::string& machine)> waits) {
    run_waits_ = std::move(waits);
  }

  // Called with a RUN that waits, as GetJob and SubmitJob are about to tell it: with what keeps its
  // machine from beginning it. From any thread, and not for long. Set as above.
  // `later` does on another thread what would keep the store from others who write.
  void OnToldToWait(std::function<void(v1::Job&)> told,
                    std::function<void(std::function<void()>)> later = {}) {
    told_to_wait_ = std::move(told);
    later_ = std::move(later);
  }

  // A new job of the same program, as that was: of a RUN that was interrupted. `continues`: it is
  // to go on where that was cut off, and is held until it is told where (RunQueue::Continue).
  // Errors: those of Submit().
  void Again(std::string_view name, const std::string& caller, const std::string& request_id,
             bool continues, std::function<void(Result<v1::Job>)> done);
  // The id of the machine that this decision is about. Errors: CellInvalidArgument, CellNotFound,
  // CellPrecondition: the job is not INTERRUPTED.
  Result<std::string> MachineToDecide(const v1::DecideInterruptedRequest& request);

  Result<v1::Job> Get(std::string_view name);
  // The same, serialised, and never waiting for the store. Null: Get() has to be asked, as of each
  // job that waits in the queue.
  std::shared_ptr<const std::string> GetAtOnce(std::string_view name) const;
  Status Delete(std::string_view name, std::string_view caller);
  // Jobs that wait in the queue: held back, let go, given another place. Errors:
  // CellInvalidArgument, CellNotFound, CellPrecondition for one that does not wait.
  Result<v1::Job> HoldBack(std::string_view name, std::string_view caller);
  Result<v1::Job> LetGo(std::string_view name, std::string_view caller);
  Result<v1::Job> Move(const v1::MoveJobRequest& request, std::string_view caller);
  // The names of the jobs that are meant: those that are named, or of the unfinished ones those
  // that a filter finds, in this state where one is given. Errors: CellInvalidArgument,
  // CellBadFilter, CellNotFound, CellPrecondition when they are not as many as expected.
  Result<std::vector<std::string>> Choose(const v1::JobChoice& choice,
                                          std::optional<storage::JobState> state);
  // Of those that the act changes, a few hundred in each transaction; the others are left as they
  // are. Returns them.
  Result<std::vector<storage::JobRecord>> ActOn(const std::vector<std::string>& names,
                                                storage::QueueAct act, std::string_view caller);
  // Whether the machine of the job can have this override. Errors: CellInvalidArgument,
  // CellNotFound.
  Status CheckOverride(std::string_view name, double percent);
  Result<v1::ListJobsResponse> List(const v1::ListJobsRequest& request);

  // A product, and what is known of it. CellNotFound with what there is.
  Result<storage::ArtifactRecord> FindArtifact(std::int64_t job, std::string_view name);
  Result<std::string> ReadArtifact(std::int64_t job, std::string_view name);
  Result<std::unique_ptr<storage::BlobReader>> OpenArtifact(std::int64_t job,
                                                            std::string_view name);

  // The log that the events of jobs are in, and whether an event with this number was seen under
  // such an id; under none: in this log. CellInvalidArgument: it is of another one.
  std::string LogId() { return store_.LogId(); }
  Status CheckLog(std::int64_t job, std::int64_t sequence, std::string_view log_id);

  // Unfinished jobs and the newest finished ones, newest first, for a watcher that begins; of this
  // machine, kind and caller.
  static constexpr int kNewestMax = 200;
  Result<std::vector<v1::Job>> Newest(storage::JobQuery query);
  // How many the query finds, by state, whatever its limit.
  Result<std::vector<v1::JobCount>> Count(const storage::JobQuery& query);

 private:
  // Of a job that is not there, has not ended, or left none such.
  Error WhyNoArtifact(std::int64_t job, std::string_view name);
  void Submit(const v1::SubmitJobRequest& request, const std::string& caller,
              std::function<void(Result<v1::Job>)> done, bool more_come,
              const std::string& continues);
  Result<storage::NewJob> Prepare(const v1::SubmitJobRequest& request, const std::string& caller,
                                  const std::string& continues);
  // Whether a job may come behind those that it names. Errors: CellNotFound, CellPrecondition.
  Status CheckAwaited(const storage::NewJob& made);
  int AttemptsOf(const v1::Job& job) const;
  void AddWhyItWaits(v1::Job& job) const;
  void TellRun(const storage::JobRecord& job);
  Result<v1::Job> WithArtifacts(const storage::JobRecord& record);
  Status CheckSize(std::size_t bytes, const std::string& what) const;
  Status AttachProgram(const v1::Job& job, const machine::MachineFamily& family,
                       storage::NewJob& made, v1::Job& specification);
  // The further programs of a simulation, moved out of the specification.
  Status AttachFurther(const v1::Job& job, const machine::MachineFamily& family,
                       storage::NewJob& made, v1::Job& specification) const;

  storage::Store& store_;
  const Config& config_;
  KnownMachines machines_;
  ToldJobs told_;
  std::function<void(const std::string&)> run_waits_;
  std::function<void(v1::Job&)> told_to_wait_;
  std::function<void(std::function<void()>)> later_;
};

// The names under which the programs of a job are kept with it: "program" for the one that is
// started, "program-46" for a further one.
std::string AttachmentName(int slot);
inline constexpr std::string_view kMainAttachment = "program";

}  // namespace rmlcell::server
