#include "clients/cli/tool_answer.h"

#include <nlohmann/json.hpp>

#include "clients/cli/findings_text.h"
#include "clients/cli/messages.h"
#include "clients/cli/program_files.h"
#include "clients/cli/terminal.h"
#include "proto/bridge/findings.h"
#include "rmlcell/v1/common.pb.h"

namespace rmlcell::cli {

void ToolAnswer::Found(const std::vector<Diagnostic>& findings, const UntoldFindings& dropped,
                       std::string_view source) {
  if (!json_) return ComplainOf(findings, dropped, source);
  findings_.insert(findings_.end(), findings.begin(), findings.end());
  dropped_.Add(dropped);
}

int ToolAnswer::PrintJson(int exit_code, std::string_view output, std::string_view content,
                          std::string_view text) {
  nlohmann::ordered_json answer;
  answer["file"] = bridge::Utf8(file_);
  answer["ok"] = exit_code == kGood;
  if (output == "-") {
    answer["content"] = bridge::Utf8(std::string(content));
  } else if (!output.empty()) {
    answer["output"] = bridge::Utf8(std::string(output));
    answer["bytes"] = content.size();
  }
  if (!text.empty()) answer["text"] = bridge::Utf8(std::string(text));
  answer["findings"] = nlohmann::ordered_json::parse(
      Json(bridge::FindingsOf(!HasErrors(findings_), findings_, dropped_, {})), nullptr, false);
  Print(answer.dump());
  return exit_code;
}

int ToolAnswer::Deliver(const machine::Bytes& bytes, const std::string& output,
                        const std::string& text) {
  if (output == "-" && !json_) {
    for (std::size_t at = 0; at < bytes->size(); at += machine::kReleaseEvery) {
      PrintRaw(bytes->substr(at, machine::kReleaseEvery));
      bytes.Release();
    }
    return kGood;
  }
  if (output != "-") {
    if (const Status written = WriteWholeFile(output, *bytes, bytes.keeper()); !written)
      return Refuse(written.error());
  }
  return Written(*bytes, output, text, kGood);
}

int ToolAnswer::Written(std::string_view bytes, std::string_view output, const std::string& text,
                        int exit_code) {
  if (json_) return PrintJson(exit_code, output, bytes, text);
  Print(std::string(output) + ": " + text);
  return exit_code;
}

int ToolAnswer::Failed() {
  return json_ ? PrintJson(kProgramErrors, {}, {}, {}) : int{kProgramErrors};
}

int ToolAnswer::Failed(const Error& error) {
  if (!json_) {
    Complain(bridge::ErrorText(error));
    return kProgramErrors;
  }
  findings_.push_back({.code = error.code,
                       .severity = Lookup(error.code).severity,
                       .detail = error.detail,
                       .where = error.where.value_or(SourceSpan{})});
  return Failed();
}

int ToolAnswer::Say(const std::string& text, int exit_code) {
  if (json_) return PrintJson(exit_code, {}, {}, text);
  if (!text.empty()) Print(text);
  return exit_code;
}

}  // namespace rmlcell::cli
