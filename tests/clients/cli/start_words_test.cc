#include "clients/cli/start_words.h"

#include <gtest/gtest.h>

#include <string>

namespace rmlcell::cli {
namespace {

// "45/10"; "-": it is none.
std::string Understood(const std::string& text) {
  const auto place = StepOf(text);
  return place ? std::to_string(place->program()) + "/" + std::to_string(place->step()) : "-";
}

TEST(StartWords, AStepOfAProgramOrOfTheMainOne) {
  EXPECT_EQ(Understood("45/10"), "45/10");
  EXPECT_EQ(Understood("10"), "0/10");
  EXPECT_EQ(Understood("1/1"), "1/1");
  EXPECT_EQ(Understood("99/2147483647"), "99/2147483647");
  EXPECT_EQ(Understood("0/1"), "0/1");
  for (const char* text : {"", "/", "0", "45/0", "45/", "/1", "-1", "-1/1", "100/1",
                           "45/2147483648", "x/1", "1/x", "1/2/3"})
    EXPECT_EQ(Understood(text), "-") << text;
}

TEST(StartWords, WhatAPersonHasSeen) {
  EXPECT_EQ(SeenName(v1::CONFIRMATION_ORIGIN_VALID), "origin-valid");
  for (const auto& [word, meant] : {std::pair{"inspected", v1::CONFIRMATION_INSPECTED},
                                    std::pair{"table-clear", v1::CONFIRMATION_TABLE_CLEAR},
                                    std::pair{"no-bound", v1::CONFIRMATION_NO_BOUND}})
    EXPECT_EQ(ConfirmationOf(word), meant) << word;
  for (const char* none : {"", "unspecified", "Tool", "origin_valid", "tools"})
    EXPECT_EQ(ConfirmationOf(none), std::nullopt) << none;
}

}  // namespace
}  // namespace rmlcell::cli
