// What a preview of a start tells, and how large files go to a server.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "rmlcell/v1/program.grpc.pb.h"
#include "rmlcell/v1/project.grpc.pb.h"
#include "tests/clients/cli/fake_machine.h"

namespace rmlcell::cli {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class PreviewSides : public MachineWords {
 protected:
  PreviewSides() {
    machine_.machine.set_family("optimo");
    machine_.statuses[0].set_machine("machines/m");
    machine_.statuses[0].set_state(v1::MACHINE_STATE_IDLE);
    machine_.preview.set_preview_token("p");
  }
  std::string Preview() { return Say("start-at m 45/10 --preview").output; }
};

TEST_F(PreviewSides, LessThanAMillimetreOfCutIsLeftOut) {
  EXPECT_THAT(Preview(), Not(HasSubstr("left out")));
  machine_.preview.set_missing_cut_mm(0.5);
  EXPECT_THAT(Preview(), HasSubstr("left out  0.500 mm of cut\n"));
}

// There are no places where nothing is different.
TEST_F(PreviewSides, UnitsAreThoseOfDifferences) {
  const char* units = "          places in units of the program\n";
  machine_.machine.set_family("rml1");
  EXPECT_THAT(Preview(), Not(HasSubstr(units)));
  v1::StartDifference& one = *machine_.preview.add_differences();
  one.set_item("SPEED");
  one.set_there("5");
  one.set_now("20");
  EXPECT_THAT(Preview(), HasSubstr(units));
  machine_.machine.set_family("optimo");
  EXPECT_THAT(Preview(), AllOf(HasSubstr("SPEED  5"), Not(HasSubstr(units))));
}

// Sizes of what comes in parts.
struct PartsOfProgram final : v1::ProgramService::Service {
  grpc::Status UploadProgram(grpc::ServerContext*,
                             grpc::ServerReader<v1::UploadProgramRequest>* reader,
                             v1::Program* response) override {
    for (v1::UploadProgramRequest part; reader->Read(&part);) {
      if (part.has_chunk()) sizes.push_back(part.chunk().size());
    }
    response->set_name("machines/m/programs/12");
    return {};
  }
  std::vector<std::size_t> sizes{};
};
struct PartsOfProject final : v1::ProjectService::Service {
  grpc::Status ImportProject(grpc::ServerContext*,
                             grpc::ServerReader<v1::ImportProjectRequest>* reader,
                             v1::Project* response) override {
    for (v1::ImportProjectRequest part; reader->Read(&part);) {
      if (part.has_chunk()) sizes.push_back(part.chunk().size());
    }
    response->set_name("projects/door");
    return {};
  }
  std::vector<std::size_t> sizes{};
};

// What fills its last part has no empty one behind it.
TEST(WholeParts, AreAsManyAsAreFull) {
  constexpr std::size_t kPart = std::size_t{512} << 10;
  const CliFolder folder;
  PartsOfProgram program;
  PartsOfProject project;
  const FakeServer server(folder, {&program, &project});
  const std::string archive = folder.Put("door.zip", std::string(2 * kPart, 'x'));
  EXPECT_EQ(Hear([&] { return ImportProject(server.remote(), "door", archive); }).exit_code, 0);
  EXPECT_THAT(project.sizes, ElementsAre(kPart, kPart));
  const std::string file = folder.Put("12.S", std::string(7 * kPart, ';'));
  EXPECT_EQ(Hear([&] { return PutProgram(server.remote(), "m", 12, file, {}); }).exit_code, 0);
  EXPECT_EQ(program.sizes, std::vector<std::size_t>(7, kPart));
}

}  // namespace
}  // namespace rmlcell::cli
