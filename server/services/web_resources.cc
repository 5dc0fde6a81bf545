#include "server/services/web_resources.h"

#include "google/rpc/status.pb.h"
#include "proto/bridge/encoding.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/sha256.h"
#include "rmlcell/v1/report.pb.h"
#include "server/base/names.h"
#include "server/base/readable.h"
#include "server/jobs/job_book.h"
#include "server/programs/content_upload.h"
#include "server/programs/program_book.h"
#include "server/programs/program_views.h"

namespace rmlcell::server {
namespace {

// By the method that does the same.
Result<Caller> Admit(const Gate& gate, const web::WebCallerMetadata& metadata,
                     const std::string& method, std::string resource) {
  CallFacts facts{.method = "/rmlcell.v1." + method,
                  .peer = "web",
                  .transport = Transport::kInProcess,
                  .resource = std::move(resource)};
  for (const auto& [key, value] : metadata) facts.metadata.emplace(key, value);
  return gate.Admit(facts);
}

// The report is kept as a message and shown as JSON, which people and curl read.
Result<std::string> ReportAsJson(const std::string& bytes) {
  v1::RunReport report;
  std::optional<std::string> json;
  if (report.ParseFromString(bytes)) json = bridge::StableJson(report, true);
  if (!json) return Error{ErrorCode::kCellStoreCorrupt, "the report cannot be read", {}};
  return *std::move(json);
}

Result<web::Resource> FindArtifact(JobBook& book, const web::ArtifactPath& path) {
  const Result<std::int64_t> job = ParseJobName("jobs/" + path.job);
  if (!job) return job.error();
  const auto artifact = book.FindArtifact(*job, path.artifact);
  if (!artifact) return artifact.error();
  Result<std::string> bytes = book.ReadArtifact(*job, path.artifact);
  if (!bytes) return bytes.error();
  web::Resource resource{.media_type = artifact->media_type, .etag = artifact->sha256};
  if (path.artifact == "report") {
    Result<std::string> json = ReportAsJson(*bytes);
    if (!json) return json.error();
    resource.media_type = "application/json";
    resource.bytes = std::move(*json);
  } else {
    resource.bytes = std::move(*bytes);
  }
  return resource;
}

// Error: CellInvalidArgument for a word that is none.
Result<v1::ProgramForm> FormOf(const std::string& word) {
  if (word.empty()) return v1::PROGRAM_FORM_UNSPECIFIED;
  if (word == "source") return v1::PROGRAM_FORM_SOURCE;
  if (word == "object") return v1::PROGRAM_FORM_OBJECT;
  if (word == "executable") return v1::PROGRAM_FORM_EXECUTABLE;
  if (word == "listing") return v1::PROGRAM_FORM_LISTING;
  return InvalidArgument("form is '" + Readable(word) +
                         "': use source, object, executable or listing");
}

web::UploadEnd Refused(const google::rpc::Status& status) {
  return {.message_type = {}, .message = {}, .status = status.SerializeAsString()};
}

// Of an upload that takes no slot.
class ContentSink final : public web::UploadSink {
 public:
  explicit ContentSink(ContentUpload upload) : upload_(std::move(upload)) {}

  Status Append(std::string_view chunk) override { return upload_.Add(chunk); }

  web::UploadEnd Finish() override {
    const Result<v1::UploadContentResponse> made = upload_.End();
    if (!made) return Refused(bridge::ToRpcStatus(made.error()));
    return {.message_type = "rmlcell.v1.UploadContentResponse",
            .message = made->SerializeAsString(),
            .status = {}};
  }

 private:
  ContentUpload upload_;
};

// Of a program for a slot.
class Sink final : public web::UploadSink {
 public:
  Sink(ProgramBook& programs, const web::UploadHeader& header, std::string name,
       v1::ProgramForm form, std::string caller)
      : programs_(programs),
        header_(header),
        name_(std::move(name)),
        form_(form),
        caller_(std::move(caller)) {}

  Status Append(std::string_view chunk) override {
    if (const Status fits =
            programs_.CheckSize(static_cast<std::int64_t>(bytes_.size() + chunk.size()));
        !fits)
      return fits.error();
    digest_.Add(chunk);
    bytes_ += chunk;
    return {};
  }

  web::UploadEnd Finish() override {
    if (!header_.sha256.empty() && digest_.Hex() != header_.sha256) {
      return Refused(bridge::ToRpcStatus({ErrorCode::kCellChecksum, "SHA-256 differs", {}}));
    }
    const ProgramResult<v1::Program> stored =
        programs_.Store({.name = name_,
                         .file_name = header_.file_name,
                         .form = form_,
                         .title = header_.title,
                         .etag = header_.etag,
                         .bytes = std::move(bytes_),
                         .validate_only = header_.validate_only,
                         .force = header_.force,
                         .caller = caller_});
    if (!stored) {
      return Refused(
          bridge::ToRpcStatus(stored.error.error, stored.error.diagnostics, stored.error.dropped));
    }
    return {.message_type = "rmlcell.v1.Program",
            .message = stored.value->SerializeAsString(),
            .status = {}};
  }

 private:
  ProgramBook& programs_;
  web::UploadHeader header_;
  std::string name_;
  v1::ProgramForm form_;
  std::string caller_;
  bridge::Sha256 digest_;
  std::string bytes_;
};

}  // namespace

Result<web::Resource> WebResources::Find(const web::ResourcePath& path,
                                         const web::WebCallerMetadata& metadata) {
  if (const auto* artifact = std::get_if<web::ArtifactPath>(&path)) {
    const Result<Caller> caller =
        Admit(gate_, metadata, "JobService/GetJobArtifact", "jobs/" + artifact->job);
    if (!caller) return caller.error();
    return FindArtifact(book_, *artifact);
  }
  if (const auto* picture = std::get_if<web::ProgramPicturePath>(&path)) {
    v1::GetProgramPictureRequest request;
    request.set_name(NameOfProgram(picture->machine, picture->slot));
    request.set_width_px(picture->width_px);
    const Result<Caller> caller =
        Admit(gate_, metadata, "ProgramService/GetProgramPicture", request.name());
    if (!caller) return caller.error();
    Result<ProgramViews::Drawing> drawing = ProgramViews(programs_).Prepare(request);
    if (!drawing) return drawing.error();
    web::Resource drawn{.media_type = std::string(kMediaTypeOfPictures), .etag = drawing->etag};
    drawn.make = [draw = std::move(drawing->draw)]() -> Result<std::string> {
      Result<v1::GetProgramPictureResponse> made = draw();
      if (!made) return made.error();
      return std::move(*made->mutable_content());
    };
    return drawn;
  }
  const auto* content = std::get_if<web::ProgramContentPath>(&path);
  if (content == nullptr) return InvalidArgument("there is nothing to read here");
  const auto& program = *content;
  const std::string name = NameOfProgram(program.machine, program.slot);
  const Result<Caller> caller = Admit(gate_, metadata, "ProgramService/GetProgramContent", name);
  if (!caller) return caller.error();
  const Result<v1::ProgramForm> form = FormOf(program.form);
  if (!form) return form.error();
  Result<ProgramBook::Content> read = programs_.Read(name, *form);
  if (!read) return read.error();
  web::Resource resource{.media_type = read->form == v1::PROGRAM_FORM_SOURCE
                                           ? "text/plain; charset=utf-8"
                                           : "application/octet-stream",
                         .etag = read->sha256,
                         .file_name = read->file_name};
  resource.bytes = std::move(read->bytes);
  return resource;
}

Result<std::unique_ptr<web::UploadSink>> WebResources::BeginUpload(
    const web::UploadHeader& header, const web::WebCallerMetadata& metadata) {
  const auto* path = std::get_if<web::ProgramContentPath>(&header.path);
  if (path == nullptr) {
    const Result<Caller> caller = Admit(gate_, metadata, "ProgramService/UploadContent", {});
    if (!caller) return caller.error();
    ContentUpload upload(store_, programs_);
    if (const Status begun = upload.Begin(header.size, header.sha256); !begun) return begun.error();
    return std::unique_ptr<web::UploadSink>(std::make_unique<ContentSink>(std::move(upload)));
  }
  const std::string name = NameOfProgram(path->machine, path->slot);
  const Result<Caller> caller = Admit(gate_, metadata, "ProgramService/UploadProgram", name);
  if (!caller) return caller.error();
  if (const Status fits = programs_.CheckSize(header.size); !fits) return fits.error();
  const Result<v1::ProgramForm> form = FormOf(path->form);
  if (!form) return form.error();
  return std::unique_ptr<web::UploadSink>(
      std::make_unique<Sink>(programs_, header, name, *form, caller->identity));
}

}  // namespace rmlcell::server
