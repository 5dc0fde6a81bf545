// Where findings that are not told come first and last.
#include <gtest/gtest.h>

#include "engine/core/untold_findings.h"

namespace rmlcell {
namespace {

Diagnostic AtLine(int line, std::int64_t byte_offset) {
  Diagnostic finding;
  finding.code = ErrorCode::kCellBadText;
  finding.where.line = line;
  finding.where.byte_offset = byte_offset;
  return finding;
}

// By their line, where the byte of one of them is not known, too.
TEST(UntoldFindings, LinesCountBeforeBytes) {
  for (const bool later_first : {false, true}) {
    UntoldFindings findings;
    findings.Add(later_first ? AtLine(5, -1) : AtLine(3, 40), SimTime(0));
    findings.Add(later_first ? AtLine(3, 40) : AtLine(5, -1), SimTime(0));
    const GatheredFindings& kind = findings.kinds().at(ErrorCode::kCellBadText);
    EXPECT_EQ(kind.first.where.line, 3);
    EXPECT_EQ(kind.last.where.line, 5);
  }
}

}  // namespace
}  // namespace rmlcell
