#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "storage/records.h"

// Resource names, etags and page sizes of the API (proto/rmlcell/v1). Errors: CellInvalidArgument
// with the form expected. A thing has exactly one name: numbers have no sign and no leading zero.
namespace rmlcell::server {

// 1 to 63 characters: a-z, 0-9, '-', beginning with a letter.
Status CheckResourceId(std::string_view id, std::string_view field);

Result<std::string> ParseMachineName(std::string_view name);  // "machines/optimo-1" -> "optimo-1"
Result<std::string> ParseProjectName(std::string_view name);  // "projects/bracket"
Result<std::int64_t> ParseJobName(std::string_view name);     // "jobs/17"

// "machines/optimo-1/programs/45", an executable by its own number. Whether the machine has such a
// number is its family's to say (records/program_place.h).
struct ProgramName {
  std::string machine;
  std::int64_t number = 0;  // as it stands in the name
  int slot = 0;             // 1..99; 0: the number is neither 1..99 nor 101..199
  bool executable = false;  // named as slot + 100
};
Result<ProgramName> ParseProgramName(std::string_view name);

// "machines/optimo-1/laserSchedules/11". Whether the machine has such a number is its family's to
// say, too.
struct ScheduleName {
  std::string machine;
  std::int64_t number = 0;
};
Result<ScheduleName> ParseScheduleName(std::string_view name);

// Etags are revisions in decimal. Empty: whatever is there. "none": must not exist yet.
// Error: CellEtagMismatch for anything else: it cannot be one of ours.
Result<storage::Revision> ParseEtag(std::string_view etag);

// Titles are for people: at most 200 characters. Error: CellInvalidArgument, naming the field.
Status CheckTitle(std::string_view title, std::string_view field);
// Why a person decided so, for all to read: 1 to 200 characters. Error: CellInvalidArgument.
Status CheckReason(std::string_view reason);

// How many entries a page of a list has: `fallback` where none is asked for, never above `max`.
// Error: CellInvalidArgument below 0.
struct PageSizes {
  int fallback = 0;
  int max = 0;
};
Result<int> PageSize(int asked, PageSizes sizes);

using storage::JobName;
using storage::MachineName;
using storage::NameOfProgram;
using storage::NameOfSchedule;
using storage::ProjectName;

}  // namespace rmlcell::server
