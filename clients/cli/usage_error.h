#pragma once

#include <string>

namespace CLI {
class App;
class Error;
}  // namespace CLI

namespace rmlcell::cli {

// What is wrong with a command line that could not be read, and what it may have meant:
// "simulate has no option --stok; did you mean --stock? (rmlcell simulate --help)". `app` is the
// whole command, as it stands after the parse.
std::string UsageText(const CLI::App& app, const CLI::Error& error);

// "there is no verb 'chek'; did you mean check? (rmlcell --help)". `verbs`: the command whose verb
// it should be.
std::string NoSuchVerb(const CLI::App& verbs, const std::string& word);

}  // namespace rmlcell::cli
