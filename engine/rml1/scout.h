#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "engine/machine/bytes.h"
#include "engine/machine/run.h"
#include "engine/rml1/device.h"
#include "engine/rml1/look_ahead.h"
#include "engine/rml1/sender.h"

namespace rmlcell::rml1 {

// Where a run halts by itself between two commands: after each, or after some.
struct CommandHalts {
  bool after_each = false;         // mode SINGLE
  std::vector<int> breakpoints{};  // numbers of commands, in order
  int entry = 0;                   // before this one; 0: none

  bool any() const { return after_each || !breakpoints.empty() || entry > 0; }
  bool BreaksAfter(int command) const { return std::ranges::binary_search(breakpoints, command); }
  bool EntersAfter(int command) const { return entry > 0 && command + 1 == entry; }
  bool After(int command) const {
    return after_each || BreaksAfter(command) || EntersAfter(command);
  }
};

// Reads the stream of a run ahead of its tool, through a device of its own: which motions come, and
// where the tool must stand between them. What that device notices nobody hears; the device of the
// run reads the same bytes when their time comes. A device knows no time, so both do the same.
class Scout {
 public:
  // `device` as the run's own before the first byte.
  explicit Scout(Device device) : device_(std::move(device)) {}
  // Between two commands, where all that the device did is carried out.
  Scout(Device device, const Sender& sender)
      : device_(std::move(device)), sender_(sender), commands_seen_(device_.commands_done()) {}

  // As far as the next motion, or the next place where the tool must stand. False: `sent_max` bytes
  // of the stream were read before that, of which sent() tells. Not behind the end of the stream.
  bool Read(machine::Bytes& stream, const CommandHalts& halts, std::size_t sent_max,
            LookAhead& ahead);

  std::size_t sent() const { return sender_.sent(); }

 private:
  bool TakeActions(machine::Bytes& stream, LookAhead& ahead);
  bool TakeWhatHappened(machine::Bytes& stream, const CommandHalts& halts, LookAhead& ahead);

  Device device_;
  Sender sender_;
  std::uint64_t commands_seen_ = 0;
  bool over_ = false;
};

}  // namespace rmlcell::rml1
