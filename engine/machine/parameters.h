#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "engine/core/result.h"

namespace rmlcell::machine {

// One machine parameter of a family: a number with a range, or one of a few words.
struct ParameterInfo {
  static constexpr ParameterInfo OfWord(std::string_view name, std::string_view choices,
                                        std::string_view text, std::string_view rule) {
    return {.name = name, .unit = {}, .choices = choices, .text = text, .rule = rule};
  }

  std::string_view name;  // "VMAX"
  std::string_view unit;  // "mm/s"; empty for words and counts
  double standard = 0.0;  // default
  double minimum = 0.0;
  double maximum = 0.0;
  std::string_view choices;  // "ARROW EFA51": the first word is the default; empty for a number
  std::string_view text;     // what it means, one sentence
  std::string_view rule;     // "OPT-B.01"
};

// A named set of values: "pw-1993", "srm-20".
struct ParameterValue {
  std::string_view name;
  std::variant<double, std::string_view> value;  // a number or a word
  std::string_view source{};                     // where it is from; "estimate"; empty: not told

  std::string Text() const;  // as Set reads it
};
struct MachineProfile {
  std::string_view id;
  std::string_view title;
  std::vector<ParameterValue> values;
};

// A value that is not the one of the profile.
struct ChangedParameter {
  std::string name;
  std::string value;
  std::string of_profile;  // the value that it stands in place of
  std::string source{};    // where it is from, "estimate"; empty: not told

  bool operator==(const ChangedParameter&) const = default;
};

// A machine of somebody's own, based on a profile.
struct OwnMachine {
  std::string name{};  // for people: "Mill of the workshop", or a file that names no profile
  std::map<std::string, std::string> sources{};  // of its parameters, by their names

  bool operator==(const OwnMachine&) const = default;
};

// Which machine something was computed for, as reports tell it.
struct MachineUsed {
  std::string profile;  // "srm-20"; empty: the family has no profile
  bool named = false;   // false: nobody named one, and the family's own choice counts
  std::vector<ChangedParameter> changes;  // by name
  std::string
      changed_by{};  // who changed them, for people: "mine.toml", "machines/mill-1"; may be empty
  std::string own_name{};  // of a machine of somebody's own, based on the profile; empty: none

  // "VMAX 20 (profile: 15), Z1 2 (profile: 0); by mine.toml"; empty when nothing was changed and
  // nobody could have.
  std::string ChangesText() const;

  bool operator==(const MachineUsed&) const = default;
};

// The parameters of one machine: the table of its family, with the values that differ from the
// defaults.
class Parameters {
 public:
  // `table` must outlive this; it is a constant of the family.
  explicit Parameters(std::span<const ParameterInfo> table) : table_(table) {}

  // Errors: CellUnknownParameter, CellParameterRange; nothing is changed then.
  Status Set(std::string_view name, double value);
  Status Set(std::string_view name, std::string_view text);  // a word, or a number as text
  Status Apply(const MachineProfile& profile);
  // The same of a family's own choice, which nobody named.
  Status ApplyUnnamed(const MachineProfile& profile);
  // Who sets values over those of the profile, for people.
  void SetChangedBy(std::string who) { changed_by_ = std::move(who); }
  // Whose machine this is, and where its figures are from.
  void SetOwn(OwnMachine own) { own_ = std::move(own); }

  // The profile in force: that was named, or the family's own choice; empty: there is none.
  const std::string& profile() const { return profile_; }
  bool profile_named() const { return profile_named_; }
  MachineUsed Used() const;

  // Precondition: the family has this parameter, and it is a number, or a word.
  double Number(std::string_view name) const;
  // Such a number in a finding, where it is the argument `argument` in its unit.
  Detail ToldNumber(std::string_view argument, std::string_view name) const;
  std::string_view Word(std::string_view name) const;

  std::span<const ParameterInfo> table() const { return table_; }

  // What differs from the defaults, by name, as text that Set reads back.
  std::map<std::string, std::string> Changed() const;

 private:
  const ParameterInfo* Find(std::string_view name) const;
  std::string TextOf(const ParameterInfo& info) const;

  std::span<const ParameterInfo> table_;
  std::string profile_;
  bool profile_named_ = false;
  std::string changed_by_;
  OwnMachine own_;
  std::map<std::string, std::string, std::less<>> of_profile_;  // where it is not the default
  std::map<std::string, double, std::less<>> numbers_;
  std::map<std::string, std::string, std::less<>> words_;
};

}  // namespace rmlcell::machine
