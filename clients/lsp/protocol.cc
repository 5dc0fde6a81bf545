#include "clients/lsp/protocol.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>

namespace rmlcell::lsp {
namespace {

bool TooDeep(std::string_view text) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (quoted) {
      if (c == '\\') ++at;
      if (c == '"') quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kJsonDepthMax) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

// From zero; beyond what a position can hold it is the largest.
std::optional<std::uint32_t> Count(const Json* json) {
  if (json == nullptr || !json->is_number_integer()) return std::nullopt;
  const bool below_zero = !json->is_number_unsigned() && json->get<std::int64_t>() < 0;
  if (below_zero) return std::nullopt;
  constexpr auto kMost = std::uint64_t{std::numeric_limits<std::uint32_t>::max()};
  return static_cast<std::uint32_t>(std::min(json->get<std::uint64_t>(), kMost));
}

// The 16 bits of the escape "\uXXXX" that begins at `at`; nothing when there is none.
std::optional<unsigned> EscapedUnit(std::string_view text, std::size_t at) {
  if (text.size() - std::min(at, text.size()) < 6 || text[at] != '\\' || text[at + 1] != 'u')
    return std::nullopt;
  unsigned unit = 0;
  const char* begin = text.data() + at + 2;
  const auto [end, error] = std::from_chars(begin, begin + 4, unit, 16);
  if (error != std::errc() || end != begin + 4) return std::nullopt;
  return unit;
}

// Half a surrogate pair is no character, but JavaScript has such strings, and an editor sends them
// while a pair is typed, or cut in two. It becomes U+FFFD, one unit of UTF-16 as well.
std::string WithWholePairs(std::string_view text) {
  std::string whole(text);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    if (whole[at] != '\\') continue;
    const auto unit = EscapedUnit(whole, at);
    if (!unit || *unit < 0xD800 || *unit > 0xDFFF) {
      ++at;  // of "\\" the second does not begin an escape
      continue;
    }
    const auto next = EscapedUnit(whole, at + 6);
    if (*unit < 0xDC00 && next && *next >= 0xDC00 && *next <= 0xDFFF) {
      at += 11;
    } else {
      whole.replace(at, 6, "\\uFFFD");
    }
  }
  return whole;
}

}  // namespace

std::optional<Json> ReadJson(std::string_view text) {
  if (TooDeep(text)) return std::nullopt;
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) json = Json::parse(WithWholePairs(text), nullptr, false);
  if (json.is_discarded()) return std::nullopt;
  return json;
}

std::string WriteJson(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

const Json* Member(const Json& json, std::initializer_list<std::string_view> path) {
  const Json* at = &json;
  for (const std::string_view name : path) {
    if (!at->is_object()) return nullptr;
    const auto found = at->find(name);
    if (found == at->end()) return nullptr;
    at = &*found;
  }
  return at;
}

std::optional<std::string> TextMember(const Json& json,
                                      std::initializer_list<std::string_view> path) {
  const Json* member = Member(json, path);
  if (member == nullptr || !member->is_string()) return std::nullopt;
  return member->get<std::string>();
}

bool FlagMember(const Json& json, std::initializer_list<std::string_view> path) {
  const Json* member = Member(json, path);
  return member != nullptr && member->is_boolean() && member->get<bool>();
}

std::optional<std::int64_t> NumberMember(const Json& json,
                                         std::initializer_list<std::string_view> path) {
  const Json* member = Member(json, path);
  if (member == nullptr || !member->is_number_integer()) return std::nullopt;
  return member->get<std::int64_t>();
}

bool Lists(const Json& json, std::initializer_list<std::string_view> path, std::string_view text) {
  const Json* member = Member(json, path);
  return member != nullptr && member->is_array() &&
         std::ranges::any_of(*member, [&](const Json& one) {
           return one.is_string() && one.get_ref<const std::string&>() == text;
         });
}

std::optional<Position> ReadPosition(const Json& json) {
  const auto line = Count(Member(json, {"line"}));
  const auto character = Count(Member(json, {"character"}));
  if (!line || !character) return std::nullopt;
  return Position{*line, *character};
}

std::optional<Range> ReadRange(const Json& json) {
  const Json* start = Member(json, {"start"});
  const Json* end = Member(json, {"end"});
  if (start == nullptr || end == nullptr) return std::nullopt;
  const auto from = ReadPosition(*start);
  const auto to = ReadPosition(*end);
  if (!from || !to) return std::nullopt;
  return Range{*from, *to};
}

Json ToJson(Position position) {
  return {{"line", position.line}, {"character", position.character}};
}
Json ToJson(const Range& range) {
  return {{"start", ToJson(range.start)}, {"end", ToJson(range.end)}};
}
Json Location(std::string_view uri, const Range& range) {
  return {{"uri", uri}, {"range", ToJson(range)}};
}
Json TextEdit(const Range& range, std::string_view text) {
  return {{"range", ToJson(range)}, {"newText", text}};
}
Json Markdown(std::string_view text) { return {{"kind", "markdown"}, {"value", text}}; }

}  // namespace rmlcell::lsp
