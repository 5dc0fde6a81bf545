// A stream for a mill, and what a verdict of it adds: verdict_instructions.py counts both.
//   verdict_count run|rides|verdict STROKES
// run: a whole simulation. rides: the motions of the stream, kept. verdict: the same, and then what
// only a verdict needs of them: every motion watched, the work fitted, the rules asked.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "engine/families/families.h"
#include "engine/rml1/cut_watch.h"
#include "engine/rml1/figures.h"
#include "engine/rml1/profile.h"
#include "engine/rml1/step_guess.h"
#include "engine/simulation/run/simulate.h"
#include "engine/simulation/verdict/verdict.h"

namespace rmlcell {
namespace {

// Zigzags of cuts with a lift after every eighth, as boards have them; the feed rate is beyond the
// machine, so that no motion is passed over.
std::string Stream(int strokes) {
  std::string stream = "VS10;!VZ90;!PZ-10,200;!MC1;";
  for (int k = 0; k < strokes; ++k) {
    const std::string place =
        std::to_string(100 + k * 37 % 15000) + "," + std::to_string(100 + k * 53 % 12000);
    if (k % 8 == 0) stream += "PU" + place + ";";
    stream += "Z" + place + ",-10;";
  }
  return stream + "PU0,0;!MC0;";
}

struct Kept {
  std::vector<rml1::CutWatch::Ride> rides;
  rml1::WorkExtent work;
};

Kept RidesOf(const std::string& stream, rml1::Device& device) {
  Kept kept;
  rml1::DeviceListener nobody;
  rml1::Point tool = device.carriage().physical();
  std::int64_t offset = 0;
  for (const char c : stream) {
    device.Receive(static_cast<unsigned char>(c), offset++, nobody);
    while (device.Step(nobody)) {
      for (; !device.actions().empty(); device.actions().Pop()) {
        const rml1::Action& action = device.actions().front();
        if (action.kind != rml1::Action::Kind::kMotion) continue;
        const bool in_work = action.use == machine::MotionUse::kCut;
        kept.rides.push_back({.from = tool,
                              .to = action.to,
                              .length_mm = rml1::DistanceXYZ(tool, action.to) * 0.01,
                              .in_work = in_work,
                              .rapid = action.rapid,
                              .spindle_turns = device.spindle_turns(),
                              .clamps_height = 500.0});
        tool = action.to;
        kept.work.x.Add(tool.x);
        kept.work.y.Add(tool.y);
        kept.work.z.Add(tool.z);
      }
    }
  }
  return kept;
}

int Main(std::string_view what, int strokes) {
  const machine::MachineFamily& mill = *families::FindFamily("rml1");
  const auto parameters = machine::MakeParameters(mill, "t1", {});
  const auto profile = parameters ? rml1::MakeProfile(*parameters) : parameters.error();
  if (!profile) return 1;
  const std::string stream = Stream(strokes);
  if (what == "run") {
    machine::RunSetup setup(*parameters);
    setup.main_program = 1;
    setup.programs[1].object = machine::Bytes::Of(stream);
    const auto result = simulation::Simulate(mill, std::move(setup), {});
    return result && result->report.judgement.verdict == machine::Verdict::kDoubtful ? 0 : 1;
  }
  rml1::Device device(*profile);
  const Kept kept = RidesOf(stream, device);
  std::printf("%zu\n", kept.rides.size());
  if (what == "rides") return 0;
  rml1::CutWatch watch;
  for (const rml1::CutWatch::Ride& ride : kept.rides)
    watch.OnRide(ride, device.registers(), device.command());
  const rml1::CuttingRange& travel = device.carriage().range();
  const rml1::WorkFit fit = rml1::FitOf(kept.work, {}, {}, travel, 0.0, 100.0);
  const rml1::StepGuess guess =
      rml1::GuessStep(fit, travel, {device.programmed().z(), device.programmed().z_grain()}, 100.0);
  const std::vector<machine::Figure> figures =
      rml1::FiguresOf(device, rml1::Physical(*profile), true);
  const machine::Judgement judgement = simulation::JudgeFigures(mill, figures);
  std::printf("%g %g %zu\n", watch.feed_limited().mm, guess.fits_at, judgement.reasons.size());
  return watch.feed_limited().mm > 0.0 ? 0 : 1;
}

}  // namespace
}  // namespace rmlcell

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: verdict_count run|rides|verdict STROKES\n");
    return 2;
  }
  return rmlcell::Main(argv[1], std::atoi(argv[2]));
}
