#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "clients/cli/remote.h"
#include "rmlcell/v1/job.grpc.pb.h"
#include "tests/clients/cli/fake_services.h"

// A server of jobs that answers with what it was given, for the verbs about jobs.
namespace rmlcell::cli {

// One connection of a watch: what it tells, and how it ends.
struct Watched {
  std::vector<v1::WatchJobResponse> messages;
  grpc::Status end;
};

struct FakeJobs final : v1::JobService::Service {
  grpc::Status SubmitJob(grpc::ServerContext*, const v1::SubmitJobRequest* request,
                         v1::Job* response) override {
    submitted.push_back(*request);
    *response = job;
    if (submitted.size() <= refusals) return refusal;
    return {};
  }
  grpc::Status WatchJob(grpc::ServerContext*, const v1::WatchJobRequest* request,
                        grpc::ServerWriter<v1::WatchJobResponse>* writer) override {
    watches.push_back(*request);
    if (watches.size() > connections.size()) return {grpc::StatusCode::NOT_FOUND, "no more"};
    const Watched& connection = connections[watches.size() - 1];
    for (const v1::WatchJobResponse& message : connection.messages) writer->Write(message);
    return connection.end;
  }
  grpc::Status ListJobs(grpc::ServerContext*, const v1::ListJobsRequest* request,
                        v1::ListJobsResponse* response) override {
    listed = *request;
    *response->add_jobs() = job;
    return refusal;
  }
  grpc::Status GetJob(grpc::ServerContext*, const v1::GetJobRequest* request,
                      v1::Job* response) override {
    asked = request->name();
    *response = job;
    return refusal;
  }
  grpc::Status CancelJob(grpc::ServerContext*, const v1::CancelJobRequest* request,
                         v1::Job* response) override {
    asked = request->name();
    *response = job;
    return refusal;
  }
  grpc::Status HoldJob(grpc::ServerContext*, const v1::HoldJobRequest* request,
                       v1::HaltJobResponse* response) override {
    asked = "hold " + request->name();
    *response->mutable_job() = job;
    return refusal;
  }
  grpc::Status ResumeJob(grpc::ServerContext*, const v1::ResumeJobRequest* request,
                         v1::Job* response) override {
    asked = "resume " + request->name();
    *response = job;
    return refusal;
  }
  grpc::Status MoveJob(grpc::ServerContext*, const v1::MoveJobRequest* request,
                       v1::Job* response) override {
    moved = *request;
    *response = job;
    return refusal;
  }
  grpc::Status GetJobPicture(grpc::ServerContext*, const v1::GetJobPictureRequest* request,
                             v1::GetJobPictureResponse* response) override {
    asked = request->name();
    response->set_content("<svg/>");
    return refusal;
  }
  grpc::Status StreamJobArtifact(
      grpc::ServerContext*, const v1::StreamJobArtifactRequest* request,
      grpc::ServerWriter<v1::StreamJobArtifactResponse>* writer) override {
    asked = request->name() + " " + request->artifact();
    v1::StreamJobArtifactResponse part;
    for (const char* chunk : {"one ", "two"}) {
      part.set_chunk(chunk);
      writer->Write(part);
    }
    return refusal;
  }

  v1::Job job;
  std::vector<v1::SubmitJobRequest> submitted;
  std::size_t refusals = 0;  // how many submissions are refused
  grpc::Status refusal;
  std::vector<v1::WatchJobRequest> watches;
  std::vector<Watched> connections;
  v1::ListJobsRequest listed;
  v1::MoveJobRequest moved;
  std::string asked;
};

inline v1::WatchJobResponse EventOf(std::int64_t sequence, const std::string& text) {
  v1::WatchJobResponse message;
  message.set_sequence(sequence);
  message.mutable_event()->mutable_message()->set_text(text);
  return message;
}
inline v1::WatchJobResponse End(std::int64_t sequence, v1::Outcome::Kind kind,
                                v1::Verdict verdict = v1::VERDICT_GOOD) {
  v1::WatchJobResponse message;
  message.set_sequence(sequence);
  message.mutable_event()->mutable_ended()->set_kind(kind);
  message.mutable_event()->mutable_ended()->set_verdict(verdict);
  return message;
}

class RemoteJobs : public testing::Test {
 protected:
  Told Watch(bool strict = false, std::int64_t after = 0, bool as_json = false) {
    jobs.watches.clear();
    return Hear([&] { return WatchJob(server.remote(as_json), "17", after, strict); });
  }
  // The one request that a submission makes.
  v1::SubmitJobRequest Submitted(const SubmitRequest& wanted) {
    jobs.submitted.clear();
    const Told told = Hear([&] { return SubmitJob(server.remote(), wanted); });
    EXPECT_EQ(told.exit_code, 0) << told.errors;
    EXPECT_THAT(jobs.submitted, testing::SizeIs(1));
    return jobs.submitted.empty() ? v1::SubmitJobRequest() : jobs.submitted[0];
  }
  // What is told before any server is asked.
  std::string Refusal(const SubmitRequest& wanted) {
    jobs.submitted.clear();
    const Told told = Hear([&] { return SubmitJob(server.remote(), wanted); });
    EXPECT_EQ(told.exit_code, 2);
    EXPECT_TRUE(jobs.submitted.empty());
    return told.errors;
  }

  CliFolder folder;
  FakeJobs jobs;
  FakeServer server{folder, {&jobs}};
};

}  // namespace rmlcell::cli
