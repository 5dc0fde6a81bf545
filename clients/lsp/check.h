#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "clients/lsp/document.h"
#include "clients/lsp/protocol.h"
#include "engine/core/diagnostic.h"
#include "engine/machine/family.h"

// What `rmlcell check` would say of a document, as the editor shows it.
namespace rmlcell::lsp {

// A longer text is edited but not checked or searched: the control holds 34,000 bytes of it, and a
// stream for a mill is seldom a hundredth.
inline constexpr std::size_t kCheckedBytesMax = std::size_t{64} << 20;

// By the extension, else by the language of the client, else the first family whose programs people
// write.
const machine::MachineFamily& FamilyOf(const Document& document);

struct Findings {
  std::vector<Diagnostic> list{};
  UntoldFindings dropped{};  // beyond those of the list
};

// A source in other units is checked as it stands (machine::CheckOptions::unconverted).
Findings CheckDocument(const Document& document);

// Bytes that a finding marks; the start of the text when it has no place.
struct Marked {
  std::size_t begin = 0;
  std::size_t end = 0;
};
Marked PlaceOf(const Diagnostic& finding, std::string_view text);

// LSP Diagnostic objects.
Json ToJson(const Findings& findings, const Document& document);
Json ToJson(const Diagnostic& finding, PositionFinder& positions, const Document& document);

}  // namespace rmlcell::lsp
