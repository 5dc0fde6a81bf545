// Where the bytes of what a job made stand: in the row of the artifact, or in a content of its own.
// Decision 0052.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/core/hex.h"
#include "storage/content.h"
#include "storage/sqlite/migrations.h"
#include "storage/sqlite/store_files.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage {
namespace {

using testing::HasSubstr;

class SqliteProducts : public testing::Test {
 protected:
  Store& store() { return bed_.store(); }
  std::int64_t Count(const std::string& from) {
    return NumberIn(bed_.path(), "SELECT count(*) FROM " + from);
  }
  Lease BeginJob(const std::string& program = "program") {
    Must(store().SubmitAndWait(
        {.kind = "CHECK",
         .attachments = {{.name = "program", .media_type = "p", .bytes = program}}}));
    return Must(store().Acquire("w", {"CHECK"}, kLease, {}))->lease;
  }
  std::int64_t RunJob(std::vector<NewArtifact> products) {
    const Lease lease = BeginJob();
    Must(store().Finish(lease, {.artifacts = std::move(products)}));
    return lease.job;
  }
  // As a whole, piece by piece and as the row tells it.
  void ExpectArtifact(std::int64_t job, const std::string& name, const std::string& bytes) {
    EXPECT_TRUE(Must(store().ReadArtifact(job, name)) == bytes) << name;
    const auto reader = Must(store().OpenArtifact(job, name));
    EXPECT_EQ(reader->size(), bytes.size());
    std::string pieces;
    for (std::string piece = Must(reader->Next()); !piece.empty(); piece = Must(reader->Next()))
      pieces += piece;
    EXPECT_TRUE(pieces == bytes) << name;
    const ArtifactRecord told = Must(store().GetArtifact(job, name));
    EXPECT_EQ(told.job, job);
    EXPECT_EQ(told.name, name);
    EXPECT_EQ(told.size, static_cast<std::int64_t>(bytes.size()));
    EXPECT_EQ(told.sha256, HexOf(Sha256(bytes)));
  }

  SqliteBed bed_;
};

// Noise does not shrink. On both sides of the bound.
TEST_F(SqliteProducts, UpToTheBoundStandInTheirRow) {
  const std::string small = Noise(kProductInRowMax, 1);
  const std::string large = Noise(kProductInRowMax + 1, 2);
  const std::int64_t job =
      RunJob({{.name = "report", .media_type = "application/x-protobuf", .bytes = small}});
  EXPECT_EQ(Count("artifact"), 1);  // the program stands with the specification
  EXPECT_EQ(Count("blob"), 0);
  EXPECT_EQ(Must(store().GetArtifact(job, "report")).media_type, "application/x-protobuf");
  const std::int64_t other = RunJob({{.name = "toolpath", .bytes = large}});
  EXPECT_EQ(Count("artifact"), 2);
  EXPECT_EQ(Count("blob"), 1);
  for (int i = 0; i < 2; ++i) {
    ExpectArtifact(job, "report", small);
    ExpectArtifact(other, "toolpath", large);
    bed_.Reopen();
  }
}

// content.h: the row with its names fits on a page. With one of the longest that the server gives.
TEST_F(SqliteProducts, TheirRowsFitOnAPage) {
  RunJob({{.name = "a-name-of-product.svg",
           .media_type = "application/octet-stream",
           .bytes = Noise(kProductInRowMax, 1)}});
  bed_.Reopen();
  const std::string rows = "dbstat WHERE name = 'artifact' AND pagetype = ";
  EXPECT_EQ(Count(rows + "'overflow'"), 0);
  EXPECT_EQ(Count(rows + "'leaf'"), 1);
}

// It counts what is stored, not what was made: a text of letters shrinks to next to nothing.
TEST_F(SqliteProducts, TheStoredBytesCount) {
  const std::string shrinks(kChunkBytes, 'x');
  const std::string too_large(kChunkBytes + 1, 'x');
  const std::int64_t job =
      RunJob({{.name = "shrinks", .bytes = shrinks}, {.name = "too large", .bytes = too_large}});
  EXPECT_EQ(Count("artifact WHERE blob IS NULL"), 1);
  EXPECT_EQ(Count("blob"), 1);  // what is cut into chunks is none for a row
  ExpectArtifact(job, "shrinks", shrinks);
  ExpectArtifact(job, "too large", too_large);
}

TEST_F(SqliteProducts, OneOfNoBytesHasItsRow) {
  const std::int64_t job = RunJob({{.name = "nothing"}});
  EXPECT_EQ(Count("artifact"), 1);
  EXPECT_EQ(Count("blob"), 0);
  ExpectArtifact(job, "nothing", "");
}

// Large ones are shared. A small one stands in the row of the job that made it first; when it comes
// again it is a content, which those have that come then. Each goes with its job, in any order.
TEST_F(SqliteProducts, JobsWithTheSameProducts) {
  const std::string large = Noise(kProductInRowMax + 1, 1);
  const std::vector<NewArtifact> products = {{.name = "report", .bytes = "the same"},
                                             {.name = "toolpath", .bytes = large}};
  const std::int64_t first = RunJob(products);
  EXPECT_EQ(Count("blob"), 1);
  RunJob({{.name = "report", .bytes = "another"}});
  const std::int64_t second = RunJob(products);
  const std::int64_t third = RunJob(products);
  EXPECT_EQ(Count("artifact"), 7);
  EXPECT_EQ(Count("artifact WHERE blob IS NULL"), 2);
  EXPECT_EQ(Count("blob"), 2);
  EXPECT_EQ(NumberIn(bed_.path(), "SELECT refs FROM blob WHERE size = 8"), 2);
  EXPECT_EQ(NumberIn(bed_.path(), "SELECT refs FROM blob WHERE size > 8"), 3);
  Must(store().DeleteJob(first, "anna"));
  EXPECT_EQ(CodeOf(store().ReadArtifact(first, "report")), ErrorCode::kCellNotFound);
  Must(store().DeleteJob(second, "anna"));
  EXPECT_EQ(NumberIn(bed_.path(), "SELECT refs FROM blob WHERE size = 8"), 1);
  ExpectArtifact(third, "report", "the same");
  ExpectArtifact(third, "toolpath", large);
  Must(store().DeleteJob(third, "anna"));
  Must(store().DeleteJob(first + 1, "anna"));
  EXPECT_EQ(Count("artifact"), 0);
  EXPECT_EQ(Count("job_specification"), 0);
  EXPECT_TRUE(Eventually([&] { return Count("blob") == 0 && Count("blob_chunk") == 0; }));
}

// All are told of by name, wherever they stand, and a name is taken once.
TEST_F(SqliteProducts, NamesAreThoseOfOneJob) {
  const Lease lease = BeginJob("M30");
  const auto refused = store().Finish(lease, {.artifacts = {{.name = "program", .bytes = "x"}}});
  ASSERT_EQ(CodeOf(refused), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(refused.error().detail, "two artifacts named program");
  Must(store().Finish(lease, {.artifacts = {{.name = "z", .bytes = "last"},
                                            {.name = "a", .bytes = Noise(9'000, 1)}}}));
  const auto twice = store().AddProducts(lease.job, {.artifacts = {{.name = "z", .bytes = "x"}}});
  ASSERT_EQ(CodeOf(twice), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(twice.error().detail, "two artifacts named z");
  RunJob({{.name = "z", .bytes = "of another job"}});
  Must(store().AddProducts(lease.job, {.artifacts = {{.name = "late", .bytes = "later"}}}));
  std::vector<std::string> names;
  for (const ArtifactRecord& artifact : Must(store().ListArtifacts(lease.job))) {
    EXPECT_EQ(artifact.job, lease.job);
    names.push_back(artifact.name);
  }
  EXPECT_THAT(names, testing::ElementsAre("a", "late", "program", "z"));
  ExpectArtifact(lease.job, "a", Noise(9'000, 1));
  ExpectArtifact(lease.job, "late", "later");
  ExpectArtifact(lease.job, "program", "M30");
  ExpectArtifact(lease.job, "z", "last");
  EXPECT_EQ(Must(store().GetArtifact(lease.job, "program")).media_type, "p");
}

// A content that is there already is named, of whatever size: nothing is read to keep it elsewhere.
TEST_F(SqliteProducts, OneThatNamesAContentSharesIt) {
  Must(store().PutMachine({.id = "m"}, 0));
  Must(store().PutPrograms("m", {{.slot = 1, .object = "in a slot"}}, {}));
  const std::int64_t job =
      RunJob({{.name = "object", .existing_sha256 = HexOf(Sha256("in a slot"))}});
  EXPECT_EQ(NumberIn(bed_.path(), "SELECT refs FROM blob"), 2);
  ExpectArtifact(job, "object", "in a slot");
}

// 9104: other bytes, a part of them, none, or a size that none can have.
TEST_F(SqliteProducts, DamageIsTold) {
  const std::int64_t job = RunJob({{.name = "report", .bytes = "the report"}});
  bed_.LeaveUnchecked();
  for (const char* damage : {"content = x'6162'", "content = x'61626364656667686970'",
                             "content = NULL", "size = -1", "size = 1 << 40"}) {
    bed_.Close();
    ExecuteIn(bed_.path(),
              "DROP TABLE IF EXISTS kept; CREATE TABLE kept AS SELECT * FROM artifact;"
              "UPDATE artifact SET " +
                  std::string(damage));
    bed_.Reopen();
    const auto read = store().ReadArtifact(job, "report");
    ASSERT_EQ(CodeOf(read), ErrorCode::kCellStoreCorrupt) << damage;
    EXPECT_THAT(read.error().detail, HasSubstr("report of job 1 are damaged"));
    EXPECT_EQ(CodeOf(store().OpenArtifact(job, "report")), ErrorCode::kCellStoreCorrupt);
    bed_.Close();
    ExecuteIn(bed_.path(), "DELETE FROM artifact; INSERT INTO artifact SELECT * FROM kept");
    bed_.Reopen();
    ExpectArtifact(job, "report", "the report");
  }
}

std::string Literal(std::string_view bytes) { return "x'" + HexOf(bytes) + "'"; }

// A store as version 14 wrote it: each product has a content, however small, and the program of a
// job a row without one.
class VersionFourteen {
 public:
  VersionFourteen() {
    Must(sqlite::MakePrivateFile(path_));
    sqlite::Database database =
        Must(sqlite::Database::Open(path_, sqlite::Database::Access::kReadWrite, {}));
    Must(sqlite::Migrate(database, sqlite::Migrations().first(14), path_, WallTime{}));
    for (const char* job : {"1", "2"}) AddJob(database, job);
    for (const std::string& report : {small_, large_}) {
      const std::string chunk = report.size() > kContentInRowMax ? "NULL" : Literal(report);
      Must(database.Execute("INSERT INTO blob (sha256, size, refs, holds, content) VALUES (" +
                            Literal(Sha256(report)) + "," + std::to_string(report.size()) +
                            ", 2, 0," + chunk + ")"));
    }
    Must(database.Execute("INSERT INTO blob_chunk VALUES (2, 0, " + Literal(large_) + ")"));
  }
  const std::string& path() const { return path_; }
  const std::string& small() const { return small_; }
  const std::string& large() const { return large_; }

 private:
  static void AddJob(sqlite::Database& database, const std::string& job) {
    const std::string program = "program " + job;
    Must(database.Execute(
        "INSERT INTO job (id, request_id, request_hash, machine, kind, title, caller, state,"
        " cancel_requested, attempts, attempts_max, attempts_begun, last_sequence,"
        " events_gone_until, created_at, started_at, finished_at) VALUES (" +
        job + ", 'r" + job + "', 'h', 'm', 'CHECK', '', '', 2, 0, 1, 1, 1, 0, 0, 0, 0, " + job +
        "); INSERT INTO job_specification (job, specification, attachment) VALUES (" + job +
        ", 'spec', " + Literal(program) +
        "); INSERT INTO artifact (job, name, media_type, blob, sha256, size) VALUES (" + job +
        ", 'program', 'text/plain', 0, " + Literal(Sha256(program)) + ", 9), (" + job +
        ", 'report', 'r', 1, NULL, 0), (" + job +
        ", 'toolpath', 't', 2, NULL, 0);"
        "UPDATE mark SET value = value + 1 WHERE name = 'finished jobs'"));
  }

  const TestDirectory directory_;
  const std::string path_ = directory_.File("cell.db");
  const std::string small_ = "the report of both";
  const std::string large_ = Noise(5'000, 1);
};

TEST(SqliteProductsOfVersion14, AreReadAndGo) {
  const VersionFourteen old;
  {
    const auto store = Must(OpenSqliteStore({.path = old.path()}));
    for (const std::int64_t job : {1, 2}) {
      const auto artifacts = Must(store->ListArtifacts(job));
      ASSERT_EQ(artifacts.size(), 3U);
      EXPECT_EQ(artifacts[0].name, "program");
      EXPECT_EQ(artifacts[0].media_type, "text/plain");
      EXPECT_EQ(artifacts[0].size, 9);
      EXPECT_EQ(artifacts[1].name, "report");
      EXPECT_EQ(artifacts[2].sha256, HexOf(Sha256(old.large())));
      EXPECT_EQ(Must(store->ReadArtifact(job, "program")), "program " + std::to_string(job));
      EXPECT_EQ(Must(store->ReadArtifact(job, "report")), old.small());
      EXPECT_TRUE(Must(store->ReadArtifact(job, "toolpath")) == old.large());
      EXPECT_EQ(Must(Must(store->OpenArtifact(job, "toolpath"))->Next()), old.large());
      EXPECT_EQ(Must(store->GetJob(job)).specification, "spec");
    }
    // Products that come now go by the rule of now, beside those that were there.
    Must(store->AddProducts(1, {.artifacts = {{.name = "late", .bytes = old.small()}}}));
    EXPECT_EQ(NumberIn(old.path(), "SELECT count(*) FROM blob"), 2);
    EXPECT_EQ(NumberIn(old.path(), "SELECT count(*) FROM artifact"), 5);
    EXPECT_EQ(CodeOf(store->AddProducts(1, {.artifacts = {{.name = "program", .bytes = "x"}}})),
              ErrorCode::kCellInvalidArgument);
    Must(store->DeleteJob(1, "anna"));
    EXPECT_EQ(Must(store->ReadArtifact(2, "report")), old.small());
  }
  ExpectSound(old.path());
  {
    const auto store = Must(OpenSqliteStore({.path = old.path()}));
    Must(store->DeleteJob(2, "anna"));
    EXPECT_TRUE(Eventually(
        [&] { return NumberIn(old.path(), "SELECT count(*) FROM blob, blob_chunk") == 0; }));
    EXPECT_EQ(NumberIn(old.path(), "SELECT count(*) FROM artifact"), 0);
    EXPECT_EQ(NumberIn(old.path(), "SELECT count(*) FROM job_specification"), 0);
  }
  ExpectSound(old.path());
}

}  // namespace
}  // namespace rmlcell::storage
