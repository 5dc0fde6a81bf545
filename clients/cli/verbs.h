#pragma once

namespace CLI {
class App;
}

namespace rmlcell::cli {

// The wiring of the command line, by groups of verbs. What runs leaves its exit code.
void AddTextToolVerbs(CLI::App& app, int& exit_code);

}  // namespace rmlcell::cli
