#pragma once

#include <memory>

#include "server/web/gateway.h"

namespace rmlcell::web {

// GET and HEAD of a resource, with ETag and If-None-Match. `request` is read in this call only.
std::shared_ptr<Exchange> MakeDownload(const Gateway& gateway, const ResourcePath& path,
                                       const HttpRequest& request, WebCallerMetadata caller,
                                       std::shared_ptr<Connection> connection);

// POST of a program: the body goes piece by piece into the sink, the next one when the sink took
// the last. The answer is the message that the sink gives, as JSON.
std::shared_ptr<Exchange> MakeUpload(const Gateway& gateway, UploadHeader header,
                                     WebCallerMetadata caller,
                                     std::shared_ptr<Connection> connection);

}  // namespace rmlcell::web
