// What stands at the stable URLs, and what goes up there.
#include "server/services/web_resources.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "google/rpc/status.pb.h"
#include "proto/bridge/sha256.h"
#include "rmlcell/v1/program.pb.h"
#include "rmlcell/v1/report.pb.h"
#include "server/base/config.h"
#include "server/jobs/job_book.h"
#include "server/programs/program_book.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/failing_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;

constexpr std::string_view kText = "SPEED 20\n";

class WebResourcesTest : public testing::Test {
 protected:
  WebResourcesTest() { config.limit_program_bytes = 100; }

  static web::UploadHeader Header(const std::string& form = {}) {
    return {.path = web::ProgramContentPath{.machine = "optimo-1", .slot = 45, .form = form},
            .file_name = "plate.S",
            .size = 9};
  }
  Result<web::Resource> Find(const std::string& form) {
    return resources.Find(web::ProgramContentPath{.machine = "optimo-1", .slot = 45, .form = form},
                          {});
  }
  // The message of the code that an upload ends with; empty: it is stored.
  std::string Upload(const web::UploadHeader& header, const std::vector<std::string>& chunks) {
    auto sink = Must(resources.BeginUpload(header, {}));
    for (const std::string& chunk : chunks) EXPECT_TRUE(sink->Append(chunk));
    const web::UploadEnd end = sink->Finish();
    EXPECT_EQ(end.status.empty(), end.message_type == "rmlcell.v1.Program");
    EXPECT_TRUE(stored.ParseFromString(end.message));
    google::rpc::Status status;
    EXPECT_TRUE(status.ParseFromString(end.status));
    return status.message().substr(0, status.message().find(':'));
  }

  ServerBed bed;
  Config config;
  Gate gate{"secret"};
  JobBook book{bed.store(), config};
  ProgramBook programs{bed.store(), config};
  WebResources resources{gate, bed.store(), book, programs};
  v1::Program stored;
};

TEST_F(WebResourcesTest, AProgramGoesUpAndComesDownInEachForm) {
  web::UploadHeader header = Header();
  header.title = "Plate";
  header.sha256 = bridge::Sha256Hex(kText);
  EXPECT_EQ(Upload(header, {"SPEED", " 20\n", ""}), "");
  EXPECT_EQ(stored.name(), "machines/optimo-1/programs/45");
  EXPECT_EQ(stored.title(), "Plate");
  EXPECT_EQ(stored.file_name(), "plate.S");
  for (const std::string form : {"", "source"}) {
    const web::Resource source = Must(Find(form));
    EXPECT_EQ(source.bytes, kText);
    EXPECT_EQ(source.media_type, "text/plain; charset=utf-8");
    EXPECT_EQ(source.file_name, "plate.S");
    EXPECT_EQ(source.etag, bridge::Sha256Hex(kText));
  }
  const web::Resource object = Must(Find("object"));
  EXPECT_EQ(object.bytes, ObjectOf(std::string(kText)));
  EXPECT_EQ(object.media_type, "application/octet-stream");
  EXPECT_EQ(object.etag, bridge::Sha256Hex(object.bytes));
  EXPECT_NE(Must(Find("listing")).bytes, kText);
  EXPECT_EQ(CodeOf(Find("executable")), ErrorCode::kProgramMissing);
  EXPECT_EQ(CodeOf(Find("picture")), ErrorCode::kCellInvalidArgument);
  header.etag = "7";
  EXPECT_EQ(Upload(header, {std::string(kText)}), "CELL-E9006");
  header.etag = "1";
  EXPECT_EQ(Upload(header, {std::string(kText)}), "");
}

// docs/api.md: ?width= of a picture is that of GetProgramPicture, 64 to 8192.
TEST_F(WebResourcesTest, APictureHasTheWidthThatIsAskedFor) {
  EXPECT_EQ(Upload(Header(), {std::string(kText)}), "");
  const auto picture = [&](int width_px) {
    return resources.Find(
        web::ProgramPicturePath{.machine = "optimo-1", .slot = 45, .width_px = width_px}, {});
  };
  EXPECT_EQ(CodeOf(picture(63)), ErrorCode::kCellInvalidArgument);
  EXPECT_NE(Must(picture(64)).etag, Must(picture(8192)).etag);
}

// cell.proto, CellEvent.caller: who stored it stands in the log of the cell.
TEST_F(WebResourcesTest, TheLogNamesWhoStored) {
  EXPECT_EQ(Upload(Header(), {std::string(kText)}), "");
  const auto events = Must(bed.store().AllEvents(0, 100));
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events.back().caller, "local");
}

// All or nothing: what is refused leaves nothing behind.
TEST_F(WebResourcesTest, UploadsThatAreRefused) {
  web::UploadHeader header = Header();
  header.sha256 = bridge::Sha256Hex("another");
  EXPECT_EQ(Upload(header, {std::string(kText)}), "CELL-E9016");
  EXPECT_EQ(Upload(Header(), {"SPEED 101\n"}), "OPT-E7004");
  EXPECT_EQ(Upload(Header(), {}), "CELL-E9017");
  header = Header();
  header.validate_only = true;
  EXPECT_EQ(Upload(header, {std::string(kText)}), "");
  EXPECT_EQ(CodeOf(Find("source")), ErrorCode::kProgramMissing);
  EXPECT_EQ(CodeOf(resources.BeginUpload(Header("picture"), {})), ErrorCode::kCellInvalidArgument);
}

// A report is kept as a message and shown as JSON; other products are shown as they are.
TEST_F(WebResourcesTest, ProductsOfAJob) {
  const auto finished = [&](const std::string& report) {
    bed.SubmitCheck();
    const storage::Lease lease = bed.Lease();
    Must(bed.store().Finish(
        lease, {.artifacts = {
                    {.name = "report", .media_type = "application/x-protobuf", .bytes = report},
                    {.name = "picture.svg", .media_type = "image/svg+xml", .bytes = "<svg/>"}}}));
    return std::to_string(lease.job);
  };
  v1::RunReport report;
  report.set_family("optimo");
  const std::string job = finished(report.SerializeAsString());
  const web::Resource shown = Must(resources.Find(web::ArtifactPath{job, "report"}, {}));
  EXPECT_EQ(shown.media_type, "application/json");
  EXPECT_THAT(shown.bytes, HasSubstr("\"optimo\""));
  EXPECT_THAT(shown.bytes, HasSubstr("\n"));  // for people
  EXPECT_EQ(shown.etag, bridge::Sha256Hex(report.SerializeAsString()));
  const web::Resource picture = Must(resources.Find(web::ArtifactPath{job, "picture.svg"}, {}));
  EXPECT_EQ(picture.media_type, "image/svg+xml");
  EXPECT_EQ(picture.bytes, "<svg/>");
  EXPECT_EQ(picture.etag, bridge::Sha256Hex("<svg/>"));
  EXPECT_EQ(CodeOf(resources.Find(web::ArtifactPath{job, "trace"}, {})), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(resources.Find(web::ArtifactPath{"0", "report"}, {})),
            ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(resources.Find(web::ArtifactPath{finished("\xFF\xFF"), "report"}, {})),
            ErrorCode::kCellStoreCorrupt);
}

// What the store refuses, the look for a product or its bytes, is what the page ends with.
TEST_F(WebResourcesTest, AProductThatCannotBeReadIsAnError) {
  bed.SubmitCheck();
  const storage::Lease lease = bed.Lease();
  Must(bed.store().Finish(lease, {.artifacts = {{.name = "picture.svg", .bytes = "<svg/>"}}}));
  const web::ArtifactPath path{std::to_string(lease.job), "picture.svg"};
  FailingStore failing{bed.store()};
  JobBook refused{failing, config};
  WebResources of_refused{gate, bed.store(), refused, programs};
  ExpectFailuresHandedOn(failing, "a product", 2,
                         [&] { return CodeOf(of_refused.Find(path, {})); });
}

// docs/api.md: bytes for a job take no slot; all of them come, or none is kept.
TEST_F(WebResourcesTest, AContentGoesUpForAJob) {
  web::UploadHeader header;
  header.path = web::UploadsPath();
  header.size = static_cast<std::int64_t>(kText.size());
  header.sha256 = bridge::Sha256Hex(kText);
  {
    auto broken_off = Must(resources.BeginUpload(header, {}));
    EXPECT_TRUE(broken_off->Append("SPEED"));
    const web::UploadEnd end = broken_off->Finish();
    google::rpc::Status status;
    EXPECT_TRUE(status.ParseFromString(end.status));
    EXPECT_THAT(status.message(), HasSubstr("CELL-E9016"));
    EXPECT_EQ(end.message, "");
  }
  {
    auto longer = Must(resources.BeginUpload(header, {}));
    EXPECT_TRUE(longer->Append(kText));
    EXPECT_EQ(CodeOf(longer->Append("x")), ErrorCode::kCellChecksum);
  }
  auto whole = Must(resources.BeginUpload(header, {}));
  EXPECT_TRUE(whole->Append(kText));
  const web::UploadEnd end = whole->Finish();
  EXPECT_EQ(end.status, "");
  EXPECT_EQ(end.message_type, "rmlcell.v1.UploadContentResponse");
  v1::UploadContentResponse made;
  ASSERT_TRUE(made.ParseFromString(end.message));
  EXPECT_EQ(made.sha256(), header.sha256);
  EXPECT_EQ(made.size(), header.size);
  EXPECT_EQ(Must(bed.store().ReadBlob(header.sha256)), kText);
  header.size = 101;
  EXPECT_EQ(CodeOf(resources.BeginUpload(header, {})), ErrorCode::kCellTooLarge);
  EXPECT_EQ(CodeOf(resources.Find(web::UploadsPath(), {})), ErrorCode::kCellInvalidArgument);
}

// server/auth: by the rights of the method that does the same.
TEST_F(WebResourcesTest, WhoMayNotCallGetsNothingHere) {
  gate.SetLocal({});
  for (const web::ResourcePath& path :
       {web::ResourcePath(web::ArtifactPath{"1", "report"}),
        web::ResourcePath(web::ProgramPicturePath{.machine = "optimo-1", .slot = 45}),
        web::ResourcePath(web::ProgramContentPath{.machine = "optimo-1", .slot = 45, .form = {}})})
    EXPECT_EQ(CodeOf(resources.Find(path, {})), ErrorCode::kCellPermission) << path.index();
  EXPECT_EQ(CodeOf(resources.BeginUpload(Header(), {})), ErrorCode::kCellPermission);
  web::UploadHeader content;
  content.path = web::UploadsPath();
  EXPECT_EQ(CodeOf(resources.BeginUpload(content, {})), ErrorCode::kCellPermission);
}

// limits.program_bytes, by what is announced and by what comes: the last byte that fits, and one
// more.
TEST_F(WebResourcesTest, ALimitOfBytes) {
  web::UploadHeader header = Header();
  for (const std::int64_t size : {-1, 0, 100}) {
    header.size = size;
    EXPECT_TRUE(resources.BeginUpload(header, {})) << size;
  }
  header.size = 101;
  EXPECT_EQ(CodeOf(resources.BeginUpload(header, {})), ErrorCode::kCellTooLarge);
  header.size = -1;
  auto sink = Must(resources.BeginUpload(header, {}));
  EXPECT_TRUE(sink->Append(std::string(60, ' ')));
  EXPECT_EQ(sink->Append(std::string(41, ' ')).error().code, ErrorCode::kCellTooLarge);
  EXPECT_TRUE(sink->Append(std::string(40, ' ')));
  EXPECT_EQ(sink->Append(" ").error().code, ErrorCode::kCellTooLarge);
}

}  // namespace
}  // namespace rmlcell::server
