#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "engine/optimo/language/ast.h"
#include "engine/optimo/offline/semantic_diff.h"

// What an instruction means, apart from how it is written: the elements that a semantic diff
// compares. Private to the folder.
namespace rmlcell::optimo {

// Modal values that are looked at where a MOVE uses them, not where they are set.
struct ModalValues {
  std::string path = "PATH of the machine", speed = "70.0", accel = "100.0", oversh = "100.0";

  bool operator==(const ModalValues&) const = default;
};

struct SemanticStep {
  std::uint32_t instruction = 0;
  // Equal exactly when both do the same; sequence numbers that are jumped to are left out, they
  // are compared by what stands there.
  std::string meaning;
  std::string kind;      // equal for steps of which one may have been made from the other
  ModalValues modal;     // MOVE, when modal instructions are folded
  unsigned aspects = 0;  // what it touches when it comes or goes
};

// Whether both programs run straight through with plain modal values, so that SPEED, ACCEL, OVERSH
// and PATH may be looked at in the MOVEs that follow them in the text.
bool CanFold(const Module& a, const Module& b);

std::vector<SemanticStep> StepsOf(const Module& module, bool fold);

// What differs between two steps of the same kind, and what that touches.
struct StepDifference {
  std::vector<std::string> what;
  unsigned aspects = 0;
  double target_moved_mm = 0.0;
};
StepDifference Compare(const Module& a, const SemanticStep& step_a, const Module& b,
                       const SemanticStep& step_b);

}  // namespace rmlcell::optimo
