#include "proto/bridge/sha256.h"
#include "tests/server/services/unary_calls_bed.h"

namespace rmlcell::server {
namespace {

// CELL-E9001: a mistake of ours ends the call in which it happens, and no other; what it was stands
// in the log alone.
class ThrownCalls : public UnaryCalls {
 protected:
  // The first call of the store throws, and the call of the client with it; the next one is good.
  template <class MadeCall>
  void ExpectEnded(MadeCall call) {
    store_.throws = true;
    store_.FailAt(1);
    call();
    EXPECT_TRUE(store_.failed());
    ExpectRefused(grpc::StatusCode::INTERNAL, "an internal error");
    EXPECT_THAT(status.error_message(), Not(testing::HasSubstr("a bug")));
    store_.FailAt(0);
    call();
    EXPECT_TRUE(status.ok()) << status.error_message();
  }

  template <class Stub, class Request, class Response>
  void Send(const std::unique_ptr<Stub>& stub,
            std::unique_ptr<grpc::ClientWriter<Request>> (Stub::*method)(grpc::ClientContext*,
                                                                         Response*),
            const std::string& header, const std::string& bytes) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    Response response;
    const auto writer = (stub.get()->*method)(&context, &response);
    writer->Write(FromText<Request>(header));
    Request chunk;
    chunk.set_chunk(bytes);
    writer->Write(chunk);
    writer->WritesDone();
    status = writer->Finish();
  }
};

TEST_F(ThrownCalls, EndWhereBytesAreSent) {
  const std::string sums = "size: 7 sha256: '" + bridge::Sha256Hex("DELAY 1") + "'";
  ExpectEnded([&] {
    Send(programs, &v1::ProgramService::Stub::UploadContent, "header { " + sums + " }", "DELAY 1");
  });
  ExpectEnded([&] {
    Send(programs, &v1::ProgramService::Stub::UploadProgram,
         "header { name: 'machines/optimo-1/programs/4' form: PROGRAM_FORM_SOURCE " + sums + " }",
         "DELAY 1");
  });
  const std::string archive = *WriteProjectArchive(FromText<v1::Project>("title: 'Lid'"));
  ExpectEnded([&] {
    Send(projects, &v1::ProjectService::Stub::ImportProject, "project_id: 'lid'", archive);
  });
}

TEST_F(ThrownCalls, EndWhereBytesAreFetched) {
  PutObject(4, 100);
  ExpectEnded([&] {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    const auto reader = programs->DownloadProgram(
        &context, FromText<v1::DownloadProgramRequest>(
                      "name: 'machines/mill-1/programs/4' form: PROGRAM_FORM_OBJECT"));
    v1::DownloadProgramResponse message;
    while (reader->Read(&message)) {
    }
    status = reader->Finish();
  });
}

TEST_F(ThrownCalls, EndWhereOneAnswerIsAskedFor) {
  Call(projects, &v1::ProjectService::Stub::CreateProject,
       "project_id: 'lid' project { title: 'Lid' }");
  ExpectEnded(
      [&] { Call(projects, &v1::ProjectService::Stub::GetProject, "name: 'projects/lid'"); });
}

}  // namespace
}  // namespace rmlcell::server
