#include "engine/optimo/language/gosub_depth.h"

#include <algorithm>

namespace rmlcell::optimo {
namespace {

enum class Visit : std::uint8_t { kNew, kOpen, kDone };

void SortOnce(std::vector<std::uint32_t>& places) {
  std::ranges::sort(places);
  places.erase(std::unique(places.begin(), places.end()), places.end());
}

// Depth first from the program's own GOSUBs: marks the calls that lead back into the chain that is
// open, and leaves the subroutines in an order in which each stands before those that call it.
class Walk {
 public:
  Walk(const std::vector<std::vector<GosubCall>>& calls, std::vector<std::uint32_t>& recursive)
      : calls_(calls), recursive_(recursive), visits_(calls.size()) {
    for (const auto& of_one : calls_) closes_.emplace_back(of_one.size());
  }

  void From(std::size_t subroutine) {
    if (visits_[subroutine] != Visit::kNew) return;
    Open(subroutine);
    while (!open_.empty()) {
      Frame& frame = open_.back();
      if (frame.next == calls_[frame.subroutine].size()) {
        visits_[frame.subroutine] = Visit::kDone;
        finished_.push_back(frame.subroutine);
        open_.pop_back();
        continue;
      }
      const std::size_t which = frame.next++;
      const GosubCall& call = calls_[frame.subroutine][which];
      if (visits_[call.to] == Visit::kOpen) {
        closes_[frame.subroutine][which] = true;
        recursive_.push_back(call.at);
      } else if (visits_[call.to] == Visit::kNew) {
        Open(call.to);
      }
    }
  }

  const std::vector<std::size_t>& finished() const { return finished_; }
  bool Closes(std::size_t subroutine, std::size_t which) const {
    return closes_[subroutine][which];
  }

 private:
  struct Frame {
    std::size_t subroutine = 0;
    std::size_t next = 0;
  };
  void Open(std::size_t subroutine) {
    visits_[subroutine] = Visit::kOpen;
    open_.push_back({subroutine, 0});
  }

  const std::vector<std::vector<GosubCall>>& calls_;
  std::vector<std::uint32_t>& recursive_;
  std::vector<Visit> visits_;
  std::vector<std::vector<bool>> closes_;
  std::vector<Frame> open_;
  std::vector<std::size_t> finished_;
};

}  // namespace

GosubNesting FindNesting(const std::vector<GosubCall>& main,
                         const std::vector<std::vector<GosubCall>>& calls, int levels_max) {
  GosubNesting nesting;
  Walk walk(calls, nesting.recursive);
  for (const GosubCall& call : main) walk.From(call.to);

  // The deepest level on which each subroutine can run: callers before those that they call.
  std::vector<int> level(calls.size());
  const auto call_from = [&](const GosubCall& call, int caller_level) {
    if (caller_level + 1 > levels_max) nesting.too_deep.push_back(call.at);
    level[call.to] = std::max(level[call.to], caller_level + 1);
  };
  for (const GosubCall& call : main) call_from(call, 0);
  for (std::size_t n = walk.finished().size(); n-- > 0;) {
    const std::size_t subroutine = walk.finished()[n];
    for (std::size_t which = 0; which < calls[subroutine].size(); ++which) {
      if (!walk.Closes(subroutine, which)) call_from(calls[subroutine][which], level[subroutine]);
    }
  }
  SortOnce(nesting.recursive);
  SortOnce(nesting.too_deep);
  return nesting;
}

}  // namespace rmlcell::optimo
