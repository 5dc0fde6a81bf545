#include "server/host/host_name.h"

#include <unistd.h>

#include "server/base/host_protocol.h"
#include "server/base/secret.h"
#include "server/base/this_computer.h"
#include "server/base/version.h"
#include "server/host/recovered.h"

namespace rmlcell::server {

v1::HostHello HelloOf(const HostOptions& options, const std::string& name, std::int64_t fence,
                      std::string& had_job) {
  v1::HostHello hello;
  hello.set_join_token(options.join_token);
  hello.set_machine(options.machine);
  hello.set_host(name);
  hello.set_version(std::string(kVersion));
  hello.set_protocol(kHostProtocol);
  hello.set_boot_id(NameOfBoot());
  hello.set_computer(NameOfComputer());
  hello.set_fence(fence);
  if (fence == 0) {
    AddNewestMark(options.journal, hello);
    had_job = hello.begin().job();
  } else if (!had_job.empty()) {
    hello.mutable_begin()->set_job(had_job);
  }
  return hello;
}

// The boot, since a number of a process comes again, and two computers may have one name; the
// random part, since it comes again in one boot, too.
std::string NameOfHost() {
  const std::string computer = NameOfComputer();
  return (computer.empty() ? "computer" : computer) + "/" + std::to_string(::getpid()) + "/" +
         NameOfBoot() + RandomText().substr(0, 8);
}

}  // namespace rmlcell::server
