#include "proto/bridge/series.h"

#include <string>

#include "engine/simulation/picture/plot.h"
#include "rmlcell/v1/job.pb.h"

namespace rmlcell::bridge {
namespace {

constexpr std::string_view kAxes = "XYZAB";  // as a plot keeps them

void AddColumn(const simulation::TimeEnvelope& values, std::size_t series,
               const std::string& signal, std::string_view unit, v1::SeriesTable& table) {
  v1::SeriesTable::Column& column = *table.add_columns();
  column.set_signal(signal);
  column.set_unit(std::string(unit));
  for (const simulation::TimeEnvelope::Bucket& bucket : values.buckets()) {
    const simulation::TimeEnvelope::Range& range = bucket.ranges[series];
    column.add_low(static_cast<float>(range.low));
    column.add_high(static_cast<float>(range.high));
    column.add_last(static_cast<float>(range.last));
  }
}

}  // namespace

v1::SeriesTable SeriesOf(const machine::FamilyInfo& family, const simulation::TimeEnvelope& values,
                         SimTime end) {
  using simulation::PlotSeries;
  v1::SeriesTable table;
  table.set_part_ns(values.width().count());
  table.set_end_ns(end.count());
  for (const simulation::TimeEnvelope::Bucket& bucket : values.buckets())
    table.add_parts(static_cast<std::int64_t>(bucket.number));
  AddColumn(values, PlotSeries::kSpeed, "speed", "mm/s", table);
  AddColumn(values, PlotSeries::kFeed, "feed", "mm/s", table);
  if (family.schedules > 0) AddColumn(values, PlotSeries::kPower, "power", "%", table);
  for (const char axis : kAxes) {
    if (family.axes.find(axis) == std::string_view::npos) continue;
    const bool turns = axis == 'A' || axis == 'B';
    AddColumn(values, PlotSeries::kFirstAxis + kAxes.find(axis), std::string("axis.") + axis,
              turns ? "rad" : "mm", table);
  }
  return table;
}

}  // namespace rmlcell::bridge
