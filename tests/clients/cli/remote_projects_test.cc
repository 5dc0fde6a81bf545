// What goes to a server and comes back when a project is transferred.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "clients/cli/remote.h"
#include "clients/cli/verbs.h"
#include "engine/core/result.h"
#include "proto/bridge/files.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/sha256.h"
#include "rmlcell/v1/machine.grpc.pb.h"
#include "rmlcell/v1/program.grpc.pb.h"
#include "rmlcell/v1/project.grpc.pb.h"
#include "tests/clients/cli/fake_import.h"
#include "tests/clients/cli/fake_services.h"

namespace rmlcell::cli {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

// 512 KiB at a time, whatever is left in the last one.
TEST(RemoteProjects, AnArchiveIsSentInParts) {
  constexpr std::size_t kPart = std::size_t{512} << 10;
  const CliFolder folder;
  FakeImport project;
  const FakeServer server(folder, {&project});
  const std::string file = folder.Put("door.zip", std::string(2 * kPart + 1, 'x'));
  const Told told = Hear([&] { return ImportProject(server.remote(), "door", file); });
  EXPECT_EQ(told.exit_code, 0) << told.errors;
  EXPECT_THAT(project.sizes, ElementsAre(kPart, kPart, std::size_t{1}));
}

struct FakeTransfer final : v1::ProjectService::Service {
  grpc::Status TransferProject(grpc::ServerContext*, const v1::TransferProjectRequest*,
                               v1::TransferProjectResponse* response) override {
    *response = transferred;
    return {};
  }
  v1::TransferProjectResponse transferred{};
};

// What was there is told where something else takes its place, and only there.
TEST(RemoteProjects, EachChangeOfATransferIsTold) {
  const CliFolder folder;
  FakeTransfer transfer;
  const auto add = [&](const std::string& name, v1::TransferChange change) -> v1::TransferItem& {
    v1::TransferItem& item = *transfer.transferred.add_items();
    item.set_name(name);
    item.set_change(change);
    return item;
  };
  add("p/12", v1::TRANSFER_CHANGE_ADD).mutable_program_after()->set_object_bytes(33);
  v1::TransferItem& same = add("p/13", v1::TRANSFER_CHANGE_SAME);
  same.mutable_program_before()->set_object_bytes(34);
  same.mutable_program_after()->set_object_bytes(34);
  same.mutable_program_after()->set_title("a\tb");
  add("p/14", v1::TRANSFER_CHANGE_UNSPECIFIED).mutable_program_after()->set_object_bytes(35);
  v1::TransferItem& schedule = add("s/3", v1::TRANSFER_CHANGE_REPLACE);
  schedule.mutable_laser_schedule_before()->set_mode(v1::LASER_MODE_CW);
  schedule.mutable_laser_schedule_before()->set_power_percent(10.0);
  schedule.mutable_laser_schedule_after()->set_mode(v1::LASER_MODE_PULSE);
  schedule.mutable_laser_schedule_after()->set_power_percent(12.5);
  schedule.mutable_laser_schedule_after()->set_title("fine");
  const FakeServer server(folder, {&transfer});
  const Told told = Hear([&] { return TransferProject(server.remote(), "p", "m", false, false); });
  EXPECT_EQ(told.output,
            "p/12 new: object 33 B\n"
            "p/13 the same as before: a\\x09b, object 34 B\n"
            "p/14 stored: object 35 B\n"
            "s/3 replaced: fine, PULSE 12.5 %, was CW 10 %\n"
            "all of it is stored\n");
}

}  // namespace
}  // namespace rmlcell::cli
