#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/machine/machine.h"
#include "rmlcell/v1/host.pb.h"
#include "server/host/host_time.h"

namespace rmlcell::server {

// Where a run is to begin, as it is asked for. Errors: CellInvalidArgument.
Result<machine::StartAtStep> StartOf(const v1::PreviewStartRequest& request,
                                     const machine::Machine& machine);
// What it would do, without token; items that a person sees to are named by what is confirmed.
v1::PreviewStartResponse ToProto(const machine::StartPreview& preview,
                                 const machine::FamilyInfo& family);

// Previews of starts at a step, until they are started, are stale, or 120 s have gone. LIVE-6.08
class StartDesk {
 public:
  static constexpr std::chrono::seconds kLasts{120};

  struct Named {
    std::string name{};  // "override", "IL"
    std::string value{};
    bool operator==(const Named&) const = default;
  };
  // All that a preview depends on; two that are equal give the same preview.
  struct Basis {
    std::string state{};          // of the machine
    std::vector<Named> named{};   // of it, by the names that people know
    std::uint64_t programs = 0;   // counts up when one changes
    std::uint64_t schedules = 0;  // likewise
    std::uint64_t halts = 0;      // counts up when somebody halts it, whatever it does
    bool operator==(const Basis&) const = default;
  };

  explicit StartDesk(std::function<std::string()> make_token)
      : make_token_(std::move(make_token)) {}

  // Replaces what was kept before; returns its token.
  std::string Keep(machine::StartAtStep start, Basis basis, const HostTime& now);
  // With what a person has seen to. Error: CellPreviewStale, with what changed.
  Result<machine::StartAtStep> Take(const v1::StartAtStepRequest& request, const Basis& basis,
                                    const HostTime& now) const;

 private:
  std::function<std::string()> make_token_;
  std::string token_{};  // empty: nothing is kept
  machine::StartAtStep start_{};
  Basis basis_{};
  std::chrono::nanoseconds until_{0};
};

}  // namespace rmlcell::server
