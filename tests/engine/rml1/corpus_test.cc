// The programs that people published, as stored programs through a run: SOURCES.md beside them.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "engine/core/number_text.h"
#include "engine/rml1/rml1_family.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

const std::string kCorpus = std::string(RMLCELL_SHARED_DIR) + "/corpus/rml1";

struct ReferenceRow {
  std::map<std::string, std::string> cells;

  const std::string& operator[](const std::string& column) const { return cells.at(column); }
  double Number(const std::string& column) const { return ParseDouble(cells.at(column)).value(); }
};

std::vector<ReferenceRow> LoadReference() {
  std::vector<ReferenceRow> rows;
  std::string text = ReadFile(kCorpus + "/reference.csv");
  std::erase(text, '\r');
  std::istringstream file(text);
  std::string line;
  std::getline(file, line);
  std::vector<std::string> columns;
  std::istringstream heading(line);
  for (std::string column; std::getline(heading, column, ',');) columns.push_back(column);
  while (std::getline(file, line)) {
    ReferenceRow row;
    std::istringstream in(line);
    for (const std::string& column : columns) std::getline(in, row.cells[column], ',');
    rows.push_back(row);
  }
  return rows;
}

// The codes of RML-1 that are expected in the log; empty for nearly all.
std::string ExpectedLog(const std::string& file) {
  if (file == "20-in.trace.rml") return "1,2";
  if (file == "25-1001.prn") return "2,2,1,1";
  return "";
}

class Rml1Corpus : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kCorpus)) GTEST_SKIP() << "no corpus at " << kCorpus;
    rows_ = LoadReference();
    ASSERT_EQ(rows_.size(), 25U);
  }

  static void ExpectFigures(const ReferenceRow& row, const Figures& figures) {
    SCOPED_TRACE(row["file"]);
    EXPECT_EQ(figures.at("programmed.commands"), row.Number("commands"));
    EXPECT_EQ(figures.at("programmed.other"), row.Number("other"));
    std::string counts;
    for (const auto& [name, value] : figures) {
      constexpr std::string_view kPrefix = "programmed.count.";
      if (!name.starts_with(kPrefix)) continue;
      if (!counts.empty()) counts += ' ';
      counts.append(name.substr(kPrefix.size())).append("=").append(ShortestText(value));
    }
    EXPECT_EQ(counts, row["by_mnemonic"]);
    for (const char* column : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"}) {
      EXPECT_EQ(figures.at(std::string("programmed.") + column), row.Number(column)) << column;
    }
    for (const char* column : {"cut_length", "travel_length"}) {
      const double value = figures.at(std::string("programmed.") + column);
      EXPECT_EQ(FixedText(value, 3), row[column]) << column;
    }
  }

  std::vector<ReferenceRow> rows_;
};

TEST_P(Rml1Corpus, GivesTheProgrammedFiguresOfTheReference) {
  for (const ReferenceRow& row : rows_) {
    TestRun run(ParametersOf(GetParam()), ReadFile(kCorpus + "/" + row["file"]));
    run.seen().keep_events = false;
    ASSERT_EQ(run.AdvanceToEnd(), machine::RunPhase::kFinished) << row["file"];
    EXPECT_EQ(run->outcome().kind, machine::OutcomeKind::kCompleted);
    EXPECT_EQ(run->state().progress, 1.0);
    if (row["damaged"] == "yes") {
      EXPECT_GT(run.figures().at("errors"), 1000.0);  // interpretation goes on through all of them
      continue;
    }
    ExpectFigures(row, run.figures());
    EXPECT_EQ(run.seen().CommandLog(), ExpectedLog(row["file"])) << row["file"];
  }
}

// The check of a stream finds the same figures without time.
TEST_P(Rml1Corpus, TranslatesToItselfWithTheSameFigures) {
  for (const ReferenceRow& row : rows_) {
    const std::string stream = ReadFile(kCorpus + "/" + row["file"]);
    const machine::Translation translation = Rml1Family().Translate(
        {.name = row["file"], .bytes = stream}, ParametersOf(GetParam()), {});
    EXPECT_TRUE(translation.ok);
    EXPECT_TRUE(translation.as_it_came);
    if (row["damaged"] == "no") ExpectFigures(row, ByName(translation.figures));
  }
}

INSTANTIATE_TEST_SUITE_P(Machines, Rml1Corpus,
                         ::testing::Values("t1", "srm-20", "mdx-20", "mdx-40a", "pnc-3200"),
                         [](const auto& machine) {
                           std::string name = machine.param;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace rmlcell::rml1
