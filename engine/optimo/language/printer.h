#pragma once

#include <string>
#include <string_view>

#include "engine/optimo/language/ast.h"

// A module as canonical source (OPT-B.39, OPT-B.40): decompiler and formatter.
namespace rmlcell::optimo {

inline constexpr std::size_t kLabelColumns = 5;  // the statement begins in column 6

// The statement in canonical form, without its sequence number and line end. Names print as names,
// whether they are resolved or not.
void PrintStatement(const Module& module, const Instruction& instruction, std::string& out);

// The expression, parentheses only where the priority needs them.
void PrintExpression(const Module& module, Expression expression, std::string& out);

// Five columns: "10   ", or blanks when there is no number.
void PrintLabelColumns(int label, std::string& out);
inline constexpr int kNoLabel = -1;

// The shortest decimal form that reads back to the same single precision value, with at least one
// decimal; an exponent only below 1E-4 and above 1E7. OPT-B.39
void PrintReal(float value, std::string& out);

// Parentheses and functions inside each other when the expression is printed; the parser's measure.
// `in_tcp`: a division outside parentheses gets some (OPT-B.85).
int PrintedNesting(Expression expression, bool in_tcp);

std::string_view FunctionName(Node node);  // "SIN"

}  // namespace rmlcell::optimo
