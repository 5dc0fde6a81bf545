#include "clients/cli/place_option.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <optional>
#include <ranges>
#include <string>
#include <string_view>

#include "engine/core/number_text.h"

namespace rmlcell::cli {

CLI::Option* AddPlace(CLI::App& verb, const char* name, const char* text, std::size_t numbers_min,
                      std::size_t numbers_max, std::vector<double>& into) {
  const auto take = [name, text, numbers_min, numbers_max, &into](const std::string& given) {
    into.clear();
    for (const auto letters : std::views::split(given, ',')) {
      const auto number = ParseDouble(std::string_view(letters.begin(), letters.end()));
      if (!number || !std::isfinite(*number))
        throw CLI::ValidationError(name, "'" + given + "' is no list of numbers");
      into.push_back(*number);
    }
    if (into.size() < numbers_min || into.size() > numbers_max)
      throw CLI::ValidationError(name, "'" + given + "': give " + text);
  };
  return verb.add_option_function<std::string>(name, take, text);
}

}  // namespace rmlcell::cli
