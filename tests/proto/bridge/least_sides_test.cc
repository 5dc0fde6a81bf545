// The least that there is: one byte, program 1, one schedule; and what a text is called that says
// nothing.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <variant>

#include "proto/bridge/files.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/inputs.h"
#include "proto/bridge/machine_inputs.h"
#include "proto/bridge/program_stream.h"
#include "proto/bridge/series.h"
#include "proto/bridge/setup.h"
#include "rmlcell/v1/job.pb.h"

namespace rmlcell::bridge {
namespace {

// What is wrong with a request is what its detail says; others have their own text before it, and
// what to do behind it.
TEST(LeastSides, WhatAnErrorSays) {
  EXPECT_EQ(ErrorText({ErrorCode::kCellInvalidArgument, "size: below 0", {}}),
            "CELL-E9003: size: below 0");
  EXPECT_EQ(ErrorText({ErrorCode::kCellInvalidArgument, {}, {}}),
            "CELL-E9003: a value in the request is not allowed; correct the field that the detail "
            "names");
  EXPECT_EQ(ErrorText({ErrorCode::kCellUsage, "no file", {}}), "CELL-E9026: no file; see --help");
  EXPECT_EQ(ErrorText({ErrorCode::kCellUsage, {}, {}}),
            "CELL-E9026: the command was used wrongly; see --help");
}

class LeastFiles : public testing::Test {
 protected:
  LeastFiles() : path_(testing::TempDir() + "least_sides." + std::to_string(::getpid())) {}
  ~LeastFiles() override { std::filesystem::remove(path_); }

  const std::string path_;
};

TEST_F(LeastFiles, TheLastByteOfAFileIsRead) {
  constexpr std::size_t kPart = std::size_t{1} << 16;
  for (const std::size_t size : {std::size_t{1}, kPart, kPart + 1}) {
    std::ofstream(path_, std::ios::binary) << std::string(size, 'x');
    const auto read = ReadFile(path_, 1 << 20);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->size(), size);
  }
}

// The last byte of a program that is read while it runs, as of any other.
TEST_F(LeastFiles, TheLastByteOfAStreamIsRead) {
  for (const std::size_t more : {std::size_t{1}, std::size_t{2}, (std::size_t{1} << 20) + 1}) {
    const std::string text(ProgramStream::kBeginning + more, 'y');
    std::ofstream(path_, std::ios::binary) << text;
    auto opened = ProgramStream::Open(path_, 1 << 22, nullptr);
    ASSERT_TRUE(opened);
    opened->bytes.ReadAll();
    EXPECT_TRUE(*opened->bytes == text) << more;
    ASSERT_NE(opened->stream, nullptr);
    EXPECT_TRUE(opened->stream->status());
  }
}

// A byte too many is one, whatever was read before it.
TEST_F(LeastFiles, OneByteTooManyIsTold) {
  for (const std::size_t limit : {ProgramStream::kBeginning, ProgramStream::kBeginning + 5000}) {
    std::ofstream(path_, std::ios::binary) << std::string(limit + 1, 'z');
    auto opened = ProgramStream::Open(path_, static_cast<std::int64_t>(limit), nullptr);
    if (!opened) {
      EXPECT_EQ(opened.error().code, ErrorCode::kCellTooLarge);
      continue;
    }
    opened->bytes.ReadAll();
    ASSERT_FALSE(opened->stream->status()) << limit;
    EXPECT_EQ(opened->stream->status().error().code, ErrorCode::kCellTooLarge);
  }
}

// Program 1 is a program; none is that of the run, and for a machine that has none open, 0.
TEST(LeastSides, ProgramOneIsAProgram) {
  v1::SimulationOptions options;
  options.mutable_simul()->set_program(1);
  options.mutable_simul()->set_step(5);
  const auto named = RunOptionsOf(options, {}, 7, machine::Mode::kCycle);
  ASSERT_TRUE(named && named->simul);
  EXPECT_EQ(named->simul->program, 1);
  options.mutable_simul()->clear_program();
  const auto own = RunOptionsOf(options, {}, 7, machine::Mode::kCycle);
  ASSERT_TRUE(own && own->simul);
  EXPECT_EQ(own->simul->program, 7);
  v1::AppliedInput applied;
  applied.mutable_breakpoints()->add_breakpoints()->mutable_step()->set_step(5);
  const auto input = InputOf(applied);
  ASSERT_TRUE(input && *input);
  const auto& set = std::get<machine::SetBreakpoints>(**input);
  ASSERT_EQ(set.breakpoints.size(), 1U);
  EXPECT_EQ(set.breakpoints[0].at.program, 0);
  EXPECT_EQ(set.breakpoints[0].at.step, 5);
}

TEST(LeastSides, OneScheduleIsALaser) {
  const v1::SeriesTable table = SeriesOf({.axes = "X", .schedules = 1}, {}, SimTime(0));
  ASSERT_EQ(table.columns_size(), 4);
  EXPECT_EQ(table.columns(2).signal(), "power");
}

// A variable without a value that can be read is 0, in each of its kinds.
TEST(LeastSides, AVariableWithoutANumberIsZero) {
  const auto made = [](machine::VariableKind kind) {
    machine::NamedVariable variable;
    variable.name = "VR[1]";
    variable.value.kind = kind;
    variable.value.text = "?";
    return ToProto(variable).value();
  };
  EXPECT_TRUE(made(machine::VariableKind::kReal).has_real());
  EXPECT_EQ(made(machine::VariableKind::kReal).real(), 0.0);
  EXPECT_TRUE(made(machine::VariableKind::kInteger).has_integer());
  EXPECT_EQ(made(machine::VariableKind::kInteger).integer(), 0);
  EXPECT_FALSE(made(machine::VariableKind::kLogical).logical());
}

}  // namespace
}  // namespace rmlcell::bridge
