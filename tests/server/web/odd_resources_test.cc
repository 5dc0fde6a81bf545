// Resources that do not keep what they said: the browser sees that something went wrong, and
// nothing of it is taken for whole.
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "rmlcell/v1/program.pb.h"
#include "server/web/web_server.h"
#include "tests/server/web/fake_cell.h"
#include "tests/server/web/raw_client.h"

namespace rmlcell::web::testing {
namespace {

constexpr int kToldBytes = 1000;

// Gives a byte less than was told.
class ShortReader final : public ResourceReader {
 public:
  Result<std::string> Read(std::size_t) override {
    return std::exchange(read_, true) ? std::string() : std::string(kToldBytes - 1, 'x');
  }

 private:
  bool read_ = false;
};

// Ends as its file is called.
class OddSink final : public UploadSink {
 public:
  explicit OddSink(std::string file_name) : file_name_(std::move(file_name)) {}
  Status Append(std::string_view) override { return {}; }
  UploadEnd Finish() override {
    if (file_name_ == "throws") throw std::runtime_error("a bug");
    if (file_name_ == "no status") return {.message_type = {}, .message = {}, .status = "\xFF"};
    if (file_name_ == "no type")
      return {.message_type = "rmlcell.v1.None", .message = {}, .status = {}};
    v1::Program program;
    program.set_title("Lid");
    return {.message_type = "rmlcell.v1.Program",
            .message = file_name_ == "no message" ? "\xFF\xFF" : program.SerializeAsString(),
            .status = {}};
  }

 private:
  std::string file_name_;
};

class OddSource final : public ResourceSource {
 public:
  Result<Resource> Find(const ResourcePath& path, const WebCallerMetadata&) override {
    Resource resource;
    if (const auto* picture = std::get_if<ProgramPicturePath>(&path)) {
      resource.media_type = "image/svg+xml";
      resource.etag = "picture-" + std::to_string(picture->slot);
      resource.make = [this, slot = picture->slot]() -> Result<std::string> {
        ++drawn;
        if (slot == 2) return Error{ErrorCode::kCellNotFound, "nothing to draw", {}};
        if (slot == 3) throw std::runtime_error("a bug");
        return std::string("<svg/>");
      };
      return resource;
    }
    resource.media_type = "text/plain";
    if (std::get<ArtifactPath>(path).artifact == "short") {
      resource.size = kToldBytes;
      resource.reader = std::make_unique<ShortReader>();
    } else {
      resource.bytes = "bare";
      resource.file_name = "bare.txt";
    }
    return resource;
  }
  Result<std::unique_ptr<UploadSink>> BeginUpload(const UploadHeader& header,
                                                  const WebCallerMetadata&) override {
    if (header.file_name == "throws at once") throw std::runtime_error("a bug");
    return std::unique_ptr<UploadSink>(std::make_unique<OddSink>(header.file_name));
  }

  std::atomic<int> drawn = 0;
};

class OddResources : public ::testing::Test {
 protected:
  RawResponse Asked(std::string_view request) const { return Exchange(web_->port(), request); }
  // As "404 CELL-E9004".
  static std::string CodeIn(const RawResponse& response) {
    const nlohmann::json body = nlohmann::json::parse(response.body, nullptr, false);
    const std::string code = body.is_object() ? body["details"][1].value("code", "") : "no error";
    return std::to_string(response.status) + " " + code;
  }
  static std::string Picture(int slot) {
    return "/v1/machines/optimo-1/programs/" + std::to_string(slot) + "/picture.svg";
  }

  OddSource source_;
  std::unique_ptr<WebServer> web_ = *WebServer::Start(AnyPort(), nullptr, source_);
};

// What takes seconds is made for those alone who do not have it.
TEST_F(OddResources, WhatIsKnownIsNotDrawnAgain) {
  const RawResponse drawn = Asked(Get(Picture(1)));
  EXPECT_EQ(drawn.status, 200);
  EXPECT_EQ(drawn.body, "<svg/>");
  EXPECT_EQ(drawn.Header("content-type"), "image/svg+xml");
  EXPECT_EQ(drawn.Header("etag"), "\"picture-1\"");
  EXPECT_EQ(source_.drawn, 1);
  EXPECT_EQ(Asked(Get(Picture(1), "If-None-Match: \"picture-1\"\r\n")).status, 304);
  EXPECT_EQ(source_.drawn, 1);
}

TEST_F(OddResources, WhatCannotBeDrawnIsAnError) {
  EXPECT_EQ(CodeIn(Asked(Get(Picture(2)))), "404 CELL-E9004");
  EXPECT_EQ(CodeIn(Asked(Get(Picture(3)))), "500 CELL-E9001");
}

// What is left out would be waited for: the connection ends where the bytes do.
TEST_F(OddResources, ADownloadThatIsTooShortIsCutOff) {
  RawClient client(web_->port());
  client.Send(Get("/v1/jobs/17/artifacts/short"));
  const RawResponse response = client.Read();
  EXPECT_EQ(response.Header("content-length"), "1000");
  EXPECT_EQ(response.body.size(), 999U);
  EXPECT_FALSE(response.complete);
  EXPECT_TRUE(client.AtEnd());
}

// RFC 9110 8.8.3: without a tag there is nothing that a browser could have already.
TEST_F(OddResources, WhatHasNoTagIsAlwaysSent) {
  const RawResponse response =
      Asked(Get("/v1/jobs/17/artifacts/bare", "If-None-Match: \"\", W/\"\", *\r\n"));
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(response.body, "bare");
  EXPECT_EQ(response.headers.count("etag"), 0U);
  EXPECT_EQ(response.Header("content-disposition"), "inline; filename=\"bare.txt\"");
}

TEST_F(OddResources, AnUploadThatEndsOddlyIsAnError) {
  const auto upload = [&](const std::string& file_name) {
    return Asked(Post("/v1/machines/optimo-1/programs/45/content?file_name=" + file_name,
                      "application/octet-stream", "MOVE"));
  };
  const RawResponse good = upload("good");
  EXPECT_EQ(good.status, 200);
  EXPECT_EQ(nlohmann::json::parse(good.body)["title"], "Lid");
  for (const char* odd : {"throws+at+once", "throws", "no+status", "no+type", "no+message"})
    EXPECT_EQ(CodeIn(upload(odd)), "500 CELL-E9001") << odd;
}

}  // namespace
}  // namespace rmlcell::web::testing
