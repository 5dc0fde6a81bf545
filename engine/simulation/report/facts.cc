#include "engine/simulation/report/facts.h"

#include <map>
#include <utility>

#include "engine/families/families.h"
#include "engine/simulation/report/fact_table.h"

namespace rmlcell::simulation {
namespace {

const facts::Table& TheFacts() {
  static const facts::Table table;
  return table;
}

}  // namespace

std::span<const FactKey> FactKeys() { return TheFacts().keys(); }

std::vector<Fact> Facts(const RunReport& report) {
  std::vector<Fact> all;
  for (const facts::Row& row : TheFacts().rows()) all.push_back({row.key, row.value(report)});
  const auto add = [&](std::string_view figure, std::string value) {
    all.push_back({report.family + '.' + std::string(figure), std::move(value)});
  };
  // Every figure that the family declares, so that a reader finds the same keys every time.
  std::map<std::string_view, double> left;
  for (const machine::Figure& figure : report.figures) left.emplace(figure.name, figure.value);
  if (const machine::MachineFamily* family = families::FindFamily(report.family)) {
    for (const machine::FigureInfo& info : family->figures()) {
      const auto known = left.find(info.name);
      add(info.name, known != left.end() ? facts::Real(known->second) : std::string(facts::kNone));
      if (known != left.end()) left.erase(known);
    }
  }
  for (const auto& [name, value] : left) add(name, facts::Real(value));
  return all;
}

std::string FactsText(const RunReport& report) {
  std::string text;
  for (const Fact& fact : Facts(report)) text += fact.key + ": " + fact.value + '\n';
  return text;
}

std::string FactsPage() {
  std::string page =
      "# Facts of a run\n\n"
      "`rmlcell simulate --facts` prints one `key: value` a line. Keys and units stand below and\n"
      "never change meaning; new keys may appear at any place, so look for the key and not for "
      "the\n"
      "line. Numbers have up to six decimals and a point, in every locale; `none` means that "
      "there\n"
      "is nothing to say. Points are in the frame of the machine unless the key says otherwise.\n\n"
      "This page is made from the table in `engine/simulation/report/fact_table.cc` and the figures of the\n"
      "machine families; a test compares it.\n\n"
      "| key | unit | meaning |\n| --- | --- | --- |\n";
  const auto row = [&page](std::string_view key, std::string_view unit, std::string_view text) {
    page += "| `";
    page += key;
    page += "` | ";
    page += unit;
    page += " | ";
    page += text;
    page += " |\n";
  };
  for (const FactKey& key : FactKeys()) row(key.key, key.unit, key.text);
  for (const machine::MachineFamily* family : families::Families()) {
    if (family->figures().empty()) continue;
    const machine::FamilyInfo& info = family->info();
    page += "\n## ";
    page += info.title;
    page += "\n\n| key | unit | meaning |\n| --- | --- | --- |\n";
    for (const machine::FigureInfo& figure : family->figures()) {
      row(std::string(info.id) + '.' + std::string(figure.name), figure.unit, figure.text);
    }
  }
  return page;
}

}  // namespace rmlcell::simulation
