#include "server/web/resource_routes.h"

#include <gtest/gtest.h>

namespace rmlcell::web {
namespace {

HttpRequest At(std::string path, std::string query = {}) {
  HttpRequest request;
  request.method = "POST";
  request.path = std::move(path);
  request.query = std::move(query);
  request.headers = {{"content-type", "application/octet-stream"}, {"content-length", "12"}};
  return request;
}

TEST(ResourceRoutes, Artifacts) {
  const ResourceRoute route = RouteResource(At("/v1/jobs/17/artifacts/picture.svg"));
  ASSERT_TRUE(route.path);
  const auto& path = std::get<ArtifactPath>(*route.path);
  EXPECT_EQ(path.job, "17");
  EXPECT_EQ(path.artifact, "picture.svg");
  const ResourceRoute escaped = RouteResource(At("/v1/jobs/17/artifacts/a%20b%c3%bc"));
  EXPECT_EQ(std::get<ArtifactPath>(*escaped.path).artifact, "a b\xC3\xBC");
  // RFC 3986: in a path a plus sign is one; a blank it is in the queries of forms.
  const ResourceRoute plus = RouteResource(At("/v1/jobs/1+7/artifacts/a+b"));
  EXPECT_EQ(std::get<ArtifactPath>(*plus.path).job, "1+7");
  EXPECT_EQ(std::get<ArtifactPath>(*plus.path).artifact, "a+b");
}

// An escaped slash or dot never becomes part of a path.
TEST(ResourceRoutes, HostileSegments) {
  for (const std::string name :
       {"..", ".", "%2e%2e", "a%2Fb", "a%5Cb", "%00", "%0a", "", "%zz", "%4", "%7f"}) {
    const ResourceRoute route = RouteResource(At("/v1/jobs/17/artifacts/" + name));
    EXPECT_TRUE(route.is_resource) << name;
    EXPECT_FALSE(route.path) << name;
  }
  EXPECT_FALSE(RouteResource(At("/v1/jobs/17/artifacts/" + std::string(201, 'a'))).path);
  EXPECT_TRUE(RouteResource(At("/v1/jobs/17/artifacts/" + std::string(200, 'a'))).path);
  for (const std::string path :
       {"/v1/jobs/17", "/v1/jobs/17/artifacts", "/v1/jobs/17/artifacts/a/b",
        "/v2/jobs/1/artifacts/a", "/v1//jobs/17/artifacts/a", "/v1/", "/v1/other",
        "/v1/machines/optimo-1/programs/45", "/v1/jobs/17/events/3", "/v1/runs/17/artifacts/a",
        "/v1/jobs/17/programs/4/content", "/v1/machines/optimo-1/schedules/4/content",
        "/v1/machines/optimo-1/programs/4/other"}) {
    EXPECT_FALSE(RouteResource(At(path)).is_resource) << path;
  }
}

// Slots 1 to 99, and 101 to 199 for executables.
TEST(ResourceRoutes, Slots) {
  for (const auto& [text, number] : {std::pair{"1", 1}, {"45", 45}, {"099", 99}, {"199", 199}}) {
    const ResourceRoute route = RouteResource(
        At("/v1/machines/optimo-1/programs/" + std::string(text) + "/content", "form=object"));
    ASSERT_TRUE(route.path) << text;
    EXPECT_EQ(std::get<ProgramContentPath>(*route.path).slot, number);
    EXPECT_EQ(std::get<ProgramContentPath>(*route.path).form, "object");
  }
  for (const std::string text : {"0", "200", "999", "-1", "1.5", "x", "0001", "%31x"}) {
    EXPECT_FALSE(RouteResource(At("/v1/machines/optimo-1/programs/" + text + "/content")).path)
        << text;
  }
}

TEST(ResourceRoutes, PicturesOfPrograms) {
  const auto width = [](const std::string& query) {
    const ResourceRoute route =
        RouteResource(At("/v1/machines/optimo-1/programs/45/picture.svg", query));
    EXPECT_TRUE(route.is_resource);
    if (!route.path) return -1;
    const auto& path = std::get<ProgramPicturePath>(*route.path);
    EXPECT_EQ(path.machine + "/" + std::to_string(path.slot), "optimo-1/45");
    return path.width_px;
  };
  EXPECT_EQ(width(""), 0);
  EXPECT_EQ(width("width=240"), 240);
  EXPECT_EQ(width("width=0"), 0);
  EXPECT_EQ(width("width=100000"), 100'000);
  for (const char* wrong :
       {"width=-1", "width=x", "width=1.5", "width=100001", "width=99999999999"})
    EXPECT_EQ(width(wrong), -1) << wrong;
}

// What is wrong is said, the machine first.
TEST(ResourceRoutes, AProblemIsSaid) {
  const auto problem = [](const std::string& place, const std::string& query) {
    const ResourceRoute route = RouteResource(At("/v1/machines/" + place, query));
    EXPECT_TRUE(route.is_resource) << place;
    EXPECT_FALSE(route.path) << place;
    return std::string(route.problem);
  };
  EXPECT_EQ(problem("%2e%2e/programs/0/content", "form=%zz"), "the path names no machine");
  EXPECT_EQ(problem("optimo-1/programs/0/content", "form=%zz"),
            "the path names no slot from 1 to 199");
  EXPECT_EQ(problem("optimo-1/programs/45/content", "form=%zz"),
            "the query has a malformed percent escape");
  EXPECT_EQ(problem("optimo-1/programs/45/picture.svg", "width=%zz"),
            "the query has a malformed percent escape");
  EXPECT_EQ(problem("optimo-1/programs/45/picture.svg", "width=x"), "width is no number of pixels");
}

TEST(ResourceRoutes, Uploads) {
  const ResourceRoute route = RouteResource(At("/v1/uploads"));
  ASSERT_TRUE(route.path);
  EXPECT_TRUE(std::holds_alternative<UploadsPath>(*route.path));
  EXPECT_FALSE(RouteResource(At("/v1/uploads/1")).is_resource);
}

TEST(UploadRoutes, Query) {
  const ProgramContentPath path{.machine = "optimo-1", .slot = 45, .form = {}};
  const std::string hash = "0189AFaf" + std::string(56, 'A');
  const UploadRoute route = RouteUpload(At("/", "file_name=M%C3%BChle+1.S&sha256=" + hash +
                                                    "&etag=none&validate_only=true&title=x%26y"),
                                        path);
  ASSERT_FALSE(route.refusal);
  EXPECT_EQ(route.header.file_name, "M\xC3\xBChle 1.S");
  EXPECT_EQ(route.header.sha256, "0189afaf" + std::string(56, 'a'));
  EXPECT_EQ(route.header.etag, "none");
  EXPECT_EQ(route.header.title, "x&y");
  EXPECT_EQ(route.header.size, 12);
  EXPECT_TRUE(route.header.validate_only);
  EXPECT_FALSE(route.header.force);
  EXPECT_TRUE(RouteUpload(At("/", "force=true"), path).header.force);
  EXPECT_FALSE(RouteUpload(At("/", "force=false"), path).header.force);
  for (const std::string& query :
       {std::string("sha256=12"), "sha256=" + std::string(64, 'g'),
        std::string("validate_only=yes"), std::string("force=1"), std::string("title=%f")}) {
    const UploadRoute refused = RouteUpload(At("/", query), path);
    ASSERT_TRUE(refused.refusal) << query;
    EXPECT_EQ(refused.refusal->status.code, kCodeInvalidArgument) << query;
    EXPECT_EQ(refused.refusal->http_status, 0) << query;
  }
}

// What a form of a foreign page can send without a preflight is no upload.
TEST(UploadRoutes, FormsAreRefused) {
  for (const std::string type : {"text/plain; charset=utf-8", "application/x-www-form-urlencoded",
                                 "Multipart/Form-Data; boundary=x", ""}) {
    HttpRequest request = At("/");
    request.headers = {{"content-type", type}};
    const UploadRoute route = RouteUpload(request, {});
    ASSERT_TRUE(route.refusal) << type;
    EXPECT_EQ(route.refusal->http_status, 415);
  }
}

TEST(Etags, ListsWeakTagsAndStar) {
  EXPECT_TRUE(EtagMatches("\"a\"", "a"));
  EXPECT_TRUE(EtagMatches("\"x\", W/\"a\" ,\"y\"", "a"));
  EXPECT_TRUE(EtagMatches("\"x\",\"a\"", "a"));
  EXPECT_TRUE(EtagMatches("*", "a"));
  for (const std::string_view other : {"", "a", "\"ab\"", "\"a", "\"", "W/", "\"A\"", ",,"}) {
    EXPECT_FALSE(EtagMatches(other, "a")) << other;
  }
}

}  // namespace
}  // namespace rmlcell::web
