#pragma once

#include "server/auth/caller.h"
#include "server/web/resource_source.h"

namespace rmlcell::storage {
class Store;
}
namespace rmlcell::server {

class JobBook;
class ProgramBook;

// What the web port serves at stable URLs: products of jobs, contents of programs. Callers pass the
// same gate as calls do.
class WebResources final : public web::ResourceSource {
 public:
  WebResources(const Gate& gate, storage::Store& store, JobBook& book, ProgramBook& programs)
      : gate_(gate), store_(store), book_(book), programs_(programs) {}

  Result<web::Resource> Find(const web::ResourcePath& path,
                             const web::WebCallerMetadata& caller) override;
  Result<std::unique_ptr<web::UploadSink>> BeginUpload(
      const web::UploadHeader& header, const web::WebCallerMetadata& caller) override;

 private:
  const Gate& gate_;
  storage::Store& store_;
  JobBook& book_;
  ProgramBook& programs_;
};

}  // namespace rmlcell::server
