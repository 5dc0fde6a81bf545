#include "engine/simulation/run/recorder.h"

#include <gtest/gtest.h>

#include <string>

#include "engine/simulation/run/version.h"
#include "tests/engine/simulation/fake_run.h"

namespace rmlcell::simulation {
namespace {

// Writes down the name of everything that it is told.
class Listener final : public machine::RunObserver {
 public:
  std::string heard;
  void OnStep(SimTime, const machine::Place&, std::string_view) override { heard += "step "; }
  void OnMotion(const machine::MotionDone&) override { heard += "motion "; }
  void OnMove(const machine::MoveDone&) override { heard += "move "; }
  void OnSignal(const machine::SignalChange&) override { heard += "signal "; }
  void OnWait(const machine::Wait&) override { heard += "wait "; }
  void OnHalt(const machine::Halt&) override { heard += "halt "; }
  void OnResume(SimTime, const machine::Place&) override { heard += "resume "; }
  void OnProgram(SimTime, const machine::Place&, std::string_view, int) override {
    heard += "program ";
  }
  void OnMessage(SimTime, const machine::Place&, std::string_view) override { heard += "message "; }
  void OnDiagnostic(SimTime, const Diagnostic&) override { heard += "diagnostic "; }
};

Script Everything() {
  Script script;
  script.Step(1, 1).Line({}, {1, 0, 0}).Move({1, 0, 0}, 50, "LIN");
  script.Signal(machine::Signal::kOutput, 1).Wait(machine::WaitKind::kDwell, 1.0);
  script.Program("CALL", 2).Message("hello").Find(ErrorCode::kShortFly, "short").Halt("STOP");
  return script;
}

TEST(Recorder, TellsEverythingToItsListeners) {
  Listener listener;
  Recorder recorder({}, {}, {.trace = {}, .toolpath = {}, .also = &listener});
  FakeRun run(Everything(), recorder, {{FromSeconds(9), machine::InputKind::kStart, 0, 1.0}});
  run.Advance(kForever);
  EXPECT_EQ(listener.heard, "step motion move signal wait program message diagnostic halt resume ");
}

TEST(Recorder, ReportCarriesInputsAndProducts) {
  int records = 0;
  std::uint64_t bytes = 0;
  Products products;
  products.trace = [&](const TraceRecord&) { return ++records > 0; };
  products.toolpath = [&](std::string_view block) { return (bytes += block.size()) > 0; };
  products.picture = true;
  InputDescription inputs;
  inputs.family = "optimo";
  inputs.title = "part.S";
  inputs.hash = "00ff";
  inputs.changed_parameters = {{"VMAX", "423.333"}};
  Recorder recorder({}, inputs, std::move(products));
  FakeRun run(Everything(), recorder, {{FromSeconds(9), machine::InputKind::kStart, 0, 1.0}});
  run.Advance(kForever);
  recorder.Finish(run);
  const RunReport report = recorder.Report(run);
  EXPECT_EQ(report.family, "optimo");
  EXPECT_EQ(report.title, "part.S");
  EXPECT_EQ(report.inputs_hash, "00ff");
  EXPECT_EQ(report.engine_version, kEngineVersion);
  EXPECT_EQ(report.changed_parameters.at("VMAX"), "423.333");
  EXPECT_TRUE(report.trace.made);
  EXPECT_EQ(report.trace.records, static_cast<std::uint64_t>(records));
  EXPECT_EQ(records, 9);  // move signal wait program message finding halt resume end
  EXPECT_EQ(report.toolpath.records, 2u);
  EXPECT_EQ(report.toolpath.bytes, bytes);
  EXPECT_GT(bytes, 0u);
  EXPECT_EQ(report.picture.records, 1u);
  EXPECT_FALSE(recorder.cut_off());
  EXPECT_NE(recorder.Svg(report, {}).find("<svg"), std::string::npos);
}

TEST(Recorder, ProductsThatWereNotAskedForAreNotMade) {
  Recorder recorder({}, {}, {});
  FakeRun run(Everything(), recorder);
  run.Advance(kForever);
  const RunReport report = recorder.Report(run);
  EXPECT_FALSE(report.trace.made || report.toolpath.made || report.picture.made);
  EXPECT_EQ(recorder.Svg(report, {}), "");
}

TEST(Recorder, CutOffProductIsSaid) {
  Products products;
  products.trace = [](const TraceRecord&) { return true; };
  products.trace_records_max = 1;
  Recorder recorder({}, {}, std::move(products));
  FakeRun run(Everything(), recorder);
  run.Advance(kForever);
  EXPECT_TRUE(recorder.cut_off());
  EXPECT_FALSE(recorder.Report(run).trace.complete);
  EXPECT_GT(recorder.Report(run).trace.dropped, 0u);
}

}  // namespace
}  // namespace rmlcell::simulation
