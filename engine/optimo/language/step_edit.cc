#include "engine/optimo/language/step_edit.h"

#include <algorithm>
#include <span>
#include <vector>

#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/printer.h"
#include "engine/optimo/language/program.h"

namespace rmlcell::optimo {
namespace {

using Labels = std::vector<std::uint16_t>;

Error NoPlace(std::string_view what) { return {ErrorCode::kObjectCorrupt, std::string(what), {}}; }

// A module that is put together from instructions of others, one behind the other.
class Joined {
 public:
  explicit Joined(const Module& names) {
    made_.names = names.names;
    made_.parameter_types = names.parameter_types;
  }

  // False: it has a name that the module does not know.
  bool Add(const Module& from, const Instruction& source, const Labels& labels) {
    Instruction i = source;
    i.first_label = Size(made_.labels);
    i.label_count = static_cast<std::uint16_t>(labels.size());
    made_.labels.insert(made_.labels.end(), labels.begin(), labels.end());
    i.first_target = Size(made_.targets);
    for (std::uint32_t t = 0; t < source.target_count; ++t)
      made_.targets.push_back(from.targets[source.first_target + t]);
    i.first_expression = Size(made_.expression_ends);
    bool known = true;
    for (std::uint32_t e = 0; e < from.ExpressionCount(source); ++e) {
      for (ExprNode node : from.expression(source.first_expression + e)) {
        known = Rename(from, node.name) && Rename(from, node.index_name) && known;
        made_.nodes.push_back(node);
      }
      made_.EndExpression();
    }
    if (source.op == Op::kIgnored) {
      i.name = static_cast<std::uint16_t>(made_.texts.size());
      made_.texts.push_back(from.texts[source.name]);
    } else {
      known = Rename(from, i.name) && known;
    }
    made_.instructions.push_back(i);
    return known;
  }

  // Its object, if the program has no errors. What is wrong says the compiler: a reader of objects
  // knows only that something is.
  Result<std::string> Object(Labels end_labels) {
    made_.end_labels = std::move(end_labels);
    std::string object = EncodeObject(made_);
    if (const Result<Module> good = DecodeObject(object)) return object;
    const Compilation compiled =
        Compile(Decompile(made_), {}, {.object_limit = 0, .advice = false});
    for (const Diagnostic& found : compiled.diagnostics) {
      if (IsError(found.severity)) return Error{found.code, found.detail, {}};
    }
    return NoPlace("the program has errors");
  }

 private:
  template <class Pool>
  static std::uint32_t Size(const Pool& pool) {
    return static_cast<std::uint32_t>(pool.size());
  }

  bool Rename(const Module& from, std::uint16_t& name) const {
    if (name == kNoName) return true;
    const NameKey key = from.names[name].key;
    const auto found = std::ranges::find(made_.names, key, &DeclaredName::key);
    if (found == made_.names.end()) return false;
    name = static_cast<std::uint16_t>(found - made_.names.begin());
    return true;
  }

  Module made_;
};

Labels LabelsAt(const Module& module, std::uint32_t place) {
  if (place >= module.instructions.size()) return module.end_labels;
  const auto labels = module.Labels(module.instructions[place]);
  return {labels.begin(), labels.end()};
}

}  // namespace

std::string InstructionText(const Module& module, std::uint32_t place) {
  const Labels labels = LabelsAt(module, place);
  std::string text;
  for (std::size_t n = 0; n + 1 < labels.size(); ++n) text += std::to_string(labels[n]) + "\n";
  if (!labels.empty()) PrintLabelColumns(labels.back(), text);
  PrintStatement(module, module.instructions[place], text);
  return text;
}

Result<std::string> InsertInstruction(const Module& module, std::uint32_t place,
                                      std::string_view text) {
  if (place > module.instructions.size()) return NoPlace("the program is shorter");
  Findings findings(1);
  const ParsedProgram parsed = Parse(text, findings, Places::kStatements);
  const Module& added = parsed.module;
  if (findings.error_count() > 0 || added.instructions.size() != 1 || !added.end_labels.empty())
    return NoPlace("the text is not one instruction");
  const Labels its = LabelsAt(added, 0);
  const Labels there = LabelsAt(module, place);
  if (its.size() > there.size() || !std::ranges::equal(its, std::span(there).first(its.size())))
    return NoPlace("its sequence numbers are not there");
  const Labels rest(there.begin() + static_cast<std::ptrdiff_t>(its.size()), there.end());

  Joined joined(module);
  bool known = true;
  const auto count = static_cast<std::uint32_t>(module.instructions.size());
  for (std::uint32_t i = 0; i <= count; ++i) {
    if (i == place) known = joined.Add(added, added.instructions[0], its);
    if (i == count) break;
    joined.Add(module, module.instructions[i], i == place ? rest : LabelsAt(module, i));
  }
  if (!known) return NoPlace("it has a name that the program does not know");
  return joined.Object(place == count ? rest : module.end_labels);
}

Result<std::string> RemoveInstruction(const Module& module, std::uint32_t place) {
  const auto count = static_cast<std::uint32_t>(module.instructions.size());
  if (place >= count) return NoPlace("the program is shorter");
  Labels moved = LabelsAt(module, place);
  const Labels there = LabelsAt(module, place + 1);
  moved.insert(moved.end(), there.begin(), there.end());
  Joined joined(module);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (i == place) continue;
    joined.Add(module, module.instructions[i], i == place + 1 ? moved : LabelsAt(module, i));
  }
  return joined.Object(place + 1 == count ? moved : module.end_labels);
}

}  // namespace rmlcell::optimo
