// A request that was carried out is known by its id (live.md 9.01).
#include "server/services/repeated_requests.h"

#include <gtest/gtest.h>

#include <string>

namespace rmlcell::server {
namespace {

// LIVE-9.01: a repeat is the same content under the same id of the same caller; another content is
// refused, and nothing is known of a request that was not carried out or has no id.
TEST(RepeatedRequests, AreKnownByTheirId) {
  RepeatedRequests repeated;
  EXPECT_FALSE(*repeated.IsRepeat("anna", "1", "enable"));
  repeated.Keep("anna", "1", "enable");
  EXPECT_TRUE(*repeated.IsRepeat("anna", "1", "enable"));
  EXPECT_FALSE(*repeated.IsRepeat("berta", "1", "enable"));
  const auto other = repeated.IsRepeat("anna", "1", "disable");
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::kCellRequestIdReused);
  repeated.Keep("anna", "", "enable");
  EXPECT_FALSE(*repeated.IsRepeat("anna", "", "enable"));
}

TEST(RepeatedRequests, TheOldestIsForgotten) {
  RepeatedRequests repeated;
  for (std::size_t i = 0; i <= RepeatedRequests::kKept; ++i)
    repeated.Keep("anna", std::to_string(i), "enable");
  EXPECT_FALSE(*repeated.IsRepeat("anna", "0", "enable"));
  EXPECT_TRUE(*repeated.IsRepeat("anna", "1", "enable"));
}

}  // namespace
}  // namespace rmlcell::server
