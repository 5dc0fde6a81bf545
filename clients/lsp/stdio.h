#pragma once

namespace rmlcell::lsp {

// A language server for the programs of this folder's disk on two file descriptors: the body of
// `rmlcell lsp`. Reads ahead while it works, so that a cancellation is seen, and checks a document
// when the client has been quiet for a moment. Ends with the "exit" of the client (0 after
// "shutdown", else 1), at the end of its input (1), or when the process that started it is gone
// (1).
int RunOnDescriptors(int input, int output);

}  // namespace rmlcell::lsp
