#include "engine/rml1/offline/explain.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "engine/rml1/offline/phrase_words.h"

namespace rmlcell::rml1 {
namespace {

class Explainer final : public PhraseListener {
 public:
  Explainer(std::string_view stream, const Profile& profile,
            const std::function<bool(const ExplainedPhrase&)>& consumer)
      : stream_(stream), profile_(profile), consumer_(consumer) {}

  bool OnPhrase(const Phrase& phrase) override {
    if (phrase.kind == Phrase::Kind::kDiscarded) {
      if (discarded_ && BlanksBetween(discarded_->end, phrase.begin)) {
        discarded_->end = phrase.end;
        KeepFindings(phrase);
        return true;
      }
      if (!Flush()) return false;
      discarded_ = Phrase{.begin = phrase.begin, .end = phrase.end};
      KeepFindings(phrase);
      return true;
    }
    return Flush() && Tell(phrase, Findings(phrase));
  }

  // What is left at the end.
  bool Flush() {
    if (!discarded_) return true;
    const Phrase phrase = *discarded_;
    discarded_.reset();
    return Tell(phrase, std::exchange(kept_, {}));
  }

 private:
  bool BlanksBetween(std::int64_t from, std::int64_t to) const {
    return std::ranges::all_of(Part(from, to), [](char c) { return c == ' ' || c == '\t'; });
  }
  std::string_view Part(std::int64_t begin, std::int64_t end) const {
    const auto size = static_cast<std::int64_t>(stream_.size());
    begin = std::clamp<std::int64_t>(begin, 0, size);
    return stream_.substr(static_cast<std::size_t>(begin),
                          static_cast<std::size_t>(std::clamp(end, begin, size) - begin));
  }
  std::vector<Diagnostic> Findings(const Phrase& phrase) {
    std::vector<Diagnostic> findings;
    for (const Finding& finding : phrase.findings)
      findings.push_back(ToDiagnostic(finding, stream_, lines_));
    return findings;
  }
  // A run of bytes that are no command has an error for each: the first ones say it.
  void KeepFindings(const Phrase& phrase) {
    if (kept_.size() >= Phrase::kFindingsMax) return;
    for (Diagnostic& finding : Findings(phrase)) kept_.push_back(std::move(finding));
  }

  bool Tell(const Phrase& phrase, std::vector<Diagnostic> findings) {
    const bool is_command = phrase.command > 0 && phrase.kind != Phrase::Kind::kIncomplete;
    if (phrase.kind == Phrase::Kind::kIncomplete) {
      constexpr ErrorCode kCode = ErrorCode::kRml1IncompleteCommand;
      findings.push_back({.code = kCode,
                          .severity = Lookup(kCode).severity,
                          .detail = "incomplete command at end of data",
                          .rule = "RML1-9.42",
                          .where = lines_.At(stream_, phrase.begin, 1)});
    }
    std::string text(Part(phrase.begin, std::min<std::int64_t>(
                                            phrase.end, phrase.begin + std::int64_t{kShownBytes})));
    const std::size_t first = text.find_first_not_of(" \t\r\n,");
    const std::size_t skipped = first == std::string::npos ? 0 : first;
    text.erase(0, skipped);
    text.erase(text.find_last_not_of(" \t\r\n") + 1);
    return consumer_({.offset = phrase.begin + static_cast<std::int64_t>(skipped),
                      .command = phrase.command,
                      .name = is_command ? std::string(RowOf(phrase.op).name) : std::string(),
                      .text = std::move(text),
                      .words = WordsOf(phrase, profile_),
                      .findings = std::move(findings)});
  }

  static_assert(kShownBytes < 1000, "a line for people");

  std::string_view stream_;
  const Profile& profile_;
  const std::function<bool(const ExplainedPhrase&)>& consumer_;
  LineCounter lines_;
  std::optional<Phrase> discarded_;
  std::vector<Diagnostic> kept_;
};

}  // namespace

Status Explain(std::string_view stream, const machine::Parameters& parameters,
               const std::function<bool(const ExplainedPhrase&)>& consumer) {
  if (stream.empty()) return Error{ErrorCode::kCellEmptyProgram, "the stream has no bytes", {}};
  const Result<Profile> profile = MakeProfile(parameters);
  if (!profile) return profile.error();
  Explainer explainer(stream, *profile, consumer);
  StreamWalk walk(*profile, explainer);
  if (walk.Run(stream)) explainer.Flush();
  return {};
}

}  // namespace rmlcell::rml1
