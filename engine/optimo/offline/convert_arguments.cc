#include <cctype>

#include "engine/core/letters.h"
#include "engine/optimo/offline/convert.h"

namespace rmlcell::optimo {
namespace {

// Place of the point of the extension; npos when the name has none.
std::size_t ExtensionAt(std::string_view name) {
  const std::size_t point = name.rfind('.');
  const bool of_folder = name.find_first_of("/\\", point) != std::string_view::npos;
  return of_folder ? std::string_view::npos : point;
}
std::string_view ExtensionOf(std::string_view name) {
  const std::size_t at = ExtensionAt(name);
  return at == std::string_view::npos ? std::string_view() : name.substr(at);
}

bool IsSwitch(std::string_view argument) {
  return !argument.empty() && argument[0] == '/' &&
         argument.find('/', 1) == std::string_view::npos &&
         argument.find('.') == std::string_view::npos;
}

bool IsUpper(std::string_view extension) {
  for (const char c : extension) {
    if (std::islower(static_cast<unsigned char>(c)) != 0) return false;
  }
  return extension.size() > 1;
}

Error Refuse(ErrorCode code, Detail detail) { return {code, std::move(detail), {}}; }

}  // namespace

Result<std::optional<ConvertRequest>> ReadConvertArguments(std::span<const std::string> arguments) {
  if (arguments.empty()) return std::optional<ConvertRequest>();
  std::optional<Direction> wanted;
  std::vector<std::string> names;
  for (const std::string& argument : arguments) {
    if (!IsSwitch(argument)) {
      names.push_back(argument);
      continue;
    }
    const std::string letter = LowerCase(argument);
    if (letter != "/i" && letter != "/m")
      return Refuse(ErrorCode::kConvertSwitch, Told("word", argument));
    const Direction direction = letter == "/i" ? Direction::kToInch : Direction::kToMetric;
    if (wanted && *wanted != direction) {
      return Refuse(ErrorCode::kConvertConflict, "/i and /m");
    }
    wanted = direction;
  }
  if (names.empty()) return Refuse(ErrorCode::kConvertTooFew, "no file name");
  if (names.size() > 2) return Refuse(ErrorCode::kConvertTooMany, "more than two file names");

  const std::string extension = LowerCase(ExtensionOf(names[0]));
  std::optional<Direction> by_name;
  if (extension == ".s") by_name = Direction::kToInch;
  if (extension == ".si") by_name = Direction::kToMetric;
  if (extension == ".cmp" && wanted == Direction::kToMetric) {
    return Refuse(ErrorCode::kConvertConflict, Told("file", names[0]) + " is metric");
  }
  if (wanted && by_name && *wanted != *by_name) {
    return Refuse(ErrorCode::kConvertConflict, Told("file", names[0]) + " and its switch");
  }
  if (!wanted && !by_name) {
    return Refuse(ErrorCode::kConvertDirection, Told("file", names[0]) + " is neither .S nor .SI");
  }
  ConvertRequest request;
  request.input = names[0];
  request.direction = wanted ? *wanted : *by_name;
  const bool inch = request.direction == Direction::kToInch;
  const bool upper = IsUpper(ExtensionOf(names[0]));
  const std::string standard = upper ? (inch ? ".SI" : ".S") : (inch ? ".si" : ".s");
  if (names.size() == 1) {
    const std::size_t at = ExtensionAt(names[0]);
    request.output = names[0].substr(0, at) + standard;
  } else {
    request.output = names[1];
    const std::string output_extension = LowerCase(ExtensionOf(names[1]));
    if (output_extension.empty()) request.output += standard;
    if (output_extension == (inch ? ".s" : ".si")) {
      return Refuse(ErrorCode::kConvertConflict,
                    Told("input", names[0]) + " and " + Told("output", names[1]));
    }
    if (inch && output_extension == ".cmp") {  // OPT-8.72
      return Refuse(ErrorCode::kConvertConflict, Told("file", names[1]) + " would not be metric");
    }
  }
  return std::optional<ConvertRequest>(std::move(request));
}

}  // namespace rmlcell::optimo
