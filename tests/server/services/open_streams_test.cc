#include <gtest/gtest.h>

#include "server/services/pull_stream.h"

namespace rmlcell::server {
namespace {

class StoppedStream final : public OpenStreams::Stream {
 public:
  void ServerStops() override { ++stops; }
  void RightsChanged() override { ++asked; }
  int stops = 0;
  int asked = 0;
};

TEST(OpenStreams, AStopIsToldToThoseThatAreOpen) {
  OpenStreams open;
  StoppedStream first, second, gone;
  for (StoppedStream* stream : {&first, &second, &gone}) open.Add(stream);
  EXPECT_EQ(open.count(), 3U);
  open.Remove(&gone);
  EXPECT_EQ(open.count(), 2U);
  EXPECT_EQ(first.stops, 0);
  open.StopAll();
  EXPECT_EQ(first.stops, 1);
  EXPECT_EQ(second.stops, 1);
  EXPECT_EQ(gone.stops, 0);
  EXPECT_EQ(open.count(), 2U);  // they go when they have said their last word
}

TEST(OpenStreams, AChangeOfRightsIsToldToThoseThatAreOpen) {
  OpenStreams open;
  StoppedStream first, gone;
  for (StoppedStream* stream : {&first, &gone}) open.Add(stream);
  open.Remove(&gone);
  open.AskAgain();
  EXPECT_EQ(first.asked, 1);
  EXPECT_EQ(gone.asked, 0);
}

// Between the stop and the end of the server a call may still begin.
TEST(OpenStreams, OneThatIsOpenedLaterIsStoppedAtOnce) {
  OpenStreams open;
  open.StopAll();
  StoppedStream late;
  open.Add(&late);
  EXPECT_EQ(late.stops, 1);
  EXPECT_EQ(open.count(), 1U);
  open.Remove(&late);
  EXPECT_EQ(open.count(), 0U);
  open.Remove(&late);  // twice is not too often
  EXPECT_EQ(open.count(), 0U);
}

}  // namespace
}  // namespace rmlcell::server
