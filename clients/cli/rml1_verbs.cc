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

}  // namespace

void AddRml1Verbs(CLI::App& app, int& exit_code) {
  CLI::App* group = app.add_subcommand(
      "rml1", "Tools for streams of Roland mills: in words, from and to G-code, moved, repeated");
  group->footer(
      "Examples:\n"
      "  rmlcell rml1 explain part.rml --profile srm-20     each command in words");
  group->require_subcommand(1);
  AddExplain(*group, exit_code);
}

}  // namespace rmlcell::cli
