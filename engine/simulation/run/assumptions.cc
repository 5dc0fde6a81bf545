#include "engine/simulation/run/assumptions.h"

#include "engine/core/number_text.h"

namespace rmlcell::simulation {

Assumptions::Assumptions(const machine::InputScript& inputs) {
  for (const machine::InputChange& input : inputs) told_.emplace(input.kind, input.index);
}

void Assumptions::Add(const machine::Assumed& assumed) {
  if (assumed.input && told_.contains({*assumed.input, assumed.index})) return;
  if (!seen_.emplace(assumed.group, assumed.index).second) return;
  if (!first_) first_ = assumed;
}

std::string Assumptions::Text() const {
  if (!first_) return {};
  std::string text =
      ", if " + std::string(first_->group) + '[' + std::to_string(first_->index) + "] is ";
  text += first_->on_off ? (first_->value != 0.0 ? "ON" : "OFF") : ShortestText(first_->value);
  const std::size_t more = seen_.size() - 1;
  if (more > 0) {
    text += " (and " + std::to_string(more) + " more";
    text += more == 1 ? " is as it was)" : " are as they were)";
  }
  return text;
}

}  // namespace rmlcell::simulation
