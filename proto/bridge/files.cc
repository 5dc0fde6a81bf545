#include "proto/bridge/files.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "engine/core/letters.h"
#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "proto/bridge/nameless_file.h"
#include "rmlcell/v1/job.pb.h"

namespace rmlcell::bridge {
namespace {

Error BadText(const std::string& name, int line, int column, const std::string& what) {
  return {ErrorCode::kCellBadText, name + ":" + std::to_string(line) + ": " + what,
          SourceSpan{.line = line, .column = column}};
}

}  // namespace

Status ReadParts(const std::string& path, std::int64_t limit,
                 const std::function<void(std::string_view)>& part) {
  const OpenFile file(std::fopen(path.c_str(), "rb"));
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

}  // namespace rmlcell::bridge
