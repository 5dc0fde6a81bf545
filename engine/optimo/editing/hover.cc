#include "engine/optimo/editing/hover.h"

#include <algorithm>
#include <array>
#include <string>

#include "engine/core/number_text.h"
#include "engine/optimo/editing/neighbours.h"
#include "engine/optimo/editing/rule_facts.h"
#include "engine/optimo/editing/variable_facts.h"
#include "engine/optimo/editing/word_facts.h"
#include "engine/optimo/language/instruction_set.h"
#include "engine/optimo/offline/house_programs.h"

namespace rmlcell::optimo::editing {
namespace {

constexpr std::size_t kQuotedMax = 120;  // bytes of a program text in a hover

// A piece of the program as code, in one line.
std::string Code(std::string_view text) {
  std::string line;
  for (const char c : text.substr(0, kQuotedMax)) {
    const bool blank = c == ' ' || c == '\t' || c == '\r' || c == '\n';
    if (!blank) line += c == '`' ? '\'' : c;
    if (blank && !line.empty() && line.back() != ' ') line += ' ';
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  return "`" + line + (text.size() > kQuotedMax ? " ..." : "") + "`";
}

std::string RuleLine(std::string_view rule) {
  const std::string_view text = TextOfRule(rule);
  return text.empty() ? "Rule " + std::string(rule)
                      : "Rule " + std::string(rule) + ": " + std::string(text);
}

std::string Plural(std::size_t count, std::string_view what) {
  return std::to_string(count) + " " + std::string(what) + (count == 1 ? "" : "s");
}

class HoverText {
 public:
  HoverText(const ProgramIndex& index, const LineTable& lines, const machine::Surroundings& around,
            const Use& use)
      : index_(index), lines_(lines), around_(around), use_(use) {}

  std::string Make() const {
    switch (use_.kind) {
      case UseKind::kWord:
        return OfWord();
      case UseKind::kName:
        return OfName();
      case UseKind::kLabel:
      case UseKind::kJump:
        return OfLabel();
      case UseKind::kProgram:
        return OfProgram(use_.number);
      case UseKind::kVariable:
        return OfVariable();
    }
    return {};
  }

 private:
  // As editors count lines.
  std::string LineText(std::size_t offset) const {
    return std::to_string(lines_.LineOf(offset) + 1);
  }

  std::string OfWord() const {
    const WordFact& fact = FactOf(use_.word);
    const WordInfo& info = Describe(use_.word);
    std::string text = "**" + std::string(info.text) + "**";
    if (!fact.form.empty()) text += " `" + std::string(fact.form) + "`";
    text += "\n\n" + std::string(fact.text);
    const Op op = OpOf(use_.word);
    const StatementPlace& statement = index_.statements()[use_.statement];
    if (op != Op::kInvalid && statement.word == use_.word) {
      text += "\n\n" + RuleLine(Describe(op).rule) + " (" + std::string(info.rule) + ")";
      if (statement.step > 0) text += "\n\nStep " + std::to_string(statement.step);
    } else {
      text += "\n\nRule " + std::string(info.rule);
    }
    if (const ProcessUse* process = ProcessOf(index_, statement)) text += OfProcess(*process);
    return text;
  }

  // What the WORKDEF of a WORK says, and what WORKs a WORKDEF has.
  std::string OfProcess(const ProcessUse& process) const {
    const auto same = [&](const ProcessUse& other) {
      return other.kind == process.kind && other.process == process.process;
    };
    const std::string name = std::to_string(process.kind) + "," + std::to_string(process.process);
    std::string text;
    if (process.defines) {
      const auto count = std::ranges::count_if(index_.processes(), [&](const ProcessUse& other) {
        return same(other) && !other.defines && other.on;
      });
      text = "\n\nProcess " + name + ", turned ON " + std::to_string(count) +
             (count == 1 ? " time." : " times.") +
             Parameters(index_.statements()[process.statement], process.kind);
    } else {
      text = DefinitionOf(process, name);
    }
    const std::string project = around_.ProcessNote(process.kind, process.process);
    return project.empty() ? text : text + "\n\nIn project.json: " + project;
  }

  // The WORKDEF that a WORK most likely follows: the nearest one before, else the first behind.
  std::string DefinitionOf(const ProcessUse& process, const std::string& name) const {
    const ProcessUse* nearest = nullptr;
    for (const ProcessUse& other : index_.processes()) {
      const bool same = other.kind == process.kind && other.process == process.process;
      if (!other.defines || !same) continue;
      if (other.statement < process.statement || nearest == nullptr) nearest = &other;
    }
    if (nearest == nullptr) {
      if (process.kind == 0) return "\n\nKind 0 needs no WORKDEF (OPT-3.10).";
      return "\n\nThis program has no WORKDEF " + name + ". " + RuleLine("OPT-3.09");
    }
    const StatementPlace& place = index_.statements()[nearest->statement];
    return "\n\nDefined on line " + LineText(place.body) + ": " + Code(index_.TextOf(place)) +
           Parameters(place, process.kind);
  }

  // The values of a WORKDEF with what they mean.
  std::string Parameters(const StatementPlace& place, int kind) const {
    constexpr std::array<std::string_view, 5> kLaser = {
        "speed, percent of the largest", "power at that speed, percent", "dwell at peak, s",
        "piercing power, percent", "laser schedule"};
    constexpr std::array<std::string_view, 1> kSchedule = {"laser schedule"};
    const std::string_view text = index_.TextOf(place);
    const std::size_t open = text.find('(');
    const std::size_t close = text.rfind(')');
    if (kind == 0 || open == std::string_view::npos || close == std::string_view::npos ||
        close < open) {
      return {};
    }
    std::string list;
    std::size_t value = 0;
    int depth = 0;
    std::size_t begin = open + 1;
    const std::size_t most = kind == 1 ? kLaser.size() : kSchedule.size();
    for (std::size_t at = begin; at <= close && value < most; ++at) {
      if (text[at] == '(') ++depth;
      if (text[at] == ')') --depth;
      if (at < close && (text[at] != ',' || depth > 0)) continue;
      const std::string_view written = text.substr(begin, at - begin);
      list +=
          "\n- " + std::string(kind == 1 ? kLaser[value] : kSchedule[value]) + ": " + Code(written);
      const bool schedule = kind == 2 || value == kLaser.size() - 1;
      if (schedule) list += OfSchedule(written);
      ++value;
      begin = at + 1;
    }
    return list.empty() ? list : "\n" + list;
  }

  // " (PULSE, 50 %)" when the project of the folder has the schedule.
  std::string OfSchedule(std::string_view written) const {
    const std::size_t first = written.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    const std::size_t last = written.find_last_not_of(" \t");
    const auto number = ParseDouble(written.substr(first, last - first + 1));
    if (!number || !(*number >= 1.0 && *number < 64.0)) return {};
    const std::string note = around_.ScheduleNote(static_cast<int>(*number));
    return note.empty() ? note : " (" + note + ")";
  }

  std::string OfName() const {
    const std::string name(index_.TextOf(use_));
    const auto uses = std::ranges::count_if(index_.uses(), [&](const Use& other) {
      return other.kind == UseKind::kName && other.key == use_.key && !other.declares;
    });
    const Declaration* declaration = index_.FindDeclaration(use_.key);
    if (declaration == nullptr)
      return "**" + name + "** is not declared in this program. " + RuleLine("OPT-7.50");
    const Use& at = index_.uses()[declaration->use];
    std::string text =
        "**" + std::string(index_.TextOf(at)) + "** = " +
        Code(index_.text().substr(declaration->value_begin,
                                  declaration->value_end - declaration->value_begin));
    text += "\n\nDeclared on line " + LineText(at.begin) + ", used " + std::to_string(uses) +
            (uses == 1 ? " time." : " times.");
    if (declaration->variable) text += "\n\n" + VariableFacts(*declaration->variable);
    if (name.size() > kNameLength) text += "\n\n" + RuleLine("OPT-7.46");
    if (const auto called = CalledProgram(index_, use_)) text += "\n\n" + OfProgram(*called);
    return text;
  }

  std::string OfLabel() const {
    const std::string number = std::to_string(use_.number);
    const Use* label = index_.FindLabel(use_.number);
    if (label == nullptr)
      return "There is no sequence number " + number + ". " + RuleLine("OPT-7.16");
    std::size_t jumps = 0;
    std::size_t gosubs = 0;
    for (const Use& other : index_.uses()) {
      if (other.kind != UseKind::kJump || other.number != use_.number) continue;
      ++(index_.statements()[other.statement].word == Word::kGosub ? gosubs : jumps);
    }
    const std::uint32_t step = index_.StepOfLabel(*label);
    std::string text = "**Sequence number " + number + "** on line " + LineText(label->begin) +
                       (step > index_.step_count() ? ", the end of the program"
                                                   : ", step " + std::to_string(step)) +
                       "\n\n" + Plural(jumps, "jump") + ", " + Plural(gosubs, "GOSUB") + " to it.";
    if (use_.kind == UseKind::kJump) {
      for (std::size_t s = label->statement; s < index_.statements().size(); ++s) {
        if (index_.statements()[s].lone_label) continue;
        text += "\n\n" + Code(index_.TextOf(index_.statements()[s]));
        break;
      }
    }
    return text;
  }

  std::string OfProgram(int number) const {
    std::string text = "**Program " + std::to_string(number) + "**";
    const auto neighbour = FindNeighbour(around_, number);
    if (!neighbour) {
      text += "\n\nThere is no file " + std::to_string(number) + ".S in this folder.";
      for (const machine::SpecialProgram& house : HousePrograms()) {
        if (house.slot == number) text += " On the control it is " + std::string(house.name) + ".";
      }
      return text;
    }
    const ProgramIndex other(neighbour->text);
    text += " in `" + neighbour->name + "`, " + Plural(other.step_count(), "step");
    if (!other.comments().empty()) {
      const Comment& first = other.comments().front();
      const bool head = other.statements().empty() || first.begin < other.statements()[0].begin;
      if (head) text += "\n\n" + Code(other.text().substr(first.begin, first.end - first.begin));
    }
    int parameters = 0;
    for (const Use& use : other.uses()) {
      if (use.kind == UseKind::kVariable && use.group == VariableGroup::kPar)
        parameters = std::max(parameters, use.number + 1);
    }
    if (parameters == 1) text += "\n\nReads PAR[0].";
    if (parameters > 1) text += "\n\nReads PAR[0] to PAR[" + std::to_string(parameters - 1) + "].";
    return text;
  }

  std::string OfVariable() const {
    const Variable variable{use_.group, static_cast<std::uint8_t>(use_.number)};
    std::string text = VariableFacts(variable);
    std::string names;
    for (const Declaration& declaration : index_.declarations()) {
      if (declaration.variable != variable) continue;
      names +=
          (names.empty() ? "" : ", ") + std::string(index_.TextOf(index_.uses()[declaration.use]));
    }
    if (!names.empty()) text += "\n\nDeclared here as " + names + ".";
    return text;
  }

  const ProgramIndex& index_;
  const LineTable& lines_;
  const machine::Surroundings& around_;
  const Use& use_;
};

}  // namespace

std::optional<machine::HoverNote> Hover(const ProgramIndex& index, const LineTable& lines,
                                        std::size_t offset, const machine::Surroundings& around) {
  const Use* use = index.CommentAt(offset) != nullptr ? nullptr : index.At(offset);
  if (use == nullptr) return std::nullopt;
  return machine::HoverNote{.text = HoverText(index, lines, around, *use).Make(),
                            .of = {use->begin, use->end}};
}

}  // namespace rmlcell::optimo::editing
