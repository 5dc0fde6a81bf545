#pragma once

#include <array>

#include "engine/core/result.h"
#include "engine/machine/bytes.h"
#include "engine/machine/parameters.h"
#include "engine/rml1/offline/byte_sink.h"

// A stream with other numbers; every byte that is not one of them is as it was.
namespace rmlcell::rml1 {

// The same work at another place: absolute coordinates and, for Z, tool heights are shifted by
// whole units. Where the program goes on relatively from where the machine happens to stand
// (power-on, H), the way there is put in with a relative three-axis command. H, IN and !ZM, which
// mean places of the machine, stay. Returns by how much, mm: as far as whole units allow. Whether
// the machine can do all of it tells CheckWork (work_check.h). Errors: as MakeProfile,
// CellEmptyProgram, Rml1NoProgram; CellInvalidArgument for a number that is none; Rml1NotRewritten
// (8111) with its place: a set with an error, a lone period as a number, a number beyond its range;
// for Z also !ZO, tool heights that the program does not give, and those that would come to the
// wrong side of Z0.
Result<std::array<double, 3>> MoveStream(const machine::Bytes& stream,
                                         const machine::Parameters& parameters,
                                         const std::array<double, 3>& by_mm, const ByteSink& sink);

// The same work on a machine with another number of coordinate units in a millimetre: coordinates,
// tool heights, !ZM and !ZO are scaled by to / from and rounded to whole units, of relative ones
// their sum, so that nothing accumulates. Speeds, which are in mm/s, times and angles stay.
// `parameters`: of the machine that the stream is for; only its command set counts.
// Errors: as MoveStream but for Z; CellInvalidArgument for steps outside 1 to 10000.
Status ScaleStream(const machine::Bytes& stream, const machine::Parameters& parameters,
                   double from_units_per_mm, double to_units_per_mm, const ByteSink& sink);

}  // namespace rmlcell::rml1
