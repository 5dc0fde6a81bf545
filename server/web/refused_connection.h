#pragma once

#include <string>

#include "server/web/http_message.h"

namespace rmlcell::web {

// What a connection is told that is one too many: 503 with CELL-E9020, and when to try again.
HttpResponse TooManyConnections();

// The same as the bytes of an answer that ends its connection.
std::string TooManyConnectionsText();

}  // namespace rmlcell::web
