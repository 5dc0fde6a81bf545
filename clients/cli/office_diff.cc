#include <nlohmann/json.hpp>

#include "clients/cli/findings_text.h"
#include "clients/cli/office.h"
#include "clients/cli/program_files.h"
#include "clients/cli/terminal.h"
#include "engine/core/number_text.h"
#include "engine/optimo/offline/semantic_diff.h"
#include "engine/optimo/offline/translate.h"
#include "engine/simulation/simulate.h"
#include "proto/bridge/files.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/setup.h"
#include "rmlcell/v1/job.pb.h"

namespace rmlcell::cli {
namespace {

struct Side {
  optimo::Module module;
  std::vector<machine::Figure> figures;  // none when it does not run to its end by itself
};

// Time, lengths and beam of a run from a new machine; a program that calls others, or waits, has none.
std::vector<machine::Figure> FiguresOfRun(const LoadedFiles& loaded) {
  const bridge::SetupInput input{.family = loaded.family, .programs = loaded.programs, .main_program = loaded.main_slot};
  v1::SimulationOptions options;
  options.set_override_percent(100.0);
  v1::Budget budget;
  Result<bridge::SetupOutcome> made = bridge::MakeSetup(input, options, budget);
  if (!made || !made->setup) return {};
  const auto result = simulation::Simulate(*loaded.family, *std::move(made->setup), {});
  if (!result || result->report.outcome.kind != machine::OutcomeKind::kCompleted) return {};
  const simulation::RunReport& report = result->report;
  return {{"cycle_time", "s", ToSeconds(report.cycle_time)},
          {"cut_length", "mm", report.total.cut_mm},
          {"travel_length", "mm", report.total.travel_mm},
          {"beam_on_time", "s", ToSeconds(report.total.beam_on)},
          {"pierces", "", static_cast<double>(report.total.pierces)},
          {"beam_energy", "J", report.total.energy_j()}};
}

// Nothing when it has errors; they are printed.
Result<std::optional<Side>> ReadSide(const std::string& file) {
  const Result<std::string> bytes = bridge::ReadFile(file, kFileBytesMax);
  if (!bytes) return bytes.error();
  const optimo::FileForm form = optimo::FormOfFile(file, *bytes);
  Side side;
  if (form == optimo::FileForm::kObject) {
    Result<optimo::Module> module = optimo::DecodeObject(*bytes);
    if (!module) return module.error();
    side.module = *std::move(module);
  } else {
    optimo::Compilation compiled =
        optimo::Compile(*bytes, file, {.advice = false, .inch = form == optimo::FileForm::kInchSource});
    ComplainOf(compiled.diagnostics, compiled.diagnostics_dropped, *bytes);
    if (!compiled.ok) return std::optional<Side>();
    side.module = std::move(compiled.module);
  }
  const Result<LoadedFiles> loaded = LoadFiles({file}, {}, 0, "optimo");
  if (!loaded) return loaded.error();
  side.figures = FiguresOfRun(*loaded);
  return std::optional<Side>(std::move(side));
}

std::string StepText(int step) { return step > 0 ? std::to_string(step) : "-"; }

void PrintText(const optimo::ProgramDiff& diff) {
  for (const optimo::StepChange& change : diff.steps) {
    Print(Paint("step " + StepText(change.step_a) + " -> " + StepText(change.step_b), Colour::kBold, ColourOnOutput()) +
          "  " + optimo::AspectText(change.aspects));
    if (!change.before.empty()) Print(Paint("  - " + change.before, Colour::kRed, ColourOnOutput()));
    if (!change.after.empty()) Print(Paint("  + " + change.after, Colour::kGreen, ColourOnOutput()));
    for (const std::string& what : change.what) Print("    " + what);
    if (change.target_moved_mm > 0.0) Print("    target moved by " + Fixed(change.target_moved_mm, 3) + " mm");
  }
  for (const optimo::FigureChange& figure : diff.figures) {
    Print(figure.name + "  " + ShortestText(figure.before) + " -> " + ShortestText(figure.after) +
          (figure.unit.empty() ? "" : " " + figure.unit));
  }
  if (diff.equal()) Print("they do the same");
}

void PrintJson(const optimo::ProgramDiff& diff) {
  nlohmann::ordered_json json;
  json["equal"] = diff.equal();
  json["aspects"] = optimo::AspectText(diff.aspects);
  json["steps"] = nlohmann::ordered_json::array();
  for (const optimo::StepChange& change : diff.steps) {
    nlohmann::ordered_json step;
    step["step_a"] = change.step_a;
    step["step_b"] = change.step_b;
    step["aspects"] = optimo::AspectText(change.aspects);
    step["before"] = change.before;
    step["after"] = change.after;
    step["what"] = change.what;
    step["target_moved_mm"] = change.target_moved_mm;
    json["steps"].push_back(std::move(step));
  }
  json["figures"] = nlohmann::ordered_json::array();
  for (const optimo::FigureChange& figure : diff.figures) {
    nlohmann::ordered_json one;
    one["name"] = figure.name;
    one["unit"] = figure.unit;
    one["before"] = figure.before;
    one["after"] = figure.after;
    json["figures"].push_back(std::move(one));
  }
  // Text of a program may have any bytes.
  Print(json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

}  // namespace

int Diff(const std::string& a, const std::string& b, bool json) {
  std::array<std::optional<Side>, 2> sides;
  for (std::size_t i = 0; i < 2; ++i) {
    Result<std::optional<Side>> side = ReadSide(i == 0 ? a : b);
    if (!side) {
      Complain(bridge::ErrorText(side.error()));
      return kUsage;
    }
    if (!*side) return kProgramErrors;
    sides[i] = *std::move(side);
  }
  const bool both_ran = !sides[0]->figures.empty() && !sides[1]->figures.empty();
  const std::vector<machine::Figure> none;
  const optimo::ProgramDiff diff =
      optimo::Diff(sides[0]->module, sides[1]->module, both_ran ? sides[0]->figures : none, both_ran ? sides[1]->figures : none);
  if (json) {
    PrintJson(diff);
  } else {
    PrintText(diff);
    if (!both_ran) Complain("no figures: a program does not run to its end by itself");
  }
  return diff.equal() ? kGood : kProgramErrors;
}

}  // namespace rmlcell::cli
