#include "server/base/names.h"

#include <algorithm>

#include "engine/core/characters.h"
#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "server/base/readable.h"

namespace rmlcell::server {
namespace {

constexpr std::uint32_t kTitleMax = 200;

Error Malformed(std::string_view name, std::string_view expected) {
  return {ErrorCode::kCellInvalidArgument,
          "name is '" + Readable(name) + "', expected is " + std::string(expected),
          {}};
}

// The part after "collection/", or nothing.
std::optional<std::string_view> After(std::string_view name, std::string_view collection) {
  if (!name.starts_with(collection)) return std::nullopt;
  return name.substr(collection.size());
}

// A number as this server writes it: each thing has one name, and "jobs/017" is none.
std::optional<std::int64_t> Number(std::string_view text) {
  const auto number = ParseInteger(text);
  if (!number || std::to_string(*number) != text) return std::nullopt;
  return std::int64_t{*number};
}

bool IsId(std::string_view id) {
  if (id.empty() || id.size() > 63 || id.front() < 'a' || id.front() > 'z') return false;
  return std::ranges::all_of(
      id, [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; });
}

}  // namespace

Status CheckResourceId(std::string_view id, std::string_view field) {
  if (IsId(id)) return {};
  return Error{
      ErrorCode::kCellInvalidArgument,
      std::string(field) + ": use 1 to 63 characters a-z, 0-9 and '-', beginning with a letter",
      {}};
}

Result<std::string> ParseMachineName(std::string_view name) {
  const auto id = After(name, "machines/");
  if (!id || !IsId(*id)) return Malformed(name, "machines/ID");
  return std::string(*id);
}

Result<std::string> ParseProjectName(std::string_view name) {
  const auto id = After(name, "projects/");
  if (!id || !IsId(*id)) return Malformed(name, "projects/ID");
  return std::string(*id);
}

Result<std::int64_t> ParseJobName(std::string_view name) {
  const auto id = After(name, "jobs/");
  const auto number = id ? Number(*id) : std::nullopt;
  if (!number || *number <= 0) return Malformed(name, "jobs/NUMBER");
  return *number;
}

Result<ProgramName> ParseProgramName(std::string_view name) {
  constexpr std::string_view kForm = "machines/ID/programs/NUMBER";
  const std::size_t slash = name.find('/', name.find('/') + 1);
  if (slash == std::string_view::npos) return Malformed(name, kForm);
  const Result<std::string> machine = ParseMachineName(name.substr(0, slash));
  const auto rest = After(name.substr(slash), "/programs/");
  const auto number = rest ? Number(*rest) : std::nullopt;
  if (!machine || !number) return Malformed(name, kForm);
  ProgramName made{
      .machine = *machine, .number = *number, .slot = 0, .executable = *number > kExecutableOffset};
  const std::int64_t slot = *number - (made.executable ? kExecutableOffset : 0);
  if (slot >= kSlotMin && slot <= kSlotMax) made.slot = static_cast<int>(slot);
  return made;
}

Result<ScheduleName> ParseScheduleName(std::string_view name) {
  constexpr std::string_view kForm = "machines/ID/laserSchedules/NUMBER";
  const std::size_t slash = name.find('/', name.find('/') + 1);
  if (slash == std::string_view::npos) return Malformed(name, kForm);
  const Result<std::string> machine = ParseMachineName(name.substr(0, slash));
  const auto rest = After(name.substr(slash), "/laserSchedules/");
  const auto number = rest ? Number(*rest) : std::nullopt;
  if (!machine || !number) return Malformed(name, kForm);
  return ScheduleName{*machine, *number};
}

Result<storage::Revision> ParseEtag(std::string_view etag) {
  if (etag.empty()) return storage::kAnyRevision;
  if (etag == "none") return storage::Revision{0};
  const auto revision = Number(etag);
  if (!revision || *revision <= 0)
    return Error{ErrorCode::kCellEtagMismatch, "etag is not one of ours", {}};
  return storage::Revision{*revision};
}

Status CheckTitle(std::string_view title, std::string_view field) {
  if (CharactersIn(title, Encoding::kUtf32) <= kTitleMax) return {};
  return InvalidArgument(std::string(field) + " is longer than " + std::to_string(kTitleMax) +
                         " characters");
}

Status CheckReason(std::string_view reason) {
  constexpr std::uint32_t kReasonMax = 200;
  if (!reason.empty() && CharactersIn(reason, Encoding::kUtf32) <= kReasonMax) return {};
  return InvalidArgument("reason: why, in 1 to 200 characters");
}

Result<int> PageSize(int asked, PageSizes sizes) {
  if (asked < 0) return InvalidArgument("page_size is below 0");
  return asked == 0 ? sizes.fallback : std::min(asked, sizes.max);
}

}  // namespace rmlcell::server
