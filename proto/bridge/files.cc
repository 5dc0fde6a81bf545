#include "proto/bridge/files.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "engine/core/letters.h"
#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "rmlcell/v1/job.pb.h"

namespace rmlcell::bridge {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

Error BadText(const std::string& name, int line, int column, const std::string& what) {
  return {ErrorCode::kCellBadText, name + ":" + std::to_string(line) + ": " + what,
          SourceSpan{.line = line, .column = column}};
}

// ON, OPEN, TRUE, YES are 1; OFF, CLOSED, FALSE, NO are 0; else a number.
std::optional<double> ValueOf(std::string_view text) {
  const std::string word = UpperCase(text);
  if (word == "ON" || word == "OPEN" || word == "TRUE" || word == "YES") return 1.0;
  if (word == "OFF" || word == "CLOSED" || word == "FALSE" || word == "NO") return 0.0;
  return ParseDouble(text);
}

// Fills kind and index from "IL[20]", "START" ...; false: no such thing.
bool SetKind(std::string_view what, v1::ScriptedInput& input) {
  const std::string word = UpperCase(what);
  if (word == "START" || word == "RESUME") {
    input.set_kind(v1::ScriptedInput::KIND_START);
  } else if (word == "HOLD") {
    input.set_kind(v1::ScriptedInput::KIND_HOLD);
  } else if (word == "STOP") {
    input.set_kind(v1::ScriptedInput::KIND_STOP);
  } else if (word == "EMERGENCY") {
    input.set_kind(v1::ScriptedInput::KIND_EMERGENCY_STOP);
  } else if (word == "OVERRIDE") {
    input.set_kind(v1::ScriptedInput::KIND_OVERRIDE);
  } else if (word == "DOOR") {
    input.set_kind(v1::ScriptedInput::KIND_DOOR);
  } else if ((word.starts_with("IL[") || word.starts_with("IA[")) && word.ends_with(']')) {
    const auto index = ParseInteger(std::string_view(word).substr(3, word.size() - 4));
    if (!index || *index < 0 || *index > 99) return false;
    input.set_kind(word[1] == 'L' ? v1::ScriptedInput::KIND_LOGICAL_INPUT
                                  : v1::ScriptedInput::KIND_ANALOGUE_INPUT);
    input.set_index(static_cast<int>(*index));
  } else {
    return false;
  }
  return true;
}

bool NeedsValue(v1::ScriptedInput::Kind kind) {
  return kind == v1::ScriptedInput::KIND_LOGICAL_INPUT ||
         kind == v1::ScriptedInput::KIND_ANALOGUE_INPUT ||
         kind == v1::ScriptedInput::KIND_OVERRIDE || kind == v1::ScriptedInput::KIND_DOOR;
}

}  // namespace

Status ReadParts(const std::string& path, std::int64_t limit,
                 const std::function<void(std::string_view)>& part) {
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rb"));
  if (file == nullptr) return Error{ErrorCode::kCellFileUnreadable, path, {}};
  std::int64_t size = 0;
  char room[1 << 16];
  for (std::size_t n = 0; (n = std::fread(room, 1, sizeof room, file.get())) > 0;) {
    part({room, n});
    size += static_cast<std::int64_t>(n);
    if (size > limit) {
      return Error{ErrorCode::kCellTooLarge,
                   path + " is larger than " + std::to_string(limit) + " bytes",
                   {}};
    }
  }
  if (std::ferror(file.get()) == 0) return {};
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(path, ignored);  // it opens all the same
  return Error{ErrorCode::kCellFileUnreadable, is_folder ? path + " is a directory" : path, {}};
}

Result<std::string> ReadFile(const std::string& path, std::int64_t limit) {
  std::string text;
  const Status read = ReadParts(path, limit, [&](std::string_view part) { text.append(part); });
  if (!read) return read.error();
  return text;
}

namespace {

int LineOf(const toml::node& node) { return static_cast<int>(node.source().begin.line); }

// Numbers and words, as texts.
Status ReadParameters(const toml::table& table, const std::string& name, MachineFile& machine) {
  for (const auto& [parameter, value] : table) {
    const std::string named(parameter);
    if (const auto* word = value.as_string()) {
      machine.parameters[named] = word->get();
    } else if (const auto* integer = value.as_integer()) {
      machine.parameters[named] = std::to_string(integer->get());
    } else if (const auto* number = value.as_floating_point()) {
      machine.parameters[named] = ShortestText(number->get());
    } else {
      return BadText(name, LineOf(value), 0, "parameter " + named + " takes a number or a text");
    }
  }
  return {};
}

// Precondition: the parameters were read.
Status ReadSources(const toml::table& table, const std::string& name, MachineFile& machine) {
  for (const auto& [parameter, value] : table) {
    const std::string named(parameter);
    const auto* text = value.as_string();
    if (text == nullptr)
      return BadText(name, LineOf(value), 0, "the source of " + named + " is a text");
    const bool given = std::ranges::any_of(
        machine.parameters, [&](const auto& one) { return EqualIgnoringCase(one.first, named); });
    if (!given)
      return BadText(name, LineOf(value), 0,
                     "a source of " + named + ", which [parameters] does not have");
    machine.sources[named] = text->get();
  }
  return {};
}

}  // namespace

Result<MachineFile> ParseMachineFile(std::string_view text, const std::string& name) {
  try {
    const toml::table table = toml::parse(text, name);
    MachineFile machine;
    const toml::table* sources = nullptr;
    for (const auto& [key, node] : table) {
      const bool names = key == "name" || key == "title";
      if ((key == "family" || key == "profile" || names) && node.is_string()) {
        (names             ? machine.name
         : key == "family" ? machine.family
                           : machine.profile) = node.as_string()->get();
      } else if (key == "parameters" && node.is_table()) {
        if (const Status read = ReadParameters(*node.as_table(), name, machine); !read)
          return read.error();
      } else if (key == "sources" && node.is_table()) {
        sources = node.as_table();
      } else {
        return BadText(name, LineOf(node), 0,
                       "unknown key " + std::string(key) +
                           "; there are family, profile, name, [parameters], [sources]");
      }
    }
    if (sources != nullptr) {
      if (const Status read = ReadSources(*sources, name, machine); !read) return read.error();
    }
    return machine;
  } catch (const toml::parse_error& error) {
    return BadText(name, static_cast<int>(error.source().begin.line),
                   static_cast<int>(error.source().begin.column), std::string(error.description()));
  }
}

Status ParseInputFile(std::string_view text, const std::string& name, double override_max,
                      v1::SimulationOptions& options) {
  int line_number = 0;
  while (!text.empty()) {
    ++line_number;
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    line = Trimmed(line.substr(0, line.find('#')));
    if (line.empty()) continue;
    const std::size_t blank = line.find_first_of(" \t");
    const auto at = ParseDouble(line.substr(0, blank));
    if (!at || !(*at >= 0.0) || blank == std::string_view::npos) {
      return BadText(name, line_number, 1,
                     "a line begins with the time in seconds, from 0: 0.5 IL[20] = 1");
    }
    std::string_view rest = Trimmed(line.substr(blank));
    const std::size_t equals = rest.find('=');
    const std::string_view what = Trimmed(rest.substr(0, equals));
    v1::ScriptedInput input;
    input.set_virtual_time_ns(FromSeconds(*at).count());
    if (!SetKind(what, input)) {
      return BadText(name, line_number, static_cast<int>(blank) + 2,
                     "'" + std::string(what.substr(0, 40)) +
                         "' is none of IL[n], IA[n], DOOR, START, HOLD, STOP, EMERGENCY, OVERRIDE");
    }
    if (NeedsValue(input.kind()) != (equals != std::string_view::npos)) {
      return BadText(name, line_number, static_cast<int>(blank) + 2,
                     std::string(what) + (equals == std::string_view::npos ? " needs '= VALUE'"
                                                                           : " takes no value"));
    }
    if (equals != std::string_view::npos) {
      const auto value = ValueOf(Trimmed(rest.substr(equals + 1)));
      if (!value)
        return BadText(name, line_number, 0, "the value is no number, ON, OFF, OPEN or CLOSED");
      input.set_value(*value);
      if (const Status valid = CheckInputValue(input, override_max); !valid) {
        return BadText(name, line_number, static_cast<int>(blank) + 2, valid.error().detail);
      }
    }
    *options.add_inputs() = input;
  }
  return {};
}

Status CheckOverride(double percent, double override_max) {
  if (percent > 0.0 && percent <= override_max) return {};
  return Error{ErrorCode::kCellInvalidArgument,
               "the value is " + ShortestText(percent) + "; allowed are above 0 to " +
                   ShortestText(override_max) + " %",
               {}};
}

Status CheckInputValue(const v1::ScriptedInput& input, double override_max) {
  const double value = input.value();
  const auto wrong = [&](const std::string& allowed) {
    return Error{ErrorCode::kCellInvalidArgument,
                 "the value is " + ShortestText(value) + "; " + allowed,
                 {}};
  };
  switch (input.kind()) {
    case v1::ScriptedInput::KIND_LOGICAL_INPUT:
    case v1::ScriptedInput::KIND_DOOR:
      if (value != 0.0 && value != 1.0) return wrong("allowed are 0 and 1");
      break;
    case v1::ScriptedInput::KIND_OVERRIDE:
      return CheckOverride(value, override_max);
    default:
      if (!std::isfinite(value)) return wrong("a number is needed");
  }
  return {};
}

}  // namespace rmlcell::bridge
