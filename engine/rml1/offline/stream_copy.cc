#include "engine/rml1/offline/stream_copy.h"

#include <algorithm>

#include "engine/rml1/offline/phrase_words.h"

namespace rmlcell::rml1 {
namespace {

bool IsPlainNumber(std::string_view text) {
  if (text.starts_with('+') || text.starts_with('-')) text.remove_prefix(1);
  return std::ranges::all_of(text, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
}

}  // namespace

void StreamCopy::Replace(const Phrase::Value& number, double value) {
  const std::string_view old = stream_->substr(static_cast<std::size_t>(number.begin),
                                               static_cast<std::size_t>(number.end - number.begin));
  if (!IsPlainNumber(old)) return Refuse("a number with other bytes in it", number.begin);
  if (old.find_first_of("0123456789") == std::string_view::npos)
    return Refuse("a lone period as a number: write 0", number.begin);
  if (value < static_cast<double>(kFloatMin) || value > static_cast<double>(kFloatMax))
    return Refuse("a number becomes " + ToldShort("value", value, {}) + ", beyond its range",
                  number.begin);
  if (!CopyUpTo(number.begin)) return;
  constexpr int kDecimals = 6;  // of a 4-byte value that is less than a unit
  std::string text = ShortNumber(value, kDecimals);
  // A period that ended the old number must not go on with the new one.
  const auto next = static_cast<std::size_t>(number.end);
  if (next < stream_->size() && (*stream_)[next] == '.' && text.find('.') == std::string::npos)
    text += ".0";
  text_.Add(text);
  next_ = number.end;
}

void StreamCopy::Insert(std::int64_t at, std::string_view text) {
  if (CopyUpTo(at)) text_.Add(text);
}

void StreamCopy::Refuse(Detail detail, std::int64_t at) {
  if (failed()) return;
  LineCounter lines;
  error_ = Error{ErrorCode::kRml1NotRewritten, std::move(detail), lines.At(*stream_, at, 1)};
}

Status StreamCopy::Finish(std::int64_t end) {
  CopyUpTo(end);
  if (error_) return *error_;
  text_.HandOver();
  return {};
}

bool StreamCopy::CopyUpTo(std::int64_t end) {
  if (failed()) return false;
  if (end < next_) {
    Refuse("a command whose first numbers are changed already", end);
    return false;
  }
  while (next_ < end) {
    const std::int64_t part =
        std::min<std::int64_t>(end - next_, std::int64_t{machine::kReleaseEvery});
    text_.Add(stream_->substr(static_cast<std::size_t>(next_), static_cast<std::size_t>(part)));
    next_ += part;
    if (part == std::int64_t{machine::kReleaseEvery}) stream_.Release();
  }
  return true;
}

std::optional<Detail> WhyNotFollowed(const Phrase& phrase) {
  using Kind = Phrase::Kind;
  if (phrase.kind != Kind::kSet && phrase.kind != Kind::kGroup && phrase.kind != Kind::kLeftOver)
    return std::nullopt;
  for (const Finding& finding : phrase.findings) {
    if (IsError(finding.kind)) return DetailOf(finding);
  }
  if (phrase.kind == Kind::kLeftOver) return "numbers that are not carried out";
  return std::nullopt;
}

std::optional<std::size_t> AxisOf(const Phrase::Value& value, std::size_t index) {
  if (value.axis == 0) return index;
  const std::size_t axis = std::string_view("XYZ").find(value.axis);
  return axis == std::string_view::npos ? std::nullopt : std::optional(axis);
}

bool IsRelative(const Phrase& phrase) {
  const ModeChange mode = RowOf(phrase.op).mode;
  return mode == ModeChange::kNone ? !phrase.before->absolute : mode == ModeChange::kRelative;
}

}  // namespace rmlcell::rml1
