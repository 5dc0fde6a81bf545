#include "engine/optimo/language/source_map.h"

#include <algorithm>
#include <utility>

#include "engine/optimo/language/byte_stream.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/linker.h"
#include "engine/optimo/language/parser.h"

namespace rmlcell::optimo {
namespace {

constexpr std::string_view kMapMagic = "LMS";
constexpr unsigned kMapVersion = 1;
constexpr unsigned kInchFlag = 1;

}  // namespace

SourceMap MapSource(std::string_view text, bool inch, std::string_view object) {
  return {HashObject(object), inch, std::string(text)};
}

std::string EncodeSourceMap(const SourceMap& map) {
  ByteWriter out;
  out.Raw(kMapMagic);
  out.Byte(kMapVersion);
  out.Byte(map.inch ? kInchFlag : 0);
  out.Fixed64(map.object_hash);
  out.Text(map.text);
  out.Fixed32(Checksum(out.bytes()));
  return out.Take();
}

Result<SourceMap> DecodeSourceMap(std::string_view bytes) {
  const Error corrupt{ErrorCode::kObjectCorrupt, "the source map is damaged", {}};
  constexpr std::size_t kTail = 4;
  if (bytes.size() < kMapMagic.size() + kTail || !bytes.starts_with(kMapMagic)) return corrupt;
  const std::string_view body = bytes.substr(0, bytes.size() - kTail);
  if (ByteReader(bytes.substr(body.size())).Fixed32() != Checksum(body)) return corrupt;
  ByteReader in(body.substr(kMapMagic.size()));
  if (in.Byte() != kMapVersion) return corrupt;
  const unsigned flags = in.Byte();
  SourceMap map;
  map.inch = flags == kInchFlag;
  map.object_hash = in.Fixed64();
  map.text = std::string(in.Text(kSourceBytesMax));
  if (in.bad() || !in.AtEnd() || flags > kInchFlag) return corrupt;
  return map;
}

Result<RecoveredSource> RecoverSource(std::string_view object,
                                      std::optional<std::string_view> source_map) {
  if (source_map) {
    Result<SourceMap> map = DecodeSourceMap(*source_map);
    if (map && map->object_hash == HashObject(object))
      return RecoveredSource{std::move(map->text), true, map->inch};
  }
  Result<std::string> text = ObjectToSource(object);
  if (!text) return text.error();
  return RecoveredSource{std::move(*text), false, false};
}

std::vector<int> LinesOfSteps(std::string_view text) {
  Findings findings(0);
  const ParsedProgram program = Parse(text, findings, Places::kStatements);
  return LinesOfSteps(program);
}

std::vector<int> LinesOfSteps(const ParsedProgram& program) {
  const std::string_view text = program.text;
  std::vector<int> lines;
  int line = 1;
  std::size_t at = 0;
  const auto line_at = [&](std::size_t offset) {
    offset = std::min(offset, text.size());
    line += static_cast<int>(std::count(text.begin() + static_cast<std::ptrdiff_t>(at),
                                        text.begin() + static_cast<std::ptrdiff_t>(offset), '\n'));
    at = offset;
    return line;
  };
  for (std::size_t i = 0; i < program.statements.size(); ++i) {
    if (program.module.instructions[i].step == 0) continue;
    lines.push_back(line_at(program.statements[i].begin));
  }
  lines.push_back(program.statements.empty() ? 1 : line_at(program.statements.back().end) + 1);
  return lines;
}

}  // namespace rmlcell::optimo
