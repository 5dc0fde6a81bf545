#include "tests/fuzz/optimo_language_input.h"

#include <algorithm>

#include "engine/optimo/language/byte_stream.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/formatter.h"
#include "engine/optimo/language/linker.h"
#include "engine/optimo/language/source_map.h"
#include "engine/optimo/offline/compensate.h"
#include "engine/optimo/offline/convert.h"
#include "engine/optimo/offline/fix_program.h"
#include "engine/optimo/offline/translate.h"

namespace rmlcell::optimo {
namespace {

std::ptrdiff_t LinesOf(std::string_view text) { return std::ranges::count(text, '\n'); }

CompileOptions Silent() { return {.object_limit = 0, .advice = false}; }

// Objects once had the sign of "-(5)" beside its literal, and are read as what they mean
// (OPT-B.40).
bool HasSignBesideLiteral(std::string_view bytes) {
  return bytes.find("\x26\x01") != std::string_view::npos ||
         bytes.find("\x26\x02") != std::string_view::npos;
}

std::string TryObjectBytes(std::string_view bytes) {
  const Result<Module> module = DecodeObject(bytes);
  if (!module) return {};
  const std::string object = EncodeObject(*module);
  if (object != bytes && !HasSignBesideLiteral(bytes))
    return "the object is encoded to other bytes";
  const std::string source = Decompile(*module);
  const Compilation again = Compile(source, {}, Silent());
  if (!again.ok) return "the decompiled source does not compile: " + source;
  if (again.object != object) return "the decompiled source gives another object: " + source;
  return {};
}

// All that is neither a number nor beside one.
std::string WordsOf(std::string_view text) {
  std::string words;
  for (const char c : text) {
    const bool number = (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+' || c == 'e' ||
                        c == 'E' || c == ' ' || c == '\t';
    if (!number) words += c;
  }
  return words;
}

// RepairedText comes to rest, and harms neither lines nor comments.
std::string TryFixes(std::string_view bytes) {
  const ProgramCheck check = [](const machine::SourceFile& file) {
    return TranslateOptimo(file, {}, 0);
  };
  const RepairedText fixed = FixProgram({.name = "a.S", .bytes = bytes}, check);
  if (LinesOf(fixed.text) != LinesOf(bytes)) return "fixing took a line: " + fixed.text;
  if (std::ranges::count(fixed.text, ';') != std::ranges::count(bytes, ';'))
    return "fixing took a comment: " + fixed.text;
  const RepairedText again = FixProgram({.name = "a.S", .bytes = fixed.text}, check);
  if (again.text != fixed.text) return "fixing does not come to rest: " + fixed.text;
  return {};
}

}  // namespace

std::string TryText(std::string_view bytes) {
  const Compilation compiled = Compile(bytes, {}, {.object_limit = 0});
  for (const Diagnostic& d : compiled.diagnostics) {
    if (d.where.line < 0 || d.where.line > LinesOf(bytes) + 1) return "a finding beyond the text";
    for (const Fix& fix : d.fixes) {
      if (fix.byte_offset < 0 || fix.length < 0 ||
          static_cast<std::size_t>(fix.byte_offset + fix.length) > bytes.size()) {
        return "a fix beyond the text";
      }
    }
  }
  const bool fixable = std::ranges::any_of(compiled.diagnostics,
                                           [](const Diagnostic& d) { return !d.fixes.empty(); });
  if (fixable) {
    if (const std::string wrong = TryFixes(bytes); !wrong.empty()) return wrong;
  }
  const std::string formatted = Format(bytes).text;
  if (Format(formatted).text != formatted) return "format is not idempotent: " + formatted;
  LinesOfSteps(bytes);
  if (!compiled.ok) return {};
  if (const std::string wrong = TryObjectBytes(compiled.object); !wrong.empty()) return wrong;
  const Compilation again = Compile(formatted, {}, Silent());
  if (again.object != compiled.object) return "format changes the program: " + formatted;
  return {};
}

std::string TryObject(std::string_view bytes) {
  if (const std::string wrong = TryObjectBytes(bytes); !wrong.empty()) return wrong;
  const Result<Executable> executable = DecodeExecutable(bytes);
  if (executable && EncodeExecutable(*executable) != bytes) return "another executable";
  const Result<SourceMap> map = DecodeSourceMap(bytes);
  if (map && EncodeSourceMap(*map) != bytes) return "another source map";
  ByteWriter framed;
  framed.Raw(std::string_view("LMR\x01", 4));
  framed.Raw(bytes);
  framed.Fixed32(Checksum(framed.bytes()));
  return TryObjectBytes(framed.bytes());
}

std::string TryConvert(std::string_view bytes) {
  if (bytes.empty()) return {};
  const bool odd = (static_cast<unsigned char>(bytes[0]) & 1U) != 0;
  const std::string_view text = bytes.substr(1);
  const Conversion converted = Convert(text, odd ? Direction::kToInch : Direction::kToMetric);
  if (LinesOf(converted.text) != LinesOf(text)) return "lines came or went";
  if (WordsOf(converted.text) != WordsOf(text)) return "words changed: " + converted.text;
  const Conversion back = Convert(converted.text, odd ? Direction::kToMetric : Direction::kToInch);
  if (WordsOf(back.text) != WordsOf(text)) return "words changed on the way back: " + back.text;
  return {};
}

std::string TryCompensate(std::string_view bytes) {
  const Compensation compensated = Compensate(bytes);
  if (!compensated.ok) return compensated.text.empty() ? "" : "a text in spite of an error";
  if (LinesOf(compensated.text) != LinesOf(bytes)) return "lines came or went";
  Findings findings;
  Parse(compensated.text, findings);
  if (findings.error_count() > 0) return "the result has errors: " + compensated.text;
  return {};
}

}  // namespace rmlcell::optimo
