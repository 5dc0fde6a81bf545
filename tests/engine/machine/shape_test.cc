#include "engine/machine/shape.h"

#include <gtest/gtest.h>

namespace rmlcell::machine {
namespace {

TEST(Box, IsEmptyUntilAPointIsAdded) {
  Box box;
  EXPECT_TRUE(box.empty());
  box.Add(motion::Vec3{1, 2, 3});
  EXPECT_FALSE(box.empty());
  EXPECT_EQ(box.min, (motion::Vec3{1, 2, 3}));
  EXPECT_EQ(box.max, (motion::Vec3{1, 2, 3}));
}

TEST(Box, GrowsInEachDirectionAlone) {
  Box box;
  box.Add(motion::Vec3{0, 0, 0});
  box.Add(motion::Vec3{-1, 5, 0});
  box.Add(motion::Vec3{3, -2, -7});
  box.Add(motion::Vec3{1, 1, -1});  // inside
  EXPECT_EQ(box.min, (motion::Vec3{-1, -2, -7}));
  EXPECT_EQ(box.max, (motion::Vec3{3, 5, 0}));
}

TEST(Box, AnEmptyOneAddsNothing) {
  Box box;
  box.Add(Box());
  EXPECT_TRUE(box.empty());
  EXPECT_EQ(box, Box());
  box.Add(motion::Vec3{1, 1, 1});
  const Box before = box;
  box.Add(Box());
  EXPECT_EQ(box, before);
  Box other;
  other.Add(motion::Vec3{-1, 0, 2});
  box.Add(other);
  EXPECT_EQ(box.min, (motion::Vec3{-1, 0, 1}));
  EXPECT_EQ(box.max, (motion::Vec3{1, 1, 2}));
}

}  // namespace
}  // namespace rmlcell::machine
