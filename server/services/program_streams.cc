#include "server/services/program_streams.h"

#include <chrono>

#include "server/programs/content_upload.h"
#include "server/programs/program_book.h"
#include "server/programs/program_views.h"
#include "server/services/frames_stream.h"
#include "server/services/program_upload.h"

namespace rmlcell::server {
namespace {

// A program that comes in chunks: stored when all are there and the digest is right.
class Upload final : public grpc::ServerReadReactor<v1::UploadProgramRequest> {
 public:
  Upload(const CallNeeds& needs, ProgramBook& programs, Caller caller, v1::Program* response)
      : needs_(needs),
        programs_(programs),
        caller_(std::move(caller)),
        response_(response),
        upload_([&programs](std::int64_t bytes) { return programs.CheckSize(bytes); }) {
    StartRead(&message_);
  }

 private:
  void OnReadDone(bool ok) override {
    if (const Status good = ok ? upload_.Add(message_) : upload_.End(); !good)
      return End(ToGrpcStatus(good.error()));
    if (ok) {
      StartRead(&message_);
    } else {
      needs_.compute.Post([this] {
        EndWhereThrown(
            kMethod, [this] { Store(); }, [this](const auto& status) { End(status); });
      });
    }
  }

  void Store() {
    const v1::UploadProgramRequest::Header& header = upload_.header();
    const ProgramResult<v1::Program> stored =
        programs_.Store({.name = header.name(),
                         .file_name = header.file_name(),
                         .form = header.form(),
                         .title = header.title(),
                         .etag = header.etag(),
                         .bytes = upload_.TakeBytes(),
                         .validate_only = header.validate_only(),
                         .force = header.force(),
                         .caller = caller_.identity});
    if (stored) *response_ = *stored.value;
    End(stored ? grpc::Status::OK : ToGrpcStatus(stored.error));
  }

  void End(const grpc::Status& status) {
    LogCall(kMethod, caller_, status, std::chrono::steady_clock::now() - begin_);
    Finish(status);
  }

  void OnDone() override { delete this; }

  static constexpr std::string_view kMethod = "ProgramService/UploadProgram";
  CallNeeds needs_;
  ProgramBook& programs_;
  Caller caller_;
  v1::Program* response_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  v1::UploadProgramRequest message_;
  ProgramUpload upload_;
};

// What is sent for SubmitJob: each chunk goes to the store before the next one is read.
class ContentReceiver final : public grpc::ServerReadReactor<v1::UploadContentRequest> {
 public:
  ContentReceiver(const CallNeeds& needs, storage::Store& store, ProgramBook& programs,
                  Caller caller, v1::UploadContentResponse* response)
      : needs_(needs), caller_(std::move(caller)), response_(response) {
    upload_.emplace(store, programs);
    StartRead(&message_);
  }

 private:
  void OnReadDone(bool ok) override {
    needs_.executor.Post([this, ok] {
      EndWhereThrown(
          kMethod, [&] { Take(ok); }, [this](const auto& status) { End(status); });
    });
  }

  void Take(bool ok) {
    if (!ok) {
      Result<v1::UploadContentResponse> made = upload_->End();
      if (!made) return End(ToGrpcStatus(made.error()));
      *response_ = *std::move(made);
      return End(grpc::Status::OK);
    }
    if (const Status good = Add(message_); !good) return End(ToGrpcStatus(good.error()));
    StartRead(&message_);
  }

  Status Add(const v1::UploadContentRequest& message) {
    if (!message.has_header()) return upload_->Add(message.chunk());
    const v1::UploadContentRequest::Header& header = message.header();
    if (header.size() < 1) return InvalidArgument("header.size is missing");
    if (header.sha256().empty()) return InvalidArgument("header.sha256 is missing");
    return upload_->Begin(header.size(), header.sha256());
  }

  void End(const grpc::Status& status) {
    upload_.reset();  // what it holds in the store is let go here, not on a thread of gRPC
    LogCall(kMethod, caller_, status, std::chrono::steady_clock::now() - begin_);
    Finish(status);
  }

  void OnDone() override { delete this; }

  static constexpr std::string_view kMethod = "ProgramService/UploadContent";
  CallNeeds needs_;
  Caller caller_;
  v1::UploadContentResponse* response_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  v1::UploadContentRequest message_;
  std::optional<ContentUpload> upload_;
};

class ProgramToolpath final : public FramesStream<v1::StreamProgramToolpathResponse> {
 public:
  ProgramToolpath(Executor& compute, OpenStreams& open, ProgramBook& programs,
                  const v1::StreamProgramToolpathRequest& request)
      : FramesStream(compute, open), views_(programs), request_(request) {}

 private:
  Result<std::string> Read() override {
    Result<ProgramViews::Toolpath> path = views_.Path(request_);
    if (!path) return path.error();
    header_ = std::move(path->header);
    return std::move(path->frames);
  }

  bool AddHeader(std::string_view, v1::StreamProgramToolpathResponse& message) override {
    *message.mutable_header() = std::move(header_);
    return true;
  }

  bool Add(std::string_view frame, v1::StreamProgramToolpathResponse& message) override {
    message.set_block(std::string(frame));
    return false;
  }

  ProgramViews views_;
  const v1::StreamProgramToolpathRequest request_;
  v1::ToolpathHeader header_;
};

class Download final : public PullStream<v1::DownloadProgramResponse> {
 public:
  Download(Executor& executor, OpenStreams& open, ProgramBook& programs,
           const v1::DownloadProgramRequest& request)
      : PullStream(executor, open), programs_(programs), request_(request) {}

 private:
  Next Make(v1::DownloadProgramResponse& message, grpc::Status& status) override {
    if (!begun_) {
      begun_ = true;
      Result<ProgramBook::Content> content = programs_.Read(request_.name(), request_.form());
      if (!content) {
        status = ToGrpcStatus(content.error());
        return Next::kEnd;
      }
      content_ = std::move(*content);
      message.mutable_header()->set_size(static_cast<std::int64_t>(content_.bytes.size()));
      message.mutable_header()->set_sha256(content_.sha256);
      message.mutable_header()->set_form(content_.form);
      message.mutable_header()->set_file_name(content_.file_name);
      return Next::kMessage;
    }
    if (sent_ >= content_.bytes.size()) return Next::kEnd;
    message.set_chunk(content_.bytes.substr(sent_, kChunkBytes));
    sent_ += message.chunk().size();
    return Next::kMessage;
  }

  ProgramBook& programs_;
  v1::DownloadProgramRequest request_;
  ProgramBook::Content content_;
  bool begun_ = false;
  std::size_t sent_ = 0;
};

}  // namespace

grpc::ServerReadReactor<v1::UploadProgramRequest>* ReceiveProgram(const CallNeeds& needs,
                                                                  ProgramBook& programs,
                                                                  Caller caller,
                                                                  v1::Program* response) {
  return new Upload(needs, programs, std::move(caller), response);
}

grpc::ServerReadReactor<v1::UploadContentRequest>* ReceiveContent(
    const CallNeeds& needs, storage::Store& store, ProgramBook& programs, Caller caller,
    v1::UploadContentResponse* response) {
  return new ContentReceiver(needs, store, programs, std::move(caller), response);
}

std::shared_ptr<PullStream<v1::DownloadProgramResponse>> MakeDownload(
    const CallNeeds& needs, OpenStreams& open, ProgramBook& programs,
    const v1::DownloadProgramRequest& request) {
  return std::make_shared<Download>(needs.executor, open, programs, request);
}

std::shared_ptr<PullStream<v1::StreamProgramToolpathResponse>> MakeProgramToolpath(
    const CallNeeds& needs, OpenStreams& open, ProgramBook& programs,
    const v1::StreamProgramToolpathRequest& request) {
  return std::make_shared<ProgramToolpath>(needs.compute, open, programs, request);
}

}  // namespace rmlcell::server
