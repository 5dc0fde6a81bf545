#pragma once

#include <string>
#include <string_view>

namespace rmlcell::simulation {

// What is wrong with a document as XML, or nothing: one root, tags that match, attributes in quotes
// and each once, no bare & or <, only characters that XML has. No DTD, no comments: ours need none.
std::string XmlFault(std::string_view document);

// How often `what` stands in a text.
std::size_t CountOf(std::string_view text, std::string_view what);

}  // namespace rmlcell::simulation
