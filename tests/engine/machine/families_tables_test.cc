#include <gtest/gtest.h>

#include <set>

#include "engine/simulation/families.h"

// The tables that families hand over, whatever the family.
namespace rmlcell::machine {
namespace {

std::string Upper(std::string_view text) {
  std::string upper(text);
  for (char& c : upper) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  return upper;
}

TEST(FamilyTables, ParametersAreCompleteAndTheirDefaultsAreInRange) {
  for (const MachineFamily* family : simulation::Families()) {
    std::set<std::string> names;
    for (const ParameterInfo& info : family->parameters()) {
      const std::string where = std::string(family->info().id) + " " + std::string(info.name);
      EXPECT_TRUE(names.insert(Upper(info.name)).second) << where << " stands twice";
      EXPECT_FALSE(info.text.empty()) << where;
      EXPECT_FALSE(info.rule.empty()) << where;
      Parameters parameters(family->parameters());
      if (info.choices.empty()) {
        EXPECT_LE(info.minimum, info.maximum) << where;
        EXPECT_TRUE(parameters.Set(info.name, info.standard)) << where;
        EXPECT_TRUE(parameters.Set(info.name, info.minimum)) << where;
        EXPECT_TRUE(parameters.Set(info.name, info.maximum)) << where;
      } else {
        EXPECT_TRUE(parameters.Set(info.name, parameters.Word(info.name))) << where;
        EXPECT_EQ(info.choices.find("  "), std::string_view::npos) << where;
      }
    }
  }
}

TEST(FamilyTables, EveryProfileCanBeApplied) {
  for (const MachineFamily* family : simulation::Families()) {
    std::set<std::string_view> ids;
    for (const MachineProfile& profile : family->profiles()) {
      EXPECT_TRUE(ids.insert(profile.id).second) << profile.id;
      EXPECT_FALSE(profile.title.empty()) << profile.id;
      Parameters parameters(family->parameters());
      const Status applied = parameters.Apply(profile);
      EXPECT_TRUE(applied) << profile.id << ": " << applied.error().detail;
    }
  }
}

// A travel whose ends are the wrong way round, or a machine without one, makes no picture.
TEST(FamilyTables, EveryProfileHasATravel) {
  for (const MachineFamily* family : simulation::Families()) {
    for (const MachineProfile& profile : family->profiles()) {
      Parameters parameters(family->parameters());
      ASSERT_TRUE(parameters.Apply(profile));
      const MachineShape shape = family->Shape(parameters);
      ASSERT_FALSE(shape.travel.empty()) << profile.id;
      EXPECT_LT(shape.travel.min.x, shape.travel.max.x) << profile.id;
      EXPECT_LT(shape.travel.min.y, shape.travel.max.y) << profile.id;
      EXPECT_LT(shape.travel.min.z, shape.travel.max.z) << profile.id;
    }
  }
}

TEST(FamilyTables, IdsAndExtensionsBelongToOneFamily) {
  std::set<std::string_view> ids;
  std::set<std::string> extensions;
  for (const MachineFamily* family : simulation::Families()) {
    EXPECT_TRUE(ids.insert(family->info().id).second);
    EXPECT_EQ(simulation::FindFamily(family->info().id), family);
    std::string_view rest = family->info().extensions;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find(' '), rest.size());
      const std::string extension(rest.substr(0, end));
      EXPECT_EQ(extension.front(), '.');
      EXPECT_TRUE(extensions.insert(Upper(extension)).second) << extension;
      EXPECT_EQ(simulation::FamilyOfFileName("a" + extension), family);
      EXPECT_EQ(simulation::FamilyOfFileName("a" + Upper(extension)), family);
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  EXPECT_EQ(simulation::FindFamily("lathe"), nullptr);
  EXPECT_EQ(simulation::FindFamily(""), nullptr);
  EXPECT_EQ(simulation::FamilyOfFileName("a.txt"), nullptr);
  EXPECT_EQ(simulation::FamilyOfFileName(""), nullptr);
}

// docs/facts.md: a figure is known by its name.
TEST(FamilyTables, FiguresHaveNamesUnitsAndMeanings) {
  for (const MachineFamily* family : simulation::Families()) {
    std::set<std::string_view> names;
    for (const FigureInfo& figure : family->figures()) {
      EXPECT_TRUE(names.insert(figure.name).second) << figure.name;
      EXPECT_FALSE(figure.text.empty()) << figure.name;
    }
  }
}

}  // namespace
}  // namespace rmlcell::machine
