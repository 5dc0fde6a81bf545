#include "clients/cli/verdict_text.h"

#include "clients/cli/terminal.h"

namespace rmlcell::cli {

std::string VerdictName(v1::Verdict verdict) {
  switch (verdict) {
    case v1::VERDICT_GOOD:
      return "GOOD";
    case v1::VERDICT_DOUBTFUL:
      return "DOUBTFUL";
    case v1::VERDICT_BAD:
      return "BAD";
    default:
      return {};
  }
}

std::string VerdictText(v1::Verdict verdict) {
  const Colour colour = verdict == v1::VERDICT_GOOD  ? Colour::kGreen
                        : verdict == v1::VERDICT_BAD ? Colour::kRed
                                                     : Colour::kYellow;
  return Paint(VerdictName(verdict), colour, ColourOnOutput());
}

std::string PlaceText(const v1::SourcePlace& place) {
  std::string text;
  if (place.program() > 0) text += "program " + std::to_string(place.program());
  if (place.step() > 0) text += (text.empty() ? "step " : " step ") + std::to_string(place.step());
  if (place.line() > 0) text += (text.empty() ? "line " : " line ") + std::to_string(place.line());
  return text;
}

std::string ReasonLine(const v1::VerdictReason& reason) {
  std::string text = Visible(reason.message()) + " (" + reason.code();
  if (const std::string place = PlaceText(reason.first()); !place.empty()) text += ", " + place;
  text += ")";
  if (!reason.advice().empty()) text += "; " + reason.advice();
  return text;
}

std::string VerdictLine(v1::Verdict verdict, const VerdictReasons& reasons) {
  std::string text = VerdictText(verdict);
  if (!reasons.empty()) text += ", " + Visible(reasons[0].message());
  if (reasons.size() > 1) text += " (and " + std::to_string(reasons.size() - 1) + " more)";
  return text;
}

int ExitOf(v1::Verdict verdict, bool strict) {
  const bool good = verdict == v1::VERDICT_GOOD || (verdict == v1::VERDICT_DOUBTFUL && !strict);
  return good ? kGood : kProgramErrors;
}

int ExitOf(const v1::Findings& found, bool strict) {
  return found.ok() ? ExitOf(found.verdict(), strict) : int{kProgramErrors};
}

std::string CountText(const v1::Findings& found) {
  const std::int64_t count = found.diagnostics_size() + found.diagnostics_dropped();
  if (count == 0) return {};
  return ", " + std::to_string(count) + (count == 1 ? " finding" : " findings");
}

int ExitOf(const v1::Outcome& outcome, bool strict) {
  if (outcome.verdict() != v1::VERDICT_UNSPECIFIED) return ExitOf(outcome.verdict(), strict);
  // A job that ended before anything was judged, as a run on a machine does: what was halted made
  // no part. LIVE-5.08
  return outcome.kind() == v1::Outcome::KIND_COMPLETED ? kGood : kProgramErrors;
}

}  // namespace rmlcell::cli
