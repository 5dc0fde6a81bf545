#include "engine/optimo/language/silence.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <string>
#include <utility>

#include "engine/core/letters.h"
#include "engine/optimo/language/nearest_word.h"

namespace rmlcell::optimo {
namespace {

constexpr std::string_view kMark = "rmlcell:";
constexpr std::string_view kAllow = "allow";
constexpr std::string_view kWholeFile = "in file";
// Warnings that a program gets when it runs, whatever was found in its text.
constexpr std::array kToldByRuns{
    ErrorCode::kFlyCancelled,    ErrorCode::kFlyReversal,       ErrorCode::kSpeedHeldByAxis,
    ErrorCode::kSpeedLimited,    ErrorCode::kArcIsStraight,     ErrorCode::kWorkActiveAtEnd,
    ErrorCode::kExecutableStale, ErrorCode::kBeamOffBySchedule, ErrorCode::kGasConflict};
constexpr std::size_t kNoStatement = std::string_view::npos;

// What a comment asks for; no numbers and no complaint when it is an ordinary one.
struct Directive {
  std::vector<int> numbers;
  bool whole_file = false;
  Detail complaint;        // why it cannot be followed
  std::vector<Fix> fixes;  // of the complaint; from the beginning of the comment
};

Directive ReadDirective(std::string_view comment) {
  Directive directive;
  std::size_t at = comment.find_first_not_of(" \t;");
  if (at == std::string_view::npos || LowerCase(comment.substr(at, kMark.size())) != kMark)
    return directive;
  const std::string text = LowerCase(comment);
  at = std::min(text.find_first_not_of(" \t", at + kMark.size()), text.size());
  const std::size_t end =
      std::min(text.find_first_not_of("abcdefghijklmnopqrstuvwxyz", at), text.size());
  if (const std::string word = text.substr(at, end - at); word != kAllow) {
    directive.complaint =
        word.empty() ? Detail("no word stands behind rmlcell:")
                     : "'" + Told("word", word.substr(0, 20)) + "' is no word for rmlcell:";
    directive.complaint += "; write rmlcell: allow and the numbers of findings";
    const NearWords near = NearestWords(word, std::array{kAllow});
    if (near.IsSingle(Slip::kOneLetter) || near.IsSingle(Slip::kSwap)) {
      directive.fixes = {
          {static_cast<std::int64_t>(at), static_cast<int>(word.size()), std::string(kAllow)}};
    }
    return directive;
  }
  const std::string rest = text.substr(end);
  const std::size_t word = std::min(rest.find_first_not_of("0123456789 \t,"), rest.size());
  directive.whole_file = std::string_view(rest).substr(word).starts_with(kWholeFile);
  int number = 0;
  for (const char c : rest.substr(0, word) + ' ') {
    if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
      number = std::min(number * 10 + (c - '0'), 100'000);
      continue;
    }
    if (number > 0) directive.numbers.push_back(number);
    number = 0;
  }
  if (directive.numbers.empty()) directive.complaint = "allow needs the numbers of findings";
  return directive;
}

// One number of one directive.
struct Allowance {
  int number = 0;
  std::size_t statement = kNoStatement;  // of which it is allowed; kNoStatement: of the whole text
  std::size_t comment = 0;
  bool used = false;
};

class Silencer {
 public:
  explicit Silencer(const ParsedProgram& program) : program_(program) {}

  void ReadComments();
  void Drop(std::vector<Diagnostic>& diagnostics);
  void Tell(const SilenceOptions& options, std::vector<Diagnostic>& diagnostics);
  std::vector<AllowedFinding> Allowed() const;

 private:
  std::size_t StatementOf(const Comment& comment) const;
  std::size_t StatementAt(std::int64_t offset) const;
  struct Complaint {
    std::size_t comment = 0;
    Detail detail;
    std::vector<Fix> fixes{};
  };
  void Add(const Complaint& complaint, std::string_view file,
           std::vector<Diagnostic>& diagnostics) const;

  const ParsedProgram& program_;
  std::vector<Allowance> allowances_;
  std::multimap<std::pair<int, std::size_t>, std::size_t> by_place_;  // number, statement
  std::vector<Complaint> complaints_;
};

// The last statement that begins at or before this byte.
std::size_t Silencer::StatementAt(std::int64_t offset) const {
  const auto behind = std::ranges::upper_bound(
      program_.statements, offset, {}, [](const Statement& s) -> std::int64_t { return s.begin; });
  if (behind == program_.statements.begin()) return kNoStatement;
  return static_cast<std::size_t>(behind - program_.statements.begin()) - 1;
}

// The statement that the comment stands in or behind, on any of its lines; on a line of its own,
// or behind a lone sequence number, the next one.
std::size_t Silencer::StatementOf(const Comment& comment) const {
  const std::size_t before = StatementAt(comment.begin);
  if (before != kNoStatement) {
    const std::uint32_t end = std::min(program_.statements[before].end, comment.begin);
    const std::string_view between = program_.text.substr(end, comment.begin - end);
    if (between.find('\n') == std::string_view::npos) return before;
  }
  const std::size_t next = before == kNoStatement ? 0 : before + 1;
  return next < program_.statements.size() ? next : kNoStatement;
}

void Silencer::ReadComments() {
  for (std::size_t c = 0; c < program_.comments.size(); ++c) {
    const Comment& comment = program_.comments[c];
    const std::string_view text = program_.text.substr(comment.begin, comment.end - comment.begin);
    if (text.find(':') == std::string_view::npos) continue;
    Directive directive = ReadDirective(text);
    if (!directive.complaint.empty())
      complaints_.push_back({c, std::move(directive.complaint), std::move(directive.fixes)});
    for (const int number : directive.numbers) {
      const auto code = FindError(ErrorFamily::kOptimo, number);
      if (!code || IsError(Lookup(*code).severity)) {
        complaints_.push_back(
            {c, Told("number", number) + (code ? " is an error, which no comment allows"
                                               : " is the number of no finding")});
        continue;
      }
      const std::size_t statement = directive.whole_file ? kNoStatement : StatementOf(comment);
      if (!directive.whole_file && statement == kNoStatement) continue;  // nothing follows
      by_place_.emplace(std::pair(number, statement), allowances_.size());
      allowances_.push_back({number, statement, c});
    }
  }
}

void Silencer::Drop(std::vector<Diagnostic>& diagnostics) {
  if (allowances_.empty()) return;
  std::erase_if(diagnostics, [&](const Diagnostic& d) {
    if (IsError(d.severity)) return false;
    const int number = Lookup(d.code).number;
    bool allowed = false;
    for (const std::size_t place : {StatementAt(d.where.byte_offset), kNoStatement}) {
      const auto [first, last] = by_place_.equal_range({number, place});
      for (auto at = first; at != last; ++at) allowed = allowances_[at->second].used = true;
      if (allowed) break;
    }
    return allowed;
  });
}

// Statements come in the order of the text, and so do the comments of each.
std::vector<AllowedFinding> Silencer::Allowed() const {
  std::vector<AllowedFinding> allowed;
  int line = 1;
  std::size_t at = 0;
  for (const Allowance& allowance : allowances_) {
    if (allowance.statement == kNoStatement) {
      allowed.push_back({.line = 0, .number = allowance.number});
      continue;
    }
    const std::size_t begin = program_.statements[allowance.statement].begin;
    line += static_cast<int>(std::ranges::count(program_.text.substr(at, begin - at), '\n'));
    at = begin;
    allowed.push_back({.line = line, .number = allowance.number});
  }
  return allowed;
}

void Silencer::Add(const Complaint& complaint, std::string_view file,
                   std::vector<Diagnostic>& diagnostics) const {
  const Comment& at = program_.comments[complaint.comment];
  Diagnostic& told = diagnostics.emplace_back();
  told.code = ErrorCode::kPracticeAdvice;
  told.severity = Severity::kAdvice;
  told.detail = complaint.detail;
  told.file = file;
  told.fixes = complaint.fixes;
  for (Fix& fix : told.fixes) fix.byte_offset += at.begin;
  told.where.byte_offset = at.begin;
  told.where.length = static_cast<int>(at.end - at.begin);
  const std::string_view before = program_.text.substr(0, at.begin);
  told.where.line = static_cast<int>(std::ranges::count(before, '\n')) + 1;
  const std::size_t line = before.rfind('\n') + 1;  // npos + 1 is 0
  told.where.column = static_cast<int>(at.begin - line) + 1;
}

void Silencer::Tell(const SilenceOptions& options, std::vector<Diagnostic>& diagnostics) {
  for (const Allowance& allowance : allowances_) {
    const bool of_contours = allowance.number >= 7317 && allowance.number <= 7319;
    if (!options.tell_idle || allowance.used || (of_contours && !options.with_contours)) continue;
    if (std::ranges::any_of(
            kToldByRuns, [&](ErrorCode code) { return Lookup(code).number == allowance.number; })) {
      continue;
    }
    complaints_.push_back({allowance.comment,
                           "allow " + Told("number", allowance.number) + " silences nothing here"});
  }
  if (complaints_.empty()) return;
  std::ranges::stable_sort(complaints_, {}, &Complaint::comment);
  constexpr std::size_t kComplaintsMax = 100;  // each looks for its line
  if (complaints_.size() > kComplaintsMax) complaints_.resize(kComplaintsMax);
  for (const Complaint& complaint : complaints_) Add(complaint, options.file, diagnostics);
  std::ranges::stable_sort(diagnostics, {},
                           [](const Diagnostic& d) { return d.where.byte_offset; });
}

}  // namespace

std::vector<AllowedFinding> Silence(const ParsedProgram& program, const SilenceOptions& options,
                                    std::vector<Diagnostic>& diagnostics) {
  Silencer silencer(program);
  silencer.ReadComments();
  silencer.Drop(diagnostics);
  silencer.Tell(options, diagnostics);
  return silencer.Allowed();
}

}  // namespace rmlcell::optimo
