#include "tests/engine/optimo/language/random_program.h"

#include <array>

namespace rmlcell::optimo {

std::string RandomProgram::Gap() {
  constexpr std::array<const char*, 5> kGaps = {"", " ", "  ", "\t", " \n   "};
  return kGaps[Below(20) == 0 ? 4 : Below(4)];
}

std::string RandomProgram::Number() {
  const std::string sign = Below(4) == 0 ? "-" : "";
  switch (Below(6)) {
    case 0:
      return sign + Whole(32768);
    case 1:
      return sign + Whole(1000) + ".";
    case 2:
      return sign + "." + std::to_string(1 + Below(99999));
    case 3:
      return sign + Whole(5000) + "." + Whole(1000000);
    case 4:
      return sign + Whole(10) + "." + Whole(1000) + " E " + (Below(2) == 0 ? "-" : "+") + Whole(10);
    default:
      return sign + std::to_string(40000 + Below(900000));
  }
}

std::string RandomProgram::NumericVariable() {
  constexpr std::array<const char*, 4> kGroups = {"VR", "VI", "IA", "OA"};
  if (names_ > 0 && Below(3) == 0)
    return std::string("NUM") + Whole(static_cast<std::uint32_t>(names_));
  return std::string(kGroups[Below(4)]) + "[" + Whole(100) + "]";
}

std::string RandomProgram::LogicalVariable() {
  constexpr std::array<const char*, 3> kGroups = {"VL", "IL", "OL"};
  return std::string(kGroups[Below(3)]) + " [" + Whole(100) + "]";
}

std::string RandomProgram::Numeric(int depth) {
  if (depth <= 0 || Below(3) == 0) return Below(2) == 0 ? Number() : NumericVariable();
  constexpr std::array<const char*, 6> kOperators = {"+", "-", "*", "/", "^", " MOD "};
  constexpr std::array<const char*, 6> kFunctions = {"SIN", "cos", "SQRT", "Abs", "INT", "ATAN"};
  switch (Below(6)) {
    case 0:
      return std::string("(") + Numeric(depth - 1) + ")";
    case 1:
      return std::string("-") + Numeric(depth - 1);
    case 2:
      return std::string(kFunctions[Below(6)]) + "(" + Numeric(depth - 1) + ")";
    default:
      return Numeric(depth - 1) + kOperators[Below(6)] + Gap() + Numeric(depth - 1);
  }
}

std::string RandomProgram::Logical(int depth) {
  if (depth <= 0) {
    constexpr std::array<const char*, 5> kConstants = {"ON", "off", "TRUE", "NO", "1"};
    return Below(3) == 0 ? kConstants[Below(5)] : LogicalVariable();
  }
  constexpr std::array<const char*, 3> kOperators = {" AND ", " or ", " XOR "};
  constexpr std::array<const char*, 7> kRelations = {"<", "<=", "=", ">=", ">", "<>", "><"};
  switch (Below(5)) {
    case 0:
      return std::string("NOT (") + Logical(depth - 1) + ")";
    case 1:
      return std::string("(") + Numeric(depth - 1) + kRelations[Below(7)] + Numeric(depth - 1) +
             ")";
    case 2:
      return std::string("(") + Logical(depth - 1) + ")";
    default:
      return Logical(depth - 1) + kOperators[Below(3)] + Gap() + Logical(depth - 1);
  }
}

std::string RandomProgram::List(int count, int depth) {
  std::string text = "(";
  for (int v = 0; v < count; ++v) text += (v == 0 ? "" : std::string(",") + Gap()) + Numeric(depth);
  return text + ")";
}

std::string RandomProgram::Label() { return Whole(static_cast<std::uint32_t>(label_ + 3)); }

std::string RandomProgram::MoveAttributes() {
  std::array<std::string, 6> attributes = {
      std::string("VIA ") + List(5, 1),           "FLY",
      std::string("START (") + Logical(1) + ")",  std::string("END(") + Numeric(1) + ")",
      std::string("TIME (2.5, ") + Label() + ")", "NEXT"};
  std::string text;
  for (std::uint32_t n = Below(4), at = Below(6); n > 0; --n, at = (at + 1 + Below(2)) % 6) {
    if (attributes[at].empty()) continue;
    text += std::string(" /") + Gap() + attributes[at];
    attributes[at].clear();
  }
  return text;
}

std::string RandomProgram::Statement() {
  switch (Below(30)) {
    case 0:
    case 1:
    case 2:
    case 3:
      return std::string("MOVE") + Gap() + List(5, 2) + MoveAttributes();
    case 4:
      return Below(2) == 0 ? "COORD ABSOL" : "coord robot";
    case 5:
      return std::string("PATH HOLE (") + Numeric(1) + ")";
    case 6:
      return "PATH LIN";
    case 7:
      return std::string("SPEED VR[1] + ") + Numeric(1);
    case 8:
      return std::string("DELAY ") + Whole(9) + ".5";
    case 9:
      return Below(4) == 0 ? "SYSDEF" : std::string("SYSDEF ") + List(6, 1);
    case 10:
      return std::string("TCP (0., 0., (") + Numeric(2) + ") / 0., 0., VR[5])";
    case 11:
      return std::string("WORKDEF 1,") + Whole(10) + " (VR[1],80.,VR[2],95" +
             (Below(2) == 0 ? ",12)" : ")");
    case 12:
      return std::string("WORKDEF 2,0") + Whole(10) + ",(" + std::to_string(1 + Below(63)) + ")";
    case 13:
      return std::string("WORK ") + Whole(3) + "," + Whole(10) + (Below(2) == 0 ? "/ON" : " / OFF");
    case 14:
      return "WORK 0,0 /START (IL[16]) /ON /NEXT";
    case 15:
      return std::string("GO ") + std::to_string(1 + Below(99)) + (Below(2) == 0 ? "/C" : "");
    case 16:
      return std::string("CALL VI[1] (") + Numeric(2) + ", " + Logical(1) + ")";
    case 17:
      return std::string("FUNCTION ") + std::to_string(1 + Below(99));
    case 18:
      return std::string("GOTO ") + Label();
    case 19:
      return std::string("GOTO VI[2] (") + Label() + ", " + Label() + ")";
    case 20:
      return std::string("GOSUB ") + Label();
    case 21:
      return std::string("IF ") + Logical(3) + " THEN " + Label() +
             (Below(2) == 0 ? std::string(" ELSE ") + Label() : "");
    case 22:
      return std::string("WAIT ") + Logical(2);
    case 23:
      return std::string("ASSIGN OL[") + Whole(80) + "] = " + Whole(16) + " /" +
             std::to_string(4 + Below(12));
    case 24:
      return Below(2) == 0 ? "UPDATE OL, IA /OFF" : "IMAGE";
    case 25:
      return std::string("TIMER (VR[3], ") + Label() + ") /AUTO";
    case 26:
      return std::string("OL[") + Whole(100) + "] = " + Logical(3);
    case 27:
      return std::string("LET VR[") + Whole(98) + "] =" + Gap() + Numeric(4);
    case 28:
      return Below(2) == 0 ? "BREAK 7, 45" : "EXTERN some Thing (";
    default: {
      constexpr std::array<const char*, 6> kBare = {"RETURN", "ENDTASK", "PAUSE",
                                                    "NOERR",  "ZERO",    "TASK 1"};
      return kBare[Below(6)];
    }
  }
}

std::string RandomProgram::Make(int statements) {
  std::string text;
  for (int s = 0; s < statements; ++s) {
    if (names_ < 9 && Below(8) == 0) {
      text += std::string("DECLARE NUM") + std::to_string(names_) + " = " +
              (Below(2) == 0 ? Number() : std::string("VR[") + Whole(100) + "]") + "\n";
      ++names_;
    }
    if (Below(6) == 0) text += "; a comment\n";
    if (Below(12) == 0) text += "\n";
    if (Below(15) == 0) text += std::to_string(label_++) + " ; alone\n";
    if (Below(4) == 0) text += std::to_string(label_++) + Gap().substr(0, 1) + " ";
    std::string statement = Statement();
    text += statement;
    // Behind EXTERN the line is not examined, but a comment still ends it.
    if (Below(5) == 0) text += " ; behind";
    text += "\n";
  }
  if (Below(2) == 0) text += std::to_string(label_++) + "\n";
  return text;
}

}  // namespace rmlcell::optimo
