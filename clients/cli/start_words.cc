#include "clients/cli/start_words.h"

#include <algorithm>

#include "clients/cli/machine_call.h"
#include "clients/cli/messages.h"
#include "engine/core/letters.h"
#include "engine/core/number_text.h"

namespace rmlcell::cli {

std::optional<v1::StepPlace> StepOf(const std::string& text) {
  const std::size_t slash = text.find('/');
  const auto step = ParseInteger(slash == std::string::npos ? text : text.substr(slash + 1));
  const auto program = slash == std::string::npos ? std::optional<long long>(0)
                                                  : ParseInteger(text.substr(0, slash));
  if (!step || !program || *step < 1 || *step > INT32_MAX || *program < 0 || *program > 99)
    return std::nullopt;
  v1::StepPlace place;
  place.set_program(static_cast<int>(*program));
  place.set_step(static_cast<int>(*step));
  return place;
}

std::string SeenName(v1::Confirmation confirmation) {
  std::string name = Short(v1::Confirmation_Name(confirmation), "CONFIRMATION_");
  std::ranges::transform(name, name.begin(), [](char c) { return c == '_' ? '-' : LowerCase(c); });
  return name;
}

std::optional<v1::Confirmation> ConfirmationOf(const std::string& seen) {
  for (int one = v1::Confirmation_MIN + 1; one <= v1::Confirmation_MAX; ++one) {
    if (v1::Confirmation_IsValid(one) && SeenName(static_cast<v1::Confirmation>(one)) == seen)
      return static_cast<v1::Confirmation>(one);
  }
  return std::nullopt;
}

}  // namespace rmlcell::cli
