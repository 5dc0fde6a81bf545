#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <thread>

#include "google/rpc/status.pb.h"
#include "proto/bridge/findings.h"
#include "rmlcell/v1/program.pb.h"
#include "tests/server/web/fake_cell.h"

namespace rmlcell::web::testing {
namespace {

constexpr std::string_view kPicture =
    "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 320 180\">"
    "<rect width=\"320\" height=\"180\" fill=\"#fff\"/>"
    "<path d=\"M40 140V60a20 20 0 0 1 20-20h200a20 20 0 0 1 20 20v80z\" fill=\"none\" "
    "stroke=\"#0b6bcb\" stroke-width=\"2\"/><circle cx=\"100\" cy=\"95\" r=\"22\" fill=\"none\" "
    "stroke=\"#0b6bcb\" stroke-width=\"2\"/><circle cx=\"220\" cy=\"95\" r=\"22\" fill=\"none\" "
    "stroke=\"#0b6bcb\" stroke-width=\"2\"/><path d=\"M40 140L100 117M122 95L198 95\" "
    "stroke=\"#c33\" stroke-dasharray=\"4 3\"/></svg>";

// Byte i of a long download, so that a test can tell any two places apart.
char PatternByte(std::int64_t i) { return static_cast<char>('a' + (i / 7 + i) % 26); }

class PatternReader : public ResourceReader {
 public:
  PatternReader(FakeResources& owner, std::int64_t size, std::int64_t broken_at)
      : owner_(owner), size_(size), broken_at_(broken_at) {}
  Result<std::string> Read(std::size_t bytes_max) override {
    owner_.largest_piece = std::max(owner_.largest_piece.load(), bytes_max);
    std::string out;
    while (at_ < size_ && out.size() < bytes_max) {
      if (at_ == broken_at_) return Error{ErrorCode::kCellStoreCorrupt, "", {}};
      out += PatternByte(at_++);
    }
    return out;
  }

 private:
  FakeResources& owner_;
  std::int64_t size_;
  std::int64_t broken_at_;
  std::int64_t at_ = 0;
};

class Sink : public UploadSink {
 public:
  Sink(FakeResources& owner, UploadHeader header) : owner_(owner), header_(std::move(header)) {
    ++owner_.open_sinks;
  }
  ~Sink() override { --owner_.open_sinks; }

  Status Append(std::string_view chunk) override {
    ++owner_.appended;
    if (header_.file_name == "full.S") return Error{ErrorCode::kCmosFull, "the memory is full", {}};
    if (header_.file_name == "throw.S") throw std::runtime_error("a bug");
    bytes_ += chunk;
    return {};
  }

  UploadEnd Finish() override {
    if (bytes_.empty()) {
      const auto status = bridge::ToRpcStatus({ErrorCode::kCellEmptyProgram, "", {}});
      return {.message_type = {}, .message = {}, .status = status.SerializeAsString()};
    }
    if (std::holds_alternative<UploadsPath>(header_.path)) {
      v1::UploadContentResponse response;
      response.set_size(static_cast<std::int64_t>(bytes_.size()));
      return {.message_type = "rmlcell.v1.UploadContentResponse",
              .message = response.SerializeAsString(),
              .status = {}};
    }
    v1::Program program;
    const auto& path = std::get<ProgramContentPath>(header_.path);
    program.set_name("machines/" + path.machine + "/programs/" + std::to_string(path.slot));
    program.set_file_name(header_.file_name);
    program.set_object_bytes(static_cast<std::int64_t>(bytes_.size()));
    const std::lock_guard lock(owner_.mutex);
    owner_.uploads[path.machine + "/" + std::to_string(path.slot)] = bytes_;
    return {
        .message_type = "rmlcell.v1.Program", .message = program.SerializeAsString(), .status = {}};
  }

 private:
  FakeResources& owner_;
  UploadHeader header_;
  std::string bytes_;
};

}  // namespace

Result<Resource> FakeResources::Find(const ResourcePath& path, const WebCallerMetadata& caller) {
  {
    const std::lock_guard lock(mutex);
    last_caller = caller;
  }
  Resource resource;
  if (const auto* artifact = std::get_if<ArtifactPath>(&path)) {
    if (artifact->artifact == "picture.svg") {
      resource.media_type = "image/svg+xml";
      resource.bytes = std::string(kPicture);
      resource.etag = "picture-1";
      return resource;
    }
    if (artifact->artifact == "report") {
      resource.media_type = "application/json";
      resource.bytes = "{\"family\":\"optimo\"}";
      resource.etag = "report-1";
      return resource;
    }
    if (artifact->artifact == "toolpath" || artifact->artifact == "broken") {
      resource.media_type = "application/octet-stream";
      resource.size = 3'000'001;
      resource.reader = std::make_unique<PatternReader>(
          *this, resource.size, artifact->artifact == "broken" ? 200'000 : -1);
      resource.etag = "toolpath-1";
      return resource;
    }
    if (artifact->artifact == "longer") {  // than it says
      resource.media_type = "application/octet-stream";
      resource.size = 200'000;
      resource.reader = std::make_unique<PatternReader>(*this, 300'000, -1);
      return resource;
    }
    if (artifact->artifact == "throw") throw std::runtime_error("a bug");
    return Error{ErrorCode::kCellNotFound, "no artifact " + artifact->artifact, {}};
  }
  const auto& program = std::get<ProgramContentPath>(path);
  if (program.machine != "optimo-1")
    return Error{ErrorCode::kCellUnknownMachine, program.machine, {}};
  resource.media_type = "text/plain; charset=utf-8";
  resource.bytes = "; " + std::to_string(program.slot) + " " + program.form + "\n";
  resource.etag = "program-" + std::to_string(program.slot);
  resource.file_name = "Träger \"1\".S";
  return resource;
}

Result<std::unique_ptr<UploadSink>> FakeResources::BeginUpload(const UploadHeader& header,
                                                               const WebCallerMetadata& caller) {
  const std::lock_guard lock(mutex);
  last_caller = caller;
  headers.push_back(header);
  const auto* path = std::get_if<ProgramContentPath>(&header.path);
  if (path != nullptr && path->machine != "optimo-1")
    return Error{ErrorCode::kCellUnknownMachine, path->machine, {}};
  return std::unique_ptr<UploadSink>(std::make_unique<Sink>(*this, header));
}

}  // namespace rmlcell::web::testing
