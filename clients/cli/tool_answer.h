#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/untold_findings.h"
#include "engine/machine/bytes.h"

namespace rmlcell::cli {

// What an off-line tool answers about one file: for people findings on standard error and a
// word about what was written, or with --json one object on standard output:
//   {"file": "12.S", "ok": true, "output": "12.O", "bytes": 93, "text": "object of 93 bytes, 4
//   steps",
//    "findings": {"ok": true, "diagnostics": [...], ...}}
// `findings` is the message rmlcell.v1.Findings, as of `check --json`. What goes to standard output
// stands in "content" instead of "output" and "bytes". Files that cannot be read are refused as
// without --json.
class ToolAnswer {
 public:
  ToolAnswer(std::string file, bool json) : file_(std::move(file)), json_(json) {}

  // Findings about the file, and about others that the tool reads along.
  void Found(const std::vector<Diagnostic>& findings, const UntoldFindings& dropped,
             std::string_view source);

  // The result, to a file or, "-", to standard output. All of these give the exit code.
  int Deliver(const machine::Bytes& bytes, const std::string& output, const std::string& text);
  int Deliver(const std::string& bytes, const std::string& output, const std::string& text) {
    return Deliver(machine::Bytes::Borrowed(bytes), output, text);
  }
  // The same when it is in its file already.
  int Written(std::string_view bytes, std::string_view output, const std::string& text,
              int exit_code);
  // Nothing was made: what stands in the way was found, or is this.
  int Failed();
  int Failed(const Error& error);
  // A line about what became of the file, when there is no result to deliver; none when it is
  // empty.
  int Say(const std::string& text, int exit_code);

 private:
  int PrintJson(int exit_code, std::string_view output, std::string_view content,
                std::string_view text);

  std::string file_;
  bool json_;
  std::vector<Diagnostic> findings_;
  UntoldFindings dropped_;
};

}  // namespace rmlcell::cli
