#pragma once

#include <cstdint>
#include <random>
#include <string>

namespace rmlcell::optimo {

// Writes valid programs of every instruction, attribute and literal form, with odd layout. The same
// seed gives the same program on every platform: no library distribution is used.
class RandomProgram {
 public:
  explicit RandomProgram(std::uint32_t seed) : random_(seed) {}
  std::string Make(int statements);

 private:
  std::uint32_t Below(std::uint32_t bound) { return static_cast<std::uint32_t>(random_()) % bound; }
  std::string Statement();
  std::string Number();
  std::string Whole(std::uint32_t bound) { return std::to_string(Below(bound)); }
  std::string NumericVariable();
  std::string LogicalVariable();
  std::string Numeric(int depth);
  std::string Logical(int depth);
  std::string List(int count, int depth);
  std::string Label();
  std::string MoveAttributes();
  std::string Gap();  // blanks, or a line break where one is allowed

  std::mt19937 random_;
  int label_ = 0;
  int names_ = 0;
  std::string declared_;
};

}  // namespace rmlcell::optimo
