// What becomes of a job that was cut off. LIVE-5.10
#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "server/jobs/job_request.h"
#include "server/records/job_messages.h"
#include "server/records/program_place.h"

namespace rmlcell::server {

Result<std::string> JobBook::MachineToDecide(const v1::DecideInterruptedRequest& request) {
  using Request = v1::DecideInterruptedRequest;
  const bool resumes = request.decision() == Request::DECISION_RESUME_AT_STEP;
  if (!resumes && request.decision() != Request::DECISION_RESTART &&
      request.decision() != Request::DECISION_ABANDON)
    return InvalidArgument("decision: RESUME_AT_STEP, RESTART or ABANDON");
  if (resumes && request.preview_token().empty())
    return InvalidArgument("preview_token: of PreviewStart, on the machine that waits");
  if (const Status good = CheckReason(request.reason()); !good) return good.error();
  const Result<std::int64_t> id = ParseJobName(request.name());
  if (!id) return id.error();
  const Result<storage::JobRecord> job = store_.GetJob(*id);
  if (!job) return job.error();
  if (job->state != storage::JobState::kInterrupted)
    return Error{ErrorCode::kCellPrecondition, request.name() + " was not interrupted", {}};
  return job->machine;
}

void JobBook::Again(std::string_view name, const std::string& caller, const std::string& request_id,
                    bool continues, std::function<void(Result<v1::Job>)> done) {
  const Result<std::int64_t> id = ParseJobName(name);
  if (!id) return done(id.error());
  const Result<storage::JobRecord> first = store_.GetJob(*id);
  if (!first) return done(first.error());
  Result<std::string> bytes = store_.ReadArtifact(*id, kMainAttachment);
  if (!bytes) return done(bytes.error());
  const v1::Job told = ToProto(*first);
  v1::SubmitJobRequest request;
  request.set_request_id(request_id);
  v1::Job& job = *request.mutable_job();
  job.set_kind(told.kind());
  job.set_machine(told.machine());
  job.set_title(told.title());
  *job.mutable_labels() = told.labels();
  job.set_priority(told.priority());
  if (told.has_run()) *job.mutable_run() = told.run();
  if (continues) {  // where, a preview has said
    job.mutable_run()->clear_step();
    job.mutable_run()->clear_confirmations();
    job.mutable_run()->clear_occurrence();
    job.mutable_run()->clear_off_until_work_on();
  }
  v1::ProgramText& program = *job.mutable_inline_program();
  program.set_content(*std::move(bytes));
  if (const auto brought = ProgramBrought(told)) {
    program.set_file_name(brought->file_name);
    program.set_form(brought->form);
    job.set_inline_slot(told.inline_slot());
  } else if (const auto stored = ParseProgramName(told.program())) {
    program.set_form(v1::PROGRAM_FORM_OBJECT);
    job.set_inline_slot(stored->slot);
  }
  Submit(request, caller, std::move(done), false, continues ? std::string(name) : std::string());
}

}  // namespace rmlcell::server
