#include "engine/optimo/language/formatter.h"

#include <algorithm>

#include "engine/optimo/language/printer.h"

namespace rmlcell::optimo {
namespace {

constexpr std::size_t kCommentGap = 2;  // blanks between a statement and its comment

// Walks statements, sequence numbers and comments side by side in the order of the text.
class Writer {
 public:
  Writer(const ParsedProgram& program, std::string_view line_end)
      : p_(program), line_end_(line_end) {}

  std::string Write() {
    const Module& module = p_.module;
    out_.reserve(p_.text.size() + p_.text.size() / 4);
    for (std::size_t s = 0; s < module.instructions.size(); ++s) {
      const Instruction& i = module.instructions[s];
      const Statement& statement = p_.statements[s];
      int label = kNoLabel;
      for (std::uint32_t l = 0; l < i.label_count; ++l) {
        const NodePlace& place = p_.label_places[i.first_label + l];
        const bool own_line =
            l + 1 < i.label_count || LineEndBetween(place.offset, statement.begin);
        if (!own_line) {
          label = module.labels[i.first_label + l];
          continue;
        }
        WriteLone(place, module.labels[i.first_label + l]);
      }
      CommentsBefore(statement.begin);
      BlankLinesBefore(label == kNoLabel
                           ? statement.begin
                           : p_.label_places[i.first_label + i.label_count - 1U].offset);
      WriteStatement(i, statement, label);
    }
    for (std::size_t l = 0; l < p_.end_label_places.size(); ++l) {
      WriteLone(p_.end_label_places[l], module.end_labels[l]);
    }
    CommentsBefore(static_cast<std::uint32_t>(p_.text.size()));
    return std::move(out_);
  }

 private:
  bool LineEndBetween(std::size_t begin, std::size_t end) const {
    return p_.text.substr(begin, end - begin).find('\n') != std::string_view::npos;
  }

  // As many blank lines as stand between what was written last and what begins at `offset`.
  void BlankLinesBefore(std::size_t offset) {
    const std::string_view gap = p_.text.substr(done_, offset - std::min(offset, done_));
    const auto line_ends = std::count(gap.begin(), gap.end(), '\n');
    for (auto n = done_ == 0 ? line_ends : line_ends - 1; n > 0; --n) out_ += line_end_;
  }

  void CommentsBefore(std::uint32_t offset) {
    for (; comment_ < p_.comments.size() && p_.comments[comment_].begin < offset; ++comment_) {
      const Comment& comment = p_.comments[comment_];
      BlankLinesBefore(comment.begin);
      const std::size_t line = p_.text.rfind('\n', comment.begin) + 1;  // npos + 1 is 0
      if (comment.begin != line) PrintLabelColumns(kNoLabel, out_);
      out_ += TrimRight(p_.text.substr(comment.begin, comment.end - comment.begin));
      out_ += line_end_;
      done_ = comment.end;
    }
  }

  // The comment on the line on which `end` lies, or nothing.
  void TrailingComment(std::size_t end) {
    if (comment_ < p_.comments.size() && !LineEndBetween(end, p_.comments[comment_].begin)) {
      const Comment& comment = p_.comments[comment_++];
      out_.append(kCommentGap, ' ');
      out_ += TrimRight(p_.text.substr(comment.begin, comment.end - comment.begin));
      done_ = comment.end;
    } else {
      done_ = end;
    }
    out_ += line_end_;
  }

  void WriteLone(const NodePlace& place, int label) {
    CommentsBefore(place.offset);
    BlankLinesBefore(place.offset);
    out_ += std::to_string(label);
    TrailingComment(place.offset + place.length);
  }

  void WriteStatement(const Instruction& i, const Statement& statement, int label) {
    for (; comment_ < p_.comments.size() && p_.comments[comment_].begin < statement.end;
         ++comment_) {
      const Comment& comment = p_.comments[comment_];  // inside a continued statement
      PrintLabelColumns(kNoLabel, out_);
      out_ += TrimRight(p_.text.substr(comment.begin, comment.end - comment.begin));
      out_ += line_end_;
    }
    PrintLabelColumns(label, out_);
    PrintStatement(p_.module, i, out_);
    TrailingComment(statement.end);
  }

  static std::string_view TrimRight(std::string_view text) {
    return text.substr(0, text.find_last_not_of(" \t\r") + 1);  // npos + 1 is 0
  }

  const ParsedProgram& p_;
  std::string_view line_end_;
  std::string out_;
  std::size_t comment_ = 0;
  std::size_t done_ = 0;  // the text before this is written
};

}  // namespace

Formatting Format(std::string_view text) {
  Findings findings(0);
  const ParsedProgram program = Parse(text, findings, Places::kStatements);
  if (findings.error_count() > 0) return {std::string(text), false};
  const std::size_t first_end = program.text.find('\n');
  const bool dos =
      first_end != std::string_view::npos && first_end > 0 && program.text[first_end - 1] == '\r';
  Formatting result;
  result.text = Writer(program, dos ? "\r\n" : "\n").Write();
  result.text += text.substr(program.text.size());  // behind the end of the text, OPT-1.03
  result.changed = result.text != text;
  return result;
}

}  // namespace rmlcell::optimo
