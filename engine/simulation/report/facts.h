#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/simulation/report/report.h"

// A report as `key: value` lines for scripts. Keys and units stand in docs/facts.md and never
// change meaning; new ones may be added at any place, so readers look for keys and not for line
// numbers.
namespace rmlcell::simulation {

struct FactKey {
  std::string_view key;   // "cycle_time_s"
  std::string_view unit;  // "s"; empty for counts and words
  std::string_view text;  // what it means, one sentence
};

// Every key that Facts gives for any report, in order. Figures of a family follow as
// "<family>.<figure>".
std::span<const FactKey> FactKeys();

struct Fact {
  std::string key;
  std::string value;  // one line; "none" when there is nothing to say
};
std::vector<Fact> Facts(const RunReport& report);

// "cycle_time_s: 12.5\n" for each.
std::string FactsText(const RunReport& report);

// The page docs/facts.md, made from the same table and the figures of all families.
std::string FactsPage();

}  // namespace rmlcell::simulation
