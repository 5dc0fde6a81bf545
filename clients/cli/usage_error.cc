#include "clients/cli/usage_error.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ranges>
#include <string_view>
#include <vector>

#include "clients/cli/terminal.h"
#include "engine/core/near_words.h"

namespace rmlcell::cli {
namespace {

std::string Question(const std::string& word, const std::vector<std::string>& known) {
  const std::vector<std::string_view> candidates(known.begin(), known.end());
  return DidYouMean(NearestTo(word, candidates).words);
}

// "simulate", "rml1 tile": without the name of the command itself.
std::string PathOf(const CLI::App& verb) {
  std::string path;
  for (const CLI::App* at = &verb; at->get_parent() != nullptr; at = at->get_parent())
    path = at->get_name() + (path.empty() ? "" : " ") + path;
  return path;
}

std::string HelpOf(const CLI::App& verb) {
  const std::string path = PathOf(verb);
  return " (rmlcell " + path + (path.empty() ? "" : " ") + "--help)";
}

// The verb that was meant: the last one that was recognised.
const CLI::App& VerbOf(const CLI::App& app) {
  const CLI::App* verb = &app;
  for (;;) {
    const std::vector<const CLI::App*> inside =
        verb->get_subcommands([](const CLI::App* one) { return one->parsed(); });
    if (inside.empty()) return *verb;
    verb = inside.front();
  }
}

// With those of the verb that it stands in, where that takes them, too.
std::vector<std::string> OptionsOf(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const CLI::App* at = &verb; at != nullptr && at->get_parent() != nullptr;
       at = at->get_fallthrough() ? at->get_parent() : nullptr) {
    for (const CLI::Option* option : at->get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
  }
  return names;
}

// "Could not convert: SLOT = x" of the library: where only numbers are converted.
std::string NoNumber(const std::string& text) {
  const std::size_t colon = text.find(": ");
  const std::size_t equals = text.find(" = ", colon);
  if (colon == std::string::npos || equals == std::string::npos) return text;
  return text.substr(colon + 2, equals - colon - 2) + ": '" + text.substr(equals + 3) +
         "' is no number";
}

// "--kind: simlate not in {simulate,check}" of the library.
std::string NoneOf(const std::string& text) {
  const std::size_t colon = text.find(": ");
  const std::size_t list = text.find(" not in {");
  if (colon == std::string::npos || list == std::string::npos || text.back() != '}') return text;
  const std::string word = text.substr(colon + 2, list - colon - 2);
  const std::string_view known(text.data() + list + 9, text.size() - list - 10);
  std::vector<std::string> words;
  std::string list_of_words;
  for (const auto letters : std::views::split(known, ',')) {
    words.emplace_back(letters.begin(), letters.end());
    list_of_words += (list_of_words.empty() ? "" : ", ") + words.back();
  }
  return text.substr(0, colon + 2) + "'" + word + "' is none of " + list_of_words +
         Question(word, words);
}

// What an option wants, which the library only counts: "--samples: RATE FILE: write where ...".
std::string Wants(const CLI::App& verb, const std::string& text) {
  const std::string name = text.substr(0, text.find(':'));
  for (const CLI::Option* option : verb.get_options()) {
    if (option->check_name(name)) return name + " wants more: " + option->get_description();
  }
  return text;
}

std::vector<std::string> VerbsOf(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(verb->get_name());
  return names;
}

}  // namespace

std::string NoSuchVerb(const CLI::App& verbs, const std::string& word) {
  return (PathOf(verbs).empty() ? "there is no verb '" : PathOf(verbs) + " has no verb '") +
         Visible(word) + "'" + Question(word, VerbsOf(verbs)) + HelpOf(verbs);
}

std::string UsageText(const CLI::App& app, const CLI::Error& error) {
  const CLI::App& verb = VerbOf(app);
  const std::vector<std::string> left = app.remaining(true);
  const auto option =
      std::ranges::find_if(left, [](const std::string& word) { return word.starts_with('-'); });
  if (option != left.end()) {
    const std::string name = option->substr(0, option->find('='));
    const std::vector<std::string> options = OptionsOf(verb);
    if (std::ranges::find(options, name) != options.end())
      return name + " stands behind the verb: rmlcell " + PathOf(verb) + " " + name + HelpOf(verb);
    return (PathOf(verb).empty() ? "rmlcell" : PathOf(verb)) + " has no option " + Visible(name) +
           Question(name, options) + HelpOf(verb);
  }
  if (!left.empty() && !VerbsOf(verb).empty()) return NoSuchVerb(verb, left.front());
  if (!left.empty()) {
    return PathOf(verb) + " does not know what to do with '" + Visible(left.front()) + "'" +
           HelpOf(verb);
  }
  std::string text = error.what();
  if (error.get_name() == "ConversionError") text = NoNumber(text);
  if (error.get_name() == "ValidationError") text = NoneOf(text);
  if (error.get_name() == "ArgumentMismatch") text = Wants(verb, text);
  const std::vector<std::string> verbs = VerbsOf(verb);
  if (error.get_name() == "RequiredError" && !verbs.empty()) {
    constexpr std::size_t kFew = 12;  // more of them are read in the help
    text = (PathOf(verb).empty() ? "rmlcell" : PathOf(verb)) + " needs a verb";
    for (std::size_t i = 0; verbs.size() <= kFew && i < verbs.size(); ++i)
      text += (i == 0 ? ": " : ", ") + verbs[i];
  }
  return Visible(text) + HelpOf(verb);
}

}  // namespace rmlcell::cli
