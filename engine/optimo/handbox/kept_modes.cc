#include <algorithm>
#include <string>
#include <vector>

#include "engine/core/number_text.h"
#include "engine/optimo/handbox/optimo_handbox.h"

// What the handbox keeps, as a line of numbers.
namespace rmlcell::optimo {
namespace {

constexpr std::size_t kNumbers = 8;

}  // namespace

std::string OptimoHandbox::Save() const {
  if (modes_ == HandboxModes()) return {};
  const auto number = [](auto value) { return std::to_string(static_cast<int>(value)) + " "; };
  return number(modes_.beeps) + number(modes_.reference) + number(modes_.coord) +
         number(modes_.path) + number(modes_.fly) + ShortestText(modes_.radius_mm) + " " +
         ShortestText(modes_.speed_percent) + " " + ShortestText(modes_.oversh_percent);
}

Result<HandboxModes> OptimoHandbox::ReadModes(std::string_view saved) {
  HandboxModes modes;
  if (saved.empty()) return modes;
  const Error bad{ErrorCode::kCellBadText, "this is no state of a handbox of this version", {}};
  std::vector<double> numbers;
  while (!saved.empty() && numbers.size() <= kNumbers) {
    const std::size_t end = std::min(saved.find(' '), saved.size());
    const std::optional<double> number = ParseDouble(saved.substr(0, end));
    if (!number) return bad;
    numbers.push_back(*number);
    saved.remove_prefix(std::min(end + 1, saved.size()));
  }
  if (numbers.size() != kNumbers) return bad;
  const auto choice = [&numbers](std::size_t i, int last) {
    const double value = numbers[i];
    return value >= 0.0 && value <= last && value == static_cast<int>(value);
  };
  const auto share = [&numbers](std::size_t i) { return numbers[i] >= 0.0 && numbers[i] <= 100.0; };
  if (!choice(0, 1) || !choice(1, 2) || !choice(2, 1) || !choice(3, 3) || !choice(4, 1) ||
      numbers[5] < 0.0 || !share(6) || !share(7))
    return bad;
  modes.beeps = numbers[0] == 1.0;
  modes.reference = static_cast<machine::JogReference>(static_cast<int>(numbers[1]));
  modes.coord = static_cast<CoordType>(static_cast<int>(numbers[2]));
  modes.path = static_cast<PathType>(static_cast<int>(numbers[3]));
  modes.fly = numbers[4] == 1.0;
  modes.radius_mm = numbers[5];
  modes.speed_percent = numbers[6];
  modes.oversh_percent = numbers[7];
  return modes;
}

}  // namespace rmlcell::optimo
