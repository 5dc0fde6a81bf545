#include "engine/machine/parameters.h"

#include <algorithm>

#include "engine/core/letters.h"
#include "engine/core/number_text.h"

namespace rmlcell::machine {
namespace {

// The word of `choices` that `word` means, or nothing.
std::string_view FindChoice(std::string_view choices, std::string_view word) {
  while (!choices.empty()) {
    const std::size_t end = std::min(choices.find(' '), choices.size());
    const std::string_view choice = choices.substr(0, end);
    if (EqualIgnoringCase(choice, word)) return choice;
    choices.remove_prefix(std::min(end + 1, choices.size()));
  }
  return {};
}

Error OutOfRange(const ParameterInfo& info, double value) {
  const auto told = [&](std::string_view name, double number) {
    return Told(name, number, info.unit, ShortestText(number));
  };
  return {ErrorCode::kCellParameterRange,
          Told("name", info.name) + " is " + told("value", value) + ", allowed are " +
              told("least", info.minimum) + " to " + told("most", info.maximum),
          {}};
}

Error NotOneOf(const ParameterInfo& info) {
  return {ErrorCode::kCellParameterRange,
          Told("name", info.name) + " takes one of " + Told("choices", info.choices),
          {}};
}

}  // namespace

std::string ParameterValue::Text() const {
  const auto* word = std::get_if<std::string_view>(&value);
  return word != nullptr ? std::string(*word) : ShortestText(std::get<double>(value));
}

const ParameterInfo* Parameters::Find(std::string_view name) const {
  const auto found = std::ranges::find_if(
      table_, [&](const ParameterInfo& info) { return EqualIgnoringCase(info.name, name); });
  return found == table_.end() ? nullptr : &*found;
}

Status Parameters::Set(std::string_view name, double value) {
  const ParameterInfo* info = Find(name);
  if (info == nullptr) return Error{ErrorCode::kCellUnknownParameter, Told("name", name), {}};
  if (!info->choices.empty()) return NotOneOf(*info);
  if (!(value >= info->minimum && value <= info->maximum)) return OutOfRange(*info, value);
  numbers_.insert_or_assign(std::string(info->name), value);
  return {};
}

Status Parameters::Set(std::string_view name, std::string_view text) {
  const ParameterInfo* info = Find(name);
  if (info == nullptr) return Error{ErrorCode::kCellUnknownParameter, Told("name", name), {}};
  if (info->choices.empty()) {
    const std::optional<double> number = ParseDouble(text);
    if (number) return Set(name, *number);
    return Error{ErrorCode::kCellParameterRange,
                 Told("name", info->name) + " takes a number, not '" + Told("word", text) + "'",
                 {}};
  }
  const std::string_view choice = FindChoice(info->choices, text);
  if (choice.empty()) return NotOneOf(*info);
  words_.insert_or_assign(std::string(info->name), std::string(choice));
  return {};
}

Status Parameters::ApplyUnnamed(const MachineProfile& profile) {
  const Status applied = Apply(profile);
  if (applied) profile_named_ = false;
  return applied;
}

Status Parameters::Apply(const MachineProfile& profile) {
  Parameters changed = *this;
  for (const ParameterValue& value : profile.values) {
    if (const Status set = changed.Set(value.name, value.Text()); !set) return set.error();
  }
  changed.profile_ = profile.id;
  changed.profile_named_ = true;
  changed.of_profile_ = {};
  for (const auto& [name, value] : changed.Changed()) changed.of_profile_.emplace(name, value);
  *this = std::move(changed);
  return {};
}

double Parameters::Number(std::string_view name) const {
  const ParameterInfo* info = Find(name);
  RMLCELL_CHECK(info != nullptr && info->choices.empty());
  const auto found = numbers_.find(info->name);
  return found == numbers_.end() ? info->standard : found->second;
}

Detail Parameters::ToldNumber(std::string_view argument, std::string_view name) const {
  const double value = Number(name);
  return Told(argument, value, Find(name)->unit, ShortestText(value));
}

std::string_view Parameters::Word(std::string_view name) const {
  const ParameterInfo* info = Find(name);
  RMLCELL_CHECK(info != nullptr && !info->choices.empty());
  const auto found = words_.find(info->name);
  if (found != words_.end()) return found->second;
  return info->choices.substr(0, info->choices.find(' '));
}

std::string Parameters::TextOf(const ParameterInfo& info) const {
  return info.choices.empty() ? ShortestText(Number(info.name)) : std::string(Word(info.name));
}

MachineUsed Parameters::Used() const {
  MachineUsed used{.profile = profile_,
                   .named = profile_named_,
                   .changes = {},
                   .changed_by = changed_by_,
                   .own_name = own_.name};
  const auto source_of = [this](std::string_view name) {
    const auto told = std::ranges::find_if(
        own_.sources, [&](const auto& one) { return EqualIgnoringCase(one.first, name); });
    return told == own_.sources.end() ? std::string() : told->second;
  };
  const Parameters defaults(table_);
  for (const ParameterInfo& info : table_) {
    const auto own = of_profile_.find(info.name);
    std::string of_profile = own != of_profile_.end() ? own->second : defaults.TextOf(info);
    std::string value = TextOf(info);
    if (value == of_profile) continue;
    used.changes.push_back({.name = std::string(info.name),
                            .value = std::move(value),
                            .of_profile = std::move(of_profile),
                            .source = source_of(info.name)});
  }
  std::ranges::sort(used.changes, {}, &ChangedParameter::name);
  return used;
}

std::string MachineUsed::ChangesText() const {
  std::string text;
  for (const ChangedParameter& change : changes) {
    text += (text.empty() ? "" : ", ") + change.name + " " + change.value +
            " (profile: " + change.of_profile +
            (change.source.empty() ? "" : "; source: " + change.source) + ")";
  }
  if (changed_by.empty()) return text;
  return text.empty() ? "nothing, by " + changed_by : text + "; by " + changed_by;
}

std::map<std::string, std::string> Parameters::Changed() const {
  std::map<std::string, std::string> changed;
  for (const auto& [name, word] : words_) {
    const std::string_view choices = Find(name)->choices;
    if (word != choices.substr(0, choices.find(' '))) changed.emplace(name, word);
  }
  for (const auto& [name, value] : numbers_) {
    if (value != Find(name)->standard) changed.emplace(name, ShortestText(value));
  }
  return changed;
}

}  // namespace rmlcell::machine
