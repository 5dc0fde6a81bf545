#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/catalogue.h"
#include "engine/core/diagnostic.h"
#include "engine/core/untold_findings.h"
#include "engine/machine/outcome.h"

// Will the part come out right? What a run did is judged by rules, each of which looks at one
// figure. docs/verdict.md lists them all.
namespace rmlcell::machine {

enum class Verdict : std::uint8_t {
  kGood,
  kDoubtful,  // it may come out right: a person should look
  kBad,       // the part, the tool or the machine suffers, or the run did not get to its end
};
std::string_view VerdictText(Verdict verdict);  // "GOOD", "DOUBTFUL", "BAD"

// A rule speaks when its figure is above the limit. What to do is the advice of its code.
struct VerdictRule {
  ErrorCode code{};
  std::string_view figure{};  // "clipped_cut_length"
  double limit = 0.0;
  Verdict verdict = Verdict::kDoubtful;
  // Of the figure, which takes the place of '#': "cuts # mm ..."; "#{name}" is another figure of
  // the same run.
  std::string_view said{};
};

// A halt that nobody ends: of a run its last place, of a check, which goes on, all there are.
inline constexpr VerdictRule kWaitsForKey = {ErrorCode::kCellWaitsForever, "waits_for_key", 0.0,
                                             Verdict::kDoubtful,
                                             "halts that wait for a key to go on: #"};

// Why a verdict is not GOOD. One for each rule that spoke, however many places it is about.
struct Reason {
  ErrorCode code{};
  Verdict verdict = Verdict::kDoubtful;
  Detail said{};  // "cuts 12.500 mm while the spindle stands"
  double amount = 0.0;
  double limit = 0.0;  // up to which nothing is said
  std::string unit{};  // of both; empty for counts
  Place first{};       // step 0: no place

  bool operator==(const Reason&) const = default;
};

struct Judgement {
  Verdict verdict = Verdict::kGood;
  std::vector<Reason> reasons{};  // most serious first; of one verdict in the order of the rules

  void Add(Reason reason);

  bool operator==(const Judgement&) const = default;
};

// Tells each finding whether one of the reasons is of its code.
void MarkJudged(const Judgement& judgement, std::span<Diagnostic> findings);
void MarkJudged(const Judgement& judgement, UntoldFindings& findings);
Judged JudgedBy(const Judgement& judgement, ErrorCode code);

// What a rule says of a figure. Lengths and times to 0.001, counts whole, percent to 0.1; other
// figures that it names are found in `figures`, and are as short as they can be told.
Reason ReasonOf(const VerdictRule& rule, const Figure& figure,
                std::span<const Figure> figures = {});

}  // namespace rmlcell::machine
