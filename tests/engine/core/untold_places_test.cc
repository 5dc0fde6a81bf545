#include <gtest/gtest.h>

#include "engine/core/untold_findings.h"

namespace rmlcell {
namespace {

Diagnostic InOneLine(int byte, int column) {
  return {.code = ErrorCode::kRml1Clipped,
          .severity = Severity::kAdvice,
          .where = {.line = 3, .column = column, .byte_offset = byte}};
}

// Of one line the byte says which place comes first, and no column: a stream has its own.
TEST(UntoldFindings, PlacesOfOneLineAreInOrderOfTheirBytes) {
  UntoldFindings untold;
  for (const auto& [byte, column] : {std::pair{20, 5}, {10, 9}, {30, 1}})
    untold.Add(InOneLine(byte, column));
  const GatheredFindings& kind = untold.kinds().at(ErrorCode::kRml1Clipped);
  EXPECT_EQ(kind.first.where.byte_offset, 10);
  EXPECT_EQ(kind.last.where.byte_offset, 30);
}

}  // namespace
}  // namespace rmlcell
