#include "engine/optimo/offline/retrieve.h"

#include <gtest/gtest.h>

#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

constexpr std::string_view kSource = "COORD ABSOL\nMOVE (25.4, 50.8, 0.0, 0.0, 0.0) ; edge\n";

// OPT-8.70, OPT-8.73, OPT-6.35: metric source and list file.
TEST(Retrieve, MetricProjectsGetSourceAndList) {
  const Result<RetrievedProgram> program = RetrieveProgram(MustCompile(kSource).object, {});
  ASSERT_TRUE(program);
  EXPECT_EQ(program->source, "     COORD ABSOL\n     MOVE (25.4, 50.8, 0.0, 0.0, 0.0)\n");
  EXPECT_EQ(program->list,
            "    1     1       COORD ABSOL\n    2     2       MOVE (25.4, 50.8, 0.0, 0.0, 0.0)\n");
}

// OPT-8.70, OPT-8.51: a project in inches gets an inch source with CONVERT's header; the list stays
// metric.
TEST(Retrieve, InchProjectsGetInches) {
  const Result<RetrievedProgram> program = RetrieveProgram(
      MustCompile(kSource).object, FileNames{"12.S", "12.SI", "Tue Apr 20 13:37:33 1993"});
  ASSERT_TRUE(program);
  EXPECT_EQ(program->source,
            "; Inch File 12.SI Created From Metric File 12.S - Tue Apr 20 13:37:33 1993\n"
            "     COORD ABSOL\n     MOVE (1.0, 2.0, 0.0, 0.0, 0.0)\n");
  EXPECT_NE(program->list.find("(25.4, 50.8,"), std::string::npos);
}

// OPT-B.71
TEST(Retrieve, DamagedObjectsAreRefused) {
  EXPECT_EQ(RetrieveProgram("LMR", {}).error().code, ErrorCode::kObjectCorrupt);
}

}  // namespace
}  // namespace rmlcell::optimo
