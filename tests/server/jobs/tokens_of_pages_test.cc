// Where a page goes on: what is no place of a list is refused and does not ask for another one.
#include <gtest/gtest.h>

#include <string>

#include "server/jobs/job_filter.h"

namespace rmlcell::server {
namespace {

bool IsPlace(const std::string& token) {
  const Result<storage::JobPlace> place = ReadJobPlace(token);
  if (!place) {
    EXPECT_EQ(place.error().code, ErrorCode::kCellBadPageToken) << token;
  }
  return static_cast<bool>(place);
}

// Five numbers: job, state, whether it is blocked, priority, place among those of its priority.
TEST(TokensOfPages, HaveFiveNumbers) {
  EXPECT_TRUE(IsPlace("7,0,0,0,-1.5"));
  for (const char* token : {"", "7", "7,0,0,0", "7,0,0,0,", ",0,0,0,1", "7,0,0,0,1,", "7,0,0,0,1,2",
                            "7,0,x,0,1", "7;0;0;0;1", "a"})
    EXPECT_FALSE(IsPlace(token)) << token;
}

// Each within what there is of it, and whole but for the last.
TEST(TokensOfPages, AreWithinWhatThereIs) {
  for (const char* token : {"1,0,0,0,1", "1000000000000000,0,0,0,1", "1,5,0,0,1", "1,0,1,0,1",
                            "1,0,0,100,1", "1,0,0,-100,1"})
    EXPECT_TRUE(IsPlace(token)) << token;
  for (const char* token : {"0,0,0,0,1", "-1,0,0,0,1", "1000000000000001,0,0,0,1", "1.5,0,0,0,1",
                            "1,-1,0,0,1", "1,6,0,0,1", "1,0.5,0,0,1", "1,0,-1,0,1", "1,0,2,0,1",
                            "1,0,0.5,0,1", "1,0,0,1001,1", "1,0,0,-1001,1", "1,0,0,0.5,1"})
    EXPECT_FALSE(IsPlace(token)) << token;
  const storage::JobPlace place = *ReadJobPlace("7,5,1,-3,2.5");
  EXPECT_EQ(place.id, 7);
  EXPECT_EQ(place.state, storage::JobState::kInterrupted);
  EXPECT_TRUE(place.blocked);
  EXPECT_EQ(place.priority, -3);
  EXPECT_EQ(place.place, 2.5);
}

}  // namespace
}  // namespace rmlcell::server
