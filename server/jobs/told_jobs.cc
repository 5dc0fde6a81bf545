#include "server/jobs/told_jobs.h"

#include <utility>

namespace rmlcell::server {

std::shared_ptr<const std::string> ToldJobs::Find(std::int64_t id, std::uint64_t changes) const {
  if (changes == 0) return nullptr;  // it is being changed
  const std::lock_guard lock(mutex_);
  const Told& told = told_[static_cast<std::size_t>(id) % kJobsMax];
  return told.id == id && told.changes == changes ? told.job : nullptr;
}

void ToldJobs::Keep(std::int64_t id, std::uint64_t changes, const v1::Job& job) {
  if (changes == 0 || job.ByteSizeLong() > kBytesMax) return;
  Told told{.id = id,
            .changes = changes,
            .job = std::make_shared<const std::string>(job.SerializeAsString())};
  const std::lock_guard lock(mutex_);
  std::swap(told_[static_cast<std::size_t>(id) % kJobsMax], told);
}

}  // namespace rmlcell::server
