#pragma once

namespace CLI {
class App;
}

namespace rmlcell::cli {

struct Remote;

// Help of --json where a verb makes something.
inline constexpr const char* kAnswerAsJson = "answer and findings as one JSON object";

// The wiring of the command line, by groups of verbs. What runs leaves its exit code.
void AddTextToolVerbs(CLI::App& app, int& exit_code);
void AddRml1Verbs(CLI::App& app, int& exit_code);  // `rmlcell rml1 ...`: tools for mills
// `rmlcell special`: programs that the product ships for a machine.
void AddSpecialVerb(CLI::App& app, Remote& remote, int& exit_code);
// `rmlcell machine ...`: machines that live.
void AddMachineVerbs(CLI::App& app, Remote& remote, int& exit_code);

}  // namespace rmlcell::cli
