#pragma once

#include <string>

#include "engine/core/result.h"
#include "rmlcell/v1/program.pb.h"

// The off-line tools on program text that a client sends (optimo.md chapters 6 and 8). Nothing is
// stored. Only the first error of what is not the program's fault is an error of the call; the
// program's own are its findings.
namespace rmlcell::server {

// True for what says that it is an object, or is one by its file name or its bytes.
bool IsObject(const v1::ProgramText& program);

// Errors: CellUnknownFamily for a text of another family, CellEmptyProgram, and those named.
Result<v1::FormatProgramResponse> FormatText(const v1::FormatProgramRequest& request);

// `now`: for the header line when the request has no date. Errors: ConvertDirection (7704) when
// neither the file name nor the target tells the direction.
Result<v1::ConvertProgramResponse> ConvertText(const v1::ConvertProgramRequest& request,
                                               const std::string& now);

Result<v1::CompensateProgramResponse> CompensateText(const v1::CompensateProgramRequest& request,
                                                     const std::string& now);

// Error: CellInvalidArgument for another number of rotations than none or three, or a value that is
// not finite.
Result<v1::TransformProgramResponse> TransformText(const v1::TransformProgramRequest& request);

// Error: as TransformText.
Result<v1::ShiftProgramResponse> ShiftText(const v1::ShiftProgramRequest& request);

// OPT-8.73. Errors: ObjectCorrupt (7034).
Result<v1::MakeListingResponse> ListText(const v1::MakeListingRequest& request);

}  // namespace rmlcell::server
