#include "server/auth/access.h"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <set>
#include <string>
#include <vector>

#include "rmlcell/v1/job.pb.h"
#include "rmlcell/v1/machine.pb.h"
#include "server/auth/caller.h"

namespace rmlcell::server {
namespace {

using google::protobuf::DescriptorPool;
using google::protobuf::FieldDescriptor;
using google::protobuf::MethodDescriptor;
using testing::UnorderedElementsAre;

// Every method of the contract, whichever file it stands in.
std::vector<const MethodDescriptor*> Methods() {
  std::vector<const MethodDescriptor*> methods;
  const auto folder = std::filesystem::path(RMLCELL_SOURCE_DIR) / "proto/rmlcell/v1";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto* file = DescriptorPool::generated_pool()->FindFileByName(
        "rmlcell/v1/" + entry.path().filename().string());
    EXPECT_NE(file, nullptr) << entry.path();
    for (int i = 0; file != nullptr && i < file->service_count(); ++i) {
      for (int j = 0; j < file->service(i)->method_count(); ++j)
        methods.push_back(file->service(i)->method(j));
    }
  }
  return methods;
}

std::string PathOf(const MethodDescriptor& method) {
  return "/" + method.service()->full_name() + "/" + method.name();
}

const FieldDescriptor* FieldAt(const google::protobuf::Descriptor& message,
                               const std::string& path) {
  const std::size_t dot = path.find('.');
  const FieldDescriptor* field = message.FindFieldByName(path.substr(0, dot));
  if (field == nullptr || dot == std::string::npos) return field;
  return field->message_type() == nullptr ? nullptr
                                          : FieldAt(*field->message_type(), path.substr(dot + 1));
}

TEST(Access, IsStatedAtEveryMethod) {
  const AccessTable table;
  const auto methods = Methods();
  EXPECT_GT(methods.size(), 100U);
  for (const MethodDescriptor* method : methods) {
    const v1::Access* access = table.Find(PathOf(*method));
    ASSERT_NE(access, nullptr) << PathOf(*method);
    if (!access->resource_field().empty()) {
      const FieldDescriptor* field = FieldAt(*method->input_type(), access->resource_field());
      ASSERT_NE(field, nullptr) << PathOf(*method);
      EXPECT_EQ(field->type(), FieldDescriptor::TYPE_STRING) << PathOf(*method);
    }
    if (!access->resource_field_2().empty()) {
      const FieldDescriptor* field = FieldAt(*method->input_type(), access->resource_field_2());
      ASSERT_NE(field, nullptr) << PathOf(*method);
      EXPECT_EQ(field->type(), FieldDescriptor::TYPE_STRING) << PathOf(*method);
    }
    // A stream carries the token in its messages.
    if (access->needs_control() != v1::CONTROL_NEED_UNSPECIFIED && !method->client_streaming()) {
      EXPECT_NE(method->input_type()->FindFieldByName("control_token"), nullptr) << PathOf(*method);
    }
  }
}

// gRPC's own services: whether a server lives may be asked by anybody.
TEST(Access, IsKnownOfMethodsThatComeWithGrpc) {
  const AccessTable table;
  ASSERT_NE(table.Find("/grpc.health.v1.Health/Check"), nullptr);
  EXPECT_EQ(table.Find("/grpc.health.v1.Health/Check")->permission(), v1::PERMISSION_NONE);
  ASSERT_NE(table.Find("/grpc.health.v1.Health/Watch"), nullptr);
  EXPECT_EQ(table.Find("/grpc.health.v1.Health/Watch")->permission(), v1::PERMISSION_NONE);
  for (const std::string version : {"v1", "v1alpha"}) {
    const v1::Access* reflection =
        table.Find("/grpc.reflection." + version + ".ServerReflection/ServerReflectionInfo");
    ASSERT_NE(reflection, nullptr);
    EXPECT_EQ(reflection->permission(), v1::PERMISSION_VIEW);
  }
  EXPECT_EQ(table.Find("/grpc.channelz.v1.Channelz/GetServers"), nullptr);
  EXPECT_EQ(table.Find("/rmlcell.v1.JobService/Nothing"), nullptr);
  EXPECT_EQ(table.Find(""), nullptr);
}

std::set<std::string> MethodsThatAskFor(v1::Permission permission) {
  const AccessTable table;
  std::set<std::string> found;
  for (const MethodDescriptor* method : Methods()) {
    if (table.Find(PathOf(*method))->permission() == permission) found.insert(method->name());
  }
  return found;
}

// LIVE-4.04: what brings something to a stop asks for `stop`, and for nothing else.
TEST(Access, OfWhatStops) {
  EXPECT_THAT(MethodsThatAskFor(v1::PERMISSION_STOP),
              UnorderedElementsAre("CancelJob", "HoldJob", "StopJob", "StopMachine", "HoldMachine",
                                   "EmergencyStopMachine"));
}

// Who has not said who he is may ask what server it is, who he is, log in, and join as a worker.
TEST(Access, OfWhatAnybodyMay) {
  EXPECT_THAT(MethodsThatAskFor(v1::PERMISSION_NONE),
              UnorderedElementsAre("GetCell", "GetCaller", "LogIn", "LogOut", "Work", "Host"));
}

// LIVE-9.02 to 9.15: what moves a machine carries a token; stops and readings do not.
TEST(Access, OfWhatNeedsControl) {
  const AccessTable table;
  std::set<std::string> found;
  for (const MethodDescriptor* method : Methods()) {
    const v1::Access* access = table.Find(PathOf(*method));
    if (access->needs_control() != v1::CONTROL_NEED_ALWAYS) continue;
    EXPECT_EQ(access->permission(), method->name() == "UndoTeachEntries" ? v1::PERMISSION_PROGRAM
                                                                         : v1::PERMISSION_OPERATE)
        << method->name();
    found.insert(method->name());
  }
  EXPECT_THAT(found,
              UnorderedElementsAre("RenewControl", "ReleaseControl", "StartMachine", "ZeroMachine",
                                   "ResumeMachine", "SetMode", "SetOverride", "AcknowledgeAlarm",
                                   "SetFactor", "WriteVariables", "SetInputs", "SetGates",
                                   "SetBreakpoints", "SetSimulation", "PressPanelKey",
                                   "HeartbeatPanel", "StartAtStep", "ConfirmMachine", "ArmMachine",
                                   "CreateHandboxSession", "PressKey", "HeartbeatHandbox",
                                   "HandboxStream", "UndoTeachEntries", "DecideInterrupted"));
}

// What the API of machines that live asks for: permission, token, and a UUID by which a repeated
// request is known.
struct MethodRow {
  const char* name;
  v1::Permission permission;
  bool token;
  bool id;
};

void ExpectRows(std::initializer_list<MethodRow> rows) {
  const AccessTable table;
  for (const MethodRow& row : rows) {
    const std::vector<const MethodDescriptor*> all = Methods();
    const auto method =
        std::ranges::find_if(all, [&](const auto* one) { return one->name() == row.name; });
    ASSERT_NE(method, all.end()) << row.name;
    const v1::Access* access = table.Find(PathOf(**method));
    EXPECT_EQ(access->permission(), row.permission) << row.name;
    EXPECT_EQ(access->needs_control() == v1::CONTROL_NEED_ALWAYS, row.token) << row.name;
    const auto* request = (*method)->input_type();
    EXPECT_EQ(request->FindFieldByName("request_id") != nullptr, row.id) << row.name;
    if (row.token && !(*method)->client_streaming()) {
      EXPECT_NE(request->FindFieldByName("control_token"), nullptr) << row.name;
    }
  }
}

// LIVE-9.01, LIVE-9.03, LIVE-9.04, LIVE-9.05, LIVE-9.06
TEST(Access, OfMachinesThatLive) {
  ExpectRows({{"EnableMachine", v1::PERMISSION_ADMINISTER, false, true},
              {"DisableMachine", v1::PERMISSION_ADMINISTER, false, true},
              {"TakeMachine", v1::PERMISSION_ADMINISTER, false, true},
              {"StartMachine", v1::PERMISSION_OPERATE, true, true},
              {"ZeroMachine", v1::PERMISSION_OPERATE, true, true},
              {"ResumeMachine", v1::PERMISSION_OPERATE, true, true},
              {"StopMachine", v1::PERMISSION_STOP, false, true},
              {"HoldMachine", v1::PERMISSION_STOP, false, true},
              {"EmergencyStopMachine", v1::PERMISSION_STOP, false, true},
              {"AbortRun", v1::PERMISSION_OPERATE, false, true},
              {"SetMode", v1::PERMISSION_OPERATE, true, true},
              {"SetOverride", v1::PERMISSION_OPERATE, true, true},
              {"AcknowledgeAlarm", v1::PERMISSION_OPERATE, true, true},
              {"SetFactor", v1::PERMISSION_OPERATE, true, true}});
}

// LIVE-9.08, LIVE-9.10, LIVE-9.11, LIVE-9.12, LIVE-9.14
TEST(Access, OfWhatActsOnMachinesThatLive) {
  ExpectRows({{"SetInputs", v1::PERMISSION_OPERATE, true, true},
              {"PressPanelKey", v1::PERMISSION_OPERATE, true, false},  // by its sequence
              {"PreviewStart", v1::PERMISSION_OPERATE, false, true},
              {"StartAtStep", v1::PERMISSION_OPERATE, true, true},
              {"DecideInterrupted", v1::PERMISSION_OPERATE, true, true},
              {"ConfirmMachine", v1::PERMISSION_OPERATE, true, true},
              {"WatchMachine", v1::PERMISSION_VIEW, false, false},
              {"WatchCell", v1::PERMISSION_VIEW, false, false},
              {"WatchHandbox", v1::PERMISSION_VIEW, false, false}});
}

// A job that simulates has no machine to move; a RUN has.
TEST(Access, OfWhatNeedsControlOfARunAlone) {
  const AccessTable table;
  std::set<std::string> found;
  for (const MethodDescriptor* method : Methods()) {
    if (table.Find(PathOf(*method))->needs_control() == v1::CONTROL_NEED_FOR_RUN)
      found.insert(method->name());
  }
  EXPECT_THAT(found, UnorderedElementsAre("ResumeJob", "SetJobOverride"));
}

// WEB-3.05: whoever submitted a job may hold it up and end it.
TEST(Access, OfOnesOwnJobs) {
  const AccessTable table;
  std::set<std::string> found;
  for (const MethodDescriptor* method : Methods()) {
    if (table.Find(PathOf(*method))->own_job()) found.insert(method->name());
  }
  EXPECT_THAT(found, UnorderedElementsAre("CancelJob", "ResumeJob", "SetJobOverride"));
}

// No permission holds another one.
TEST(Permissions, OfTheRoles) {
  const auto of = [](const Permissions& role) {
    std::string text;
    for (const v1::Permission one :
         {v1::PERMISSION_VIEW, v1::PERMISSION_STOP, v1::PERMISSION_PROGRAM, v1::PERMISSION_OPERATE,
          v1::PERMISSION_ADMINISTER})
      text += role.Has(one) ? "1" : "0";
    return text;
  };
  EXPECT_EQ(of(ViewerPermissions()), "10000");
  EXPECT_EQ(of(ProgrammerPermissions()), "11100");
  EXPECT_EQ(of(OperatorPermissions()), "11010");
  EXPECT_EQ(of(AdministratorPermissions()), "11111");
  EXPECT_EQ(of({}), "00000");
  EXPECT_FALSE(AdministratorPermissions().Has(v1::PERMISSION_UNSPECIFIED));
}

TEST(Resource, IsWhatTheFieldNames) {
  v1::SubmitJobRequest submit;
  submit.mutable_job()->set_machine("machines/mill-1");
  EXPECT_EQ(ResourceOf(submit, "job.machine"), "machines/mill-1");
  EXPECT_EQ(ResourceOf(submit, "job.nothing"), "");
  EXPECT_EQ(ResourceOf(submit, "job.budget"), "");
  EXPECT_EQ(ResourceOf(submit, "request_id.machine"), "");
  EXPECT_EQ(ResourceOf(submit, ""), "");
  EXPECT_EQ(ResourceOf(v1::SubmitJobRequest(), "job.machine"), "");
  v1::GetMachineRequest get;
  get.set_name("machines/a");
  EXPECT_EQ(ResourceOf(get, "name"), "machines/a");
}

}  // namespace
}  // namespace rmlcell::server
