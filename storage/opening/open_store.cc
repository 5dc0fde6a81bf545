#include "storage/opening/open_store.h"

#include "storage/sqlite/sqlite_store.h"

namespace rmlcell::storage {
namespace {

constexpr std::string_view kEmbedded = "sqlite:";

}  // namespace

// What stands behind the scheme may be a password.
Status CheckStoreUrl(std::string_view url) {
  if (url.empty()) return {};
  const std::string_view scheme = url.substr(0, url.find(':'));
  if (!url.starts_with(kEmbedded)) {
    return Error{ErrorCode::kCellConfiguration,
                 "store.url: there is no store '" + std::string(scheme.substr(0, 20)) +
                     "'; there is sqlite:/path/of/cell.db",
                 {}};
  }
  if (!url.substr(kEmbedded.size()).starts_with('/')) {
    return Error{
        ErrorCode::kCellConfiguration, "store.url: the path behind sqlite: begins with /", {}};
  }
  return {};
}

Result<std::unique_ptr<Store>> OpenStore(const StoreChoice& choice) {
  if (const Status good = CheckStoreUrl(choice.url); !good) return good.error();
  return OpenSqliteStore({.path = choice.url.empty() ? choice.directory + "/cell.db"
                                                     : choice.url.substr(kEmbedded.size()),
                          .keep_finished_jobs = choice.keep_finished_jobs,
                          .keep_record_events = choice.keep_record_events,
                          .log_bytes_prepared = choice.log_bytes_prepared,
                          .program_memory = choice.program_memory});
}

}  // namespace rmlcell::storage
