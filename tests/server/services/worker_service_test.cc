// The line to a worker as it goes over the wire.
#include "server/services/worker_service.h"

#include <gtest/gtest.h>

#include <future>
#include <map>
#include <string>
#include <vector>

#include "server/base/executor.h"
#include "server/jobs/job_book.h"
#include "tests/server/jobs/dispatcher_bed.h"

namespace rmlcell::server {
namespace {

constexpr std::size_t kPieceOfProgram = 131'072;  // worker.proto: a chunk of a blob

class WorkerLineTest : public testing::Test {
 protected:
  WorkerLineTest() {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    stub_ = v1::WorkerService::NewStub(grpc::CreateChannel("127.0.0.1:" + std::to_string(port),
                                                           grpc::InsecureChannelCredentials()));
    context_.set_deadline(std::chrono::system_clock::now() + kPatience);
  }
  ~WorkerLineTest() override {
    context_.TryCancel();
    server_->Shutdown(std::chrono::system_clock::now());
    server_->Wait();
    bed_.End();
  }

  void SubmitSimulation(const std::string& machine, int slot) {
    v1::SubmitJobRequest request;
    request.mutable_job()->set_kind(v1::JOB_KIND_SIMULATE);
    request.mutable_job()->set_machine(machine);
    request.mutable_job()->set_program(machine + "/programs/" + std::to_string(slot));
    std::promise<bool> submitted;
    book_.Submit(request, "c",
                 [&](const Result<v1::Job>& job) { submitted.set_value(job.has_value()); });
    ASSERT_TRUE(submitted.get_future().get());
  }

  DispatcherBed bed_;
  JobBook book_{bed_.server.store(), bed_.config};
  Gate gate_{"a secret of the web port"};
  Executor executor_{1};
  WorkerService service_{{gate_, executor_, executor_, 1 << 20}, bed_.dispatcher()};
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::WorkerService::Stub> stub_;
  grpc::ClientContext context_;
};

// A large program comes in pieces, and the last one is not empty, whether it is full or not: of one
// piece and a byte, of exactly two, and of two and a byte.
TEST_F(WorkerLineTest, ProgramsComeInPiecesOfWhichNoneIsEmpty) {
  const std::map<int, std::size_t> sizes = {
      {1, kPieceOfProgram + 1}, {2, 2 * kPieceOfProgram}, {3, 2 * kPieceOfProgram + 1}};
  for (const auto& [slot, size] : sizes) {
    Must(bed_.server.store().PutPrograms(
        "optimo-1",
        {{.slot = slot, .name = "p", .object = std::string(size, static_cast<char>('a' + slot))}},
        {}));
  }
  SubmitSimulation("machines/optimo-1", 1);
  const auto stream = stub_->Work(&context_);
  v1::WorkRequest hello;
  *hello.mutable_hello() = Hello("w");
  ASSERT_TRUE(stream->Write(hello));
  std::map<int, std::vector<std::size_t>> pieces;
  std::map<int, std::string> programs;
  v1::WorkResponse message;
  while (programs[3].size() < sizes.at(3) && stream->Read(&message)) {
    if (!message.has_blob()) continue;
    pieces[message.blob().slot()].push_back(message.blob().chunk().size());
    programs[message.blob().slot()] += message.blob().chunk();
  }
  EXPECT_EQ(pieces[1], (std::vector<std::size_t>{kPieceOfProgram, 1}));
  EXPECT_EQ(pieces[2], (std::vector<std::size_t>{kPieceOfProgram, kPieceOfProgram}));
  EXPECT_EQ(pieces[3], (std::vector<std::size_t>{kPieceOfProgram, kPieceOfProgram, 1}));
  for (const auto& [slot, size] : sizes)
    EXPECT_EQ(programs[slot], std::string(size, static_cast<char>('a' + slot))) << slot;
}

TEST_F(WorkerLineTest, AWorkerSaysHelloFirst) {
  const auto refused = [&](const v1::WorkRequest& first) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    const auto stream = stub_->Work(&context);
    stream->Write(first);
    v1::WorkResponse nothing;
    EXPECT_FALSE(stream->Read(&nothing));
    return stream->Finish();
  };
  v1::WorkRequest request;
  request.mutable_heartbeat();
  const grpc::Status dumb = refused(request);
  EXPECT_EQ(dumb.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_NE(dumb.error_message().find("the first message must be hello"), std::string::npos);
  *request.mutable_hello() = Hello("w");
  request.mutable_hello()->set_join_token("guessed");
  const grpc::Status guessed = refused(request);
  EXPECT_FALSE(guessed.ok());
  EXPECT_NE(guessed.error_message().find("CELL-E"), std::string::npos) << guessed.error_message();
}

// CELL-E9001: what is thrown for a worker ends its line, and it is told that it was our mistake.
TEST_F(WorkerLineTest, ALineForWhichSomethingIsThrownEnds) {
  bed_.server.SubmitCheck();
  v1::WorkRequest hello;
  *hello.mutable_hello() = Hello("w");
  const auto stream = stub_->Work(&context_);
  ASSERT_TRUE(stream->Write(hello));
  v1::WorkResponse told;
  while (stream->Read(&told) && !told.has_assignment()) continue;
  ASSERT_TRUE(told.has_assignment());
  bed_.hooks.finishes_that_throw = 1;
  v1::WorkRequest finish;
  *finish.mutable_finish()->mutable_lease() = told.assignment().lease();
  finish.mutable_finish()->mutable_outcome()->set_kind(v1::Outcome::KIND_COMPLETED);
  ASSERT_TRUE(stream->Write(finish));
  while (stream->Read(&told)) continue;
  const grpc::Status end = stream->Finish();
  EXPECT_EQ(end.error_code(), grpc::StatusCode::INTERNAL) << end.error_message();
  EXPECT_NE(end.error_message().find("an internal error"), std::string::npos);
}

// A worker whose line ends has left: its job goes to the next one.
TEST_F(WorkerLineTest, AJobOfALineThatEndsGoesToTheNext) {
  bed_.server.SubmitCheck();
  v1::WorkRequest hello;
  *hello.mutable_hello() = Hello("w");
  const auto assigned = [&](grpc::ClientReaderWriter<v1::WorkRequest, v1::WorkResponse>& stream) {
    EXPECT_TRUE(stream.Write(hello));
    v1::WorkResponse message;
    while (stream.Read(&message)) {
      if (message.has_assignment()) return message.assignment().lease().job();
    }
    return std::int64_t{0};
  };
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kPatience);
  const auto first = stub_->Work(&context);
  EXPECT_EQ(assigned(*first), 1);
  first->WritesDone();
  for (v1::WorkResponse rest; first->Read(&rest);) continue;
  EXPECT_TRUE(first->Finish().ok());
  EXPECT_EQ(assigned(*stub_->Work(&context_)), 1);
}

}  // namespace
}  // namespace rmlcell::server
