#pragma once

#include <google/protobuf/repeated_ptr_field.h>

#include <string>
#include <vector>

#include "rmlcell/v1/common.pb.h"
#include "rmlcell/v1/program.pb.h"
#include "rmlcell/v1/report.pb.h"

// What the part will come out like, as the command says it.
namespace rmlcell::cli {

using VerdictReasons = google::protobuf::RepeatedPtrField<v1::VerdictReason>;

// "GOOD"; empty when nothing was judged.
std::string VerdictName(v1::Verdict verdict);
// In its colour.
std::string VerdictText(v1::Verdict verdict);

// "12.500 mm of the work lie beyond the travel (RML1-E8002, step 5 line 7); move the work origin".
std::string ReasonLine(const v1::VerdictReason& reason);

// Verdict and first reason on one line: "BAD, 12.500 mm of ... (and 2 more)".
std::string VerdictLine(v1::Verdict verdict, const VerdictReasons& reasons);

// "step 5 line 7"; empty: no place.
std::string PlaceText(const v1::SourcePlace& place);

// The exit code of a run or job: 0 when the part may come out right, and, where it is `strict`,
// only when nothing speaks against it.
int ExitOf(v1::Verdict verdict, bool strict);
int ExitOf(const v1::Outcome& outcome, bool strict);
int ExitOf(const v1::Findings& found, bool strict);  // of a check

// ", 1 finding"; empty: there is none.
std::string CountText(const v1::Findings& found);

}  // namespace rmlcell::cli
