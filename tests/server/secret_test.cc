#include "server/base/secret.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

namespace rmlcell::server {
namespace {

TEST(Secret, IsKnownToWhoGivesTheWholeOfIt) {
  EXPECT_TRUE(KnowsSecret("s3cret", "s3cret"));
  for (const std::string wrong : {"", "s", "s3cre", "s3creT", "S3cret", "s3cret ", "x3cret"})
    EXPECT_FALSE(KnowsSecret(wrong, "s3cret")) << wrong;
  using namespace std::string_view_literals;
  EXPECT_FALSE(KnowsSecret("a\0b"sv, "a\0c"sv));
  EXPECT_TRUE(KnowsSecret("a\0b"sv, "a\0b"sv));
}

TEST(Secret, AnEmptyOneIsKnownToNobody) {
  EXPECT_FALSE(KnowsSecret("", ""));
  EXPECT_FALSE(KnowsSecret("x", ""));
}

// An operator == ends at the first character that is wrong, and its time tells how many were right.
TEST(Secret, NoSourceComparesOneByItself) {
  for (const std::string name : {"server/auth/caller.cc", "server/jobs/dispatcher.cc"}) {
    std::ifstream file(std::string(RMLCELL_SOURCE_DIR) + "/" + name);
    std::stringstream text;
    text << file.rdbuf();
    ASSERT_NE(text.str().find("KnowsSecret("), std::string::npos) << name;
    for (const std::string compared : {"== web_secret_", "web_secret_ ==", "!= join_token_",
                                       "== join_token_", "join_token_ ==", "join_token_ !="})
      EXPECT_EQ(text.str().find(compared), std::string::npos) << name << ": " << compared;
  }
}

}  // namespace
}  // namespace rmlcell::server
