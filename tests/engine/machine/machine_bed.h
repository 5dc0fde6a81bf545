#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "engine/families/families.h"
#include "engine/machine/machine.h"
#include "engine/machine/parameters.h"

namespace rmlcell::machine {

inline SimTime At(double seconds) { return FromSeconds(seconds); }

// What runs told, a line each.
class Heard final : public RunObserver {
 public:
  void OnStep(SimTime at, const Place& place, std::string_view name) override {
    Add(at, place, "step " + std::string(name));
  }
  void OnMotion(const MotionDone& done) override {
    Add(done.start, done.place, "motion to " + std::to_string(done.end.count()));
  }
  void OnSignal(const SignalChange& change) override {
    Add(change.at, change.place,
        "signal " + std::to_string(static_cast<int>(change.signal)) + " " +
            std::to_string(change.index) + " " + std::to_string(change.value));
  }
  void OnHalt(const Halt& halt) override {
    Add(halt.at, halt.place, "halt " + std::string(halt.why));
    halts.push_back(halt.place.step);
  }
  void OnResume(SimTime at, const Place& place) override { Add(at, place, "resume"); }
  void OnDiagnostic(SimTime at, const Diagnostic& finding) override {
    Add(at, {}, "finding " + CodeText(finding.code));
  }
  std::vector<std::string> told;
  std::vector<int> halts;  // the steps

 private:
  void Add(SimTime at, const Place& place, const std::string& what) {
    told.push_back(std::to_string(at.count()) + " " + std::to_string(place.program) + "/" +
                   std::to_string(place.step) + " " + what);
  }
};

class MachineTest : public testing::Test {
 protected:
  explicit MachineTest(std::string_view family = "optimo")
      : family_(*families::FindFamily(family)) {}

  StoredProgram Translated(const std::string& text) const {
    const std::string name = family_.info().id == "optimo" ? "a.S" : "a.rml";
    Translation made =
        family_.Translate({.name = name, .bytes = text}, parameters(), {.advice = false});
    EXPECT_TRUE(made.ok) << text;
    return {.name = name, .object = Bytes::Of(ObjectOf(std::move(made), text))};
  }
  Parameters parameters() const {
    return *MakeParameters(family_, std::string(family_.info().default_profile), {});
  }
  // Program 1 and up.
  void Load(const std::vector<std::string>& programs, std::string_view state = {}) {
    MachineMemory memory;
    for (std::size_t i = 0; i < programs.size(); ++i)
      memory.programs[static_cast<int>(i) + 1] = Translated(programs[i]);
    Result<std::unique_ptr<Machine>> made =
        Machine::Make(family_, parameters(), std::move(memory), state, heard);
    ASSERT_TRUE(made) << made.error().detail;
    machine = *std::move(made);
  }
  void Start(int program = 1) { Good(StartRun{.program = program}); }
  void Good(const MachineInput& input) {
    const Status done = machine->Apply(input);
    EXPECT_TRUE(done) << CodeText(done.error().code) << " " << done.error().detail;
  }
  // "CELL-E9421 the machine is HELD: ..."
  std::string Refused(const MachineInput& input) {
    const Status done = machine->Apply(input);
    if (done) return "it was taken";
    return CodeText(done.error().code) + " " + done.error().detail;
  }
  // Goes on to this time of the machine.
  void GoOn(SimTime until) {
    while (machine->Advance(until) == Progress::kMoreWork) {
    }
    EXPECT_EQ(machine->time(), until);
  }
  RunOver Over() {
    std::vector<RunOver> over = machine->TakeRunsOver();
    EXPECT_EQ(over.size(), 1U);
    return over.empty() ? RunOver() : std::move(over.back());
  }
  std::string Value(std::string_view name) const {
    return machine->ReadVariable(name).value_or(VariableValue{.text = "none"}).text;
  }
  MachineState state() const { return machine->state(); }

  const MachineFamily& family_;
  Heard heard;
  std::unique_ptr<Machine> machine;
};

}  // namespace rmlcell::machine
