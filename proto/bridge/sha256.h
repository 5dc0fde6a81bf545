#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace rmlcell::bridge {

// SHA-256 of bytes that come in parts.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void Add(std::string_view bytes);
  std::string Hex();  // lower case; once

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

std::string Sha256Hex(std::string_view bytes);

// A digest that a client wrote, in lower case; nothing for what is not 64 hexadecimal digits.
std::optional<std::string> ReadSha256(std::string_view text);

}  // namespace rmlcell::bridge
