#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "engine/core/untold_findings.h"
#include "engine/machine/observer.h"
#include "rmlcell/v1/worker.pb.h"

namespace rmlcell::server {

// Chooses what of a run goes into the durable log of its job: what people would look for
// afterwards. Moves and steps are in the trace, positions are latest-wins.
class JobEvents final : public machine::RunObserver {
 public:
  // Events of one job at most; a program that switches an output a million times does not fill the
  // log.
  static constexpr std::int64_t kEventsMax = 10'000;
  static constexpr int kBatch = 64;

  explicit JobEvents(std::function<void(const v1::WorkerEvents&)> send) : send_(std::move(send)) {}

  void OnSignal(const machine::SignalChange& change) override;
  void OnHalt(const machine::Halt& halt) override;
  void OnResume(SimTime at, const machine::Place& place) override;
  void OnProgram(SimTime at, const machine::Place& place, std::string_view what,
                 int program) override;
  void OnMessage(SimTime at, const machine::Place& place, std::string_view text) override;
  void OnDiagnostic(SimTime at, const Diagnostic& diagnostic) override;
  void OnCounted(SimTime at, const Diagnostic& diagnostic) override { rest_.Add(diagnostic, at); }

  // Findings that nobody told singly.
  void AddUntold(const UntoldFindings& untold) { rest_.Add(untold); }

  void Tell(v1::JobEvent event);
  // At the end of a run: of each kind of finding what was not told singly.
  void TellRest();
  void Flush();
  // Those that were not sent; they are no more to be.
  v1::WorkerEvents TakeUnsent() { return std::exchange(batch_, {}); }

 private:
  // Program, step, line, column.
  using FindingPlace = std::tuple<int, int, int, int>;
  static constexpr std::size_t kPlacesMax = 1'000;

  std::function<void(const v1::WorkerEvents&)> send_;
  v1::WorkerEvents batch_;
  std::int64_t count_ = 0;
  bool cut_ = false;
  // By code, at most kPlacesMax of each: the same place is told once.
  std::map<ErrorCode, std::set<FindingPlace>> places_;
  UntoldFindings rest_;
};

}  // namespace rmlcell::server
