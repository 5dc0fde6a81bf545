#include "storage/opening/open_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage {
namespace {

using testing::HasSubstr;

// IF-14: the embedded store where the configuration has none, or the file that it names.
TEST(OpenStore, TheEmbeddedOne) {
  const TestDirectory directory;
  ASSERT_TRUE(OpenStore({.directory = directory.File("a")}));
  EXPECT_TRUE(std::filesystem::exists(directory.File("a/cell.db")));
  ASSERT_TRUE(OpenStore({.url = "sqlite:" + directory.File("b.db"), .directory = "/nowhere/else"}));
  EXPECT_TRUE(std::filesystem::exists(directory.File("b.db")));
}

// What stands behind the scheme may be a password: it is not repeated.
TEST(OpenStore, NoOther) {
  for (const std::string url : {"postgresql://rmlcell:secret@a/cell", "cell.db", "sqlite",
                                "SQLITE:/a", "secretsecretsecretsecret"}) {
    const auto opened = OpenStore({.url = url});
    ASSERT_FALSE(opened) << url;
    EXPECT_EQ(opened.error().code, ErrorCode::kCellConfiguration);
    EXPECT_THAT(opened.error().detail, HasSubstr("store.url"));
    EXPECT_THAT(opened.error().detail, testing::Not(HasSubstr("secretsecretsecretsecret")));
    EXPECT_THAT(opened.error().detail, testing::Not(HasSubstr(":secret")));
  }
  EXPECT_THAT(OpenStore({.url = "secretsecretsecretsecret"}).error().detail,
              HasSubstr("there is no store 'secretsecretsecretse'; there is sqlite:"));
  EXPECT_THAT(OpenStore({.url = "sqlite:cell.db"}).error().detail, HasSubstr("begins with /"));
}

// The path of the embedded store begins with /: any other is a wrong configuration.
TEST(OpenStore, APathThatIsNotWhole) {
  for (const std::string url : {"sqlite:", "sqlite:cell.db", "sqlite:./cell.db"})
    EXPECT_EQ(CodeOf(CheckStoreUrl(url)), ErrorCode::kCellConfiguration) << url;
  EXPECT_FALSE(CodeOf(CheckStoreUrl("sqlite:/cell.db")));
  EXPECT_FALSE(CodeOf(CheckStoreUrl("")));
}

}  // namespace
}  // namespace rmlcell::storage
