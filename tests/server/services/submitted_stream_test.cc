// SubmitJobs: many submissions in one stream, each answered by its number (job.proto).
#include "server/base/names.h"
#include "tests/server/services/unary_calls_bed.h"

namespace rmlcell::server {
namespace {

class SubmittedStream : public UnaryCalls {
 protected:
  static v1::SubmitJobsRequest Check(std::int64_t number, const std::string& machine) {
    v1::SubmitJobsRequest request;
    request.set_number(number);
    v1::Job& job = *request.mutable_submission()->mutable_job();
    job.set_kind(v1::JOB_KIND_CHECK);
    job.set_machine("machines/" + machine);
    job.mutable_inline_program()->set_file_name("a.S");
    job.mutable_inline_program()->set_content("STOP\n");
    return request;
  }
  v1::SubmitJobsResponse Answered(const v1::SubmitJobsRequest& request) {
    v1::SubmitJobsResponse response;
    EXPECT_TRUE(stream_->Write(request) && stream_->Read(&response));
    EXPECT_EQ(response.number(), request.number());
    return response;
  }
  void ExpectGoodEndOfStream() {
    stream_->WritesDone();
    v1::SubmitJobsResponse nothing;
    EXPECT_FALSE(stream_->Read(&nothing)) << nothing.ShortDebugString();
    const grpc::Status end = stream_->Finish();
    EXPECT_TRUE(end.ok()) << end.error_message();
  }

 private:
  void SetUp() override {
    context_.set_deadline(std::chrono::system_clock::now() + kPatience);
    stream_ = jobs->SubmitJobs(&context_);
  }

  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::SubmitJobsRequest, v1::SubmitJobsResponse>> stream_;
};

TEST_F(SubmittedStream, EachIsDurableWhenItIsAnswered) {
  for (const std::int64_t number : {7, 3}) {
    const v1::SubmitJobsResponse answer = Answered(Check(number, "optimo-1"));
    EXPECT_EQ(answer.result_case(), v1::SubmitJobsResponse::kJob);
    const storage::JobRecord job = Must(store_.GetJob(Must(ParseJobName(answer.job()))));
    EXPECT_EQ(job.machine, "optimo-1");
    EXPECT_EQ(job.caller, "local");
  }
  EXPECT_EQ(Must(store_.ListJobs({})).size(), 2U);
  ExpectGoodEndOfStream();
}

TEST_F(SubmittedStream, OneThatIsRefusedEndsNothing) {
  const v1::SubmitJobsResponse nowhere = Answered(Check(1, "none"));
  EXPECT_EQ(nowhere.result_case(), v1::SubmitJobsResponse::kRefusal);
  EXPECT_EQ(nowhere.refusal().code(), CodeText(ErrorCode::kCellUnknownMachine));
  EXPECT_TRUE(Must(store_.ListJobs({})).empty());
  v1::SubmitJobsRequest large = Check(2, "optimo-1");
  large.mutable_submission()->mutable_job()->mutable_inline_program()->set_content(
      std::string(std::size_t{8} << 20, ' '));
  const v1::SubmitJobsResponse refused = Answered(large);
  EXPECT_EQ(refused.refusal().code(), CodeText(ErrorCode::kCellTooLarge));
  EXPECT_THAT(refused.refusal().message(), testing::HasSubstr("limits.message_bytes"));
  EXPECT_NE(Answered(Check(3, "optimo-1")).job(), "");
  ExpectGoodEndOfStream();
}

// common.proto validate_only: it would be taken, and nothing is made.
TEST_F(SubmittedStream, ATrialMakesNothing) {
  v1::SubmitJobsRequest request = Check(5, "optimo-1");
  request.mutable_submission()->set_validate_only(true);
  const v1::SubmitJobsResponse answer = Answered(request);
  EXPECT_FALSE(answer.has_refusal()) << answer.ShortDebugString();
  EXPECT_EQ(answer.job(), "");
  EXPECT_TRUE(Must(store_.ListJobs({})).empty());
  ExpectGoodEndOfStream();
}

}  // namespace
}  // namespace rmlcell::server
