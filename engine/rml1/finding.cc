#include "engine/rml1/finding.h"

#include <algorithm>
#include <array>
#include <limits>

#include "engine/core/hex.h"
#include "engine/core/number_text.h"

namespace rmlcell::rml1 {
namespace {

constexpr std::array kFindings = {
    FindingRow{FindingKind::kForeignCharacter, ErrorCode::kRml1UnknownCommand, "RML1-2.05"},
    FindingRow{FindingKind::kUnknownName, ErrorCode::kRml1UnknownCommand, "RML1-2.09"},
    FindingRow{FindingKind::kStrayNumber, ErrorCode::kRml1WrongParameters, "RML1-2.02"},
    FindingRow{FindingKind::kUnknownCall, ErrorCode::kRml1WrongParameters, "RML1-3A.31"},
    FindingRow{FindingKind::kAxisTwice, ErrorCode::kRml1WrongParameters, "RML1-3D.15"},
    FindingRow{FindingKind::kAxisValue, ErrorCode::kRml1ParameterRange, "RML1-3D.16"},
    FindingRow{FindingKind::kAxisLetter, ErrorCode::kRml1ParameterRange, "RML1-3D.17"},
    FindingRow{FindingKind::kAxesTogether, ErrorCode::kRml1ParameterRange, "RML1-3D.13"},
    FindingRow{FindingKind::kLeftOver, ErrorCode::kRml1WrongParameters, "RML1-9.15"},
    FindingRow{FindingKind::kValueRange, ErrorCode::kRml1ParameterRange, "RML1-2.34"},
    FindingRow{FindingKind::kHeightRange, ErrorCode::kRml1ParameterRange, "RML1-3C.13"},
    FindingRow{FindingKind::kSettingRange, ErrorCode::kRml1ParameterRange, "RML1-2.33"},
    FindingRow{FindingKind::kTravelRange, ErrorCode::kRml1ParameterRange, "RML1-3C.29"},
    FindingRow{FindingKind::kBadSequence, ErrorCode::kRml1BadSequence, "RML1-4.05"},
    FindingRow{FindingKind::kBadSequenceParameter, ErrorCode::kRml1BadSequenceParameter,
               "RML1-4.16"},
    FindingRow{FindingKind::kSequenceParameterRange, ErrorCode::kRml1SequenceParameterRange,
               "RML1-4.15"},
    FindingRow{FindingKind::kTooManySequenceParameters, ErrorCode::kRml1TooManySequenceParameters,
               "RML1-4.19"},
    FindingRow{FindingKind::kLineError, ErrorCode::kRml1LineError, "RML1-4.23"},
    FindingRow{FindingKind::kBufferOverflow, ErrorCode::kRml1BufferOverflow, "RML1-4.23"},
    FindingRow{FindingKind::kSpeedLimited, ErrorCode::kRml1SpeedClamped, "RML1-3A.46"},
    FindingRow{FindingKind::kClipped, ErrorCode::kRml1Clipped, "RML1-5A.01"},
    FindingRow{FindingKind::kSkippedName, ErrorCode::kRml1SkippedName, "RML1-9.48"},
    FindingRow{FindingKind::kLogCut, ErrorCode::kRml1LogCut, "RML1-6.10"},
};

constexpr bool IsIndexedByKind() {
  for (std::size_t i = 0; i < kFindings.size(); ++i) {
    if (static_cast<std::size_t>(kFindings[i].kind) != i) return false;
  }
  return kFindings.size() == static_cast<std::size_t>(kFindingKindCount);
}
static_assert(IsIndexedByKind(), "one row per FindingKind, in its order");

// 'X', or 0x9F where the byte is no printing character.
Detail ByteText(unsigned char byte) {
  const auto c = static_cast<char>(byte);
  if (byte > 0x20 && byte < 0x7F) return "'" + Told("character", {&c, 1}) + "'";
  return Told("byte", byte, {}, "0x" + HexByte(c));
}

}  // namespace

const FindingRow& RowOf(FindingKind kind) { return kFindings[static_cast<std::size_t>(kind)]; }

Detail DetailOf(const Finding& finding) {
  const auto name = [&] { return Told("command", RowOf(finding.op).name); };
  const auto told = [](std::string_view argument, double number) {
    return Told(argument, number, {}, ShortestText(number));
  };
  switch (finding.kind) {
    case FindingKind::kForeignCharacter:
      return ByteText(finding.byte) + " begins no command";
    case FindingKind::kUnknownName:
      return "the name that ends with " + ByteText(finding.byte) + " is no command";
    case FindingKind::kStrayNumber:
      return ByteText(finding.byte) + " where a command is expected";
    case FindingKind::kUnknownCall:
      return "the name after ^ that ends with " + ByteText(finding.byte) +
             " is no command of two letters";
    case FindingKind::kAxisTwice:
      return "axis " + ByteText(finding.byte) + " twice in one group";
    case FindingKind::kAxisValue:
      return "an axis letter without a number";
    case FindingKind::kAxisLetter:
      return ByteText(finding.byte) + " where an axis letter is expected";
    case FindingKind::kAxesTogether:
      return "Y and A cannot move in one group";
    case FindingKind::kLeftOver:
      return name() + " lacks a number of its last set";
    case FindingKind::kValueRange:
      return "a coordinate of " + name() + " becomes " + told("value", finding.value);
    case FindingKind::kHeightRange:
      return "a tool height of " + Told("value", finding.value, {}, FixedText(finding.value, 0)) +
             ", allowed are " + told("least", finding.allowed.low) + " to " +
             told("most", finding.allowed.high);
    case FindingKind::kSettingRange:
      return name() + " " + told("value", finding.value);
    case FindingKind::kTravelRange:
      return name() + " leads to machine Z " + told("value", finding.value);
    case FindingKind::kSpeedLimited:
      return name() + " " + told("value", finding.value) + " is beyond the machine";
    case FindingKind::kClipped:
      return "the tool could not follow " + name() + " to its end";
    case FindingKind::kSkippedName:
      return name() + " was skipped";
    default:
      return {};
  }
}

SourceSpan LineCounter::At(std::string_view stream, std::int64_t offset, int length) {
  const auto size = static_cast<std::int64_t>(stream.size());
  const std::int64_t wanted = std::clamp<std::int64_t>(offset, 0, size);
  if (wanted < at_) {  // a little back: the name of a command, after an error inside it
    const std::string_view between =
        stream.substr(static_cast<std::size_t>(wanted), static_cast<std::size_t>(at_ - wanted));
    const auto ends = std::count(between.begin(), between.end(), '\n');
    if (ends > 0) {
      line_ -= static_cast<int>(ends);
      const std::size_t before = wanted == 0
                                     ? std::string_view::npos
                                     : stream.rfind('\n', static_cast<std::size_t>(wanted - 1));
      line_start_ = before == std::string_view::npos ? 0 : static_cast<std::int64_t>(before) + 1;
    }
  }
  while (at_ < wanted) {
    const std::string_view rest =
        stream.substr(static_cast<std::size_t>(at_), static_cast<std::size_t>(wanted - at_));
    const std::size_t end = rest.find('\n');
    if (end == std::string_view::npos) break;
    at_ += static_cast<std::int64_t>(end) + 1;
    ++line_;
    line_start_ = at_;
  }
  at_ = wanted;
  const std::int64_t column =
      std::min<std::int64_t>(wanted - line_start_ + 1, std::numeric_limits<int>::max());
  return {
      .line = line_, .column = static_cast<int>(column), .length = length, .byte_offset = offset};
}

Diagnostic PlainDiagnostic(const Finding& finding, std::string_view stream, LineCounter& lines) {
  const ErrorCode code = RowOf(finding.kind).code;
  Diagnostic diagnostic{.code = code, .severity = Lookup(code).severity, .step = finding.step};
  if (!stream.empty()) diagnostic.where = lines.At(stream, finding.offset, finding.length);
  return diagnostic;
}

Diagnostic ToDiagnostic(const Finding& finding, std::string_view stream, LineCounter& lines) {
  Diagnostic diagnostic = PlainDiagnostic(finding, stream, lines);
  diagnostic.detail = DetailOf(finding);
  diagnostic.rule = RowOf(finding.kind).rule;
  return diagnostic;
}

}  // namespace rmlcell::rml1
