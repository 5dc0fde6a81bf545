#include "proto/bridge/series.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rmlcell/v1/job.pb.h"

namespace rmlcell::bridge {
namespace {

using testing::ElementsAre;

std::vector<std::string> Signals(const v1::SeriesTable& table) {
  std::vector<std::string> signals;
  for (const v1::SeriesTable::Column& column : table.columns())
    signals.push_back(column.signal() + " " + column.unit());
  return signals;
}

TEST(SeriesMessage, HasWhatWasAddedInItsParts) {
  simulation::TimeEnvelope values;
  const std::int64_t width = values.width().count();
  values.Add(SimTime(0), {5.0, 6.0, 7.0, 1.0, 2.0, 3.0, 0.25, 0.5});
  values.Add(SimTime(1), {2.0, 6.0, 7.0, 1.0, 2.0, 3.0, 0.25, 0.5});
  values.Add(SimTime(3 * width), {9.0, 0.0, 0.0, 1.5, 2.0, 3.0, 0.25, 0.75});
  const v1::SeriesTable table =
      SeriesOf({.axes = "X Y Z A B", .schedules = 63}, values, SimTime(4 * width));
  EXPECT_EQ(table.part_ns(), width);
  EXPECT_EQ(table.end_ns(), 4 * width);
  EXPECT_THAT(table.parts(), ElementsAre(0, 3));
  EXPECT_THAT(Signals(table), ElementsAre("speed mm/s", "feed mm/s", "power %", "axis.X mm",
                                          "axis.Y mm", "axis.Z mm", "axis.A rad", "axis.B rad"));
  EXPECT_THAT(table.columns(0).low(), ElementsAre(2.0F, 9.0F));
  EXPECT_THAT(table.columns(0).high(), ElementsAre(5.0F, 9.0F));
  EXPECT_THAT(table.columns(0).last(), ElementsAre(2.0F, 9.0F));
  EXPECT_THAT(table.columns(3).last(), ElementsAre(1.0F, 1.5F));
  EXPECT_THAT(table.columns(7).high(), ElementsAre(0.5F, 0.75F));
}

// A mill has no laser, and other axes.
TEST(SeriesMessage, HasWhatTheFamilyHas) {
  const v1::SeriesTable table = SeriesOf({.axes = "X Y Z A"}, {}, SimTime(0));
  EXPECT_THAT(Signals(table), ElementsAre("speed mm/s", "feed mm/s", "axis.X mm", "axis.Y mm",
                                          "axis.Z mm", "axis.A rad"));
  EXPECT_EQ(table.columns(0).low_size(), 0);
}

}  // namespace
}  // namespace rmlcell::bridge
