#include "engine/machine/profile_files.h"

#include <toml++/toml.h>

#include <utility>

namespace rmlcell::machine {
namespace {

Error Bad(std::string_view id, const toml::source_region& where, const Detail& what) {
  return {ErrorCode::kCellBadText,
          Told("profile", id) + ".toml:" + Told("line", where.begin.line) + ": " + what,
          {}};
}

}  // namespace

// A deque never moves what it has.
std::string_view ProfileFiles::Kept(std::string text) {
  texts_.push_back(std::move(text));
  return texts_.back();
}

// toml++ throws on text that is not TOML; nothing else of it leaves this file.
Status ProfileFiles::Add(const ProfileText& file) {
  MachineProfile profile{.id = file.id, .title = {}, .values = {}};
  try {
    const toml::table table = toml::parse(file.text);
    for (const auto& [key, node] : table) {
      const bool known = key == "title" || key == "parameters" || key == "sources";
      if (!known) return Bad(file.id, node.source(), "no key " + Told("key", key.str()));
    }
    const auto title = table["title"].value<std::string>();
    if (!title) return Bad(file.id, table.source(), "no title");
    profile.title = Kept(*title);
    const toml::table none;
    const toml::table* parameters = table["parameters"].as_table();
    const toml::node_view sources = table["sources"];
    for (const auto& [name, node] : parameters != nullptr ? *parameters : none) {
      ParameterValue value{.name = Kept(std::string(name.str())), .value = 0.0, .source = {}};
      if (const auto number = node.value<double>()) {
        value.value = *number;
      } else if (const auto word = node.value<std::string>()) {
        value.value = Kept(*word);
      } else {
        return Bad(file.id, node.source(), Told("name", name.str()) + " is no number and no word");
      }
      const auto source = sources[name.str()].value<std::string>();
      if (!source) return Bad(file.id, node.source(), Told("name", name.str()) + " has no source");
      value.source = Kept(*source);
      profile.values.push_back(value);
    }
  } catch (const toml::parse_error& error) {
    return Bad(file.id, error.source(), std::string(error.description()));
  }
  profiles_.push_back(std::move(profile));
  return {};
}

Result<ProfileFiles> ProfileFiles::Read(std::span<const ProfileText> files) {
  ProfileFiles made;
  for (const ProfileText& file : files) {
    if (const Status added = made.Add(file); !added) return added.error();
  }
  return made;
}

ProfileFiles::ProfileFiles(std::span<const ProfileText> files) {
  for (const ProfileText& file : files) {
    const Status added = Add(file);
    RMLCELL_CHECK(bool(added));
  }
}

}  // namespace rmlcell::machine
