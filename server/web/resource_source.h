#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "engine/core/result.h"

// What the web port serves at stable URLs, besides calls. The server implements ResourceSource; the
// gateway speaks HTTP. All functions may block; they run on a few threads of the gateway's own,
// several at a time for different requests, never two at once for one reader or sink.
namespace rmlcell::web {

// GET /v1/jobs/{job}/artifacts/{artifact}
struct ArtifactPath {
  std::string job;       // "17"
  std::string artifact;  // "picture.svg"
};

// GET, POST /v1/machines/{machine}/programs/{slot}/content
struct ProgramContentPath {
  std::string machine;  // "optimo-1"
  int slot = 0;         // 1 to 199; 100 is not ruled out here
  std::string form;  // of the query: "source", "object", "executable", "listing"; empty: not said
};

// GET /v1/machines/{machine}/programs/{slot}/picture.svg
struct ProgramPicturePath {
  std::string machine;  // "optimo-1"
  int slot = 0;         // 1 to 199
  int width_px = 0;     // of the query; 0: not said
};

// POST /v1/uploads: bytes for a job, that take no slot
struct UploadsPath {};

using ResourcePath =
    std::variant<ArtifactPath, ProgramContentPath, ProgramPicturePath, UploadsPath>;

// The metadata that a call of this browser would carry: for the same gate that admits calls.
using WebCallerMetadata = std::vector<std::pair<std::string, std::string>>;

// The bytes of a large resource, piece by piece.
class ResourceReader {
 public:
  virtual ~ResourceReader() = default;
  // Up to `bytes_max` bytes; empty: the end. An error breaks the download off visibly.
  virtual Result<std::string> Read(std::size_t bytes_max) = 0;
};

struct Resource {
  std::string media_type;  // "image/svg+xml"
  std::string etag;        // without quotes; normally the SHA-256
  std::string file_name;   // for saving; empty: none is proposed
  std::string bytes;       // when there is neither reader nor `make`
  // Makes `bytes`, which takes seconds of a processor: called on threads of its own, and only where
  // the client does not have what `etag` names.
  std::function<Result<std::string>()> make;
  std::unique_ptr<ResourceReader> reader;
  std::int64_t size = 0;  // of what the reader gives, in bytes
};

struct UploadHeader {
  std::variant<ProgramContentPath, UploadsPath> path;
  std::string file_name;   // of the query; may be empty
  std::string title;       // of the query; may be empty
  std::string etag;        // of the query: as in PutProgramRequest
  std::string sha256;      // of the query, lower-case hexadecimal; empty: not said
  std::int64_t size = -1;  // of the header Content-Length; -1: not known before the end
  bool validate_only = false;
  bool force = false;  // what looks like no program of the machine at all, too
};

// How an upload ended: a good answer, or a status with all that there is to say.
struct UploadEnd {
  std::string message_type;  // "rmlcell.v1.Program", "rmlcell.v1.UploadContentResponse"
  std::string message;       // serialised
  std::string status;        // a serialised google.rpc.Status; empty: good
};

// Takes the bytes of one upload. Destroyed without Finish: nothing of it remains.
class UploadSink {
 public:
  virtual ~UploadSink() = default;
  virtual Status Append(std::string_view chunk) = 0;
  virtual UploadEnd Finish() = 0;
};

class ResourceSource {
 public:
  virtual ~ResourceSource() = default;

  // Errors: those of the catalogue; their RPC code decides the HTTP status (CellNotFound: 404).
  virtual Result<Resource> Find(const ResourcePath& path, const WebCallerMetadata& caller) = 0;

  // Called when the headers are there and before any byte of the body is asked for.
  virtual Result<std::unique_ptr<UploadSink>> BeginUpload(const UploadHeader& header,
                                                          const WebCallerMetadata& caller) = 0;
};

}  // namespace rmlcell::web
