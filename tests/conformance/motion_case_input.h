#pragma once

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "engine/core/number_text.h"
#include "engine/motion/geometry/frames.h"

// How the inputs of reference cases are read. Members that are missing or of another type throw
// nlohmann::json::exception.
namespace rmlcell::motion {

// A case that no machine could have.
struct SenselessCase : std::runtime_error {
  using std::runtime_error::runtime_error;
};

inline MachineVector PointOf(const nlohmann::json& j) {
  return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()};
}

inline double NumberOf(const nlohmann::json& input, const char* name) {
  return input.at(name).get<double>();
}
inline double NumberOr(const nlohmann::json& input, const char* name, double standard) {
  return input.contains(name) ? NumberOf(input, name) : standard;
}
inline double PositiveOf(const nlohmann::json& input, const char* name) {
  const double value = NumberOf(input, name);
  if (!(value > 0.0))
    throw SenselessCase(std::string(name) + " is " + ShortestText(value) +
                        ": it has to be above 0");
  return value;
}

inline double NotBelowZero(double value, const char* name) {
  if (!(value >= 0.0))
    throw SenselessCase(std::string(name) + " is " + ShortestText(value) + ": it is 0 or above");
  return value;
}

inline std::string Numbered(std::string name, std::size_t number) {
  return name.append(std::to_string(number));
}

}  // namespace rmlcell::motion
