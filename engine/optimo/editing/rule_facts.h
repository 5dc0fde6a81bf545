#pragma once

#include <span>
#include <string_view>

// The rules that findings and instructions of the Optimo name, each in a sentence, so that an
// editor can say what "OPT-2.47" is without the specification at hand.
namespace rmlcell::optimo::editing {

struct RuleFact {
  std::string_view id;
  std::string_view text;
};

// Ordered by id.
std::span<const RuleFact> RuleFacts();

// Empty when the rule is not known.
std::string_view TextOfRule(std::string_view id);

}  // namespace rmlcell::optimo::editing
