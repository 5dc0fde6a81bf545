// Numbered, forward-only migrations.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <array>
#include <set>
#include <string>

#include "storage/sqlite/migrations.h"
#include "storage/sqlite/store_files.h"
#include "tests/storage/failing_statements.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage::sqlite {
namespace {

using testing::HasSubstr;

constexpr std::array kThree = {
    Migration{1, "a table", "CREATE TABLE part (name TEXT);"},
    Migration{2, "a column", "ALTER TABLE part ADD COLUMN weight_g REAL;"},
    Migration{3, "filled", "UPDATE part SET weight_g = 1.5 WHERE weight_g IS NULL;"},
};

class SqliteMigrations : public testing::Test {
 protected:
  Database Open() {
    Must(MakePrivateFile(path_));
    return Must(Database::Open(path_, Database::Access::kReadWrite, {}));
  }
  Status MigrateTo(std::size_t number) {
    Database database = Open();
    return Migrate(database, std::span(kThree).first(number), path_, WallTime{});
  }

  const TestDirectory directory_;
  const std::string path_ = directory_.File("cell.db");
};

TEST_F(SqliteMigrations, AreNumberedFrom1WithoutGap) {
  int number = 0;
  for (const Migration& migration : Migrations()) EXPECT_EQ(migration.number, ++number);
  EXPECT_GE(number, 1);
}

TEST_F(SqliteMigrations, NewStoreGetsThemAll) {
  Must(MigrateTo(3));
  EXPECT_EQ(NumberIn(path_, "PRAGMA user_version"), 3);
  EXPECT_EQ(NumberIn(path_, "PRAGMA application_id"), kApplicationId);
  EXPECT_EQ(NumberIn(path_, "SELECT count(*) FROM migration"), 3);
  EXPECT_EQ(TextIn(path_, "SELECT what FROM migration WHERE number = 2"), "a column");
  for (const char* none : {".version-0", ".version-1"})  // nothing to copy
    EXPECT_FALSE(std::filesystem::exists(path_ + none));
}

TEST_F(SqliteMigrations, OldStoreGetsThoseThatItLacks) {
  Must(MigrateTo(1));
  ExecuteIn(path_, "INSERT INTO part (name) VALUES ('bracket')");
  Must(MigrateTo(3));
  EXPECT_EQ(NumberIn(path_, "PRAGMA user_version"), 3);
  EXPECT_EQ(TextIn(path_, "SELECT weight_g FROM part WHERE name = 'bracket'"), "1.5");
  Must(MigrateTo(3));  // and then none, and there is nothing to copy
  EXPECT_FALSE(std::filesystem::exists(path_ + ".version-3"));
  EXPECT_EQ(NumberIn(path_, "SELECT count(*) FROM migration"), 3);
}

// conventions.md, reliability 10: a copy before the upgrade, private as the store.
TEST_F(SqliteMigrations, OldStoreIsCopiedBefore) {
  Must(MigrateTo(1));
  ExecuteIn(path_, "INSERT INTO part (name) VALUES ('bracket')");
  Must(MigrateTo(2));
  const std::string copy = path_ + ".version-1";
  EXPECT_EQ(NumberIn(copy, "PRAGMA user_version"), 1);
  EXPECT_EQ(TextIn(copy, "SELECT name FROM part"), "bracket");
  struct stat facts {};
  ASSERT_EQ(stat(copy.c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777U, 0600U);
}

TEST_F(SqliteMigrations, WithoutItsCopyAnOldStoreStaysOld) {
  Must(MigrateTo(1));
  const std::string copy = path_ + ".version-1";
  std::filesystem::create_directory(copy);
  const Status migrated = MigrateTo(3);
  ASSERT_EQ(CodeOf(migrated), ErrorCode::kCellStoreFailed);
  EXPECT_THAT(migrated.error().detail, HasSubstr("cannot make " + copy));
  EXPECT_EQ(NumberIn(path_, "PRAGMA user_version"), 1);
  std::filesystem::remove(copy);
  Must(MigrateTo(3));
}

TEST_F(SqliteMigrations, NewerStoreIsRefused) {
  Must(MigrateTo(3));
  const Status refused = MigrateTo(2);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellStoreNewer);
  EXPECT_THAT(refused.error().detail, HasSubstr("version 3"));
  EXPECT_THAT(refused.error().detail, HasSubstr("up to 2"));
  EXPECT_EQ(NumberIn(path_, "PRAGMA user_version"), 3);
}

// Each step is a transaction: one that fails leaves the store as the step before made it.
TEST_F(SqliteMigrations, FailedStepChangesNothing) {
  Must(MigrateTo(1));
  constexpr std::array kBroken = {
      kThree[0],
      Migration{2, "broken", "ALTER TABLE part ADD COLUMN good; ALTER TABLE nosuch ADD x;"}};
  {
    Database database = Open();
    EXPECT_EQ(CodeOf(Migrate(database, kBroken, path_, WallTime{})), ErrorCode::kCellStoreFailed);
  }
  EXPECT_EQ(NumberIn(path_, "PRAGMA user_version"), 1);
  EXPECT_EQ(NumberIn(path_, "SELECT count(*) FROM pragma_table_info('part')"), 1);
  Must(MigrateTo(3));
}

// The same whichever of its statements fails: what it does, that it is noted, and its number.
TEST_F(SqliteMigrations, AStepIsDoneWholeOrNotAtAll) {
  failing_statements::Register();
  Must(MigrateTo(2));
  const std::string before = ReadFile(path_);
  std::set<std::string> failures;
  for (int number = 0;; ++number) {
    WriteFile(path_, before);
    Database database = Open();
    failing_statements::Fail(failing_statements::Of::kWriter, number);
    const Status migrated = Migrate(database, kThree, path_, WallTime{});
    const std::string failed = failing_statements::Heal();
    if (failed.empty()) {
      EXPECT_FALSE(CodeOf(migrated));
      EXPECT_EQ(Must(database.Number("PRAGMA user_version")), 3);
      break;
    }
    failures.insert(failed);
    EXPECT_EQ(CodeOf(migrated), ErrorCode::kCellStoreFailed) << failed;
    EXPECT_EQ(Must(database.Number("PRAGMA user_version")), 2) << failed;
    EXPECT_EQ(Must(database.Number("SELECT count(*) FROM migration")), 2) << failed;
    if (migrated) break;
  }
  EXPECT_TRUE(failures.contains("PRAGMA user_version = 3"));
  EXPECT_GE(failures.size(), 5U);
}

TEST_F(SqliteMigrations, DatabaseOfAnotherProgramIsRefused) {
  ExecuteIn(path_, "CREATE TABLE part (name TEXT); PRAGMA user_version = 1");
  const Status refused = MigrateTo(3);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellStoreCorrupt);
  EXPECT_THAT(refused.error().detail, HasSubstr("another program"));
  EXPECT_EQ(NumberIn(path_, "SELECT count(*) FROM sqlite_master"), 1);
}

// A file is either empty or known as ours: one that another program has marked is not empty, though
// it has no table, and one with our mark has a version.
TEST_F(SqliteMigrations, AMarkAloneMakesNoStore) {
  const std::string marks[] = {"PRAGMA application_id = 7", "PRAGMA user_version = 2",
                               "PRAGMA application_id = " + std::to_string(kApplicationId)};
  for (const std::string& mark : marks) {
    const std::string path = directory_.File(mark);
    ExecuteIn(path, mark);
    Database database = Must(Database::Open(path, Database::Access::kReadWrite, {}));
    const Result<int> refused = StoreNumber(database, kThree);
    ASSERT_EQ(CodeOf(refused), ErrorCode::kCellStoreCorrupt) << mark;
    EXPECT_EQ(refused.error().detail, "the file is a database of another program") << mark;
  }
}

}  // namespace
}  // namespace rmlcell::storage::sqlite
