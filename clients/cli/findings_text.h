#pragma once

#include <google/protobuf/repeated_ptr_field.h>

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/result.h"
#include "engine/core/untold_findings.h"
#include "rmlcell/v1/common.pb.h"

namespace rmlcell::v1 {
class RunReport;
}

namespace rmlcell::cli {

// Of many findings of one kind the first few are shown, and the others counted: nobody reads a
// thousand lines of one code.
class KindsShown {
 public:
  // Whether this one is to be shown. `line` 0: not known.
  bool Show(const std::string& code, int line);
  // Those that were not kept anywhere; `dropped` in all, of which `gathered` tells the kinds.
  void AddUntold(const google::protobuf::RepeatedPtrField<v1::GatheredFindings>& gathered,
                 std::int64_t dropped);
  // "and 95 more RML1-E2, lines 12 to 300" for each kind that was cut, and of a kind of which none
  // was shown what it is; each with a line end.
  std::string Rest() const;

 private:
  struct Kind {
    std::uint64_t shown = 0;
    std::uint64_t left_out = 0;
    int first_line = 0;
    int last_line = 0;
    std::string said;  // of a kind that was not kept anywhere: "advice RML1-E8002: ..."
  };
  void LeaveOut(Kind& kind, std::uint64_t count, int first_line, int last_line);

  std::map<std::string, Kind> kinds_;
  std::int64_t of_no_kind_ = 0;  // of a server that does not tell the kinds
};

// ", lines 12 to 300", ", line 7"; empty where no line is known.
std::string ExtentText(int first_line, int last_line);

// Findings with the source line of each and a caret below it; `source` may be empty.
// To standard output: they are what was asked for.
void PrintFindings(const std::vector<Diagnostic>& findings, const UntoldFindings& dropped,
                   std::string_view source);
// To standard error: something else was asked for.
void ComplainOf(const std::vector<Diagnostic>& findings, const UntoldFindings& dropped,
                std::string_view source);
// Those of a message: Findings, or a RunReport.
std::string FindingsText(const v1::Findings& findings);
std::string FindingsText(const v1::RunReport& report);

// A finding as the local checks print it, without source line.
std::string FindingLine(const v1::Diagnostic& diagnostic);

// Says why nothing is done, and gives the exit code of a wrong use or an unreadable file.
int Refuse(const Error& error);

}  // namespace rmlcell::cli
