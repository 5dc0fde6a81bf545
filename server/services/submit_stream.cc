#include "server/services/submit_stream.h"

#include <memory>
#include <utility>

#include "server/jobs/job_book.h"
#include "server/services/answered_stream.h"

namespace rmlcell::server {
namespace {

using SubmitAnswers = AnsweredStream<v1::SubmitJobsRequest, v1::SubmitJobsResponse>;
static_assert(kSubmittedAtOnce == SubmitAnswers::kAtOnce);

class SubmitStream final : public SubmitAnswers {
 public:
  SubmitStream(const CallNeeds& needs, JobBook& book, OpenStreams& open, CallFacts facts,
               Caller caller)
      : SubmitAnswers(needs, open, "JobService/SubmitJobs", std::move(facts), std::move(caller)),
        book_(book) {}

 private:
  void Take(std::shared_ptr<v1::SubmitJobsRequest> request, Answer answer) override {
    const auto submitted = [number = request->number(),
                            answer = std::move(answer)](const Result<v1::Job>& job) {
      v1::SubmitJobsResponse response;
      response.set_number(number);
      if (job) {
        response.set_job(job->name());
      } else {
        *response.mutable_refusal() = bridge::ToErrorDetail(job.error());
      }
      answer(std::move(response));
    };
    if (const Status good = CheckRequest(needs(), *request); !good) return submitted(good.error());
    book_.Submit(
        request->submission(), caller().identity,
        [request, submitted](const Result<v1::Job>& job) { submitted(job); }, /*more_come=*/true);
  }

  JobBook& book_;
};

}  // namespace

grpc::ServerBidiReactor<v1::SubmitJobsRequest, v1::SubmitJobsResponse>* MakeSubmitStream(
    const CallNeeds& needs, grpc::CallbackServerContext& context, JobBook& book,
    OpenStreams& open) {
  return BeginAnsweredStream<v1::SubmitJobsRequest, v1::SubmitJobsResponse>(
      needs, context, "JobService/SubmitJobs", [&](CallFacts facts, const Caller& caller) {
        return std::make_shared<SubmitStream>(needs, book, open, std::move(facts), caller);
      });
}

}  // namespace rmlcell::server
