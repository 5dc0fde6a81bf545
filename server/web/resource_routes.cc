#include "server/web/resource_routes.h"

#include <algorithm>
#include <tuple>

#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "proto/bridge/sha256.h"

namespace rmlcell::web {
namespace {

constexpr std::size_t kSegmentBytesMax = 200;  // longer than any name of ours
constexpr long long kWidthMax_px = 100'000;    // what a picture can be is not known here
constexpr int kSlotNumberMax = 199;            // executables live in slot + 100

std::vector<std::string_view> Split(std::string_view path) {
  std::vector<std::string_view> segments;
  while (!path.empty()) {
    path.remove_prefix(1);  // the '/'
    const std::size_t slash = path.find('/');
    segments.push_back(path.substr(0, slash));
    path = slash == std::string_view::npos ? std::string_view() : path.substr(slash);
  }
  return segments;
}

std::optional<std::string> Segment(std::string_view raw) {
  std::optional<std::string> text = PercentDecode(raw, false);
  if (!text || text->empty() || text->size() > kSegmentBytesMax || *text == "." || *text == "..") {
    return std::nullopt;
  }
  const bool good = std::ranges::all_of(*text, [](char c) {
    return static_cast<unsigned char>(c) >= 0x20 && c != 0x7F && c != '/' && c != '\\';
  });
  return good ? text : std::nullopt;
}

ResourceRoute RouteProgram(const HttpRequest& request, std::string_view machine_raw,
                           std::string_view slot_raw, bool picture) {
  ResourceRoute route{.is_resource = true, .path = {}, .problem = {}};
  const std::optional<std::string> machine = Segment(machine_raw);
  const bool digits = !slot_raw.empty() && slot_raw.size() <= 3 &&
                      std::ranges::all_of(slot_raw, [](char c) { return c >= '0' && c <= '9'; });
  const long long number = digits ? ParseInteger(slot_raw).value_or(0) : 0;
  const int slot = static_cast<int>(number);
  const QueryValue value = QueryParameter(request.query, picture ? "width" : "form");
  const std::string said = value.value.value_or("");
  if (!machine) {
    route.problem = "the path names no machine";
  } else if (number < kSlotMin || number > kSlotNumberMax) {
    route.problem = "the path names no slot from 1 to 199";
  } else if (!value.ok) {
    route.problem = "the query has a malformed percent escape";
  } else if (!picture) {
    route.path = ProgramContentPath{.machine = *machine, .slot = slot, .form = said};
  } else {
    const auto width = said.empty() ? 0 : ParseInteger(said).value_or(-1);
    if (width < 0 || width > kWidthMax_px) {
      route.problem = "width is no number of pixels";
      return route;
    }
    route.path =
        ProgramPicturePath{.machine = *machine, .slot = slot, .width_px = static_cast<int>(width)};
  }
  return route;
}

// What HTML forms can send without asking first.
bool IsFormType(const std::string& type) {
  return type == "application/x-www-form-urlencoded" || type == "multipart/form-data" ||
         type == "text/plain";
}

}  // namespace

ResourceRoute RouteResource(const HttpRequest& request) {
  if (!request.path.starts_with("/v1/")) return {};
  const std::vector<std::string_view> segments = Split(request.path);
  if (segments.size() == 5 && segments[1] == "jobs" && segments[3] == "artifacts") {
    const std::optional<std::string> job = Segment(segments[2]);
    const std::optional<std::string> artifact = Segment(segments[4]);
    if (!job || !artifact) {
      return {.is_resource = true, .path = {}, .problem = "the path names no artifact of a job"};
    }
    return {.is_resource = true,
            .path = ArtifactPath{.job = *job, .artifact = *artifact},
            .problem = {}};
  }
  if (segments.size() == 6 && segments[1] == "machines" && segments[3] == "programs" &&
      (segments[5] == "content" || segments[5] == "picture.svg")) {
    return RouteProgram(request, segments[2], segments[4], segments[5] == "picture.svg");
  }
  if (segments.size() == 2 && segments[1] == "uploads")
    return {.is_resource = true, .path = UploadsPath(), .problem = {}};
  return {};
}

UploadRoute RouteUpload(const HttpRequest& request,
                        const std::variant<ProgramContentPath, UploadsPath>& path) {
  UploadRoute route;
  UploadHeader& header = route.header;
  const auto refuse = [&](int http_status, std::string detail) {
    route.refusal =
        RpcRefusal{.status = FromError({ErrorCode::kCellInvalidArgument, std::move(detail), {}}),
                   .http_status = http_status,
                   .headers = {}};
    return route;
  };
  const std::string type = MediaType(request.Header("content-type"));
  if (type.empty() || IsFormType(type)) {
    return refuse(415, "an upload needs a Content-Type such as application/octet-stream");
  }
  const std::string_view encoding = request.Header("content-encoding");
  if (!encoding.empty() && encoding != "identity")
    return refuse(415, "compressed bodies are not offered");

  header.path = path;
  std::string validate_only, force;
  const std::pair<std::string_view, std::string*> parameters[] = {
      {"file_name", &header.file_name},  {"title", &header.title},
      {"sha256", &header.sha256},        {"etag", &header.etag},
      {"validate_only", &validate_only}, {"force", &force}};
  for (const auto& [name, target] : parameters) {
    QueryValue value = QueryParameter(request.query, name);
    if (!value.ok) return refuse(0, "the query has a malformed percent escape");
    *target = std::move(value.value).value_or("");
  }
  const std::tuple<std::string_view, const std::string&, bool&> choices[] = {
      {"validate_only", validate_only, header.validate_only}, {"force", force, header.force}};
  for (const auto& [name, value, target] : choices) {
    if (!value.empty() && value != "true" && value != "false") {
      return refuse(0, std::string(name) + " is neither true nor false");
    }
    target = value == "true";
  }
  if (!header.sha256.empty()) {
    std::optional<std::string> digest = bridge::ReadSha256(header.sha256);
    if (!digest) return refuse(0, "sha256 is not 64 hexadecimal digits");
    header.sha256 = *std::move(digest);
  }
  const std::string_view length = request.Header("content-length");
  if (!length.empty()) header.size = ParseInteger(length).value_or(-1);
  return route;
}

}  // namespace rmlcell::web
