#pragma once

#include <string>

namespace rmlcell::machine {

enum class VariableKind {
  kReal,
  kInteger,
  kLogical,  // the text is "1" or "0", or "on" or "off"
  kWord,     // one of a few words, or several numbers
};

// What a variable of a control or a register of a mill holds, as its family writes it.
struct VariableValue {
  VariableKind kind = VariableKind::kReal;
  std::string text{};

  bool operator==(const VariableValue&) const = default;
};

struct NamedVariable {
  std::string name{};  // "VR[5]"
  VariableValue value{};

  bool operator==(const NamedVariable&) const = default;
};

}  // namespace rmlcell::machine
