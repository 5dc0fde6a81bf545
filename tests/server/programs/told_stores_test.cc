// Who hears of what is stored, and what is told of it.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tests/server/engine_bytes.h"
#include "tests/server/programs/program_views_bed.h"

namespace rmlcell::server {
namespace {

class ToldStores : public ProgramViewsBed {
 protected:
  ToldStores() {
    programs.OnStored([this] { ++tells_; });
  }
  static std::string Name(int number) {
    return "machines/optimo-1/programs/" + std::to_string(number);
  }
  bool Store(int number, const std::string& bytes, bool validate_only = false) {
    const auto stored = programs.Store({.name = Name(number),
                                        .file_name = "part.S",
                                        .bytes = bytes,
                                        .validate_only = validate_only});
    return static_cast<bool>(stored);
  }
  bool Delete(int number) {
    v1::DeleteProgramRequest request;
    request.set_name(Name(number));
    return programs.Delete(request, "anna").ok();
  }
  // The files that findings of the motion name, and the programs that they are in.
  std::vector<std::pair<std::string, int>> PlacesOf(const std::string& source) {
    v1::ProgramText text;
    text.set_file_name("44.S");
    text.set_content(source);
    std::vector<std::pair<std::string, int>> places;
    const auto check = Must(programs.Check("", "machines/optimo-1", text, true));
    for (const Diagnostic& finding : check.motion.findings)
      places.emplace_back(finding.file, finding.program);
    return places;
  }

  int tells_ = 0;
};

// LIVE-3.20: hosts hear of each change of a memory, and of nothing that is only asked or refused.
TEST_F(ToldStores, EachChangeIsTold) {
  EXPECT_TRUE(Store(45, "STOP\n", true));
  EXPECT_FALSE(Store(45, "SPEED 101\n"));
  EXPECT_EQ(tells_, 0);
  EXPECT_TRUE(Store(45, "STOP\n"));
  EXPECT_EQ(tells_, 1);
  const std::string executable = ExecutableOf(45, "STOP\n");
  EXPECT_TRUE(Store(145, executable, true));
  EXPECT_EQ(tells_, 1);
  EXPECT_TRUE(Store(145, executable));
  EXPECT_EQ(tells_, 2);
  EXPECT_TRUE(Delete(145));
  EXPECT_EQ(tells_, 3);
  EXPECT_FALSE(Delete(145));
  EXPECT_EQ(tells_, 3);
  EXPECT_TRUE(Delete(45));
  EXPECT_EQ(tells_, 4);
}

// OPT-1.15: its answer is that of the executable.
TEST_F(ToldStores, AnExecutableIsToldWithItsBytes) {
  ASSERT_TRUE(Store(45, "STOP\n"));
  const std::string executable = ExecutableOf(45, "STOP\n");
  for (const bool validate_only : {true, false}) {
    const auto stored =
        programs.Store({.name = Name(145), .bytes = executable, .validate_only = validate_only});
    ASSERT_TRUE(stored);
    EXPECT_EQ(stored.value->name(), Name(145));
    EXPECT_EQ(stored.value->executable_bytes(), static_cast<std::int64_t>(executable.size()));
  }
}

// OPT-10.17, OPT-E.7413: it names the file without the folder that it came from.
TEST_F(ToldStores, AFindingOfASlotNamesTheFile) {
  for (const bool validate_only : {true, false}) {
    const auto reserved = programs.Store({.name = Name(5),
                                          .file_name = "parts/door.S",
                                          .bytes = "STOP\n",
                                          .validate_only = validate_only});
    ASSERT_TRUE(reserved);
    ASSERT_EQ(reserved.value->findings().diagnostics_size(), 1) << validate_only;
    EXPECT_EQ(reserved.value->findings().diagnostics(0).place().file(), "door.S");
  }
}

// OPT-E.7301: what the text itself does is in its file, and what another program does is not.
TEST_F(ToldStores, AFindingOfAMotionNamesItsFile) {
  const std::string far = "COORD ROBOT\nMOVE (9000.,0.,0.,0.,0.)\n";
  using Places = std::vector<std::pair<std::string, int>>;
  EXPECT_EQ(PlacesOf(far), (Places{{"44.S", 44}}));
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 61, .object = ObjectOf(far)}}, {}));
  EXPECT_EQ(PlacesOf("CALL 61\n"), (Places{{"", 61}}));
}

}  // namespace
}  // namespace rmlcell::server
