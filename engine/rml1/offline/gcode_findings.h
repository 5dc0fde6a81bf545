#pragma once

#include <set>
#include <string>
#include <utility>

#include "engine/machine/program_file.h"
#include "engine/rml1/offline/from_gcode.h"

namespace rmlcell::rml1 {

// What is said about a program in G-code: errors, which refuse it, and notes.
class GcodeFindings {
 public:
  void Add(ErrorCode code, Detail detail, const SourceSpan& where) {
    Diagnostic finding{.code = code,
                       .severity = Lookup(code).severity,
                       .detail = std::move(detail),
                       .where = where};
    if (outcome_.findings.size() == machine::kDiagnosticsMax) {
      outcome_.findings_dropped.Add(finding);
      return;
    }
    outcome_.findings.push_back(std::move(finding));
  }
  void Refuse(ErrorCode code, Detail detail, const SourceSpan& where) {
    outcome_.ok = false;
    Add(code, std::move(detail), where);
  }
  void Refuse(const Error& error) {
    Refuse(error.code, error.detail, error.where.value_or(SourceSpan{}));
  }
  // Of each key once: CAM tools write some words on every line.
  void Note(ErrorCode code, const std::string& key, const Detail& detail, const SourceSpan& where) {
    if (told_.insert(key).second) Add(code, detail, where);
  }

  bool ok() const { return outcome_.ok; }
  bool full() const { return !outcome_.findings_dropped.empty(); }
  FromGcodeOutcome Take() { return std::move(outcome_); }

 private:
  FromGcodeOutcome outcome_{.ok = true};
  std::set<std::string> told_;  // bounded: the words of the subset, and a few of ours
};

}  // namespace rmlcell::rml1
