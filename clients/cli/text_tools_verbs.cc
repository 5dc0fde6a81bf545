#include <unistd.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "clients/cli/place_option.h"
#include "clients/cli/text_tools.h"
#include "clients/cli/verbs.h"
#include "clients/lsp/stdio.h"

namespace rmlcell::cli {
namespace {

CLI::App* FileVerb(CLI::App& app, const char* name, const char* text, const char* examples,
                   const std::shared_ptr<ToolOptions>& arguments, const char* output_text) {
  CLI::App* verb = app.add_subcommand(name, text);
  verb->footer(std::string("Examples:\n") + examples);
  verb->add_option("FILE", arguments->file, "a program")->required();
  verb->add_option("-o,--output", arguments->output, output_text);
  verb->add_flag("--json", arguments->json, kAnswerAsJson);
  return verb;
}

void AddDiff(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<DiffOptions>();
  CLI::App* verb = app.add_subcommand(
      "diff", "Say what two programs do differently: path, time, power, outputs");
  verb->footer(
      "Examples:\n"
      "  rmlcell diff old.S new.S             exit code 1 when they differ\n"
      "  rmlcell diff 12.S 12.O               layout, comments and names do not count\n"
      "  rmlcell diff a.rml b.rml --profile srm-20   motions, depth, speeds and spindle of a mill\n"
      "  rmlcell diff old.S new.S --svg d.svg  both paths: removed, added, common");
  verb->add_option("A", options->before, "a program")->required();
  verb->add_option("B", options->after, "the program it is compared with")->required();
  verb->add_option("--profile", options->machine.profile,
                   "profile of a machine model, such as srm-20 or pw-1993");
  verb->add_option("--machine", options->machine.file,
                   "machine file (TOML): family, profile, [parameters]");
  verb->add_option("--svg", options->svg, "write a picture of both paths, - for standard output");
  verb->add_flag("--json", options->json, "as JSON");
  verb->callback([options, &exit_code] { exit_code = Diff(*options); });
}

}  // namespace

void AddTextToolVerbs(CLI::App& app, int& exit_code) {
  {
    auto arguments = std::make_shared<ToolOptions>();
    auto map = std::make_shared<bool>(false);
    CLI::App* verb = FileVerb(
        app, "compile", "Compile a source to its object",
        "  rmlcell compile 12.S                 writes 12.O\n"
        "  rmlcell compile 12.S --map           and 12.MAP: comments and layout for decompile\n"
        "  rmlcell compile 12.S -o - | xxd      the bytes",
        arguments, "file of the object, - for standard output; default: FILE with .O");
    verb->add_flag("--map", *map, "write a source map beside the object, .MAP for its extension");
    verb->callback([arguments, map, &exit_code] { exit_code = Compile(*arguments, *map); });
  }
  {
    auto arguments = std::make_shared<ToolOptions>();
    FileVerb(app, "decompile",
             "Give the source of an object: its own text where 12.MAP beside it has it",
             "  rmlcell decompile 12.O -o 12.S", arguments,
             "file of the source; default: standard output")
        ->callback([arguments, &exit_code] { exit_code = Decompile(*arguments); });
  }
  {
    auto arguments = std::make_shared<LinkOptions>();
    CLI::App* verb =
        app.add_subcommand("link", "Make the executable of a program with the FUNCTIONs it needs");
    verb->footer(
        "Examples:\n"
        "  rmlcell link 12.S progs/                         writes 12.X; FUNCTIONs from progs/44.S and the like\n"
        "  rmlcell link 12.S --slot 44=f.S -o 112.X && rmlcell put optimo-1 112 112.X");
    verb->add_option("FILES", arguments->files,
                     "the program, then further ones or folders of 44.S ...")
        ->required();
    verb->add_option("--slot", arguments->slots, "44=FILE: a further program")
        ->expected(-1)
        ->allow_extra_args(false);
    verb->add_option("--main", arguments->main_slot, "slot of the program")
        ->check(CLI::Range(1, 99));
    verb->add_option("-o,--output", arguments->output,
                     "file of the executable, - for standard output; default: FILE with .X");
    verb->add_flag("--json", arguments->json, kAnswerAsJson);
    verb->callback([arguments, &exit_code] { exit_code = Link(*arguments); });
  }
  {
    auto options = std::make_shared<FormatOptions>();
    CLI::App* verb =
        app.add_subcommand("format", "Put sources into canonical layout; comments stay");
    verb->footer(
        "Examples:\n"
        "  rmlcell format progs/*.S\n"
        "  rmlcell format --check progs/*.S     names the files that are not; changes none");
    verb->add_option("FILES", options->files, "sources")->required();
    verb->add_flag("--check", options->check_only,
                   "change nothing; exit code 1 when a file is not in canonical layout");
    verb->add_flag("--json", options->json, "one JSON object a file");
    verb->callback([options, &exit_code] { exit_code = Format(*options); });
  }
  {
    auto arguments = std::make_shared<ConvertOptions>();
    CLI::App* verb =
        app.add_subcommand("convert", "Convert a source between inches/degrees and mm/rad");
    verb->footer(
        "Examples:\n"
        "  rmlcell convert part.SI              writes part.S\n"
        "  rmlcell convert part.S -o -          to standard output\n"
        "  rmlcell convert part.S new           writes new.SI\n"
        "  rmlcell convert old.txt new.S /m     another name: say which way");
    verb->add_option("ARGUMENTS", arguments->arguments, "FILE [OUT] [/i or /m]");
    verb->add_option("-o,--output", arguments->output,
                     "file of the result, - for standard output; default: FILE with .SI or .S");
    verb->add_flag("--json", arguments->json, kAnswerAsJson);
    verb->callback([arguments, &exit_code] { exit_code = Convert(*arguments); });
  }
  {
    auto arguments = std::make_shared<ToolOptions>();
    FileVerb(app, "compensate",
             "Offset the path by the beam's radius, as the ;$ directives of the source say",
             "  rmlcell compensate part.S            writes part.CMP", arguments,
             "file of the result, - for standard output; default: FILE with .CMP")
        ->callback([arguments, &exit_code] { exit_code = Compensate(*arguments); });
  }
  {
    auto options = std::make_shared<TransformOptions>();
    CLI::App* verb =
        FileVerb(app, "transform", "Move and turn a program, head angles included",
                 "  rmlcell transform part.S --move 100,0,0 -o moved.S\n"
                 "  rmlcell transform part.S --turn 1.570796,0,0 -o turned.S\n"
                 "  rmlcell transform part.S --shift 1,0,0,0,0,0     adds to VR[86] to VR[91]",
                 options, "file of the result; default: standard output");
    AddPlace(*verb, "--move", "X,Y,Z in mm", 3, 3, options->move);
    AddPlace(*verb, "--turn", "angles about Z,Y,X in rad", 3, 3, options->turn);
    AddPlace(*verb, "--shift", "X,Y,Z,rz,ry,rx: add to VR[86] to VR[91] instead", 6, 6,
             options->shift);
    verb->callback([options, &exit_code] { exit_code = Transform(*options); });
  }
  {
    auto arguments = std::make_shared<ToolOptions>();
    FileVerb(app, "list",
             "List a program with line numbers and step numbers as the control counts them",
             "  rmlcell list 12.S", arguments, "file of the list; default: standard output")
        ->callback([arguments, &exit_code] { exit_code = List(*arguments); });
  }
  AddDiff(app, exit_code);
  {
    CLI::App* verb = app.add_subcommand(
        "lsp", "Serve an editor: findings, fixes, hover, jumps, names (language server protocol)");
    verb->footer(
        "Examples:\n"
        "  rmlcell lsp                          on standard input and output; editors start it\n"
        "clients/vscode has an extension; any editor with a language server client will do.");
    auto stdio = std::make_shared<bool>(false);
    verb->add_flag("--stdio", *stdio, "accepted: standard input and output are what it serves on");
    verb->callback(
        [stdio, &exit_code] { exit_code = lsp::RunOnDescriptors(STDIN_FILENO, STDOUT_FILENO); });
  }
}

}  // namespace rmlcell::cli
