// The page: which names there are, and what a browser is told with each.
#include "server/web/static_page.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

namespace rmlcell::web {
namespace {

HttpRequest Asking(std::string path, HeaderList headers = {}) {
  HttpRequest request;
  request.method = "GET";
  request.path = std::move(path);
  request.headers = std::move(headers);
  return request;
}

std::map<std::string, std::string> HeadersOf(const HttpResponse& response) {
  return {response.headers.begin(), response.headers.end()};
}

// A browser is told to take nothing from elsewhere, to guess no types, and to let nobody else show
// the page.
TEST(StaticPages, TellTheBrowserWhatItMayDo) {
  const StaticPage page;
  for (const std::string path : {"/", "/index.html", "/page.js", "/page.css", "/favicon.svg"}) {
    const auto response = page.Find(Asking(path));
    ASSERT_TRUE(response) << path;
    EXPECT_EQ(response->status, 200);
    std::map<std::string, std::string> headers = HeadersOf(*response);
    EXPECT_EQ(headers.size(), response->headers.size()) << path;
    for (const std::string own : {"default-src 'none'", "script-src 'self'", "style-src 'self'",
                                  "img-src 'self'", "connect-src 'self'", "base-uri 'none'",
                                  "form-action 'none'", "frame-ancestors 'none'"}) {
      EXPECT_NE(headers["Content-Security-Policy"].find(own), std::string::npos) << own;
    }
    EXPECT_TRUE(headers["ETag"].starts_with('"') && headers["ETag"].ends_with('"'))
        << headers["ETag"];
    EXPECT_GT(headers["ETag"].size(), 2U);
    headers.erase("Content-Type");
    headers.erase("Content-Security-Policy");
    headers.erase("ETag");
    EXPECT_EQ(headers,
              (std::map<std::string, std::string>{{"Cache-Control", "no-cache"},
                                                  {"X-Content-Type-Options", "nosniff"},
                                                  {"Referrer-Policy", "no-referrer"},
                                                  {"Cross-Origin-Resource-Policy", "same-origin"},
                                                  {"Cross-Origin-Opener-Policy", "same-origin"},
                                                  {"X-Frame-Options", "DENY"}}))
        << path;
  }
}

TEST(StaticPages, AreNotSentTwice) {
  const StaticPage page;
  const std::string etag = HeadersOf(*page.Find(Asking("/page.js")))["ETag"];
  EXPECT_NE(etag, HeadersOf(*page.Find(Asking("/page.css")))["ETag"]);
  const auto known = page.Find(Asking("/page.js", {{"if-none-match", etag}}));
  ASSERT_TRUE(known);
  EXPECT_EQ(known->status, 304);
  EXPECT_EQ(known->body, "");
  EXPECT_EQ(HeadersOf(*known)["ETag"], etag);
  EXPECT_EQ(page.Find(Asking("/page.css", {{"if-none-match", etag}}))->status, 200);
}

// A page that is open is told by it to load anew; that of no file at all is FNV-1a of nothing.
TEST(StaticPages, HaveATagTogether) {
  EXPECT_EQ(PageEtag(), PageEtag());
  EXPECT_EQ(PageEtag().find_first_not_of("0123456789abcdef"), std::string::npos) << PageEtag();
  EXPECT_NE(PageEtag(), "cbf29ce484222325");
}

TEST(StaticPages, OtherNamesAreNone) {
  const StaticPage page;
  for (const std::string path :
       {"/page", "/Page.js", "/page.js/", "//page.js", "/README.md", "/index.html.bak"}) {
    EXPECT_FALSE(page.Find(Asking(path))) << path;
  }
}

// The bytes of a folder, of the names that are built in; FNV-1a of its authors' vectors: "", "a",
// "foobar".
TEST(StaticPages, OfAFolderAreReadAtEachRequest) {
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / "rmlcell_static_pages";
  std::filesystem::create_directories(folder);
  const auto write = [&](const std::string& name, const std::string& bytes) {
    std::ofstream(folder / name, std::ios::binary) << bytes;
  };
  const StaticPage page(folder.string());
  write("other.js", "x");
  const std::map<std::string, std::string> rows = {{"", "\"cbf29ce484222325\""},
                                                   {"a", "\"af63dc4c8601ec8c\""},
                                                   {"foobar", "\"85944171f73967e8\""}};
  for (const auto& [bytes, etag] : rows) {
    write("page.js", bytes);
    const auto response = page.Find(Asking("/page.js"));
    ASSERT_TRUE(response);
    EXPECT_EQ(response->body, bytes);
    EXPECT_EQ(HeadersOf(*response)["ETag"], etag);
    EXPECT_EQ(HeadersOf(*response)["Content-Type"], "text/javascript; charset=utf-8");
  }
  EXPECT_FALSE(page.Find(Asking("/other.js")));
  EXPECT_FALSE(page.Find(Asking("/page.css")));  // built in, and not in the folder
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace rmlcell::web
