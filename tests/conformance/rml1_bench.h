#pragma once

#include <memory>
#include <string_view>

#include "engine/rml1/device.h"
#include "tests/conformance/rml1_example.h"

namespace rmlcell::rml1::conformance {

// A device on a bench: no clock, every action is carried out at once. Fed in chunks of any size.
class Bench final : public DeviceListener {
 public:
  explicit Bench(const machine::Parameters& parameters, bool resumes_outside_pauses = false);

  void Feed(std::string_view chunk);
  void PressResume();
  Observed Look() const;

  Device& device() { return *device_; }
  const Profile& profile() const { return profile_; }
  const std::vector<Finding>& findings() const { return findings_; }

  void OnCommand(const CommandPlace& command) override;
  void OnFinding(const Finding& finding) override { findings_.push_back(finding); }

 private:
  void Work();
  void CarryOut(const Action& action);

  Profile profile_;
  bool resumes_outside_pauses_;
  std::unique_ptr<Device> device_;
  std::int64_t offset_ = 0;
  bool pause_told_ = false;
  std::size_t log_cleared_at_ = 0;
  std::vector<Observed::Event> trace_;
  std::vector<Finding> findings_;
};

// An example from power-on, fed in chunks of `chunk` bytes (0: whole), or split at one position.
Observed RunOnBench(const Example& example, std::size_t chunk);
Observed RunOnBenchSplitAt(const Example& example, std::size_t position);

// The same example as a program through MillRun: a stored stream in virtual time.
Observed RunAsProgram(const Example& example);

}  // namespace rmlcell::rml1::conformance
