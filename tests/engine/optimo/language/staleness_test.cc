#include "engine/optimo/language/staleness.h"

#include <gtest/gtest.h>

#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

class Staleness : public testing::Test {
 protected:
  void Store(int slot, const std::string& text) { objects_[slot] = MustCompile(text).object; }
  ObjectLookup Lookup() {
    return [this](int slot) -> std::optional<std::string_view> {
      const auto found = objects_.find(slot);
      return found == objects_.end() ? std::nullopt
                                     : std::optional<std::string_view>(found->second);
    };
  }
  void Make(int slot) {
    const Result<Executable> made = Link(slot, Lookup(), {});
    ASSERT_TRUE(made);
    bytes_[slot] = EncodeExecutable(*made);
  }
  std::vector<StaleExecutable> Stale() {
    std::map<int, std::string_view> executables;
    for (const auto& [slot, bytes] : bytes_) executables[slot] = bytes;
    return FindStaleExecutables(executables, {Lookup(), deleted_});
  }
  void Delete(int slot) {
    objects_.erase(slot);
    deleted_.insert(slot);
  }
  std::map<int, std::string> objects_, bytes_;
  std::set<int> deleted_;
};

// OPT-1.13, OPT-9.13, OPT-E.7110: programs 32 and 68 contain 44, 12 does not.
TEST_F(Staleness, AnAlteredFunctionAgesAllThatContainIt) {
  Store(12, "SPEED 5\n");
  Store(32, "FUNCTION 44\n");
  Store(68, "FUNCTION 45\n");
  Store(44, "SPEED 6\n");
  Store(45, "FUNCTION 44\n");
  for (const int slot : {12, 32, 68}) Make(slot);
  EXPECT_TRUE(Stale().empty());
  Store(44, "SPEED 7\n");
  EXPECT_EQ(Stale(), (std::vector<StaleExecutable>{{32, {{44, StaleReason::kFunctionChanged}}},
                                                   {68, {{44, StaleReason::kFunctionChanged}}}}));
  Delete(44);  // counts as altering
  EXPECT_EQ(Stale(), (std::vector<StaleExecutable>{{32, {{44, StaleReason::kFunctionDeleted}}},
                                                   {68, {{44, StaleReason::kFunctionDeleted}}}}));
  Store(44, "SPEED 6\n");  // the old code again
  EXPECT_TRUE(Stale().empty());
}

// OPT-1.15: linked off-line and brought to a machine that never had FUNCTION 44.
TEST_F(Staleness, AFunctionThatWasNeverStoredAgesNothing) {
  Store(32, "FUNCTION 44\n");
  Store(44, "SPEED 6\n");
  Make(32);
  objects_.erase(44);
  EXPECT_TRUE(Stale().empty());
}

// OPT-1.13, OPT-9.05: one part for each FUNCTION concerned, in order of first use.
TEST_F(Staleness, EveryFunctionConcernedIsNamed) {
  Store(32, "FUNCTION 45\nFUNCTION 44\nFUNCTION 46\n");
  for (const int slot : {44, 45, 46}) Store(slot, "SPEED 6\n");
  Make(32);
  Store(44, "SPEED 7\n");
  Delete(45);
  EXPECT_EQ(Stale(),
            (std::vector<StaleExecutable>{
                {32, {{45, StaleReason::kFunctionDeleted}, {44, StaleReason::kFunctionChanged}}}}));
}

// OPT-1.12, OPT-1.14, OPT-1.15
TEST_F(Staleness, AnAlteredProgramAgesItsOwn) {
  Store(32, "FUNCTION 44\n");
  Store(44, "SPEED 6\n");
  Make(32);
  Store(32, "FUNCTION 44\nSPEED 5\n");
  Store(44, "SPEED 7\n");
  EXPECT_EQ(Stale(),
            (std::vector<StaleExecutable>{
                {32, {{32, StaleReason::kObjectChanged}, {44, StaleReason::kFunctionChanged}}}}));
  objects_.erase(32);
  EXPECT_EQ(Stale()[0].parts[0].reason, StaleReason::kObjectMissing);
}

// OPT-B.71
TEST_F(Staleness, DamagedExecutablesAreTold) {
  Store(32, "SPEED 5\n");
  Make(32);
  bytes_[32][6] ^= 1;
  EXPECT_EQ(Stale(), (std::vector<StaleExecutable>{{32, {{32, StaleReason::kDamaged}}}}));
}

}  // namespace
}  // namespace rmlcell::optimo
