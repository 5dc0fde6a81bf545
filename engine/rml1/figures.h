#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/machine/family.h"
#include "engine/rml1/device.h"
#include "engine/rml1/physical.h"

namespace rmlcell::rml1 {

// Every figure that a run or a check can give, in the order of giving. Names never change meaning.
std::span<const machine::FigureInfo> FigureTable();

// The figures of a device and of what its tool did; those that have nothing to say (an extent of no
// points, a command that did not occur) are left out.
// `starved`: of the look-ahead, where motions were timed. `ended`: the stream was carried out to
// its end; else nothing is said of how it ends.
std::vector<machine::Figure> FiguresOf(const Device& device, const Physical& physical, bool ended,
                                       std::optional<std::uint64_t> starved = {});

// Gives the places of figures their program and line.
void PlaceFigures(std::string_view stream, int program, std::vector<machine::Figure>& figures);

}  // namespace rmlcell::rml1
