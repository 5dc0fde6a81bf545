#include <algorithm>
#include <array>
#include <cctype>

#include "clients/cli/findings_text.h"
#include "clients/cli/messages.h"
#include "clients/cli/program_files.h"
#include "clients/cli/terminal.h"
#include "clients/cli/text_tools.h"
#include "engine/core/letters.h"
#include "engine/core/number_text.h"
#include "engine/families/families.h"
#include "proto/bridge/comparison.h"
#include "proto/bridge/findings.h"

namespace rmlcell::cli {
namespace {

using Response = v1::DiffProgramsResponse;

Result<bridge::ComparedProgram> ReadProgram(const std::string& file) {
  const auto family = families::FamilyThatCompares(file);
  if (!family) return family.error();
  const Result<LoadedFiles> loaded = LoadFiles({file}, {}, 0, std::string((*family)->info().id));
  if (!loaded) return loaded.error();
  return bridge::ComparedProgram{
      .file_name = file, .bytes = loaded->programs.front().bytes, .slot = loaded->main_slot};
}

// "path, time"
std::string AspectText(const google::protobuf::RepeatedField<int>& aspects) {
  std::string text;
  for (const int aspect : aspects) {
    const std::string name =
        v1::DiffAspect_Name(aspect).substr(std::string_view("DIFF_ASPECT_").size());
    text += (text.empty() ? "" : ", ") + LowerCase(name);
  }
  return text;
}

// For people: three decimals, or as many as it takes to tell the two apart; whole numbers without
// any.
std::array<std::string, 2> FigureTexts(double before, double after) {
  std::array<std::string, 2> texts;
  for (int decimals = 3; decimals <= 12 && texts[0] == texts[1]; decimals += 3)
    texts = {TrimmedText(before, decimals), TrimmedText(after, decimals)};
  for (std::string& text : texts) {
    if (text.ends_with(".0")) text.resize(text.size() - 2);
  }
  return texts;
}

std::string StepText(int step) { return step > 0 ? std::to_string(step) : "-"; }

void PrintText(const Response& diff) {
  const bool colour = ColourOnOutput();
  for (const Response::StepChange& change : diff.steps()) {
    Print(Paint("step " + StepText(change.step_before()) + " -> " + StepText(change.step_after()),
                Colour::kBold, colour) +
          "  " + AspectText(change.aspects()));
    if (!change.before().empty()) Print(Paint("  - " + change.before(), Colour::kRed, colour));
    if (!change.after().empty()) Print(Paint("  + " + change.after(), Colour::kGreen, colour));
    for (const std::string& what : change.what()) Print("    " + what);
    if (change.target_moved_mm() > 0.0) {
      Print("    target moved by " + Fixed(change.target_moved_mm(), 3) + " mm");
    }
  }
  if (diff.steps_dropped() > 0)
    Print("and " + std::to_string(diff.steps_dropped()) + " more steps");
  // Times and lengths are those of a machine.
  const machine::MachineFamily* family = families::FindFamily(diff.family());
  if (family != nullptr && !diff.figures().empty()) PrintRaw(MachineRows(*family, diff));
  for (const Response::FigureChange& figure : diff.figures()) {
    const auto [before, after] = FigureTexts(figure.before(), figure.after());
    Print(figure.name() + "  " + before + " -> " + after +
          (figure.unit().empty() ? "" : " " + figure.unit()));
  }
  if (diff.equal()) Print("they do the same");
}

}  // namespace

int Diff(const DiffOptions& options) {
  const std::array<std::string, 2> files = {options.before, options.after};
  std::array<bridge::ComparedProgram, 2> programs;
  for (std::size_t i = 0; i < 2; ++i) {
    Result<bridge::ComparedProgram> program = ReadProgram(files[i]);
    if (!program) return Refuse(program.error());
    programs[i] = *std::move(program);
  }
  const Result<bridge::MachineFile> machine = ReadMachine(options.machine);
  if (!machine) return Refuse(machine.error());
  const Result<bridge::ComparisonOutcome> made =
      bridge::ComparePrograms(programs[0], programs[1],
                              {.picture = !options.svg.empty(),
                               .profile = machine->profile,
                               .parameters = machine->parameters,
                               .parameters_of = ParametersOf(options.machine),
                               .own = OwnOf(options.machine, *machine)});
  if (!made) return Refuse(made.error());
  for (std::size_t i = 0; i < 2; ++i)
    ComplainOf(made->diagnostics[i], made->dropped[i], *programs[i].bytes);
  if (!made->ok) return kProgramErrors;
  const Response& diff = made->response;
  if (!options.svg.empty() && options.svg != "-") {
    if (const Status written = WriteWholeFile(options.svg, diff.picture_svg()); !written) {
      return Refuse(written.error());
    }
  }
  if (options.svg == "-") {
    PrintRaw(diff.picture_svg());  // in place of the text: it is to be a file of its own
  } else if (options.json) {
    Print(Json(diff));
  } else {
    PrintText(diff);
  }
  if (options.json) return diff.equal() ? kGood : kProgramErrors;
  const bool none = !diff.compared_runs();
  if (none && diff.notes().empty()) Complain("no figures: a program cannot run by itself");
  for (const std::string& note : diff.notes()) {
    Complain(none ? "no figures: " + note + "; what they do is compared to the end of both" : note);
  }
  return diff.equal() ? kGood : kProgramErrors;
}

}  // namespace rmlcell::cli
