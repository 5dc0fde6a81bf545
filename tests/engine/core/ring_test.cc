#include "engine/core/ring.h"

#include <gtest/gtest.h>

#include <deque>

namespace rmlcell {
namespace {

// Three in and two out in turn, so that it grows while it is wrapped round: elements keep their
// numbers.
TEST(Ring, ElementsKeepTheirNumbers) {
  Ring<int> ring;
  std::deque<int> model;
  std::uint64_t gone = 0;
  for (int turn = 0; turn < 300; ++turn) {
    for (int n = 0; n < 3; ++n) {
      ring.Push(3 * turn + n);
      model.push_back(3 * turn + n);
    }
    for (int n = 0; n < 2; ++n, ++gone) {
      ring.PopFront();
      model.pop_front();
    }
    ASSERT_EQ(ring.first(), gone);
    ASSERT_EQ(ring.size(), model.size());
    ASSERT_EQ(ring.end(), gone + model.size());
    for (std::size_t i = 0; i < model.size(); ++i) ASSERT_EQ(ring[gone + i], model[i]);
    ASSERT_EQ(ring.front(), model.front());
    ASSERT_EQ(ring.back(), model.back());
  }
}

TEST(Ring, TheNewestGoesToo) {
  Ring<int> ring;
  ring.Push(1);
  ring.Push(2);
  ring.PopBack();
  EXPECT_EQ(ring.back(), 1);
  ring.Push(3);
  EXPECT_EQ(ring[1], 3);
  ring.PopFront();
  ring.PopBack();
  EXPECT_TRUE(ring.empty());
  EXPECT_EQ(ring.first(), 1U);
  ring.Rewind();
  ring.Push(4);
  EXPECT_EQ(ring.first(), 0U);
  EXPECT_EQ(ring[0], 4);
}

// A slot holds what an older element left there: room that it has is used again.
TEST(Ring, SlotsAreUsedAgain) {
  Ring<std::vector<int>> ring;
  ring.PushSlot().assign(100, 7);
  const int* const room = ring.front().data();
  ring.PopFront();
  for (int n = 0; n < 15; ++n, ring.PopFront()) ring.PushSlot();
  EXPECT_EQ(ring.PushSlot().data(), room);  // the first of sixteen comes round
}

}  // namespace
}  // namespace rmlcell
