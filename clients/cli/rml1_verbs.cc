#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "clients/cli/rml1_tools.h"
#include "clients/cli/verbs.h"

namespace rmlcell::cli {
namespace {

constexpr const char* kJsonText = "answer and findings as one JSON object";

// A verb that reads a file for one machine.
CLI::App* MillVerb(CLI::App& group, const char* name, const char* text, const std::string& examples,
                   const std::shared_ptr<MillToolOptions>& options, const char* file_text) {
  CLI::App* verb = group.add_subcommand(name, text);
  verb->footer("Examples:\n" + examples);
  verb->add_option("FILE", options->file, file_text)->required();
  verb->add_option("--profile", options->profile, "named mill, such as srm-20 or mdx-20");
  verb->add_option("--machine", options->machine_file,
                   "machine file (TOML): family, profile, [parameters]");
  return verb;
}

void AddExplain(CLI::App& group, int& exit_code) {
  auto options = std::make_shared<MillToolOptions>();
  CLI::App* verb = MillVerb(group, "explain",
                            "Tell a stream in words: each command with its place and what it does",
                            "  rmlcell rml1 explain part.rml --profile srm-20\n"
                            "  rmlcell rml1 explain part.rml --profile mdx-20 | less\n"
                            "  rmlcell rml1 explain part.rml --json | jq -c .words",
                            options, "a stream");
  verb->add_flag("--json", options->json, "one JSON object a line");
  verb->callback([options, &exit_code] { exit_code = ExplainStream(*options); });
}

void AddOutput(CLI::App& verb, const std::shared_ptr<MillToolOptions>& options, const char* text) {
  verb.add_option("-o,--output", options->output, text);
  verb.add_flag("--json", options->json, kJsonText);
}

void AddGcode(CLI::App& group, int& exit_code) {
  auto to = std::make_shared<MillToolOptions>();
  CLI::App* verb = MillVerb(
      group, "to-gcode", "Write what the mill does with a stream as G-code (docs/gcode.md)",
      "  rmlcell rml1 to-gcode part.rml --profile srm-20          writes part.nc\n"
      "  rmlcell rml1 to-gcode part.rml --profile mdx-20 -o -     to standard output",
      to, "a stream");
  AddOutput(*verb, to, "file of the G-code, - for standard output; default: FILE with .nc");
  verb->callback([to, &exit_code] { exit_code = StreamToGcode(*to); });

  auto from = std::make_shared<FromGcodeToolOptions>();
  verb = MillVerb(group, "from-gcode",
                  "Make a stream of G-code: lines and arcs, absolute, one tool (docs/gcode.md)",
                  "  rmlcell rml1 from-gcode part.nc --profile srm-20         writes part.rml\n"
                  "  rmlcell rml1 from-gcode part.nc --profile mdx-40a --tolerance 0.002 -o p.rml",
                  from, "a program in G-code");
  AddOutput(*verb, from, "file of the stream, - for standard output; default: FILE with .rml");
  verb->add_option("--tolerance", from->tolerance_mm,
                   "of the chords of an arc from the arc, mm; default 0.01");
  verb->callback([from, &exit_code] { exit_code = StreamFromGcode(*from); });
}

}  // namespace

void AddRml1Verbs(CLI::App& app, int& exit_code) {
  CLI::App* group = app.add_subcommand(
      "rml1", "Tools for streams of Roland mills: in words, from and to G-code, moved, repeated");
  group->footer(
      "Examples:\n"
      "  rmlcell rml1 explain part.rml --profile srm-20     each command in words\n"
      "  rmlcell rml1 from-gcode part.nc --profile srm-20   a stream of what a CAM tool wrote");
  group->require_subcommand(1);
  AddExplain(*group, exit_code);
  AddGcode(*group, exit_code);
}

}  // namespace rmlcell::cli
