// Files that are sent in parts, and end where a part does: behind them comes nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "clients/cli/remote.h"
#include "rmlcell/v1/program.grpc.pb.h"
#include "tests/clients/cli/fake_import.h"
#include "tests/clients/cli/fake_services.h"

namespace rmlcell::cli {
namespace {

using testing::Each;
using testing::SizeIs;

constexpr std::size_t kEvenPart = std::size_t{512} << 10;

struct PartsOfPrograms final : v1::ProgramService::Service {
  grpc::Status PutProgram(grpc::ServerContext* /*context*/, const v1::PutProgramRequest* request,
                          v1::Program* /*response*/) override {
    whole = request->program().content().size();
    return {};
  }
  grpc::Status UploadProgram(grpc::ServerContext* /*context*/,
                             grpc::ServerReader<v1::UploadProgramRequest>* reader,
                             v1::Program* /*response*/) override {
    v1::UploadProgramRequest part;
    while (reader->Read(&part)) {
      if (part.has_chunk()) sizes.push_back(part.chunk().size());
    }
    return {};
  }
  std::size_t whole = 0;
  std::vector<std::size_t> sizes{};
};

// Up to 3 MiB go in one message.
TEST(EvenParts, OfAProgram) {
  const CliFolder folder;
  PartsOfPrograms programs;
  const FakeServer server(folder, {&programs});
  const std::string most = folder.Put("1.S", std::string(6 * kEvenPart, ';'));
  EXPECT_EQ(Hear([&] { return PutProgram(server.remote(), "m", 1, most, {}); }).exit_code, 0);
  EXPECT_EQ(programs.whole, 6 * kEvenPart);
  EXPECT_THAT(programs.sizes, SizeIs(0));
  const std::string more = folder.Put("1.S", std::string(7 * kEvenPart, ';'));
  EXPECT_EQ(Hear([&] { return PutProgram(server.remote(), "m", 1, more, {}); }).exit_code, 0);
  EXPECT_THAT(programs.sizes, SizeIs(7));
  EXPECT_THAT(programs.sizes, Each(kEvenPart));
}

TEST(EvenParts, OfAnArchive) {
  const CliFolder folder;
  FakeImport projects;
  const FakeServer server(folder, {&projects});
  const std::string file = folder.Put("door.zip", std::string(2 * kEvenPart, 'x'));
  EXPECT_EQ(Hear([&] { return ImportProject(server.remote(), "door", file); }).exit_code, 0);
  EXPECT_THAT(projects.sizes, SizeIs(2));
  EXPECT_THAT(projects.sizes, Each(kEvenPart));
}

}  // namespace
}  // namespace rmlcell::cli
