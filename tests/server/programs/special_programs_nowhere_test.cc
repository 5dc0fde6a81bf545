// Special programs of machines that cannot have any.
#include <gtest/gtest.h>

#include "server/programs/special_programs.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

// Of another version of this server, or of none.
TEST(SpecialProgramsNowhere, AFamilyThatNobodyKnowsHasNone) {
  ServerBed bed;
  Must(bed.store().PutMachine({.id = "odd", .family = "lathe"}, 0));
  v1::StoreSpecialProgramsRequest request;
  request.set_parent("machines/odd");
  const auto stored = StoreSpecialPrograms(bed.store(), request, "anna");
  ASSERT_FALSE(stored);
  EXPECT_EQ(stored.error().code, ErrorCode::kCellUnknownFamily);
  EXPECT_EQ(stored.error().detail, "'lathe'; there are optimo rml1");
}

// Parameters that its family does not know keep its programs from being translated.
TEST(SpecialProgramsNowhere, AMachineWithAStrangeParameterHasNone) {
  ServerBed bed;
  Must(bed.store().PutMachine({.id = "odd", .family = "optimo", .parameters = {{"NO_SUCH", "1"}}},
                              0));
  v1::StoreSpecialProgramsRequest request;
  request.set_parent("machines/odd");
  EXPECT_EQ(CodeOf(StoreSpecialPrograms(bed.store(), request, "anna")),
            ErrorCode::kCellUnknownParameter);
  EXPECT_TRUE(Must(bed.store().ListPrograms("odd", 0, 99)).empty());
}

}  // namespace
}  // namespace rmlcell::server
