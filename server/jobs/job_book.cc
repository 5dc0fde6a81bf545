#include "server/jobs/job_book.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <span>

#include "engine/core/units.h"
#include "engine/families/families.h"
#include "proto/bridge/encoding.h"
#include "proto/bridge/inputs.h"
#include "proto/bridge/sha256.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "server/base/readable.h"
#include "server/jobs/job_filter.h"
#include "server/jobs/job_milling.h"
#include "server/jobs/job_request.h"
#include "server/records/file_family.h"
#include "server/records/job_messages.h"
#include "server/records/program_place.h"
#include "storage/jobs/job_rules.h"
#include "storage/jobs/queue_rules.h"

namespace rmlcell::server {
namespace {

constexpr PageSizes kJobPages{.fallback = 50, .max = 1000};
constexpr int kChoicePage = 1000;
constexpr std::size_t kActedOnAtOnce = 200;

// Two requests of one request_id must ask for the same: by this alone a submission is acknowledged
// as a job that is there already, so nobody may be able to make two jobs of one hash. A store of an
// earlier version holds another kind of hash: such a request, repeated, is refused as reused, and
// nothing is run twice.
std::string RequestHash(const v1::SubmitJobRequest& request) {
  return bridge::Sha256Hex(bridge::StableBytes(request.job()));
}

}  // namespace

std::string AttachmentName(int slot) { return "program-" + std::to_string(slot); }

Status JobBook::AttachProgram(const v1::Job& job, const machine::MachineFamily& family,
                              storage::NewJob& made, v1::Job& specification) {
  switch (job.program_source_case()) {
    case v1::Job::kInlineProgram: {
      if (const Status fits =
              CheckSize(job.inline_program().content().size(), "job.inline_program");
          !fits)
        return fits.error();
      if (const Status good = CheckBrought(job, job.inline_program().file_name(), family); !good)
        return good.error();
      made.attachments.push_back({std::string(kMainAttachment),
                                  "application/octet-stream",
                                  job.inline_program().content(),
                                  {}});
      specification.mutable_inline_program()->clear_content();
      return {};
    }
    case v1::Job::kUploadedProgram: {
      const v1::UploadedProgram& uploaded = job.uploaded_program();
      std::optional<std::string> sha256 = bridge::ReadSha256(uploaded.sha256());
      if (!sha256)
        return InvalidArgument("job.uploaded_program.sha256 is not 64 hexadecimal digits");
      if (const Status good = CheckBrought(job, uploaded.file_name(), family); !good)
        return good.error();
      const auto content = store_.OpenBlob(*sha256);
      if (!content) return content.error();
      if (const Status fits = CheckSize((*content)->size(), "job.uploaded_program"); !fits)
        return fits.error();
      made.attachments.push_back(
          {std::string(kMainAttachment), "application/octet-stream", {}, *std::move(sha256)});
      return {};
    }
    case v1::Job::kProgram: {
      const Result<ProgramName> name = ParseProgramName(job.program());
      if (!name) return name.error();
      if (name->machine != made.machine)
        return InvalidArgument("job.program is not a program of job.machine");
      if (const Status there = CheckNumber(family, *name); !there) return there.error();
      if (name->executable)
        return Error{family.info().no_slot, "an executable is started by its object", {}};
      const auto found = store_.GetProgramSummary(made.machine, name->slot);
      if (!found) {
        if (found.error().code != ErrorCode::kCellNotFound) return found.error();
        return EmptySlot(family, job.program());
      }
      made.attachments.push_back(
          {std::string(kMainAttachment), "application/octet-stream", {}, found->object_sha256});
      return {};
    }
    case v1::Job::PROGRAM_SOURCE_NOT_SET:
      break;
  }
  return InvalidArgument("job.program, job.inline_program or job.uploaded_program is missing");
}

Status JobBook::CheckSize(std::size_t bytes, const std::string& what) const {
  if (bytes == 0) return Error{ErrorCode::kCellEmptyProgram, what, {}};
  if (static_cast<std::int64_t>(bytes) <= config_.limit_program_bytes) return {};
  return Error{ErrorCode::kCellTooLarge,
               what + " has " +
                   Told("bytes", static_cast<double>(bytes), "bytes", std::to_string(bytes)) +
                   " bytes; limits.program_bytes is " +
                   Told("limit", static_cast<double>(config_.limit_program_bytes), "bytes",
                        std::to_string(config_.limit_program_bytes)),
               {}};
}

Status JobBook::AttachFurther(const v1::Job& job, const machine::MachineFamily& family,
                              storage::NewJob& made, v1::Job& specification) const {
  std::set<int> further;
  for (v1::SlotProgram& program : *specification.mutable_simulation()->mutable_programs()) {
    const std::string what = "job.simulation.programs of slot " + std::to_string(program.slot());
    if (const Status fits = CheckSize(program.program().content().size(), what); !fits)
      return fits.error();
    if (const Status fits = CheckFileFamily(program.program().file_name(), family); !fits)
      return fits.error();
    if (!further.insert(program.slot()).second) return InvalidArgument(what + " stands twice");
    if (!job.has_program() && program.slot() == InlineSlotOf(job)) {
      return InvalidArgument(
          what + ": the slot of the job's own program (inline_slot, 1 when it is not given)");
    }
    made.attachments.push_back({AttachmentName(program.slot()),
                                "application/octet-stream",
                                std::move(*program.mutable_program()->mutable_content()),
                                {}});
    program.mutable_program()->clear_content();
  }
  return {};
}

Result<storage::NewJob> JobBook::Prepare(const v1::SubmitJobRequest& request,
                                         const std::string& caller, const std::string& continues) {
  const v1::Job& job = request.job();
  if (const Status good = CheckRequest(request); !good) return good.error();
  const Result<std::string> machine_id = ParseMachineName(job.machine());
  if (!machine_id) return machine_id.error();
  const Result<storage::MachineRecord> machine = machines_.Get(*machine_id);
  if (!machine) return machine.error();
  const machine::MachineFamily* known = families::FindFamily(machine->family);
  if (known == nullptr) return families::UnknownFamily(machine->family);
  const machine::MachineFamily& family = *known;
  if (const Status valid = CheckSimulation(job.simulation(), family); !valid) return valid.error();

  auto after = AwaitedJobs(job);
  if (!after) return after.error();
  std::optional<storage::WallTime> not_before;
  if (job.has_not_before_time()) not_before = FromProto(job.not_before_time());

  storage::NewJob made{.request_id = request.request_id(),
                       .request_hash = request.request_id().empty() ? "" : RequestHash(request),
                       .machine = *machine_id,
                       .family = machine->family,
                       .kind = std::string(KindName(job.kind())),
                       .pool = std::string(job.simulation().pace() > 0.0 ? kPacedPool : ""),
                       .title = job.title(),
                       .caller = caller,
                       .labels = {job.labels().begin(), job.labels().end()},
                       .specification = {},
                       .attempts_max = AttemptsOf(job),
                       .queued_max = config_.jobs_queued_max,
                       .priority = job.priority(),
                       .held = job.held() || !continues.empty(),
                       .not_before = not_before,
                       .after = *std::move(after),
                       .attachments = {},
                       .events = {By(caller, StateEvent(storage::JobState::kQueued))}};
  v1::Job specification = job;
  if (const Status attached = AttachProgram(job, family, made, specification); !attached)
    return attached.error();
  std::map<std::string, std::string> values = machine->parameters;
  for (const auto& [name, value] : job.simulation().parameters()) values[name] = value;
  const Result<machine::Parameters> parameters =
      machine::MakeParameters(family, machine->profile, values);
  if (!parameters) return parameters.error();
  if (const Status good = CheckVariables(job.simulation(), family, *parameters); !good)
    return good.error();
  if (const Status good =
          SettleMilling(store_, config_, family, family.Shape(*parameters), made, specification);
      !good)
    return good.error();
  if (const Status further = AttachFurther(job, family, made, specification); !further)
    return further.error();
  if (!job.has_simulation()) specification.clear_simulation();
  specification.set_continues(continues);
  made.specification = bridge::StableBytes(specification);
  return made;
}

Status JobBook::CheckAwaited(const storage::NewJob& made) {
  for (const std::int64_t id : made.after) {
    const auto other = store_.GetJob(id);
    if (!other) return other.error();
    if (const auto awaited = storage::MustAwait(id, other->state); !awaited) return awaited.error();
  }
  return {};
}

void JobBook::Submit(const v1::SubmitJobRequest& request, const std::string& caller,
                     std::function<void(Result<v1::Job>)> done, bool more_come,
                     const std::string& continues) {
  Result<storage::NewJob> made = Prepare(request, caller, continues);
  if (made) made->more_come = more_come;
  if (!made || request.validate_only()) {
    // Repeated after an answer that was lost: what it needed may be gone by now, its job is there.
    std::optional<storage::JobRecord> first;
    if (!request.request_id().empty()) {
      auto found = store_.FindSubmitted(request.request_id(), RequestHash(request));
      if (!found) return done(found.error());
      first = *std::move(found);
    }
    if (!made && !first) return done(made.error());
    if (!request.validate_only()) return done(ToProto(*first));
    if (made && !first) {
      if (const Status may = CheckAwaited(*made); !may) return done(may.error());
    }
    v1::Job job = request.job();
    job.clear_name();
    return done(std::move(job));
  }
  store_.Submit(std::move(*made), [this, more_come, done = std::move(done)](
                                      const Result<storage::SubmittedJob>& submitted) {
    if (!submitted) return done(submitted.error());
    TellRun(submitted->job);
    v1::Job job = ToProto(submitted->job);
    // Of many at once nobody reads why each waits.
    if (more_come || job.kind() != v1::JOB_KIND_RUN) return done(std::move(job));
    auto tell = [this, job = std::move(job), done]() mutable {
      AddWhyItWaits(job);
      done(std::move(job));
    };
    later_ ? later_(tell) : tell();
  });
}

// Once on a machine, whatever happens. LIVE-5.01
int JobBook::AttemptsOf(const v1::Job& job) const {
  if (job.kind() == v1::JOB_KIND_RUN) return 1;
  return job.attempts_max() > 0 ? job.attempts_max() : static_cast<int>(config_.jobs_attempts);
}

void JobBook::TellRun(const storage::JobRecord& job) {
  if (run_waits_ && job.kind == storage::kRunKind && job.state == storage::JobState::kQueued)
    run_waits_(job.machine);
}

void JobBook::AddWhyItWaits(v1::Job& job) const {
  const bool waits = job.kind() == v1::JOB_KIND_RUN && job.state() == v1::Job::STATE_QUEUED;
  if (told_to_wait_ && waits) told_to_wait_(job);
}

Result<v1::Job> JobBook::Get(std::string_view name) {
  const Result<std::int64_t> id = ParseJobName(name);
  if (!id) return id.error();
  const std::uint64_t changes = store_.JobChanges(*id);
  v1::Job known;
  if (const auto told = told_.Find(*id, changes); told && known.ParseFromString(*told))
    return known;
  const Result<storage::JobRecord> record = store_.GetJob(*id);
  if (!record) return record.error();
  Result<v1::Job> job = WithArtifacts(*record);
  if (!job) return job;
  if (job->wait_reason() == v1::WAIT_REASON_WORKER) {
    const Result<std::int64_t> before = store_.CountBefore(*id);
    if (before) job->set_position_in_queue(*before);
    // Else it has begun meanwhile.
  }
  AddWhyItWaits(*job);
  // What one waits for, and how long, changes without it.
  if (record->state != storage::JobState::kQueued) told_.Keep(*id, changes, *job);
  return job;
}

std::shared_ptr<const std::string> JobBook::GetAtOnce(std::string_view name) const {
  const Result<std::int64_t> id = ParseJobName(name);
  return id ? told_.Find(*id, store_.JobChanges(*id)) : nullptr;
}

Status JobBook::Delete(std::string_view name, std::string_view caller) {
  const Result<std::int64_t> id = ParseJobName(name);
  if (!id) return id.error();
  return store_.DeleteJob(*id, caller);
}

Result<v1::Job> JobBook::HoldBack(std::string_view name, std::string_view caller) {
  const Result<std::int64_t> id = ParseJobName(name);
  if (!id) return id.error();
  const auto job = store_.GetJob(*id);
  if (!job) return job.error();
  const auto held = store_.HoldBack(*id, {By(caller, QueueEvent(true, job->priority))});
  if (!held) return held.error();
  return WithArtifacts(*held);
}

Result<v1::Job> JobBook::LetGo(std::string_view name, std::string_view caller) {
  const Result<std::int64_t> id = ParseJobName(name);
  if (!id) return id.error();
  const auto job = store_.GetJob(*id);
  if (!job) return job.error();
  const auto gone = store_.LetGo(*id, {By(caller, QueueEvent(false, job->priority))});
  if (!gone) return gone.error();
  TellRun(*gone);
  return WithArtifacts(*gone);
}

Result<v1::Job> JobBook::Move(const v1::MoveJobRequest& request, std::string_view caller) {
  const Result<std::int64_t> id = ParseJobName(request.name());
  if (!id) return id.error();
  std::int64_t before = 0;
  std::optional<int> priority;
  if (request.has_priority()) priority = request.priority();
  auto job = store_.GetJob(*id);
  if (!job) return job.error();
  if (!request.before().empty()) {
    const Result<std::int64_t> other = ParseJobName(request.before());
    if (!other) return other.error();
    const auto found = store_.GetJob(*other);
    if (!found) return found.error();
    before = *other;
    job->priority = found->priority;
  } else if (priority) {
    job->priority = *priority;
  }
  const auto moved =
      store_.Move(*id, before, priority, {By(caller, QueueEvent(job->held, job->priority))});
  if (!moved) return moved.error();
  return WithArtifacts(*moved);
}

Result<std::vector<std::string>> JobBook::Choose(const v1::JobChoice& choice,
                                                 std::optional<storage::JobState> state) {
  std::vector<std::string> names;
  storage::JobQuery query{.finished = false, .limit = kChoicePage};
  switch (choice.which_case()) {
    case v1::JobChoice::kNames: {
      std::set<std::int64_t> named;
      for (const std::string& name : choice.names().names()) {
        const Result<std::int64_t> id = ParseJobName(name);
        if (!id) return id.error();
        if (const auto job = store_.GetJob(*id); !job) return job.error();
        if (named.insert(*id).second) names.push_back(JobName(*id));
      }
      break;
    }
    case v1::JobChoice::kFilter:
      if (choice.filter().empty()) return InvalidArgument("jobs.filter is empty; say all");
      if (const Status applied = ApplyFilter(choice.filter(), query); !applied)
        return applied.error();
      [[fallthrough]];
    case v1::JobChoice::kAll: {
      if (choice.which_case() == v1::JobChoice::kAll && !choice.all())
        return InvalidArgument("jobs.all is false");
      if (state && query.state && *query.state != *state) break;  // none of these waits
      if (state) query.state = state;
      for (;;) {
        const auto page = store_.ListJobs(query);
        if (!page) return page.error();
        for (const storage::JobRecord& job : *page) names.push_back(JobName(job.id));
        if (page->size() < static_cast<std::size_t>(kChoicePage)) break;
        query.behind = storage::PlaceOf(page->back());
      }
      break;
    }
    case v1::JobChoice::WHICH_NOT_SET:
      return InvalidArgument("jobs is missing: names, filter or all");
  }
  if (choice.expected_count() != 0 &&
      choice.expected_count() != static_cast<std::int64_t>(names.size())) {
    return Error{ErrorCode::kCellPrecondition,
                 "these are " + std::to_string(names.size()) + " jobs, expected were " +
                     std::to_string(choice.expected_count()),
                 {}};
  }
  return names;
}

Result<std::vector<storage::JobRecord>> JobBook::ActOn(const std::vector<std::string>& names,
                                                       storage::QueueAct act,
                                                       std::string_view caller) {
  std::vector<std::int64_t> jobs;
  for (const std::string& name : names) jobs.push_back(*ParseJobName(name));
  const auto event = [&](const storage::JobRecord& job) {
    if (act == storage::QueueAct::kCancel) return By(caller, CancelledEvent());
    return By(caller, QueueEvent(act == storage::QueueAct::kHold, job.priority));
  };
  std::vector<storage::JobRecord> changed;
  std::span<const std::int64_t> left = jobs;
  while (!left.empty()) {
    const auto part = left.first(std::min(left.size(), kActedOnAtOnce));
    left = left.subspan(part.size());
    auto of_part = store_.ActOn(part, act, event);
    if (!of_part) return of_part.error();
    std::move(of_part->begin(), of_part->end(), std::back_inserter(changed));
  }
  return changed;
}

Status JobBook::CheckOverride(std::string_view name, double percent) {
  const Result<std::int64_t> id = ParseJobName(name);
  if (!id) return id.error();
  const Result<storage::JobRecord> record = store_.GetJob(*id);
  if (!record) return record.error();
  const auto machine = machines_.Get(record->machine);
  if (!machine) return machine.error();
  const machine::MachineFamily* family = families::FindFamily(machine->family);
  if (family == nullptr) return families::UnknownFamily(machine->family);
  const Status valid = bridge::CheckOverride(percent, family->info().override_max_percent);
  return valid ? valid : InvalidArgument("override_percent: " + valid.error().detail);
}

Result<v1::Job> JobBook::WithArtifacts(const storage::JobRecord& record) {
  v1::Job job = ToProto(record);
  const auto artifacts = store_.ListArtifacts(record.id);
  if (!artifacts) return artifacts.error();
  for (const storage::ArtifactRecord& artifact : *artifacts)
    *job.add_artifacts() = ToProto(artifact);
  return job;
}

Result<v1::ListJobsResponse> JobBook::List(const v1::ListJobsRequest& request) {
  storage::JobQuery query;
  const Result<int> size = PageSize(request.page_size(), kJobPages);
  if (!size) return size.error();
  query.limit = *size + 1;  // one more tells whether there is a next page
  if (const Status applied = ApplyFilter(request.filter(), query); !applied) return applied.error();
  const Result<storage::JobOrder> order = ReadJobOrder(request.order_by());
  if (!order) return order.error();
  query.order = *order;
  if (!request.page_token().empty()) {
    const Result<storage::JobPlace> behind = ReadJobPlace(request.page_token());
    if (!behind) return behind.error();
    query.behind = *behind;
  }
  const Result<std::vector<storage::JobRecord>> records = store_.ListJobs(query);
  if (!records) return records.error();
  v1::ListJobsResponse response;
  if (request.count()) {
    const auto counts = Count(query);
    if (!counts) return counts.error();
    for (const v1::JobCount& count : *counts)
      response.set_total_size(response.total_size() + count.jobs());
    *response.mutable_counts() = {counts->begin(), counts->end()};
  }
  for (const storage::JobRecord& record : *records) {
    if (response.jobs_size() == *size) {
      response.set_next_page_token(
          WriteJobPlace(storage::PlaceOf((*records)[static_cast<std::size_t>(*size) - 1])));
      break;
    }
    Result<v1::Job> job = WithArtifacts(record);
    if (!job) return job.error();
    *response.add_jobs() = *std::move(job);
  }
  return response;
}

Result<std::vector<v1::JobCount>> JobBook::Count(const storage::JobQuery& query) {
  const auto counted = store_.CountByState(query);
  if (!counted) return counted.error();
  std::vector<v1::JobCount> counts;
  for (const storage::JobStateCount& count : *counted) {
    if (query.state && *query.state != count.state) continue;
    if (query.finished && *query.finished != storage::IsFinal(count.state)) continue;
    v1::JobCount& made = counts.emplace_back();
    made.set_state(ToProto(count.state));
    made.set_jobs(count.jobs);
  }
  return counts;
}

Result<storage::ArtifactRecord> JobBook::FindArtifact(std::int64_t job, std::string_view name) {
  Result<storage::ArtifactRecord> artifact = store_.GetArtifact(job, name);
  if (artifact || artifact.error().code != ErrorCode::kCellNotFound) return artifact;
  return WhyNoArtifact(job, name);
}

Error JobBook::WhyNoArtifact(std::int64_t job, std::string_view name) {
  const Result<storage::JobRecord> record = store_.GetJob(job);
  if (!record) return record.error();
  if (!storage::IsFinal(record->state)) {
    return Error{ErrorCode::kCellPrecondition,
                 JobName(job) + " has not ended: what it leaves, perhaps " + Readable(name) +
                     ", is there at its end",
                 {}};
  }
  const std::string later =
      record->kind == storage::kRunKind && record->started_at
          ? " yet: what its machine recorded is played again for it, where it "
            "was not cut off"
          : "";
  return Error{ErrorCode::kCellNotFound, JobName(job) + " has no " + Readable(name) + later, {}};
}

Result<std::string> JobBook::ReadArtifact(std::int64_t job, std::string_view name) {
  Result<std::string> bytes = store_.ReadArtifact(job, name);
  if (bytes || bytes.error().code != ErrorCode::kCellNotFound) return bytes;
  return WhyNoArtifact(job, name);
}

Result<std::unique_ptr<storage::BlobReader>> JobBook::OpenArtifact(std::int64_t job,
                                                                   std::string_view name) {
  auto opened = store_.OpenArtifact(job, name);
  if (opened || opened.error().code != ErrorCode::kCellNotFound) return opened;
  return WhyNoArtifact(job, name);
}

Status JobBook::CheckLog(std::int64_t job, std::int64_t sequence, std::string_view log_id) {
  if (log_id.empty() || sequence <= 0) return {};
  // Where it stands in the log of the cell; one that was removed only shows that the log is known.
  std::int64_t position = 0;
  const auto events = store_.JobEvents(job, sequence - 1, 1);
  if (!events && events.error().code != ErrorCode::kCellEventsGone) return events.error();
  if (events && !events->empty()) position = events->front().position;
  const Result<bool> known = store_.HasPosition(log_id, position);
  if (!known) return known.error();
  if (*known) return {};
  return InvalidArgument("after_sequence is a number of another log: begin anew, with a snapshot");
}

Result<std::vector<v1::Job>> JobBook::Newest(storage::JobQuery query) {
  std::vector<v1::Job> jobs;
  for (const bool finished : {false, true}) {
    query.finished = finished;
    query.limit = kNewestMax - static_cast<int>(jobs.size());
    if (query.limit <= 0) break;
    const Result<std::vector<storage::JobRecord>> records = store_.ListJobs(query);
    if (!records) return records.error();
    for (const storage::JobRecord& record : *records) {
      Result<v1::Job> job = WithArtifacts(record);
      if (!job) return job.error();
      jobs.push_back(*std::move(job));
    }
  }
  std::ranges::sort(jobs, [](const v1::Job& a, const v1::Job& b) {
    return *ParseJobName(a.name()) > *ParseJobName(b.name());
  });
  return jobs;
}

}  // namespace rmlcell::server
