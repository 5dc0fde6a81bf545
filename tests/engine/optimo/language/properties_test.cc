// Properties over random valid programs; a failure names the seed that replays it.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "engine/optimo/language/formatter.h"
#include "tests/engine/optimo/language/compile_text.h"
#include "tests/engine/optimo/language/random_program.h"

namespace rmlcell::optimo {
namespace {

constexpr std::uint32_t kRounds = 400;

// OPT-1.05, OPT-1.06, OPT-B.69
TEST(Properties, CompileDecompileCompileIsIdentity) {
  for (std::uint32_t seed = 1; seed <= kRounds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::string text = RandomProgram(seed).Make(40);
    const Compilation compiled = MustCompile(text);
    ASSERT_TRUE(compiled.ok) << text;
    const Result<std::string> source = ObjectToSource(compiled.object);
    ASSERT_TRUE(source) << source.error().detail;
    const Compilation again = MustCompile(*source);
    ASSERT_EQ(again.object, compiled.object) << *source;
    ASSERT_EQ(Decompile(again.module), *source);
  }
}

// OPT-B.40
TEST(Properties, FormattingIsIdempotentAndChangesNothing) {
  for (std::uint32_t seed = 1; seed <= kRounds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::string text = RandomProgram(seed).Make(40);
    const std::string formatted = Format(text).text;
    ASSERT_EQ(Format(formatted).text, formatted);
    ASSERT_EQ(MustCompile(formatted).object, MustCompile(text).object) << formatted;
  }
}

// Cutting a good program anywhere gives findings, never a crash, and errors stay near the cut.
TEST(Properties, EveryPrefixIsAnswered) {
  const std::string text = RandomProgram(7).Make(30);
  for (std::size_t length = 0; length < text.size(); ++length) {
    const Compilation compiled = Compile(std::string_view(text).substr(0, length), "", {});
    std::uint64_t errors = 0;
    for (const Diagnostic& d : compiled.diagnostics) errors += IsError(d.severity) ? 1 : 0;
    EXPECT_LE(errors, 2U) << length;
  }
}

// One wrong byte costs at most a few errors: no cascades. OPT-1.33
TEST(Properties, OneWrongByteCostsFewErrors) {
  const std::string text = RandomProgram(11).Make(60);
  for (std::size_t at = 0; at < text.size(); at += 3) {
    for (const char wrong : {'(', ')', '#', ',', '\n'}) {
      std::string damaged = text;
      damaged[at] = wrong;
      std::uint64_t errors = 0;
      for (const Diagnostic& d : Compile(damaged, "", {}).diagnostics) {
        errors += IsError(d.severity) && d.code != ErrorCode::kNameUndeclared ? 1 : 0;
      }
      EXPECT_LE(errors, 3U) << "byte " << at << " as " << wrong;
    }
  }
}

}  // namespace
}  // namespace rmlcell::optimo
