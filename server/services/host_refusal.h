#pragma once

#include <grpcpp/grpcpp.h>

#include "rmlcell/v1/host.pb.h"

namespace rmlcell::server {

// Of an answer with a refusal: the code of the host, and what the machine says of it.
grpc::Status RefusalOf(const v1::HostOrderAnswer& answer);

}  // namespace rmlcell::server
