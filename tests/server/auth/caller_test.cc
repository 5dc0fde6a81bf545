#include "server/auth/caller.h"

#include <gtest/gtest.h>

namespace rmlcell::server {
namespace {

Caller Admitted(const Gate& gate, std::multimap<std::string, std::string> metadata) {
  const auto caller = gate.Admit({.method = "/rmlcell.v1.JobService/GetJob",
                                  .peer = "ipv4:127.0.0.1:7",
                                  .metadata = std::move(metadata)});
  EXPECT_TRUE(caller);
  return *caller;
}

// Loopback and unix sockets only: whoever calls is the local administrator.
TEST(Gate, EveryCallerIsTheLocalAdministrator) {
  const Caller caller = Admitted(Gate("secret"), {});
  EXPECT_EQ(caller.identity, "local");
  EXPECT_EQ(caller.permissions, AdministratorPermissions());
  EXPECT_EQ(caller.peer, "ipv4:127.0.0.1:7");
  EXPECT_EQ(caller.request_id, "");
}

// The kernel says who is at the other end of a unix socket; a descriptor is given again.
TEST(Gate, KnowsTheUserOfASocket) {
  Gate gate("secret");
  gate.socket_users().Note(0, 1);
  gate.socket_users().Note(7, 1000);
  const auto admitted = [&gate](const std::string& peer, Transport transport) {
    return *gate.Admit(
        {.method = "/rmlcell.v1.JobService/GetJob", .peer = peer, .transport = transport});
  };
  const auto user = [&admitted](const std::string& peer, Transport transport) {
    return admitted(peer, transport).user;
  };
  // The log names the user, and where he is not known the descriptor.
  EXPECT_EQ(admitted("fd:7", Transport::kUnixSocket).peer, "unix:user 1000");
  EXPECT_EQ(admitted("fd:8", Transport::kUnixSocket).peer, "fd:8");
  EXPECT_EQ(user("fd:7", Transport::kUnixSocket), 1000U);
  EXPECT_EQ(user("fd:8", Transport::kUnixSocket), std::nullopt);
  EXPECT_EQ(user("fd:7", Transport::kTcp), std::nullopt);
  EXPECT_EQ(user("fd:", Transport::kUnixSocket), std::nullopt);
  EXPECT_EQ(user("fd:x", Transport::kUnixSocket), std::nullopt);
  EXPECT_EQ(user("at:7", Transport::kUnixSocket), std::nullopt);
  // That of the gateway is not the browser's.
  const auto browser = gate.Admit({.method = "/rmlcell.v1.JobService/GetJob",
                                   .peer = "fd:7",
                                   .metadata = {{"rmlcell-web-secret", "secret"}},
                                   .transport = Transport::kUnixSocket});
  EXPECT_EQ(browser->user, std::nullopt);
  gate.socket_users().Note(7, 0);
  EXPECT_EQ(user("fd:7", Transport::kUnixSocket), 0U);
}

TEST(Gate, RightsChange) {
  Gate gate("secret");
  const auto may = [&gate] {
    return bool(gate.Admit({.method = "/rmlcell.v1.JobService/StopJob", .peer = ""}));
  };
  EXPECT_TRUE(may());
  int told = 0;
  gate.OnChange([&told] { ++told; });
  gate.SetLocal(ViewerPermissions());
  EXPECT_EQ(told, 1);
  EXPECT_FALSE(may());
  gate.SetLocal(OperatorPermissions());
  EXPECT_TRUE(may());
}

TEST(Gate, AMethodThatStatesNothingIsRefused) {
  const auto refused = Gate("secret").Admit({.method = "/a.B/C", .peer = "unix:"});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellPermission);
  EXPECT_EQ(refused.error().detail, "/a.B/C states no permission");
}

TEST(Gate, ACallerMayDoWhatHeHasThePermissionFor) {
  const auto may = [](const Permissions& local, const std::string& method) {
    const auto caller =
        Gate("secret", local).Admit({.method = "/rmlcell.v1." + method, .peer = ""});
    EXPECT_TRUE(caller || caller.error().code == ErrorCode::kCellPermission);
    return bool(caller);
  };
  EXPECT_TRUE(may(ViewerPermissions(), "JobService/GetJob"));
  EXPECT_FALSE(may(ViewerPermissions(), "JobService/StopJob"));
  EXPECT_FALSE(may(ViewerPermissions(), "JobService/SubmitJob"));
  EXPECT_TRUE(may(ProgrammerPermissions(), "JobService/StopJob"));
  EXPECT_TRUE(may(ProgrammerPermissions(), "JobService/SubmitJob"));
  EXPECT_FALSE(may(ProgrammerPermissions(), "JobService/ResumeJob"));
  EXPECT_TRUE(may(OperatorPermissions(), "JobService/ResumeJob"));
  EXPECT_FALSE(may(OperatorPermissions(), "MachineService/CreateMachine"));
  // Asked of nobody.
  EXPECT_TRUE(may({}, "CellService/GetCell"));
  EXPECT_FALSE(may({}, "JobService/GetJob"));
}

// What is said of a browser counts with the secret of the gateway, and without one never.
TEST(Gate, OnlyTheGatewaySpeaksForABrowser) {
  const Gate gate("secret");
  const auto peer = [](const Gate& of, const std::string& secret) {
    return Admitted(of, {{"rmlcell-web-secret", secret}, {"rmlcell-web-peer", "10.1.1.1:5"}}).peer;
  };
  EXPECT_EQ(gate.web_secret(), "secret");
  EXPECT_EQ(peer(gate, "secret"), "web:10.1.1.1:5");
  for (const std::string wrong : {"", "Secret", "secret ", "secre"})
    EXPECT_EQ(peer(gate, wrong), "ipv4:127.0.0.1:7");
  EXPECT_EQ(Admitted(gate, {{"rmlcell-web-peer", "10.1.1.1:5"}}).peer, "ipv4:127.0.0.1:7");
  EXPECT_EQ(peer(Gate(""), ""), "ipv4:127.0.0.1:7");
  EXPECT_EQ(Admitted(Gate(""), {{"rmlcell-web-peer", "10.1.1.1:5"}}).peer, "ipv4:127.0.0.1:7");
}

// It goes into lines of the log: 64 characters that can be read, blank to tilde.
TEST(Gate, ARequestIdFitsALineOfTheLog) {
  const auto shown = [](const std::string& id) {
    return Admitted(Gate("secret"), {{"x-request-id", id}}).request_id;
  };
  EXPECT_EQ(shown("r-7"), "r-7");
  EXPECT_EQ(shown(" !}~"), " !}~");
  EXPECT_EQ(shown("a\x1F"
                  "b\x7F"
                  "c\n\xC3\xBC"),
            "a?b?c???");
  EXPECT_EQ(shown(std::string(64, 'x')), std::string(64, 'x'));
  EXPECT_EQ(shown(std::string(64, 'x') + "y"), std::string(64, 'x'));
}

}  // namespace
}  // namespace rmlcell::server
