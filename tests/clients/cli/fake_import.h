#pragma once

#include <grpcpp/grpcpp.h>

#include <cstddef>
#include <vector>

#include "rmlcell/v1/project.grpc.pb.h"

namespace rmlcell::cli {

// Keeps the sizes of the parts in which an archive comes.
struct FakeImport final : v1::ProjectService::Service {
  grpc::Status ImportProject(grpc::ServerContext*,
                             grpc::ServerReader<v1::ImportProjectRequest>* reader,
                             v1::Project* response) override {
    v1::ImportProjectRequest part;
    while (reader->Read(&part)) {
      if (part.has_chunk()) sizes.push_back(part.chunk().size());
    }
    response->set_name("projects/door");
    return {};
  }
  std::vector<std::size_t> sizes{};
};

}  // namespace rmlcell::cli
