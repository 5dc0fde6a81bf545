#include "tests/storage/sqlite_bed.h"

#include <sqlite3.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

namespace rmlcell::storage {
namespace {

class Connection {
 public:
  Connection(const std::string& path, int flags) {
    if (sqlite3_open_v2(path.c_str(), &handle_, flags, nullptr) != SQLITE_OK) {
      const std::string message = sqlite3_errmsg(handle_);
      sqlite3_close(handle_);
      throw std::runtime_error(path + ": " + message);
    }
    sqlite3_busy_timeout(handle_, 5'000);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() { sqlite3_close(handle_); }

  // The first column of the first row, as text.
  std::string First(const std::string& sql) {
    std::string first;
    char* message = nullptr;
    const auto take = [](void* into, int, char** values, char**) {
      auto& text = *static_cast<std::string*>(into);
      if (text.empty() && values[0] != nullptr) text = values[0];
      return 0;
    };
    if (sqlite3_exec(handle_, sql.c_str(), take, &first, &message) != SQLITE_OK) {
      const std::string text = message != nullptr ? message : "?";
      sqlite3_free(message);
      throw std::runtime_error(sql + ": " + text);
    }
    return first;
  }

 private:
  sqlite3* handle_ = nullptr;
};

}  // namespace

TestDirectory::TestDirectory() {
  std::string name = (std::filesystem::temp_directory_path() / "rmlcell-storage-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary directory");
  path_ = name;
}

TestDirectory::~TestDirectory() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

SqliteBed::SqliteBed(SqliteOptions options) : options_(std::move(options)) {
  options_.path = directory_.File("cell.db");
  Reopen();
}

SqliteBed::~SqliteBed() {
  Close();
  if (checked_) ExpectSound(path());
}

void SqliteBed::Reopen() {
  store_.reset();
  store_ = Must(Open());
}

Result<std::unique_ptr<Store>> SqliteBed::Open() {
  return OpenSqliteStore(options_, [this] { return clock().Now(); });
}

std::int64_t NumberIn(const std::string& path, const std::string& sql) {
  return std::stoll(TextIn(path, sql));
}

std::string TextIn(const std::string& path, const std::string& sql) {
  return Connection(path, SQLITE_OPEN_READWRITE).First(sql);
}

void ExecuteIn(const std::string& path, const std::string& sql) {
  Connection(path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE).First(sql);
}

std::string ReadFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void WriteFile(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

void ExpectSound(const std::string& path) {
  Connection connection(path, SQLITE_OPEN_READWRITE);
  EXPECT_EQ(connection.First("PRAGMA integrity_check"), "ok");
  const auto expect_none = [&](const std::string& what, const std::string& from) {
    EXPECT_EQ(connection.First("SELECT count(*) FROM " + from), "0") << what;
  };
  expect_none("blobs with a wrong count of references",
              "(SELECT blob.refs AS told,"
              " (SELECT count(*) FROM program WHERE object_blob = blob.id) +"
              " (SELECT count(*) FROM program WHERE source_blob = blob.id) +"
              " (SELECT count(*) FROM program WHERE executable_blob = blob.id) +"
              " (SELECT count(*) FROM project WHERE body_blob = blob.id) +"
              " (SELECT count(*) FROM job_specification WHERE specification_blob = blob.id) +"
              " (SELECT count(*) FROM upload WHERE upload.blob = blob.id) +"
              " (SELECT count(*) FROM artifact WHERE artifact.blob = blob.id) AS found FROM blob)"
              " WHERE told <> found");
  expect_none("artifacts with two places for their bytes, or none",
              "artifact WHERE (blob IS NULL) = (content IS NULL) OR (content IS NULL) <>"
              " (sha256 IS NULL) OR (content IS NULL) <> (size IS NULL)");
  expect_none("programs that are kept with their jobs in part",
              "job_specification WHERE (attachment IS NULL) <> (attachment_name IS NULL) OR"
              " (attachment IS NULL) <> (attachment_media_type IS NULL) OR"
              " (attachment IS NULL) <> (attachment_sha256 IS NULL) OR"
              " (attachment IS NULL) <> (attachment_size IS NULL)");
  expect_none("two artifacts of a job with one name",
              "artifact JOIN job_specification USING (job) WHERE name = attachment_name");
  expect_none("chunks without a blob", "blob_chunk WHERE blob NOT IN (SELECT id FROM blob)");
  for (const char* table :
       {"job_specification", "lease", "attempt", "event", "artifact", "job_after"}) {
    expect_none(std::string(table) + " without a job",
                std::string(table) + " WHERE job <> 0 AND job NOT IN (SELECT id FROM job)");
  }
  expect_none("events of nothing", "event WHERE (job = 0) <> (resource <> '')");
  expect_none("jobs that wait for others and are not in the queue",
              "job_after WHERE job IN (SELECT id FROM job WHERE state <> 0)");
  expect_none("jobs that wait for no reason, or have a reason and do not wait",
              "job WHERE (blocked & 1 <> 0) <> (state = 0 AND held) OR (blocked & 4 <> 0) <>"
              " EXISTS (SELECT 1 FROM job_after WHERE job_after.job = job.id)");
  expect_none("machines whose jobs are counted wrongly",
              "(SELECT machine, count(*) AS found FROM job WHERE state < 2 GROUP BY machine)"
              " AS counted FULL JOIN machine_jobs AS kept USING (machine)"
              " WHERE found IS NOT kept.unfinished");
  expect_none("marks that tell a wrong count",
              "mark WHERE value <> (SELECT count(*) FROM job WHERE state = 0 AND blocked <> 0)"
              " AND name = 'blocked jobs' OR value <> (SELECT count(*) FROM event WHERE job = 0)"
              " AND name = 'record events'");
  expect_none("running jobs without a lease, or leases of others",
              "job WHERE (state = 1) <> (id IN (SELECT job FROM lease))");
  expect_none("jobs with a gap in their events",
              "job WHERE last_sequence - events_gone_until <>"
              " (SELECT count(*) FROM event WHERE event.job = job.id) OR last_sequence <>"
              " ifnull((SELECT max(sequence) FROM event WHERE event.job = job.id),"
              " events_gone_until)");
}

}  // namespace rmlcell::storage
