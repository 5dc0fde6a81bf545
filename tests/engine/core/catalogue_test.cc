#include "engine/core/catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "engine/core/number_text.h"

namespace rmlcell {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// A code as a specification gives it.
struct SpecCode {
  std::string family;
  int number = 0;
  std::string constant;  // empty: the specification has no name for it
  std::string severity;

  auto operator<=>(const SpecCode&) const = default;
};

std::vector<std::string> Split(const std::string& line, const std::string& separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end = 0; (end = line.find(separator, begin)) != std::string::npos;) {
    parts.push_back(line.substr(begin, end - begin));
    begin = end + separator.size();
  }
  parts.push_back(line.substr(begin));
  return parts;
}

std::vector<SpecCode> CommittedCodes() {
  std::ifstream file(RMLCELL_SOURCE_DIR "/tests/conformance/catalogue_codes.csv");
  std::vector<SpecCode> codes;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    const std::vector<std::string> parts = Split(line, ",");
    codes.push_back({parts.at(0), std::stoi(parts.at(1)), parts.at(2), parts.at(3)});
  }
  return codes;
}

// The rows "| OPT-E.60 | LABEL_NOT_FOUND | when | program; fatal when ... | notes | page |".
std::vector<SpecCode> CodesOfTheSpecification(std::istream& text) {
  std::vector<SpecCode> codes;
  for (std::string line; std::getline(text, line);) {
    if (!line.starts_with("| OPT-E.")) continue;
    const std::vector<std::string> cells = Split(line, " | ");
    const std::string severity = cells.at(3).substr(0, cells.at(3).find_first_of(";, "));
    codes.push_back({"OPT", std::stoi(cells.at(0).substr(8)), cells.at(1), severity});
  }
  return codes;
}

std::string SeverityWord(Severity severity) {
  switch (severity) {
    case Severity::kAdvice:
      return "advice";
    case Severity::kWarning:
      return "warning";
    case Severity::kCompile:
      return "compile";
    case Severity::kProgram:
      return "program";
    case Severity::kFatal:
      return "fatal";
    case Severity::kAlarm:
      return "alarm";
    case Severity::kMessage:
      return "message";
    case Severity::kTool:
      return "tool";
    case Severity::kBudget:
      return "budget";
    case Severity::kDevice:
      return "device";
    case Severity::kRequest:
      return "request";
  }
  return "";
}

// optimo.md section C, rml1.md 4.20 and 6.01 to 6.03.
TEST(Catalogue, HasEveryCodeOfTheSpecificationsWithItsNameAndSeverity) {
  const std::map<std::string, ErrorFamily> families = {{"OPT", ErrorFamily::kOptimo},
                                                       {"RML1", ErrorFamily::kRml1}};
  const std::vector<SpecCode> codes = CommittedCodes();
  EXPECT_EQ(codes.size(), 127U + 11U);
  for (const SpecCode& spec : codes) {
    const std::optional<ErrorCode> code = FindError(families.at(spec.family), spec.number);
    ASSERT_TRUE(code) << spec.family << spec.number;
    if (!spec.constant.empty()) {
      EXPECT_EQ(ConstantName(*code), spec.constant);
    }
    EXPECT_EQ(SeverityWord(Lookup(*code).severity), spec.severity) << spec.family << spec.number;
  }
}

TEST(Catalogue, TheCommittedCodesAreThoseOfTheSpecification) {
  std::ifstream text(RMLCELL_SHARED_DIR "/spec/optimo.md");
  if (!text) GTEST_SKIP() << "no specification at hand";
  std::vector<SpecCode> committed = CommittedCodes();
  std::erase_if(committed, [](const SpecCode& code) { return code.family != "OPT"; });
  EXPECT_EQ(CodesOfTheSpecification(text), committed);
}

// design.md section 5: 7000-7999 ours for the Optimo, 8000-8999 advice of RML-1, 9000-9999 the
// cell.
TEST(Catalogue, NumbersAreThoseOfTheirFamilyAndUnique) {
  std::set<std::pair<ErrorFamily, int>> numbers;
  const std::set<int> of_the_manual = {60, 129, 348, 931};
  for (const CatalogueEntry& entry : Catalogue()) {
    EXPECT_TRUE(numbers.insert({entry.family, entry.number}).second) << entry.symbol;
    switch (entry.family) {
      case ErrorFamily::kOptimo:
        EXPECT_TRUE(of_the_manual.contains(entry.number) ||
                    (entry.number >= 7000 && entry.number <= 7999))
            << entry.symbol;
        break;
      case ErrorFamily::kRml1:
        EXPECT_TRUE(entry.number <= 18 || (entry.number >= 8000 && entry.number <= 8999))
            << entry.symbol;
        EXPECT_EQ(entry.severity == Severity::kDevice, entry.number <= 18) << entry.symbol;
        break;
      case ErrorFamily::kCell:
        EXPECT_TRUE(entry.number >= 9000 && entry.number <= 9999) << entry.symbol;
        break;
      case ErrorFamily::kFirstOfTables:
        ADD_FAILURE() << entry.symbol;
    }
  }
}

const std::map<int, std::string_view> kNumbersOfTheCell = {
    {9001, "CellInternal"},
    {9002, "CellUnavailable"},
    {9003, "CellInvalidArgument"},
    {9004, "CellNotFound"},
    {9005, "CellAlreadyExists"},
    {9006, "CellEtagMismatch"},
    {9007, "CellTooLarge"},
    {9008, "CellUnknownFamily"},
    {9009, "CellUnknownMachine"},
    {9010, "CellUnknownParameter"},
    {9011, "CellParameterRange"},
    {9012, "CellPermission"},
    {9013, "CellUnauthenticated"},
    {9014, "CellUnimplemented"},
    {9015, "CellPrecondition"},
    {9016, "CellChecksum"},
    {9017, "CellEmptyProgram"},
    {9018, "CellFamilyUnknownFromName"},
    {9019, "CellRequestIdReused"},
    {9020, "CellResourceExhausted"},
    {9021, "CellEventsGone"},
    {9022, "CellFileUnreadable"},
    {9023, "CellFileUnwritable"},
    {9024, "CellBadText"},
    {9025, "CellDiagnosticsCut"},
    {9026, "CellUsage"},
    {9027, "CellToolpathCorrupt"},
    {9101, "CellStoreFailed"},
    {9102, "CellStoreNewer"},
    {9103, "CellStoreBusy"},
    {9104, "CellStoreCorrupt"},
    {9105, "CellLeaseLost"},
    {9106, "CellBadPageToken"},
    {9107, "CellBadFilter"},
    {9201, "CellConfiguration"},
    {9202, "CellPortUsed"},
    {9203, "CellUnsafeListen"},
    {9301, "CellWorkerDied"},
    {9302, "CellMemoryBudget"},
    {9303, "CellProcessorBudget"},
    {9304, "CellStepBudget"},
    {9305, "CellTimeBudget"},
    {9306, "CellOutputBudget"},
    {9307, "CellCancelled"},
    {9308, "CellWaitsForever"},
    {9309, "CellVersionMismatch"},
    {9310, "CellJoinRefused"},
    {9406, "CellNotArmed"},
    {9407, "CellTicket"},
    {9601, "CellGouge"},
    {9602, "CellBelowBlock"},
    {9603, "CellBlockUntouched"},
    {9611, "CellShankInMaterial"},
    {9612, "CellDeepPass"},
    {9613, "CellTargetGouged"},
    {9614, "CellTargetLeft"},
    {9621, "CellBeamStands"},
    {9622, "CellContourSlow"},
    {9623, "CellEnergyAboveProcess"},
    {9624, "CellEnergyBelowProcess"},
    {9625, "CellCutInPtp"},
    {9626, "CellHeadSingular"},
    {9627, "CellNearTravelEnd"},
    {9615, "CellChipThick"},
    {9616, "CellChipThin"},
    {9617, "CellEdgeFast"},
    {9618, "CellBesideBlock"},
    {9619, "CellTooWide"},
    {9620, "CellFastPlunge"},
    {9604, "CellCheckCutShort"},
    {9605, "CellTravelLeft"},
    {9606, "CellCheckLacksProgram"},
    {9607, "CellCheckWaits"},
    {9608, "CellCheckFailsPerhaps"},
    {9501, "CellTargetUnusable"},
    {9502, "CellNoMotion"},
    {9503, "CellArcUndefined"},
    {9504, "CellHoleRadius"},
    {9505, "CellHoleNormal"},
    {9432, "CellHostStopped"},
    {9108, "CellStoreUnavailable"},
    {9408, "CellLeaseHeld"},
    {9409, "CellInspect"},
    {9411, "CellHostDied"},
    {9420, "CellControlNeeded"},
    {9421, "CellMachineState"},
    {9422, "CellMachineTaken"},
    {9423, "CellMode"},
    {9424, "CellNotLive"},
    {9425, "CellDisplaced"},
    {9426, "CellStepUnreachable"},
    {9427, "CellApproach"},
    {9428, "CellPreviewStale"},
    {9429, "CellJournal"},
    {9430, "CellHostLate"},
    {9431, "CellServerLost"},
    {9433, "CellDoorOpen"},
    {9434, "CellKeySequence"},
    {9436, "CellReplayDiffers"},
    {9437, "CellEmergencyStop"},
    {9438, "CellPowerOff"},
};

// design.md section 5: clients and logs know the cell's codes by number, so a number keeps its
// meaning for good; a new code is a new line here. What ends a run is a budget, a finding that cuts
// the others short is advice, what judges a part is a warning, all else refuses a request.
TEST(Catalogue, NumbersOfTheCellKeepTheirMeaning) {
  std::size_t rows = 0;
  for (const CatalogueEntry& entry : Catalogue()) {
    if (entry.family != ErrorFamily::kCell) continue;
    ++rows;
    ASSERT_TRUE(kNumbersOfTheCell.contains(entry.number)) << entry.number;
    EXPECT_EQ(entry.symbol, kNumbersOfTheCell.at(entry.number));
    const bool budget = (entry.number >= 9301 && entry.number <= 9308) || entry.number == 9411 ||
                        entry.number == 9432 || entry.number == 9437 || entry.number == 9438;
    const bool verdict = entry.number >= 9601 && entry.number <= 9627;
    const bool held = entry.number == 9430 || entry.number == 9431;
    const bool motion = entry.number >= 9501 && entry.number <= 9505;
    EXPECT_EQ(entry.severity, budget                 ? Severity::kBudget
                              : motion               ? Severity::kProgram
                              : verdict || held      ? Severity::kWarning
                              : entry.number == 9025 ? Severity::kAdvice
                                                     : Severity::kRequest)
        << entry.number;
  }
  EXPECT_EQ(rows, kNumbersOfTheCell.size());
}

TEST(Catalogue, SymbolsConstantsAndCodesAreUnique) {
  std::set<std::string> names;
  for (const CatalogueEntry& entry : Catalogue()) {
    EXPECT_TRUE(names.insert(std::string(entry.symbol)).second) << entry.symbol;
    EXPECT_TRUE(names.insert(ConstantName(entry.code)).second ||
                ConstantName(entry.code) == entry.symbol)
        << entry.symbol;
    EXPECT_TRUE(names.insert(CodeText(entry.code)).second) << entry.symbol;
    for (const char c : ConstantName(entry.code)) {
      EXPECT_TRUE((c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_') << entry.symbol;
    }
  }
}

// style.md section 4: lower case, no full stop; every row says what happened and what can be done.
TEST(Catalogue, EveryRowSaysWhatHappenedAndWhatCanBeDone) {
  for (const CatalogueEntry& entry : Catalogue()) {
    EXPECT_EQ(&Lookup(entry.code), &entry);
    EXPECT_GE(entry.when.size(), 4U) << entry.symbol;
    EXPECT_GE(entry.advice.size(), 8U) << entry.symbol;
    EXPECT_NE(entry.when, entry.advice) << entry.symbol;
    for (const std::string_view text : {entry.when, entry.advice}) {
      EXPECT_NE(text.back(), '.') << entry.symbol;
      EXPECT_FALSE(text.front() == ' ' || text.back() == ' ') << entry.symbol;
      for (const char c : text) EXPECT_TRUE(c >= 0x20 && c < 0x7F) << entry.symbol;
    }
    EXPECT_TRUE(entry.advice.front() >= 'a' && entry.advice.front() <= 'z') << entry.symbol;
  }
}

TEST(Catalogue, SeveritiesHaveAnameAndAnEffect) {
  std::set<std::string_view> names;
  std::set<std::string_view> effects;
  for (int i = 0; i <= static_cast<int>(Severity::kRequest); ++i) {
    EXPECT_TRUE(names.insert(SeverityName(static_cast<Severity>(i))).second) << i;
    EXPECT_TRUE(effects.insert(SeverityEffect(static_cast<Severity>(i))).second) << i;
    EXPECT_TRUE(SeverityEffect(static_cast<Severity>(i)).ends_with('.'));
  }
  EXPECT_FALSE(names.contains(""));
}

TEST(Catalogue, CodesAreWrittenWithTheirFamily) {
  EXPECT_EQ(CodeText(ErrorCode::kHoleRadiusZero), "OPT-E348");
  EXPECT_EQ(CodeText(ErrorCode::kRml1WrongParameters), "RML1-E2");
  EXPECT_EQ(CodeText(ErrorCode::kCellWorkerDied), "CELL-E9301");
  EXPECT_EQ(ConstantName(ErrorCode::kHoleRadiusZero), "HOLE_RADIUS_ZERO");
  EXPECT_EQ(ConstantName(ErrorCode::kGas3NotFitted), "GAS_3_NOT_FITTED");
  EXPECT_EQ(ConstantName(ErrorCode::kRml1UnknownCommand), "RML1_UNKNOWN_COMMAND");
  EXPECT_EQ(ConstantName(ErrorCode::kRml1Z0Moved), "RML1_Z0_MOVED");
}

TEST(CatalogueDeathTest, WhatIsNoCodeStops) {
  const auto past_the_last = static_cast<ErrorCode>(Catalogue().size());
  EXPECT_DEATH((void)Lookup(past_the_last), "check failed");
  EXPECT_DEATH((void)Lookup(OwnError(OwnErrorTable("PLT"), 0)), "check failed");
}

std::vector<std::string> Found(std::string_view text) {
  std::vector<std::string> codes;
  for (const CatalogueEntry* entry : FindByText(text)) codes.push_back(CodeText(entry->code));
  return codes;
}

TEST(Catalogue, IsSearchedByWhatAPersonMayWrite) {
  for (const std::string_view text :
       {"OPT-E348", "opt-e348", "OPT-348", "348", "E348", "e348", "HoleRadiusZero",
        "holeradiuszero", "HOLE_RADIUS_ZERO", "hole_radius_zero"}) {
    EXPECT_THAT(Found(text), ElementsAre("OPT-E348")) << text;
  }
  EXPECT_THAT(Found("rml1-e2"), ElementsAre("RML1-E2"));
  EXPECT_THAT(Found("2"), ElementsAre("RML1-E2"));
  for (const std::string_view text :
       {"", "-", "E", "OPT-", "OPT-E", "0", "-348", "OPT-E-348", "348 ", " 348", "348.0",
        "99999999999999999999", "RML1-E348", "FOO-E348", "HOLE"}) {
    EXPECT_THAT(Found(text), IsEmpty()) << text;
  }
  for (const CatalogueEntry& entry : Catalogue()) {
    EXPECT_THAT(Found(CodeText(entry.code)), ElementsAre(CodeText(entry.code)));
    EXPECT_THAT(Found(ConstantName(entry.code)), ElementsAre(CodeText(entry.code)));
    EXPECT_EQ(FindError(entry.family, entry.number), entry.code);
  }
  EXPECT_EQ(FindError(ErrorFamily::kCell, 348), std::nullopt);
}

// A program without a registry of families has the catalogue alone.
TEST(Catalogue, HasNoTablesOfItsOwnWithoutFamilies) {
  EXPECT_TRUE(OwnErrorTables().empty());
  EXPECT_EQ(FamilyPrefix(OwnErrorFamily(OwnErrorTable("PLT"))), "");
  // Letters count from 1 to the base 27: no prefix is the beginning of another one.
  EXPECT_EQ(OwnErrorTable("A"), 1);
  EXPECT_EQ(OwnErrorTable("AA"), 28);
  EXPECT_EQ(OwnErrorTable("ZZZZ"), 531'440);
  EXPECT_EQ(static_cast<int>(OwnError(1, 1)), 101'001);
  EXPECT_EQ(static_cast<int>(OwnError(OwnErrorTable("ZZZZ"), 999)), 531'540'999);
}

}  // namespace
}  // namespace rmlcell
