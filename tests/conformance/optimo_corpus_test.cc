// The programs that the manual prints, where the shared corpus is at hand: they compile without
// error and come back from the object unchanged.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/formatter.h"
#include "engine/optimo/language/linker.h"

namespace rmlcell::optimo {
namespace {

class OptimoCorpus : public testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path folder =
        std::filesystem::path(RMLCELL_SHARED_DIR) / "corpus/optimo";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "the shared corpus is not here";
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".S" && extension != ".CMP") continue;
      std::ifstream file(entry.path(), std::ios::binary);
      std::ostringstream text;
      text << file.rdbuf();
      sources_[entry.path().filename().string()] = text.str();
    }
  }
  std::map<std::string, std::string> sources_;
};

// OPT-1.05, OPT-1.06, OPT-1.09, OPT-B.35
TEST_F(OptimoCorpus, EveryProgramCompilesAndComesBack) {
  ASSERT_GE(sources_.size(), 21U);
  for (const auto& [name, source] : sources_) {
    SCOPED_TRACE(name);
    const Compilation compiled = Compile(source, name, {});
    ASSERT_TRUE(compiled.ok);
    EXPECT_LT(compiled.object.size(), source.size());
    const Result<std::string> text = ObjectToSource(compiled.object);
    ASSERT_TRUE(text);
    const Compilation again = Compile(*text, name, {});
    EXPECT_EQ(again.object, compiled.object);
    EXPECT_EQ(Decompile(again.module), *text);
    const std::string formatted = Format(source).text;
    EXPECT_EQ(Compile(formatted, name, {}).object, compiled.object);
    EXPECT_EQ(Format(formatted).text, formatted);
  }
}

// OPT-10.01: 19 steps, step n has sequence number n.
TEST_F(OptimoCorpus, SampleOneHasNineteenSteps) {
  const Compilation compiled = Compile(sources_["sample1.S"], "", {});
  EXPECT_EQ(compiled.module.step_count, 19U);
  for (const Instruction& i : compiled.module.instructions) {
    ASSERT_EQ(i.label_count, 1);
    EXPECT_EQ(compiled.module.Labels(i)[0], i.step);
  }
}

// OPT-10.04, OPT-10.08, OPT-10.12
TEST_F(OptimoCorpus, StepsAreCountedAsTheManualDoes) {
  EXPECT_EQ(Compile(sources_["sample2-cylind.S"], "", {}).module.step_count, 73U);
  EXPECT_EQ(Compile(sources_["special-1.S"], "", {}).module.step_count, 10U);
}

// OPT-9.17, OPT-9.02: program 32 contains 44 once.
TEST_F(OptimoCorpus, ProgramsOfChapterNineLink) {
  std::map<int, std::string> objects;
  for (const int slot : {32, 44, 68}) {
    objects[slot] = Compile(sources_["ch09-program" + std::to_string(slot) + ".S"], "", {}).object;
  }
  const ObjectLookup lookup = [&](int slot) -> std::optional<std::string_view> {
    const auto found = objects.find(slot);
    return found == objects.end() ? std::nullopt : std::optional<std::string_view>(found->second);
  };
  for (const int main : {32, 68}) {
    const Result<Executable> executable = Link(main, lookup, {});
    ASSERT_TRUE(executable);
    ASSERT_EQ(executable->modules.size(), 2U);
    EXPECT_EQ(executable->modules[1].slot, 44);
  }
}

}  // namespace
}  // namespace rmlcell::optimo
