#include "proto/bridge/header_date.h"

#include <array>
#include <chrono>
#include <ctime>

namespace rmlcell::bridge {

std::string HeaderDate() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm local{};
  localtime_r(&now, &local);
  // The names of strftime follow the locale of the process, which nobody sets: "C".
  std::array<char, 40> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), "%a %b %d %H:%M:%S %Y", &local);
  return {text.data(), size};
}

}  // namespace rmlcell::bridge
