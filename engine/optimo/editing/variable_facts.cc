#include "engine/optimo/editing/variable_facts.h"

#include <array>
#include <string_view>

#include "engine/optimo/language/units_of_variables.h"

namespace rmlcell::optimo::editing {
namespace {

struct Fact {
  VariableGroup group;
  int first, last;
  std::string_view text;
  std::string_view rule;
};

// clang-format off
constexpr std::array kVariableFacts = {
    Fact{VariableGroup::kVr, 0, 25, "free for customers", "OPT-7.104"},
    Fact{VariableGroup::kVr, 26, 42, "free for customers, without unit: rotary-table angles, laser schedules", "OPT-7.104"},
    Fact{VariableGroup::kVr, 43, 59, "used by Amada's programs", "OPT-7.104"},
    Fact{VariableGroup::kVr, 60, 63, "by convention speed, power, delay, peak of WORKDEF 1,00", "OPT-7.104"},
    Fact{VariableGroup::kVr, 64, 64, "by convention speed 1", "OPT-7.104"},
    Fact{VariableGroup::kVr, 65, 68, "by convention speed, power, delay, peak of WORKDEF 1,01", "OPT-7.104"},
    Fact{VariableGroup::kVr, 69, 69, "by convention speed 2", "OPT-7.104"},
    Fact{VariableGroup::kVr, 70, 73, "by convention speed, power, delay, peak of WORKDEF 1,02", "OPT-7.104"},
    Fact{VariableGroup::kVr, 74, 74, "by convention speed 3", "OPT-7.104"},
    Fact{VariableGroup::kVr, 75, 78, "by convention speed, power, delay, peak of WORKDEF 1,03", "OPT-7.104"},
    Fact{VariableGroup::kVr, 79, 79, "by convention speed 4", "OPT-7.104"},
    Fact{VariableGroup::kVr, 80, 85, "by convention the six values of TCP", "OPT-7.104"},
    Fact{VariableGroup::kVr, 86, 91, "by convention the six values of SYSDEF 1, which RMLSHIFT changes", "OPT-7.104"},
    Fact{VariableGroup::kVr, 92, 97, "by convention the six values of SYSDEF 2", "OPT-7.104"},
    Fact{VariableGroup::kVr, 98, 99, "used by the system", "OPT-7.104"},
    Fact{VariableGroup::kVi, 1, 1, "by convention the program number for chaining", "OPT-7.105"},
    Fact{VariableGroup::kVi, 2, 69, "free for customers", "OPT-7.105"},
    Fact{VariableGroup::kVi, 70, 97, "used by Amada's programs", "OPT-7.105"},
    Fact{VariableGroup::kVi, 98, 98, "counts the runs of the main program since it was selected; read only", "OPT-7.70"},
    Fact{VariableGroup::kVi, 99, 99, "the code of the latest error; read only", "OPT-7.71"},
    Fact{VariableGroup::kVl, 0, 79, "free for customers", "OPT-7.105"},
    Fact{VariableGroup::kVl, 80, 99, "used by Amada's programs", "OPT-7.105"},
    Fact{VariableGroup::kOl, 0, 1, "used by the system", "OPT-7.106"},
    Fact{VariableGroup::kOl, 2, 2, "beam modulation of an EFA-51 laser; else used by the system", "OPT-7.106"},
    Fact{VariableGroup::kOl, 3, 7, "used by the system", "OPT-7.106"},
    Fact{VariableGroup::kOl, 8, 9, "assist gas; one at a time", "OPT-7.106"},
    Fact{VariableGroup::kOl, 10, 10, "used by the system", "OPT-7.106"},
    Fact{VariableGroup::kOl, 11, 11, "height sensor", "OPT-7.106"},
    Fact{VariableGroup::kOl, 12, 15, "used by the system", "OPT-7.106"},
    Fact{VariableGroup::kOl, 16, 16, "free for customers", "OPT-7.106"},
    Fact{VariableGroup::kOl, 17, 31, "used by the system", "OPT-7.106"},
    Fact{VariableGroup::kIl, 0, 15, "used by the system", "OPT-7.106"},
    Fact{VariableGroup::kIl, 16, 16, "the START push-button", "OPT-7.67"},
    Fact{VariableGroup::kIl, 17, 31, "used by the system", "OPT-7.106"},
    Fact{VariableGroup::kIl, 95, 95, "1 while a motion runs", "OPT-7.68"},
    Fact{VariableGroup::kIl, 96, 99, "reserved", "OPT-7.68"},
    Fact{VariableGroup::kIa, 0, 0, "machine coordinate X: the tip in COORD ABSOL, else the column, in mm", "OPT-7.65"},
    Fact{VariableGroup::kIa, 1, 1, "machine coordinate Y: the tip in COORD ABSOL, else the column, in mm", "OPT-7.65"},
    Fact{VariableGroup::kIa, 2, 2, "machine coordinate Z: the tip in COORD ABSOL, else the column, in mm", "OPT-7.65"},
    Fact{VariableGroup::kIa, 3, 3, "head angle A in rad", "OPT-7.64"},
    Fact{VariableGroup::kIa, 4, 4, "head angle B in rad", "OPT-7.64"},
    Fact{VariableGroup::kIa, 5, 39, "reserved", "OPT-7.64"},
    Fact{VariableGroup::kOa, 0, 0, "the speed: mm/s times the system cycle (0.048 s); read only", "OPT-7.69"},
};
// clang-format on

constexpr int kFirstWorkFlag = 87, kLastWorkFlag = 94;  // IL, OPT-3.37

const Fact* Find(Variable variable) {
  for (const Fact& fact : kVariableFacts) {
    if (fact.group == variable.group && variable.index >= fact.first && variable.index <= fact.last)
      return &fact;
  }
  return nullptr;
}

bool IsWorkFlag(Variable variable) {
  return variable.group == VariableGroup::kIl && variable.index >= kFirstWorkFlag &&
         variable.index <= kLastWorkFlag;
}

std::string WorkFlag(Variable variable) {
  return "1 while a process with number " + std::to_string(variable.index - kFirstWorkFlag) +
         " is ON";
}

std::string_view KindOf(VariableGroup group) {
  constexpr std::array<std::string_view, 8> kKinds = {
      "real variable",    "whole-number variable, -32768 to 32767",
      "logical variable", "logical input",
      "logical output",   "analogue input",
      "analogue output",  "parameter of CALL or FUNCTION"};
  return kKinds[static_cast<std::size_t>(group)];
}

}  // namespace

std::string VariableNote(Variable variable) {
  if (IsWorkFlag(variable)) return WorkFlag(variable);
  const Fact* fact = Find(variable);
  return fact == nullptr ? std::string() : std::string(fact->text);
}

std::string VariableFacts(Variable variable) {
  std::string text = "**" + std::string(GroupName(variable.group)) + "[" +
                     std::to_string(variable.index) + "]** " + std::string(KindOf(variable.group));
  if (IsWorkFlag(variable)) {
    text += "\n\n" + WorkFlag(variable) + " (OPT-3.37)";
  } else if (const Fact* fact = Find(variable)) {
    text += "\n\n" + std::string(fact->text) + " (" + std::string(fact->rule) + ")";
  }
  if (IsReadOnly(variable)) text += "\n\nA program cannot write it (OPT-7.66).";
  switch (UnitOf(variable)) {
    case Unit::kLinear:
      text += "\n\nCONVERT takes its numbers for lengths (OPT-8.30).";
      break;
    case Unit::kRotary:
      text += "\n\nCONVERT takes its numbers for angles (OPT-8.30).";
      break;
    case Unit::kNone:
      break;
  }
  return text;
}

}  // namespace rmlcell::optimo::editing
