#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "clients/lsp/document.h"
#include "clients/lsp/protocol.h"
#include "engine/core/diagnostic.h"

// What `rmlcell check` would say of a document, as the editor shows it.
namespace rmlcell::lsp {

// Language identifiers of the client, for documents whose name does not tell.
inline constexpr std::string_view kOptimoLanguage = "optimo-rml";
inline constexpr std::string_view kRml1Language = "rml1";
// A longer text is edited but not checked or searched: the control holds 34,000 bytes of it, and a
// stream for a mill is seldom a hundredth.
inline constexpr std::size_t kCheckedBytesMax = std::size_t{64} << 20;

enum class Family { kOptimo, kRml1 };
// By the extension, else by the language of the client, else Optimo.
Family FamilyOf(const Document& document);

struct Findings {
  std::vector<Diagnostic> list{};
  std::uint64_t dropped = 0;  // beyond those of the list
};

// An inch source (.SI) is checked as it stands: what must be converted before it runs is said as
// advice (7030), and advice that depends on millimetres is left out.
Findings CheckDocument(const Document& document);

// Bytes that a finding marks; the start of the text when it has no place.
struct Marked {
  std::size_t begin = 0;
  std::size_t end = 0;
};
Marked PlaceOf(const Diagnostic& finding, std::string_view text);

// LSP Diagnostic objects.
Json ToJson(const Findings& findings, const Document& document);
Json ToJson(const Diagnostic& finding, PositionFinder& positions, std::string_view text);

}  // namespace rmlcell::lsp
