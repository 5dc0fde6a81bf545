#include "engine/rml1/scout.h"

#include <gtest/gtest.h>

#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

// How far it reads before the tool does anything. RML1-9.06
class ScoutTest : public testing::Test {
 protected:
  bool Read(std::string_view stream, std::size_t sent_max, const CommandHalts& halts = {}) {
    machine::Bytes bytes = machine::Bytes::Borrowed(stream);
    return scout_.Read(bytes, halts, sent_max, ahead_);
  }

  const Profile profile_ = MakeProfile(ParametersOf("t1")).value();
  LookAhead ahead_{profile_, {}, 100.0};
  Scout scout_{Device(profile_)};
};

TEST_F(ScoutTest, ReadsNoMoreBytesThanItMay) {
  const std::string settings = "VS1;VS2;VS3;VS4;";
  EXPECT_FALSE(Read(settings, 10));
  EXPECT_EQ(scout_.sent(), 10U);
  EXPECT_FALSE(Read(settings, 11));
  EXPECT_EQ(scout_.sent(), 11U);
  EXPECT_FALSE(Read(settings, 5));  // it has read more already
  EXPECT_EQ(scout_.sent(), 11U);
  EXPECT_TRUE(Read(settings, 100));  // the end of the stream: the tool stands there
  EXPECT_EQ(scout_.sent(), settings.size());
}

TEST_F(ScoutTest, StopsReadingAtAMotion) {
  const std::string stream = "VS1;PU100,0;VS2;";
  EXPECT_TRUE(Read(stream, 100));
  EXPECT_EQ(scout_.sent(), std::string("VS1;PU100,0;").size());
  EXPECT_TRUE(Read(stream, 100));
  EXPECT_EQ(scout_.sent(), stream.size());
}

// RML1-3C.08, RML1-9.35: at a pause the tool must stand, and what the sender hands over meanwhile
// is read motion by motion as well.
TEST_F(ScoutTest, StopsAtEachMotionBehindAPause) {
  const std::string stream = "!NR;PU100,0;PU200,0;";
  EXPECT_TRUE(Read(stream, 100));
  EXPECT_TRUE(Read(stream, 100));
  EXPECT_TRUE(Read(stream, 100));
}

// Where the run halts behind each command the tool must stand behind each: no further is read.
TEST_F(ScoutTest, StopsReadingWhereTheRunHalts) {
  const std::string stream = "VS1;VS2;PU100,0;";
  EXPECT_TRUE(Read(stream, 100, {.after_each = true}));
  EXPECT_EQ(scout_.sent(), std::string("VS1;").size());
  EXPECT_TRUE(Read(stream, 100, {.after_each = true}));
  EXPECT_EQ(scout_.sent(), std::string("VS1;VS2;").size());
}

}  // namespace
}  // namespace rmlcell::rml1
