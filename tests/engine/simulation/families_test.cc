#include "engine/simulation/families.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "engine/simulation/version.h"
#include "tests/engine/simulation/fake_family.h"

namespace rmlcell::simulation {
namespace {

TEST(Families, ExtensionsAreComparedWithoutCase) {
  const FakeFamily family;
  const machine::FamilyInfo& info = family.info();
  EXPECT_TRUE(ClaimsExtension(info, ".fk"));
  EXPECT_TRUE(ClaimsExtension(info, ".FAKE"));
  EXPECT_FALSE(ClaimsExtension(info, ".fak"));
  EXPECT_FALSE(ClaimsExtension(info, ""));
  EXPECT_FALSE(ClaimsExtension(info, "fk"));
}

// Only letters have two cases: what stands beside them in ASCII is itself.
TEST(Families, OnlyLettersHaveTwoCases) {
  const machine::FamilyInfo info{.extensions = ".AZ .B@ .C["};
  for (const char* same : {".AZ", ".az", ".Az", ".b@", ".c["}) {
    EXPECT_TRUE(ClaimsExtension(info, same)) << same;
  }
  for (const char* other : {".b`", ".c{", ".A", ".AZ ", ".AZ .B@"}) {
    EXPECT_FALSE(ClaimsExtension(info, other)) << other;
  }
}

// The extension is what follows the last point of the name itself, whichever way folders are
// written.
TEST(Families, OfFileNames) {
  const machine::MachineFamily* optimo = FindFamily("optimo");
  ASSERT_NE(optimo, nullptr);
  for (const char* name : {"part.S", "part.si", "a.b.S", "C:\\old.d\\part.S", "x.rml/part.cmp"}) {
    EXPECT_EQ(FamilyOfFileName(name), optimo) << name;
  }
  EXPECT_EQ(FamilyOfFileName("old.S\\part"), nullptr);
  EXPECT_EQ(FamilyOfFileName("part.S.bak"), nullptr);
}

TEST(Families, NamesOfNobody) {
  EXPECT_EQ(FindFamily("no such family"), nullptr);
  EXPECT_EQ(FamilyOfFileName("part.xyz"), nullptr);
  EXPECT_EQ(FamilyOfFileName("part"), nullptr);
  EXPECT_EQ(FamilyOfFileName(""), nullptr);
  EXPECT_EQ(FamilyOfFileName("old.rml/part"), nullptr);  // the extension of a folder
}

// A family is found by its own id and by each of its extensions, and no two share one.
TEST(Families, EachIsFoundByIdAndExtension) {
  std::set<std::string_view> ids;
  for (const machine::MachineFamily* family : Families()) {
    ASSERT_NE(family, nullptr);
    EXPECT_TRUE(ids.insert(family->info().id).second);
    EXPECT_EQ(FindFamily(family->info().id), family);
    const std::string extensions(family->info().extensions);
    const std::string first = extensions.substr(0, extensions.find(' '));
    EXPECT_EQ(FamilyOfFileName("folder.d/part" + first), family);
  }
}

// The version in reports is that of the project.
TEST(Version, IsThatOfTheProject) {
  std::ifstream file(RMLCELL_SOURCE_DIR "/CMakeLists.txt");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::string wanted = "VERSION ";
  wanted += kEngineVersion;
  EXPECT_NE(text.find(wanted + ' '), std::string::npos);
}

}  // namespace
}  // namespace rmlcell::simulation
