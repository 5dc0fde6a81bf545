#include "clients/lsp/project_facts.h"

#include <nlohmann/json.hpp>
#include <vector>

#include "clients/lsp/protocol.h"
#include "engine/core/number_text.h"

namespace rmlcell::lsp {
namespace {

constexpr std::string_view kModePrefix = "LASER_MODE_";  // as JSON names the values of an enum

// The rows of a list of the project of this folder.
std::vector<Json> RowsOf(const ProgramFolder& folder, std::string_view uri, std::string_view list) {
  const std::size_t slash = uri.rfind('/');
  if (slash == std::string_view::npos) return {};
  const Result<std::string> text =
      folder.Read(std::string(uri.substr(0, slash + 1)) + "project.json");
  const auto project = text ? ReadJson(*text) : std::nullopt;
  const Json* rows = project ? Member(*project, {list}) : nullptr;
  if (rows == nullptr || !rows->is_array()) return {};
  return {rows->begin(), rows->end()};
}

std::string NumberText(const Json* number) {
  return number != nullptr && number->is_number() ? ShortestText(number->get<double>()) : "";
}

}  // namespace

std::string ScheduleNote(const ProgramFolder& folder, std::string_view uri, int number) {
  for (const Json& row : RowsOf(folder, uri, "laserSchedules")) {
    if (NumberMember(row, {"number"}) != number) continue;
    std::string note = TextMember(row, {"mode"}).value_or("CW");
    if (note.starts_with(kModePrefix)) note.erase(0, kModePrefix.size());
    const std::string power = NumberText(Member(row, {"powerPercent"}));
    if (!power.empty()) note += ", " + power + " %";
    if (const auto title = TextMember(row, {"title"}); title && !title->empty())
      note += ", " + *title;
    return note;
  }
  return {};
}

std::string ProcessNote(const ProgramFolder& folder, std::string_view uri, int kind, int process) {
  for (const Json& row : RowsOf(folder, uri, "processes")) {
    if (NumberMember(row, {"kind"}).value_or(0) != kind ||
        NumberMember(row, {"process"}).value_or(0) != process) {
      continue;
    }
    std::string note;
    if (const Json* values = Member(row, {"values"}); values != nullptr && values->is_array()) {
      for (const Json& value : *values) note += (note.empty() ? "" : ", ") + NumberText(&value);
    }
    if (const auto text = TextMember(row, {"note"}); text && !text->empty())
      note += (note.empty() ? "" : " ") + ("(" + *text + ")");
    return note;
  }
  return {};
}

}  // namespace rmlcell::lsp
