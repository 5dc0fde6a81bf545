// A stream that comes while it runs does what the same stream does that is there.
#include <gtest/gtest.h>

#include "tests/engine/rml1/random_stream.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

// As many bytes as somebody waits for, and no more: so it is cut there.
class Coming final : public machine::BytesKeeper {
 public:
  explicit Coming(std::string bytes) : bytes_(std::move(bytes)) {}
  std::string_view ReadOn(std::string_view known, std::size_t size) const override {
    come = std::max(come, std::min(size, bytes_.size()));
    over_ = over_ || size > bytes_.size();
    return std::string_view(bytes_).substr(0, std::max(come, known.size()));
  }
  bool IsWhole(std::string_view known) const override {
    return over_ && known.size() == bytes_.size();
  }

  mutable std::size_t come = 0;

 private:
  const std::string bytes_;
  mutable bool over_ = false;
};

machine::RunSetup ComingSetup(const machine::Parameters& parameters,
                              std::shared_ptr<const Coming> stream) {
  machine::RunSetup setup = SetupOf(parameters, {});
  setup.programs[1].object = machine::Bytes(stream, {});
  setup.budget.virtual_time = FromSeconds(1e6);
  return setup;
}

// Goes on behind each halt.
std::string Played(TestRun run) {
  for (int halts = 0; halts < 500; ++halts) {
    if (run.AdvanceToEnd() == machine::RunPhase::kFinished) break;
    run.Press(machine::InputKind::kStart);
  }
  std::string text = run.seen().text();
  for (const auto& [name, value] : run.figures()) text += name + " " + std::to_string(value) + "\n";
  return text;
}

TEST(ComingStream, DoesWhatAWholeOneDoes) {
  constexpr int kStreams = 40;
  constexpr std::uint64_t kPieces = 30'000;  // many times what is waited for at a time
  for (int n = 0; n < kStreams; ++n) {
    std::mt19937_64 dice(static_cast<std::uint64_t>(n));
    const machine::Parameters parameters = RandomMachine(dice);
    const std::string stream = RandomStream(dice, kPieces + static_cast<std::uint64_t>(n));
    machine::RunSetup whole = SetupOf(parameters, stream);
    whole.budget.virtual_time = FromSeconds(1e6);
    const auto coming = std::make_shared<const Coming>(stream);
    ASSERT_TRUE(Played(TestRun(ComingSetup(parameters, coming))) ==
                Played(TestRun(std::move(whole))))
        << "stream " << n;
    EXPECT_EQ(coming->come, stream.size());
  }
}

// The first motion is there long before the stream is, and of what has come nothing waits but the
// last of it; how far it is nobody knows until it is over.
TEST(ComingStream, RunsAsItComes) {
  std::string stream = "PA;PA;VS10;";
  for (int n = 0; n < 100'000; ++n)
    stream += "PD" + std::to_string(n % 3000) + "," + std::to_string(n * 7 % 2000) + ";";
  const auto coming = std::make_shared<const Coming>(stream);
  TestRun run(ComingSetup(ParametersOf("t1"), coming));
  while (run.seen().moves().empty()) run->Advance(run->state().time + FromSeconds(0.5));
  EXPECT_LT(coming->come, std::size_t{1} << 16);
  EXPECT_LT(run->state().progress, 0.0);
  run.AdvanceToEnd();
  EXPECT_EQ(run.seen().moves().size(), 100'000U);
  EXPECT_EQ(run->state().progress, 1.0);
}

}  // namespace
}  // namespace rmlcell::rml1
