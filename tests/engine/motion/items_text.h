// What a ride still has before it, as a text.
#pragma once

#include <deque>
#include <string>
#include <variant>

#include "engine/motion/planner/planner.h"

namespace rmlcell::motion {

// " 1 m11": the motion with the tag 1, then the mark 11.
inline std::string ItemsOf(const std::deque<PlannedItem>& items) {
  std::string text;
  for (const PlannedItem& item : items) {
    const auto* mark = std::get_if<PlannedMark>(&item);
    text += mark != nullptr ? " m" + std::to_string(mark->tag)
                            : " " + std::to_string(std::get<PlannedMotion>(item).tag);
  }
  return text;
}

}  // namespace rmlcell::motion
