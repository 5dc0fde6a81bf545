// Families and machines as messages, and which machines a cell takes.
#include "server/records/machine_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/families/families.h"
#include "engine/machine/family.h"
#include "engine/machine/run.h"
#include "server/records/job_messages.h"
#include "server/records/machine_options.h"

namespace rmlcell::server {
namespace {

using machine::ParameterInfo;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using testing::UnorderedElementsAre;

// A family with one parameter of each kind.
class TableFamily final : public machine::MachineFamily {
 public:
  explicit TableFamily(int schedules = 0) { info_.schedules = schedules; }
  const machine::FamilyInfo& info() const override { return info_; }
  std::span<const ParameterInfo> parameters() const override { return table_; }
  std::span<const machine::MachineProfile> profiles() const override { return profiles_; }
  machine::Translation Translate(const machine::SourceFile&, const machine::Parameters&,
                                 const machine::CheckOptions&) const override {
    return {};
  }
  Result<std::unique_ptr<machine::Run>> NewRun(machine::RunSetup,
                                               machine::RunObserver&) const override {
    return Error{ErrorCode::kCellInvalidArgument, "it does not run", {}};
  }

 private:
  machine::FamilyInfo info_{.id = "table",
                            .title = "A table",
                            .extensions = ".T .TT",
                            .axes = "X Y A",
                            .has_executables = true};
  std::array<ParameterInfo, 2> table_{
      ParameterInfo{"SPEED", "mm/s", 12.5, -1.0, 100.0, {}, "how fast", "T-1"},
      ParameterInfo::OfWord("START", "LEFT RIGHT", "where it begins", "T-2")};
  std::vector<machine::MachineProfile> profiles_{
      {.id = "plain", .title = "as it is", .values = {}},
      {.id = "quick", .title = "a quick one", .values = {{"SPEED", 99.5}, {"START", "RIGHT"}}}};
};

TEST(FamilyMessage, SaysWhatTheFamilyIs) {
  const TableFamily table;
  const v1::Family message = ToProto(table);
  EXPECT_EQ(message.id(), "table");
  EXPECT_EQ(message.title(), "A table");
  EXPECT_THAT(message.extensions(), ElementsAre(".T", ".TT"));
  EXPECT_THAT(message.axes(), ElementsAre("X", "Y", "A"));
  EXPECT_TRUE(message.has_executables());
  EXPECT_FALSE(message.has_schedules());
}

TEST(FamilyMessage, NumbersHaveARangeAndWordsTheirChoices) {
  const TableFamily table;
  const v1::Family message = ToProto(table);
  ASSERT_EQ(message.parameters_size(), 2);
  const v1::ParameterInfo& number = message.parameters(0);
  EXPECT_EQ(number.name(), "SPEED");
  EXPECT_EQ(number.unit(), "mm/s");
  EXPECT_EQ(number.default_value(), "12.5");
  EXPECT_EQ(number.minimum(), -1.0);
  EXPECT_EQ(number.maximum(), 100.0);
  EXPECT_EQ(number.choices_size(), 0);
  EXPECT_EQ(number.description(), "how fast");
  const v1::ParameterInfo& word = message.parameters(1);
  EXPECT_EQ(word.default_value(), "LEFT");  // the first one
  EXPECT_THAT(word.choices(), ElementsAre("LEFT", "RIGHT"));
  EXPECT_EQ(word.unit(), "");
  EXPECT_EQ(word.minimum(), 0.0);
  EXPECT_EQ(word.maximum(), 0.0);
}

TEST(FamilyMessage, ProfilesHaveTheValuesThatDiffer) {
  const TableFamily table;
  const v1::Family message = ToProto(table);
  ASSERT_EQ(message.profiles_size(), 2);
  EXPECT_EQ(message.profiles(0).id(), "plain");
  EXPECT_TRUE(message.profiles(0).parameters().empty());
  EXPECT_EQ(message.profiles(1).title(), "a quick one");
  EXPECT_THAT(message.profiles(1).parameters(),
              UnorderedElementsAre(Pair("SPEED", "99.5"), Pair("START", "RIGHT")));
}

// OPT-3.44: a laser has schedules, and a mill has none; one is enough.
TEST(FamilyMessage, ALaserHasSchedules) {
  EXPECT_TRUE(ToProto(TableFamily(1)).has_schedules());
  EXPECT_TRUE(ToProto(*families::FindFamily("optimo")).has_schedules());
  EXPECT_FALSE(ToProto(*families::FindFamily("rml1")).has_schedules());
}

// What a client reads there it can write into a machine.
TEST(FamilyMessage, EveryDefaultAndProfileMakesAMachine) {
  for (const machine::MachineFamily* family : families::Families()) {
    const v1::Family message = ToProto(*family);
    storage::MachineRecord machine{.id = "m-1", .family = message.id()};
    for (const v1::ParameterInfo& parameter : message.parameters())
      machine.parameters[parameter.name()] = parameter.default_value();
    EXPECT_TRUE(CheckMachine(machine)) << message.id();
    for (const v1::MachineProfile& profile : message.profiles()) {
      machine.profile = profile.id();
      machine.parameters = {profile.parameters().begin(), profile.parameters().end()};
      EXPECT_TRUE(CheckMachine(machine)) << profile.id();
    }
  }
}

TEST(MachineMessage, SaysWhatTheRecordHolds) {
  const storage::MachineRecord record{
      .id = "optimo-1",
      .family = "optimo",
      .title = "Laser",
      .profile = "pw-1993",
      .parameters = {{"VMAX", "400"}, {"LASER", "EFA51"}},
      .revision = 12,
      .created_at = storage::WallTime(std::chrono::microseconds(1'500'000'250'000)),
      .updated_at = storage::WallTime(std::chrono::microseconds(1'500'001'000'001))};
  const v1::Machine message = ToProto(record);
  EXPECT_EQ(message.name(), "machines/optimo-1");
  EXPECT_EQ(message.family(), "optimo");
  EXPECT_EQ(message.title(), "Laser");
  EXPECT_EQ(message.profile(), "pw-1993");
  EXPECT_THAT(message.parameters(),
              UnorderedElementsAre(Pair("VMAX", "400"), Pair("LASER", "EFA51")));
  EXPECT_EQ(message.connection().kind(), v1::MachineConnection::KIND_VIRTUAL);
  EXPECT_EQ(message.status().machine(), message.name());
  EXPECT_EQ(message.status().state(), v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(message.etag(), "12");
  EXPECT_EQ(message.create_time().seconds(), 1'500'000);
  EXPECT_EQ(message.create_time().nanos(), 250'000'000);
  EXPECT_EQ(message.update_time().seconds(), 1'500'001);
  EXPECT_EQ(message.update_time().nanos(), 1'000);
}

TEST(ScheduleMessage, SaysWhatTheRecordHolds) {
  const v1::LaserSchedule message = ToProto(storage::ScheduleRecord{.machine = "optimo-1",
                                                                    .number = 11,
                                                                    .name = "thick",
                                                                    .mode = "PULSE",
                                                                    .power_percent = 62.5,
                                                                    .revision = 3});
  EXPECT_EQ(message.name(), "machines/optimo-1/laserSchedules/11");
  EXPECT_EQ(message.title(), "thick");
  EXPECT_EQ(message.mode(), v1::LASER_MODE_PULSE);
  EXPECT_EQ(message.power_percent(), 62.5);
  EXPECT_EQ(message.etag(), "3");
}

void ExpectNoMachine(const storage::MachineRecord& machine, ErrorCode code,
                     const std::string& detail) {
  const Status checked = CheckMachine(machine);
  ASSERT_FALSE(checked) << detail;
  EXPECT_EQ(checked.error().code, code) << checked.error().detail;
  EXPECT_THAT(checked.error().detail, HasSubstr(detail));
}

TEST(CheckMachine, FamilyProfileAndParametersMustExistAndBeInRange) {
  storage::MachineRecord good{.id = "m-1", .family = "optimo", .profile = "pw-1993"};
  good.parameters = {{"VMAX", "2000"}, {"coord_default", "robot"}};
  EXPECT_TRUE(CheckMachine(good));

  storage::MachineRecord bad = good;
  bad.family = "lathe";
  ExpectNoMachine(bad, ErrorCode::kCellUnknownFamily, "'lathe'; there are optimo rml1");
  bad.family = "";
  ExpectNoMachine(bad, ErrorCode::kCellUnknownFamily, "''");

  bad = good;
  bad.profile = "srm-20";  // of the other family
  ExpectNoMachine(bad, ErrorCode::kCellInvalidArgument, "no profile 'srm-20'");

  bad = good;
  bad.parameters = {{"X_MAX", "1"}};  // of the other family
  ExpectNoMachine(bad, ErrorCode::kCellUnknownParameter, "X_MAX");

  for (const auto& [name, value] : std::map<std::string, std::string>{{"VMAX", "2000.5"},
                                                                      {"AMAX", "9"},
                                                                      {"JMAX", "much"},
                                                                      {"LASER", "CO2"},
                                                                      {"SETTLE", "nan"}}) {
    bad.parameters = {{name, value}};
    ExpectNoMachine(bad, ErrorCode::kCellParameterRange, name);
  }
  bad.parameters = {{"TRAVEL_X_MIN", "100"}, {"TRAVEL_X_MAX", "50"}};  // each may be
  ExpectNoMachine(bad, ErrorCode::kCellParameterRange, "TRAVEL_X_MAX");
}

TEST(CheckMachine, ATitleHas200CharactersAtMost) {
  storage::MachineRecord machine{.id = "m-1", .family = "rml1"};
  for (int i = 0; i < 200; ++i) machine.title += "\xC3\xA4";  // characters, not bytes
  EXPECT_TRUE(CheckMachine(machine));
  machine.title += "x";
  ExpectNoMachine(machine, ErrorCode::kCellInvalidArgument, "title is longer than 200");
}

const storage::MachineRecord kMill{.id = "m-1",
                                   .family = "rml1",
                                   .title = "Mill",
                                   .profile = "mdx-20",
                                   .parameters = {{"ORIGIN_X", "10"}},
                                   .revision = 7};

google::protobuf::FieldMask Mask(const std::vector<std::string>& paths) {
  google::protobuf::FieldMask mask;
  for (const std::string& path : paths) mask.add_paths(path);
  return mask;
}

TEST(UpdatedMachine, WithoutAMaskOnlyWhatHasAValueChanges) {
  v1::Machine wanted;
  wanted.set_title("Mill by the door");
  const auto updated = Updated(kMill, wanted, {});
  ASSERT_TRUE(updated);
  EXPECT_EQ(updated->title, "Mill by the door");
  EXPECT_EQ(updated->profile, "mdx-20");
  EXPECT_EQ(updated->parameters, kMill.parameters);
  EXPECT_EQ(updated->family, "rml1");
  EXPECT_EQ(updated->revision, 7);
}

TEST(UpdatedMachine, AFieldThatTheMaskNamesIsEmptiedWithoutAValue) {
  v1::Machine wanted;
  wanted.set_title("not named");
  const auto updated = Updated(kMill, wanted, Mask({"profile", "parameters"}));
  ASSERT_TRUE(updated);
  EXPECT_EQ(updated->title, "Mill");
  EXPECT_EQ(updated->profile, "");
  EXPECT_TRUE(updated->parameters.empty());
}

// How it lives stays, unless it is stated or named by the mask.
TEST(UpdatedMachine, ItsOptionsAreThoseThatAreWanted) {
  v1::Machine wanted;
  wanted.mutable_options()->set_ticket_needed(true);
  const auto updated = Updated(kMill, wanted, {});
  ASSERT_TRUE(updated);
  const auto options = OptionsOf(*updated);
  ASSERT_TRUE(options);
  EXPECT_TRUE(options->ticket_needed());
  EXPECT_EQ(updated->title, "Mill");
  v1::Machine titled;
  titled.set_title("Mill by the door");
  EXPECT_EQ(Updated(*updated, titled, {})->options, updated->options);
  EXPECT_EQ(Updated(*updated, titled, Mask({"options"}))->options, "");
}

TEST(UpdatedMachine, ItsFamilyStays) {
  v1::Machine wanted;
  wanted.set_family("rml1");
  EXPECT_TRUE(Updated(kMill, wanted, {}));
  wanted.set_family("optimo");
  EXPECT_EQ(Updated(kMill, wanted, {}).error().code, ErrorCode::kCellInvalidArgument);
}

TEST(UpdatedMachine, WhatCannotBeIsRefused) {
  EXPECT_EQ(Updated(kMill, {}, Mask({"revision"})).error().code, ErrorCode::kCellInvalidArgument);
  v1::Machine wanted;
  (*wanted.mutable_parameters())["NO_SUCH"] = "1";
  EXPECT_EQ(Updated(kMill, wanted, {}).error().code, ErrorCode::kCellUnknownParameter);
}

}  // namespace
}  // namespace rmlcell::server
