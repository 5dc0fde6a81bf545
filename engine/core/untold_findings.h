#pragma once

#include <cstdint>
#include <map>

#include "engine/core/diagnostic.h"
#include "engine/core/units.h"

namespace rmlcell {

// Findings of one code that are not told singly.
struct GatheredFindings {
  ErrorCode code{};
  Severity severity{};          // the most serious of them: an error before what is none
  Judged judged = Judged::kNo;  // as of a finding
  std::uint64_t count = 0;
  // The places of the first and the last of them in the text, by program, line and byte: file,
  // program, step and span alone are known.
  Diagnostic first{};
  Diagnostic last{};
  SimTime last_at{0};  // virtual time at which the last one was made

  bool operator==(const GatheredFindings&) const = default;
};

// What a list of findings has no room for: of each code how many there are, and their extent. As
// small as the catalogue is, however many they are.
class UntoldFindings {
 public:
  void Add(const Diagnostic& finding, SimTime at = SimTime(0));
  void Add(const GatheredFindings& others);
  void Add(const UntoldFindings& others);

  // The places of all of them, for who knows more of the text: void(Diagnostic& place).
  template <class Function>
  void ForEachPlace(const Function& function) {
    for (auto& [code, kind] : kinds_) {
      function(kind.first);
      function(kind.last);
    }
  }
  // Judges each kind: Judged(ErrorCode).
  template <class Function>
  void Mark(const Function& judged_by) {
    for (auto& [code, kind] : kinds_) kind.judged = judged_by(code);
  }

  bool empty() const { return count_ == 0; }
  std::uint64_t count() const { return count_; }
  const std::map<ErrorCode, GatheredFindings>& kinds() const { return kinds_; }

  bool operator==(const UntoldFindings&) const = default;

 private:
  std::uint64_t count_ = 0;
  std::map<ErrorCode, GatheredFindings> kinds_;
};

}  // namespace rmlcell
