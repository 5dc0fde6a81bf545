#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/core/catalogue.h"
#include "engine/core/detail.h"

namespace rmlcell::machine {

// Where in the programs something happened.
struct Place {
  int program = 0;  // slot of the module; 0 for a stream without slot
  int step = 0;     // as the control counts; for a stream the number of the command from 1
  int line = 0;     // 0 when no text is known
  std::int64_t byte_offset = -1;  // streams: of the command's first byte

  bool operator==(const Place&) const = default;
};

// Why a run halts: PAUSE, STOP, HOLD, a breakpoint, !NR.
enum class HaltReason {
  kHold,        // the key, or an order
  kStop,        // the key, or an order
  kProgram,     // an instruction of the program, or what it leads to
  kBreakpoint,  // this step is over
  kSingle,      // the mode SINGLE
};

enum class OutcomeKind { kCompleted, kStopped, kFailed, kCancelled, kBudgetExceeded };
struct Outcome {
  OutcomeKind kind = OutcomeKind::kCompleted;
  std::optional<ErrorCode> code{};  // the machine's own; none when completed
  Detail detail{};
  Place place{};  // of the last step, or where it failed
};

// A figure that a family computes about a finished run, with a stable name.
struct Figure {
  std::string name{};  // "programmed.cut_length"
  std::string unit{};  // "mm"; empty for counts
  double value = 0.0;
  Place first{};  // where it first came to be above 0; step 0: it has no place
};

}  // namespace rmlcell::machine
