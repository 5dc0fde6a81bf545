// Runs that a family refuses to begin: who asked for one is told the refusal.
#include <gtest/gtest.h>

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/simulation/run/joint_check.h"
#include "engine/simulation/run/rehearsal.h"
#include "tests/engine/simulation/fake_family.h"

namespace rmlcell::simulation {
namespace {

constexpr std::string_view kUnwanted = "not this one";

// Runs any program but that one, and each without a step.
class ChoosyFamily final : public machine::MachineFamily {
 public:
  const machine::FamilyInfo& info() const override { return info_; }
  std::span<const machine::ParameterInfo> parameters() const override {
    return FakeFamily::Table();
  }
  machine::Translation Translate(const machine::SourceFile& file, const machine::Parameters&,
                                 const machine::CheckOptions&) const override {
    return {.ok = true, .object = std::string(file.bytes)};
  }
  Result<std::unique_ptr<machine::Run>> NewRun(machine::RunSetup setup,
                                               machine::RunObserver& observer) const override {
    if (*setup.programs[setup.main_program].object == kUnwanted)
      return Error{ErrorCode::kCellUnimplemented, "not that", {}};
    return std::unique_ptr<machine::Run>(std::make_unique<FakeRun>(Script(), observer));
  }

 private:
  machine::FamilyInfo info_{.id = "choosy", .title = "Choosy machine", .checked_by_running = true};
};

JointProgram ReadyIn(int slot, std::string_view text) {
  const machine::Translation made{.ok = true, .object = std::string(text)};
  return {
      .program = {.slot = slot, .translation = std::make_shared<const machine::Translation>(made)}};
}

Status CheckedTogether(std::vector<JointProgram> programs) {
  const ChoosyFamily family;
  const machine::Parameters parameters(family.parameters());
  return CheckTogether(family, parameters, programs, {});
}

// One of those that stand in the memory, and one that is looked at in the place of another.
TEST(RefusedRuns, ACheckOfSeveralTellsTheRefusal) {
  EXPECT_TRUE(CheckedTogether({ReadyIn(44, "one"), ReadyIn(44, "other")}));
  const Status seated = CheckedTogether({ReadyIn(44, kUnwanted), ReadyIn(45, "one")});
  ASSERT_FALSE(seated);
  EXPECT_EQ(seated.error().code, ErrorCode::kCellUnimplemented);
  EXPECT_EQ(seated.error().detail, "not that");
  const Status left_over = CheckedTogether({ReadyIn(44, "one"), ReadyIn(44, kUnwanted)});
  ASSERT_FALSE(left_over);
  EXPECT_EQ(left_over.error().code, ErrorCode::kCellUnimplemented);
}

// The text is good, and so the refusal is that of the run which follows its motion.
TEST(RefusedRuns, ACheckOfOneTellsTheRefusal) {
  const ChoosyFamily family;
  const machine::Parameters parameters(family.parameters());
  const auto checked = [&](std::string_view text) {
    const ProgramMemory memory{.family = &family,
                               .programs = {{.slot = 3,
                                             .file_name = "3.choosy",
                                             .bytes = machine::Bytes::Of(std::string(text)),
                                             .is_source = true}}};
    return CheckProgram(memory, parameters, 3, false, {});
  };
  EXPECT_TRUE(checked("one"));
  const auto refused = checked(kUnwanted);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellUnimplemented);
  EXPECT_EQ(refused.error().detail, "not that");
}

}  // namespace
}  // namespace rmlcell::simulation
