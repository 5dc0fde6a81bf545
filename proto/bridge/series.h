#pragma once

#include "engine/core/units.h"
#include "engine/machine/family.h"
#include "engine/simulation/picture/time_envelope.h"

namespace rmlcell::v1 {
class SeriesTable;
}

namespace rmlcell::bridge {

// What a plot draws of a run that ends at `end`, on a machine of the family: the series of
// simulation::PlotSeries. Of the axes those that the family has.
v1::SeriesTable SeriesOf(const machine::FamilyInfo& family, const simulation::TimeEnvelope& values,
                         SimTime end);

}  // namespace rmlcell::bridge
