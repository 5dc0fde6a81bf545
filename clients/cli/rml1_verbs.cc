#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clients/cli/place_option.h"
#include "clients/cli/rml1_tools.h"
#include "clients/cli/verbs.h"

namespace rmlcell::cli {
namespace {

// A verb that reads a file for one machine.
CLI::App* MillVerb(CLI::App& group, const char* name, const char* text, const std::string& examples,
                   const std::shared_ptr<MillToolOptions>& options, const char* file_text) {
  CLI::App* verb = group.add_subcommand(name, text);
  verb->footer("Examples:\n" + examples);
  verb->add_option("FILE", options->file, file_text)->required();
  verb->add_option("--profile", options->machine.profile,
                   "profile of a mill, such as srm-20 or mdx-20");
  verb->add_option("--machine", options->machine.file,
                   "machine file (TOML): family, profile, [parameters]");
  AddPlace(*verb, "--origin",
           "X,Y or X,Y,Z of the work origin on the machine, mm; default: as the profile has it", 2,
           3, options->machine.origin);
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
  verb.add_flag("--force", options->force,
                "write it although the machine would leave out a part of it");
  verb.add_flag("--json", options->json, kAnswerAsJson);
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

constexpr const char* kStreamOutput =
    "file of the stream, - for standard output; default: standard output";

void AddRewriting(CLI::App& group, int& exit_code) {
  auto move = std::make_shared<MoveToolOptions>();
  CLI::App* verb =
      MillVerb(group, "move", "Move the work of a stream to another place; all other bytes stay",
               "  rmlcell rml1 move part.rml --by 10,20 -o moved.rml\n"
               "  rmlcell rml1 move part.rml --by -5,0,-0.2 --profile mdx-20 -o moved.rml",
               move, "a stream");
  AddPlace(*verb, "--by", "X,Y or X,Y,Z in mm, rounded to units of the machine", 2, 3, move->by_mm)
      ->required();
  AddOutput(*verb, move, kStreamOutput);
  verb->callback([move, &exit_code] { exit_code = MoveMillStream(*move); });

  auto steps = std::make_shared<StepsToolOptions>();
  verb = MillVerb(
      group, "steps", "Convert a stream between machines of different step sizes",
      "  rmlcell rml1 steps mdx.rml --from 40 --to 100 -o srm.rml    40 units in a mm to 100",
      steps, "a stream");
  verb->add_option("--from", steps->from, "units in a mm of the stream: 40 or 100")->required();
  verb->add_option("--to", steps->to, "units in a mm of what is written")->required();
  AddOutput(*verb, steps, kStreamOutput);
  verb->callback([steps, &exit_code] { exit_code = ScaleMillStream(*steps); });

  auto tile = std::make_shared<TileToolOptions>();
  verb = MillVerb(
      group, "tile", "Repeat a stream in columns and rows, within the travel",
      "  rmlcell rml1 tile part.rml --columns 3 --rows 2 --gap 2 --profile srm-20 -o six.rml\n"
      "  rmlcell rml1 tile part.rml --within 150x100 --gap 4 --profile srm-20 -o sheet.rml",
      tile, "a stream");
  CLI::Option* columns = verb->add_option("--columns", tile->columns, "copies in X; default 1");
  CLI::Option* rows = verb->add_option("--rows", tile->rows, "copies in Y; default 1");
  verb->add_option(
          "--within", tile->within,
          "150x100: as many copies as have room in a field of so many mm, from the first one "
          "to the right and to the back; the paths count, so take off the width of the tool")
      ->excludes(columns)
      ->excludes(rows);
  verb->add_option("--gap", tile->gap_mm,
                   "mm between the paths of two copies, so more than the tool; default 1");
  AddOutput(*verb, tile, kStreamOutput);
  verb->callback([tile, &exit_code] { exit_code = TileMillStream(*tile); });
}

void AddPng(CLI::App& group, int& exit_code) {
  auto options = std::make_shared<PngToolOptions>();
  rml1::BoardOptions& board = options->board;
  CLI::App* verb = MillVerb(
      group, "from-png",
      "Make a stream that mills a circuit board, of a picture in black and white",
      "  rmlcell rml1 from-png traces.png --profile srm-20 --tool 0.4 --depth 0.1 --passes 4\n"
      "  rmlcell rml1 from-png outline.png --profile srm-20 --tool 1 --depth 1.7 --step 0.6 --outline\n"
      "  rmlcell rml1 from-png traces.png --profile mdx-20 --tool 0.4 --depth 0.1 --dpi 1000 --at 10,10\n\n"
      "White is copper, or the board with --outline; black is milled. No copper is cut away: lines keep\n"
      "the radius of the tool from it, and a little more (docs/boards.md).",
      options, "a PNG");
  verb->add_option("--tool", board.tool_mm, "diameter where it cuts, mm")->required();
  verb->add_option("--depth", board.depth_mm, "below Z 0, mm")->required();
  verb->add_option("--step", board.step_mm, "of the depth at a time, mm; default: all at once");
  CLI::Option* passes = verb->add_option("--passes", board.passes,
                                         "lines around the copper, side by side; default 1");
  CLI::Option* overlap = verb->add_option(
      "--overlap", board.overlap, "of neighbouring passes, share of the diameter; default 0.5");
  verb->add_flag("--outline", board.outline, "cut the board out: once around it, holes first")
      ->excludes(passes)
      ->excludes(overlap);
  verb->add_option("--dpi", options->dpi, "pixels an inch; default: as the PNG says");
  AddPlace(*verb, "--at", "X,Y in mm of the lower left corner of the picture; default 0,0", 2, 2,
           options->at_mm);
  verb->add_option("--feed", board.feed_mm_s, "mm/s around the copper; default 4");
  verb->add_option("--plunge", board.plunge_mm_s, "mm/s into the work; default 1");
  verb->add_option("--rpm", board.rpm, "of the spindle; default: as the machine has it");
  verb->add_option("--clearance", board.clearance_mm, "mm above the work between lines; default 2");
  verb->add_option("--tolerance", board.tolerance_mm, "mm of points left out; default 0.005");
  verb->add_flag("--invert", options->invert, "black is copper");
  AddOutput(*verb, options, "file of the stream, - for standard output; default: FILE with .rml");
  verb->callback([options, &exit_code] { exit_code = StreamFromPng(*options); });
}

}  // namespace

void AddRml1Verbs(CLI::App& app, int& exit_code) {
  CLI::App* group = app.add_subcommand(
      "rml1", "Tools for streams of Roland mills: in words, from and to G-code, moved, repeated");
  group->footer(
      "Examples:\n"
      "  rmlcell rml1 explain part.rml --profile srm-20     each command in words\n"
      "  rmlcell rml1 from-gcode part.nc --profile srm-20   a stream of what a CAM tool wrote\n"
      "  rmlcell rml1 from-png traces.png --tool 0.4 --depth 0.1 --profile srm-20\n"
      "  rmlcell rml1 tile part.rml --columns 3 --gap 2 -o three.rml");
  group->require_subcommand(1);
  AddExplain(*group, exit_code);
  AddGcode(*group, exit_code);
  AddRewriting(*group, exit_code);
  AddPng(*group, exit_code);
}

}  // namespace rmlcell::cli
