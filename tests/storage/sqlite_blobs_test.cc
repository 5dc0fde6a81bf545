// Garbage of the table of contents goes in slices.
#include <gtest/gtest.h>

#include "storage/sqlite/blob_table.h"
#include "storage/sqlite/migrations.h"
#include "storage/sqlite/store_files.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage::sqlite {
namespace {

class SqliteBlobs : public testing::Test {
 protected:
  SqliteBlobs() { Must(Migrate(database_, Migrations(), path_, WallTime{})); }

  // A content of `chunks` chunks that nothing names.
  void AddGarbage(int id, int chunks, int refs = 0, int holds = 0) {
    const std::string number = std::to_string(id);
    Must(database_.Execute("INSERT INTO blob (id, sha256, size, refs, holds) VALUES (" + number +
                           ", x'" + (id < 10 ? "0" : "") + number + "', 1, " +
                           std::to_string(refs) + ", " + std::to_string(holds) + ")"));
    for (int k = 0; k < chunks; ++k) {
      Must(database_.Execute("INSERT INTO blob_chunk (blob, number, content) VALUES (" + number +
                             ", " + std::to_string(k) + ", x'00')"));
    }
  }
  std::int64_t Count(const std::string& what) {
    return Must(database_.Number("SELECT count(*) FROM " + what));
  }

  const TestDirectory directory_;
  const std::string path_ = directory_.File("cell.db");
  Database database_ = [this] {
    Must(MakePrivateFile(path_));
    return Must(Database::Open(path_, Database::Access::kReadWrite, {}));
  }();
};

TEST_F(SqliteBlobs, AreSweptAFewAtATime) {
  BlobTable table(database_);
  for (int id = 1; id <= 7; ++id) AddGarbage(id, 0);
  EXPECT_TRUE(Must(table.Sweep(3, 8)));
  EXPECT_EQ(Count("blob"), 4);
  EXPECT_TRUE(Must(table.Sweep(4, 8)));  // it did not look for a fifth
  EXPECT_EQ(Count("blob"), 0);
  EXPECT_FALSE(Must(table.Sweep(3, 8)));
}

TEST_F(SqliteBlobs, LoseAFewChunksAtATime) {
  BlobTable table(database_);
  AddGarbage(1, 10);
  EXPECT_TRUE(Must(table.Sweep(256, 4)));
  EXPECT_EQ(Count("blob_chunk"), 6);
  EXPECT_EQ(Count("blob"), 1);
  EXPECT_EQ(Count("blob WHERE sha256 IS NULL"), 1);  // it is found no more
  EXPECT_TRUE(Must(table.Sweep(256, 4)));
  EXPECT_EQ(Count("blob_chunk"), 2);
  EXPECT_FALSE(Must(table.Sweep(256, 4)));
  EXPECT_EQ(Count("blob_chunk"), 0);
  EXPECT_EQ(Count("blob"), 0);
}

// As many chunks as a slice takes: whether there are more is seen by the next one.
TEST_F(SqliteBlobs, ShareTheChunksOfASlice) {
  BlobTable table(database_);
  AddGarbage(1, 4);
  EXPECT_TRUE(Must(table.Sweep(256, 4)));
  EXPECT_EQ(Count("blob"), 1);
  EXPECT_FALSE(Must(table.Sweep(256, 4)));
  EXPECT_EQ(Count("blob"), 0);

  AddGarbage(2, 3);
  AddGarbage(3, 3);
  EXPECT_TRUE(Must(table.Sweep(256, 4)));
  EXPECT_EQ(Count("blob"), 1);
  EXPECT_EQ(Count("blob_chunk"), 2);
}

TEST_F(SqliteBlobs, StayWhileTheyAreNamedOrHeld) {
  BlobTable table(database_);
  AddGarbage(1, 1, 1, 0);
  AddGarbage(2, 1, 0, 1);
  AddGarbage(3, 1);
  EXPECT_FALSE(Must(table.Sweep(256, 8)));
  EXPECT_EQ(Count("blob"), 2);
  EXPECT_EQ(Count("blob WHERE id = 3"), 0);
  Must(table.ReleaseAll());
  EXPECT_FALSE(Must(table.Sweep(256, 8)));
  EXPECT_EQ(Count("blob"), 1);
  EXPECT_EQ(Count("blob_chunk"), 1);
}

// 9104: what stays though it was removed would be met again and again.
TEST_F(SqliteBlobs, ThatStayAreTold) {
  BlobTable table(database_);
  AddGarbage(1, 0);
  Must(database_.Execute(
      "CREATE TRIGGER keeps BEFORE DELETE ON blob BEGIN SELECT RAISE(IGNORE); END"));
  const Result<bool> swept = table.Sweep(3, 8);
  ASSERT_EQ(CodeOf(swept), ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(swept.error().detail, "blob 1: is not there");
}

}  // namespace
}  // namespace rmlcell::storage::sqlite
