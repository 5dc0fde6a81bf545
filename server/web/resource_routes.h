#pragma once

#include <optional>
#include <string>

#include "server/web/http_message.h"
#include "server/web/resource_source.h"
#include "server/web/rpc_request.h"

// The stable URLs: paths and queries to values. Pure functions.
namespace rmlcell::web {

struct ResourceRoute {
  bool is_resource = false;          // the path has the shape of one
  std::optional<ResourcePath> path;  // nothing: `problem` says why
  std::string problem;
};

// Segments are percent-decoded after the path was split, so that an escaped '/' stays inside its
// segment; segments that are empty, "." or "..", or hold '/', '\' or control characters, are
// problems.
ResourceRoute RouteResource(const HttpRequest& request);

struct UploadRoute {
  UploadHeader header;
  std::optional<RpcRefusal> refusal;
};

// Query: file_name, title, sha256, etag, form, validate_only=true, force=true. A Content-Type is
// needed, and not one that a form of a foreign page can send: application/octet-stream is the right
// one.
UploadRoute RouteUpload(const HttpRequest& request,
                        const std::variant<ProgramContentPath, UploadsPath>& path);

}  // namespace rmlcell::web
