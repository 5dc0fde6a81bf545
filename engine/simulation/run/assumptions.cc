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

Detail Assumptions::Text() const {
  if (!first_) return {};
  const std::string variable =
      std::string(first_->group) + '[' + std::to_string(first_->index) + ']';
  Detail text = ", if " + Told("assumed", variable) + " is ";
  text += Told("assumed_value", first_->value, {},
               !first_->on_off        ? ShortestText(first_->value)
               : first_->value != 0.0 ? "ON"
                                      : "OFF");
  const std::size_t more = seen_.size() - 1;
  if (more > 0) {
    text += " (and " + Told("more", more) + " more";
    text += more == 1 ? " is as it was)" : " are as they were)";
  }
  return text;
}

}  // namespace rmlcell::simulation
