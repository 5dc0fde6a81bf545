#pragma once

#include <chrono>

namespace rmlcell::lsp {

// At its end, with a client that reads nothing of what is still to be sent.
inline constexpr std::chrono::milliseconds kLastPatience{2000};

// A language server for the programs of this folder's disk on two file descriptors: the body of
// `rmlcell lsp`. Reads ahead while it works, so that a cancellation is seen, and checks a document
// when the client has been quiet for a moment. Ends with the "exit" of the client (0 after
// "shutdown", else 1), at the end of its input (1), or when the process that started it is gone
// (1).
int RunOnDescriptors(int input, int output, std::chrono::milliseconds patience = kLastPatience);

}  // namespace rmlcell::lsp
