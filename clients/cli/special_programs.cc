#include <CLI/CLI.hpp>
#include <memory>
#include <vector>

#include "clients/cli/messages.h"
#include "clients/cli/remote_call.h"
#include "clients/cli/terminal.h"
#include "clients/cli/verbs.h"
#include "rmlcell/v1/program.grpc.pb.h"

namespace rmlcell::cli {
namespace {

struct SpecialWords {
  std::string machine;
  std::vector<int> slots;
  bool replace = false;
};

int StoreSpecial(const Remote& remote, const SpecialWords& words) {
  const auto stub = v1::ProgramService::NewStub(Connect(remote));
  grpc::ClientContext context;
  cli::Prepare(context);
  v1::StoreSpecialProgramsRequest request;
  request.set_parent(FullName("machines", words.machine));
  request.mutable_slots()->Add(words.slots.begin(), words.slots.end());
  request.set_replace(words.replace);
  v1::StoreSpecialProgramsResponse response;
  const grpc::Status status = stub->StoreSpecialPrograms(&context, request, &response);
  if (!status.ok()) return Refused(status, remote);
  for (const v1::Program& program : response.programs())
    Print(remote.json ? Json(program) : program.name() + " stored: " + Visible(program.title()));
  return kGood;
}

}  // namespace

void AddSpecialVerb(CLI::App& app, Remote& remote, int& exit_code) {
  const auto words = std::make_shared<SpecialWords>();
  CLI::App* verb = app.add_subcommand(
      "special", "Store the programs that others call and that a new machine does not have");
  verb->footer(
      "Examples:\n"
      "  rmlcell special optimo-1                       sensor calibration, Z-up, home return, "
      "tool\n"
      "  rmlcell special optimo-1 2 4 90                these alone\n"
      "  rmlcell special optimo-1 2 --replace           whatever is there");
  verb->add_option("--server", remote.server,
                   "host:port or unix:/path; default: RMLCELL_SERVER, or 127.0.0.1:50051");
  verb->add_flag("--json", remote.json, "print messages as JSON, one line each");
  verb->add_option("MACHINE", words->machine)->required();
  verb->add_option("SLOTS", words->slots, "of an Optimo 1, 2, 4, 90; none: all of them");
  verb->add_flag("--replace", words->replace,
                 "put them in place of what is there; else that is refused, and nothing is stored");
  verb->callback([words, &remote, &exit_code] { exit_code = StoreSpecial(remote, *words); });
}

}  // namespace rmlcell::cli
