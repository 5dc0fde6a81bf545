#include "engine/simulation/material/chip_load.h"

#include <toml++/toml.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "engine/core/check.h"
#include "engine/simulation/material/chip_texts.h"

namespace rmlcell::simulation {
namespace {

Error BadTable(const toml::source_region& where, const Detail& what) {
  return {ErrorCode::kCellBadText,
          "chip_loads.toml:" + Told("line", where.begin.line) + ": " + what,
          {}};
}

// Numbers above 0, each above the one before; empty: they are not.
std::vector<double> Rising(const toml::node_view<const toml::node>& node) {
  std::vector<double> numbers;
  const toml::array* array = node.as_array();
  if (array == nullptr) return {};
  for (const toml::node& element : *array) {
    const std::optional<double> number = element.value<double>();
    if (!number || !(*number > (numbers.empty() ? 0.0 : numbers.back()))) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

Result<ChipTable> ReadTable(std::string_view material, const toml::table& table) {
  const toml::source_region& where = table.source();
  ChipTable made{.material = std::string(material)};
  const auto name = [&] { return Told("material", material); };
  const auto source = table["source"].value<std::string>();
  if (!source || source->empty()) return BadTable(where, name() + " has no source");
  made.source = *source;
  made.speed_most_m_min = table["speed_most_m_min"].value_or(0.0);
  if (!(made.speed_most_m_min > 0.0))
    return BadTable(where, name() + " has no speed_most_m_min above 0");
  made.plunge_share = table["plunge_share"].value_or(0.0);
  if (!(made.plunge_share > 0.0) || made.plunge_share > 1.0)
    return BadTable(where, name() + " has no plunge_share above 0 and up to 1");
  const auto diameters = Rising(table["diameter_mm"]);
  const auto least = Rising(table["least_mm"]);
  const auto most = Rising(table["most_mm"]);
  if (diameters.empty() || least.size() != diameters.size() || most.size() != diameters.size()) {
    return BadTable(where, name() +
                               ": diameter_mm, least_mm and most_mm are lists of one length, of "
                               "numbers that rise");
  }
  for (std::size_t i = 0; i < diameters.size(); ++i) {
    if (least[i] > most[i]) return BadTable(where, name() + " has a least above its most");
    made.rows.push_back({diameters[i], least[i], most[i]});
  }
  return made;
}

}  // namespace

ChipRange ChipTable::For(double diameter_mm) const {
  const auto range = [&](const Row& row, double by) {
    return ChipRange{row.least_mm * by, row.most_mm * by, speed_most_m_min,
                     row.most_mm * by * plunge_share};
  };
  const auto above =
      std::ranges::find_if(rows, [&](const Row& row) { return row.diameter_mm >= diameter_mm; });
  if (above == rows.begin() || above == rows.end()) {
    const Row& end = above == rows.end() ? rows.back() : rows.front();
    return range(end, diameter_mm / end.diameter_mm);
  }
  const Row& low = *std::prev(above);
  const Row& high = *above;
  const double share = (diameter_mm - low.diameter_mm) / (high.diameter_mm - low.diameter_mm);
  const double most = low.most_mm + share * (high.most_mm - low.most_mm);
  return {low.least_mm + share * (high.least_mm - low.least_mm), most, speed_most_m_min,
          most * plunge_share};
}

// toml++ throws on text that is not TOML; nothing else of it leaves this file.
Result<std::vector<ChipTable>> ReadChipTables(std::string_view text) {
  std::vector<ChipTable> tables;
  try {
    const toml::table file = toml::parse(text);
    for (const auto& [name, node] : file) {
      const toml::table* table = node.as_table();
      if (table == nullptr) return BadTable(node.source(), "no key " + Told("key", name.str()));
      Result<ChipTable> read = ReadTable(name.str(), *table);
      if (!read) return read.error();
      tables.push_back(*std::move(read));
    }
  } catch (const toml::parse_error& error) {
    return BadTable(error.source(), std::string(error.description()));
  }
  return tables;
}

const std::vector<ChipTable>& ChipTables() {
  static const std::vector<ChipTable> tables = [] {
    Result<std::vector<ChipTable>> read = ReadChipTables(ChipLoadText());
    RMLCELL_CHECK(bool(read));
    return *std::move(read);
  }();
  return tables;
}

Result<ChipRange> ChipsOf(std::string_view material, double diameter_mm) {
  Detail known;
  for (const ChipTable& table : ChipTables()) {
    if (table.material == material) return table.For(diameter_mm);
    known += (known.empty() ? "" : ", ") + Told("known", table.material);
  }
  return InvalidArgument("'" + Told("material", material) + "' is no material: " + known);
}

}  // namespace rmlcell::simulation
