#pragma once

#include <array>
#include <string_view>

namespace rmlcell::optimo {

// A second opinion on expressions: reads the text of one by the grammar of optimo.md B.9 and works
// it out on the way, without the engine's lexer, parser, tree or arithmetic. Only for text without
// errors of syntax or type.
struct ReferenceVariables {
  std::array<float, 10> vr{};
  std::array<float, 10> vi{};
  std::array<float, 10> vl{};
};

struct ReferenceValue {
  float number = 0.0F;  // logical: 0 or 1
  int error = 0;        // 7201, 7202 or 7204: the first one from the left
  bool understood = true;
};

ReferenceValue EvaluateText(std::string_view text, const ReferenceVariables& variables);

}  // namespace rmlcell::optimo
