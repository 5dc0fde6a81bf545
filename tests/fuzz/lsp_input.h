#pragma once

#include <string>
#include <string_view>

namespace rmlcell::lsp {

// What every input of the language server must hold; returns what is wrong with one, empty when
// nothing is. The first byte chooses: the bytes as they are, as a stream of frames; or a text with
// every request at places all over it, edits in between (what formatting, fixes and renaming hand
// out lies in the text, in order), and the incremental text against the same text opened anew.
std::string TryLsp(std::string_view bytes);

}  // namespace rmlcell::lsp
