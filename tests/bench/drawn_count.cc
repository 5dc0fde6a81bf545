// A program of the corpus, carried out again and again: drawn_paths.py counts what it costs.
//   drawn_count PROGRAM:STAGE TIMES
// PROGRAM: a file of OPTIMO (.S), which a loop CALLs, with those beside it that it names; any other
// is a stream for a mill, of which at most kBytesMax are taken, written one behind the other.
// STAGE: moves, how many there are; text, it is written, and no more. Of mills: read, by a device;
// check, by the family; gcode, the same places for a rival. plan: it is read and run with nobody to
// tell; report, toolpath, picture, each is made beside it; all, they are made together. tail: how
// long one more segment takes the planner, taken and given out, as `motion_planner_bench --tail`.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include "engine/families/families.h"
#include "engine/optimo/language/compiler.h"
#include "tests/bench/planner_calls.h"
#include "tests/bench/report_stages.h"
#include "tests/bench/rml1_reading.h"

namespace rmlcell::bench {
namespace {

constexpr std::size_t kBytesMax = 100'000;  // so that callgrind takes a minute, not ten

std::string ReadFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

struct Drawn {
  const machine::MachineFamily* family = nullptr;
  std::string text{};  // of a mill
  std::optional<machine::RunSetup> setup{};
};

Drawn Mill(const std::filesystem::path& path, int times) {
  std::string once = ReadFile(path);
  if (once.size() > kBytesMax) once.resize(once.rfind(';', kBytesMax) + 1);
  Drawn drawn{.family = families::FindFamily("rml1")};
  for (int k = 0; k < times; ++k) (drawn.text += once) += '\n';
  drawn.setup.emplace(*WideMachine());
  drawn.setup->programs[1].object = machine::Bytes::Borrowed(drawn.text);
  return drawn;
}

// The slot of the drawn program. Those that others name have the numbers of the manual; one that
// the manual does not list does nothing.
constexpr int kSlot = 3;
std::optional<machine::Bytes> Compiled(const std::string& text) {
  optimo::Compilation compiled = optimo::Compile(text, "drawn.S", {.advice = false});
  if (!compiled.ok) return {};
  return machine::Bytes::Of(std::move(compiled.object));
}

Drawn Laser(const std::filesystem::path& path, int times) {
  Drawn drawn{.family = families::FindFamily("optimo")};
  drawn.setup.emplace(*machine::MakeParameters(*drawn.family, "", {}));
  const std::filesystem::path beside = path.parent_path();
  const std::pair<int, std::string> programs[] = {
      {1, "VR[35]=0.\n10 CALL " + std::to_string(kSlot) + "\nVR[35]=VR[35]+1.\nIF VR[35]<" +
              std::to_string(times) + ". THEN 10\nENDTASK\n"},
      {2, "VI[35]=1\n"},
      {kSlot, ReadFile(path)},
      {44, ReadFile(beside / "ch09-program44.S")},
      {45, ReadFile(beside / "ch07-target45.S")},
      {46, "VI[35]=1\n"}};
  for (const auto& [slot, text] : programs) {
    std::optional<machine::Bytes> object = Compiled(text);
    if (object) drawn.setup->programs[slot].object = *std::move(object);
    if (!object && slot == kSlot) drawn.setup.reset();
    if (!drawn.setup) break;
  }
  return drawn;
}

// Motions that the program asks for: what all figures are divided by.
class CountMoves : public machine::RunObserver {
 public:
  void OnMove(const machine::MoveDone& /*move*/) override { ++moves; }
  int moves = 0;
};

bool RunToEnd(const machine::MachineFamily& family, machine::RunSetup setup,
              machine::RunObserver& observer) {
  const auto run = family.NewRun(std::move(setup), observer);
  if (!run) return false;
  while ((*run)->Advance(kForever) == machine::RunPhase::kRunning) {
  }
  return (*run)->outcome().kind == machine::OutcomeKind::kCompleted;
}

// Through the places that a device reads, at one feed rate.
void WriteGcode(const rml1::Profile& profile, std::string_view text) {
  std::printf("G21 G90 G94 G64 P0.01\nF1500\n");
  ForEachMove(profile, text, [](const rml1::Action& action) {
    std::printf("G1 X%.3f Y%.3f Z%.3f\n", 0.01 * action.to.x, 0.01 * action.to.y,
                0.01 * action.to.z);
  });
  std::printf("M2\n");
}

int OfText(std::string_view stage, const std::string& text) {
  const Result<machine::Parameters> parameters = WideMachine();
  const Result<rml1::Profile> profile = rml1::MakeProfile(*parameters);
  if (stage == "gcode") return WriteGcode(*profile, text), 0;
  if (stage == "check") return CheckText(*parameters, text) ? 0 : 1;
  const int moves = ReadPlaces(*profile, text).moves;
  if (stage == "moves") std::printf("%d\n", moves);
  return moves > 0 ? 0 : 1;
}

int OfRun(std::string_view stage, const machine::MachineFamily& family, machine::RunSetup setup) {
  CountMoves count;
  machine::RunObserver nobody;
  const bool counted = stage == "moves";
  if (counted || stage == "plan") {
    const bool over = RunToEnd(family, std::move(setup),
                               counted ? static_cast<machine::RunObserver&>(count) : nobody);
    if (counted) std::printf("%d\n", count.moves);
    return over && (!counted || count.moves > 0) ? 0 : 1;
  }
  if (stage == "tail") {
    KeepPlannerCalls();
    if (!RunToEnd(family, std::move(setup), nobody)) return 1;
    return PrintTail() ? 0 : 1;
  }
  return SimulateStage(stage, family, std::move(setup));
}

int Main(const std::filesystem::path& path, std::string_view stage, int times) {
  const bool mill = path.extension() != ".S";
  Drawn drawn = mill ? Mill(path, times) : Laser(path, times);
  if (!drawn.setup) return 1;
  if (stage == "text") return 0;
  const bool of_text = stage == "read" || stage == "check" || stage == "gcode" || stage == "moves";
  if (mill && of_text) return OfText(stage, drawn.text);
  drawn.setup->main_program = 1;
  drawn.setup->budget.steps = 0;
  return OfRun(stage, *drawn.family, *std::move(drawn.setup));
}

}  // namespace
}  // namespace rmlcell::bench

int main(int argc, char** argv) {
  const std::string_view what = argc == 3 ? argv[1] : "";
  const std::size_t colon = what.rfind(':');
  if (colon == std::string_view::npos) {
    std::fprintf(stderr,
                 "usage: drawn_count PROGRAM:moves|text|read|check|gcode|plan|report|toolpath|"
                 "picture|all|tail TIMES\n");
    return 2;
  }
  return rmlcell::bench::Main(what.substr(0, colon), what.substr(colon + 1), std::atoi(argv[2]));
}
