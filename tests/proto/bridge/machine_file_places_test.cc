// Where a machine file is wrong.
#include <gtest/gtest.h>

#include <string>

#include "proto/bridge/files.h"

namespace rmlcell::bridge {
namespace {

SourceSpan WrongIn(const std::string& text) {
  const auto read = ParseMachineFile(text, "m.toml");
  if (read) {
    ADD_FAILURE() << "read: " << text;
    return {};
  }
  EXPECT_EQ(read.error().code, ErrorCode::kCellBadText);
  return read.error().where.value_or(SourceSpan{});
}

// A value is wrong as a whole: its line is told, and no column of it.
TEST(MachineFilePlaces, AValueHasALineAndNoColumn) {
  for (const std::string text :
       {"family = \"rml1\"\n[parameters]\nVMAX = true\n", "[parameters]\n[sources]\n  VMAX = 5\n",
        "[sources]\n\n     VMAX = \"measured\"\n", "family = \"rml1\"\n\n  colour = \"red\"\n"}) {
    const SourceSpan where = WrongIn(text);
    EXPECT_EQ(where.line, 3) << text;
    EXPECT_EQ(where.column, 0) << text;
  }
}

TEST(MachineFilePlaces, WhatIsNoTomlHasBoth) {
  const SourceSpan where = WrongIn("family = \"rml1\"\n\nprofile = !\n");
  EXPECT_EQ(where.line, 3);
  EXPECT_EQ(where.column, 11);
}

}  // namespace
}  // namespace rmlcell::bridge
