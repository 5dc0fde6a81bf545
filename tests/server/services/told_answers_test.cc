// Answers say of what they bring what it is; and what the cell says of itself (cell.proto, Cell).
#include <grpcpp/generic/generic_stub.h>

#include <algorithm>
#include <future>

#include "proto/bridge/sha256.h"
#include "server/base/names.h"
#include "server/services/cell_service.h"
#include "server/web/static_page.h"
#include "tests/server/refusing_store.h"
#include "tests/server/services/unary_calls_bed.h"

namespace rmlcell::server {
namespace {

// How a call ends whose bytes are no message.
grpc::Status EndOfNoRequest(const std::shared_ptr<grpc::Channel>& channel,
                            const std::string& method) {
  grpc::GenericStub raw(channel);
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kPatience);
  const grpc::Slice bytes("\xFF");
  const grpc::ByteBuffer request(&bytes, 1);
  grpc::ByteBuffer response;
  std::promise<grpc::Status> ended;
  raw.UnaryCall(&context, "/rmlcell.v1." + method, grpc::StubOptions(), &request, &response,
                [&ended](const grpc::Status& end) { ended.set_value(end); });
  return ended.get_future().get();
}

class ToldAnswers : public UnaryCalls {
 protected:
  using Programs = v1::ProgramService::Stub;

  static bool Advises(const v1::Findings& findings) {
    return std::ranges::any_of(findings.diagnostics(), [](const v1::Diagnostic& finding) {
      return finding.code() == CodeText(ErrorCode::kPracticeAdvice);
    });
  }
};

// GetProgramContentResponse, DownloadProgramResponse.Header.
TEST_F(ToldAnswers, AContentSaysItsFormItsNameAndItsDigest) {
  const std::string name = "name: 'machines/optimo-1/programs/45' ";
  Call(programs, &Programs::PutProgram,
       name + "program { file_name: 'a.S' content: 'SPEED 20\\n' }");
  ASSERT_TRUE(status.ok()) << status.error_message();
  const auto expect = [&](const std::string& asked, v1::ProgramForm form,
                          const std::string& file_name) {
    const auto got = Call(programs, &Programs::GetProgramContent, name + asked);
    EXPECT_EQ(got.form(), form);
    EXPECT_EQ(got.file_name(), file_name);
    EXPECT_EQ(got.sha256(), bridge::Sha256Hex(got.content()));
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    const auto reader =
        programs->DownloadProgram(&context, FromText<v1::DownloadProgramRequest>(name + asked));
    v1::DownloadProgramResponse first;
    ASSERT_TRUE(reader->Read(&first));
    EXPECT_EQ(first.header().form(), form);
    EXPECT_EQ(first.header().file_name(), file_name);
    EXPECT_EQ(first.header().sha256(), got.sha256());
    for (v1::DownloadProgramResponse rest; reader->Read(&rest);)
      EXPECT_EQ(rest.chunk(), got.content());
    EXPECT_TRUE(reader->Finish().ok());
  };
  expect("form: PROGRAM_FORM_SOURCE", v1::PROGRAM_FORM_SOURCE, "a.S");
  expect("form: PROGRAM_FORM_OBJECT", v1::PROGRAM_FORM_OBJECT, "a.O");
}

TEST_F(ToldAnswers, APictureOfAJobSaysWhatItIs) {
  const std::int64_t job = EndedJob({{.name = "picture.svg", .bytes = "<svg/>"}});
  EXPECT_EQ(
      Call(jobs, &v1::JobService::Stub::GetJobPicture, "name: '" + JobName(job) + "'").media_type(),
      "image/svg+xml");
}

// CheckProgramRequest.errors_only leaves advice out; else there is some, as from CompileProgram.
TEST_F(ToldAnswers, AdviceComesUnlessErrorsAloneAreWanted) {
  // It silences a finding that is not there.
  const std::string program =
      " program { file_name: 'b.S' content: 'SPEED 5 ; rmlcell: allow 7413\\n' }";
  const auto check = [&](const std::string& more) {
    return Call(programs, &Programs::CheckProgram, "machine: 'machines/optimo-1'" + more + program)
        .findings();
  };
  const v1::Findings advised = check("");
  EXPECT_TRUE(Advises(advised)) << status.error_message();
  EXPECT_EQ(advised.file(), "b.S");
  EXPECT_FALSE(Advises(check(" errors_only: true")));
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_TRUE(
      Advises(Call(programs, &Programs::CompileProgram, "family: 'optimo'" + program).findings()));
}

// GetJob gives the bytes that are kept; what comes must be a request all the same.
TEST_F(ToldAnswers, BytesThatAreNoRequestAreRefused) {
  EXPECT_EQ(EndOfNoRequest(channel, "JobService/GetJob").error_code(), grpc::StatusCode::INTERNAL);
}

class ToldCell : public testing::Test {
 protected:
  ToldCell() {
    config_.cell_name = "the hall";
    config_.limit_program_bytes = kMostBytes;
    grpc::ServerBuilder builder;
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    channel = server_->InProcessChannel({});
    stub_ = v1::CellService::NewStub(channel);
  }
  ~ToldCell() override {
    server_->Shutdown(std::chrono::system_clock::now());
    server_->Wait();
    bed.End();
  }
  v1::Cell Get() {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    v1::Cell cell;
    status = stub_->GetCell(&context, {}, &cell);
    return cell;
  }

  static constexpr std::int64_t kMostBytes = 12'345;  // of a program

  DispatcherBed bed;
  RefusingStore store{bed.server.store()};
  grpc::Status status;  // of the newest call
  std::shared_ptr<grpc::Channel> channel;

 private:
  Config config_;
  EventFeed feed_{bed.server.store()};
  Gate gate_{"secret"};
  OpenStreams open_;
  Executor executor_{1};
  JobBook book_{store, config_};
  ProgramBook programs_{store, config_};
  ProjectBook projects_{store};
  JobFactsBook facts_{store};
  SharedLogs logs_{{{store, book_, programs_, projects_}, feed_, facts_, "instance"}};
  WatchRegistry registry_;
  CellService service_{CallNeeds{gate_, executor_, executor_, 8 << 20},
                       CellWatchNeeds{.executor = executor_,
                                      .open = open_,
                                      .records = {store, book_, programs_, projects_},
                                      .feed = feed_,
                                      .logs = logs_,
                                      .facts = facts_,
                                      .registry = registry_,
                                      .instance_id = "instance"},
                       bed.dispatcher(), config_};
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::CellService::Stub> stub_;
};

TEST_F(ToldCell, SaysWhatItIsAndWhatItHasToDo) {
  for (int i = 0; i < 3; ++i) bed.server.SubmitCheck();
  bed.server.Lease();
  const v1::Cell cell = Get();
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_NE(cell.version(), "");
  EXPECT_EQ(cell.instance_id(), "instance");
  EXPECT_EQ(cell.log_id(), store.LogId());
  EXPECT_EQ(cell.title(), "the hall");
  EXPECT_EQ(cell.page_etag(), web::PageEtag());
  EXPECT_EQ(cell.jobs_queued(), 2);
  EXPECT_EQ(cell.jobs_running(), 1);
  store.Refuse("CountJobs");
  Get();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INTERNAL);
  EXPECT_THAT(status.error_message(), testing::HasSubstr("the disk is full"));
}

// What a call takes of a program, what the cell takes at all, and who works for it.
TEST_F(ToldCell, SaysWhatItTakesAndHowManyWork) {
  EXPECT_EQ(Get().workers(), 0);
  const FakeWorker one(bed.dispatcher(), "one");
  const FakeWorker two(bed.dispatcher(), "two");
  const v1::Cell cell = Get();
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(cell.workers(), 2);
  EXPECT_EQ(cell.unary_program_bytes_max(), std::int64_t{3} << 20);
  EXPECT_EQ(cell.program_bytes_max(), kMostBytes);
}

// Nor do they open a watch of everything.
TEST_F(ToldCell, BytesThatAreNoRequestAreWatchedByNobody) {
  EXPECT_EQ(EndOfNoRequest(channel, "CellService/WatchCell").error_code(),
            grpc::StatusCode::INTERNAL);
}

}  // namespace
}  // namespace rmlcell::server
