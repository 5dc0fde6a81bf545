#include "clients/lsp/program_folder.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <tuple>
#include <utility>

#include "engine/core/hex.h"
#include "engine/core/letters.h"
#include "engine/core/number_text.h"
#include "engine/core/units.h"

namespace rmlcell::lsp {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kScheme = "file://";

struct Found {
  int number = 0;
  std::size_t rank = 0;  // of its extension
  std::string path;
};

bool ComesBefore(const Found& a, const Found& b) {
  return std::tie(a.number, a.rank, a.path) < std::tie(b.number, b.rank, b.path);
}

std::optional<std::string> Unescaped(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] != '%') {
      out += text[at];
      continue;
    }
    if (at + 2 >= text.size()) return std::nullopt;
    const std::optional<unsigned> high = HexValue(text[at + 1]);
    const std::optional<unsigned> low = HexValue(text[at + 2]);
    if (!high || !low || (*high == 0 && *low == 0)) return std::nullopt;
    out += static_cast<char>(*high * 16 + *low);
    at += 2;
  }
  return out;
}

std::size_t ExtensionRank(std::string_view name, SourceExtensions extensions) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos) return extensions.size();
  const auto found = std::ranges::find_if(
      extensions, [&](std::string_view one) { return EqualIgnoringCase(one, name.substr(dot)); });
  return static_cast<std::size_t>(found - extensions.begin());
}

}  // namespace

std::optional<std::string> PathOfUri(std::string_view uri) {
  if (!uri.starts_with(kScheme)) return std::nullopt;
  uri.remove_prefix(kScheme.size());
  const std::size_t slash = uri.find('/');  // behind the name of a host, which is not looked at
  if (slash == std::string_view::npos) return std::nullopt;
  uri.remove_prefix(slash);
  return Unescaped(uri.substr(0, uri.find_first_of("?#")));
}

std::string UriOfPath(std::string_view path) {
  constexpr std::string_view kPlain = "-._~/";
  std::string uri(kScheme);
  for (const char c : path) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (letter || kPlain.find(c) != std::string_view::npos) {
      uri += c;
    } else {
      uri += '%' + HexByte(c);
    }
  }
  return uri;
}

std::string FileNameOfUri(std::string_view uri) {
  const std::string whole = Unescaped(uri).value_or(std::string(uri));
  const std::size_t slash = whole.find_last_of("/\\:");
  return slash == std::string::npos ? whole : whole.substr(slash + 1);
}

std::optional<int> ProgramNumberOf(std::string_view uri, SourceExtensions extensions) {
  const std::string name = FileNameOfUri(uri);
  if (ExtensionRank(name, extensions) == extensions.size()) return std::nullopt;
  const auto number = ParseInteger(name.substr(0, name.rfind('.')));
  if (!number || *number < kSlotMin || *number > kSlotMax) return std::nullopt;
  return static_cast<int>(*number);
}

std::vector<machine::NumberedFile> DiskFolder::Programs(std::string_view uri,
                                                        SourceExtensions extensions) const {
  const std::optional<std::string> path = PathOfUri(uri);
  if (!path) return {};
  std::vector<Found> found;
  std::error_code error;
  std::size_t looked_at = 0;
  for (fs::directory_iterator entry(fs::path(*path).parent_path(), error), end;
       !error && entry != end && looked_at < kFolderEntriesMax;
       entry.increment(error), ++looked_at) {
    const std::string file = entry->path().string();
    const std::optional<int> number = ProgramNumberOf(file, extensions);
    std::error_code ignored;
    if (number && entry->is_regular_file(ignored))
      found.push_back({*number, ExtensionRank(file, extensions), file});
  }
  std::ranges::sort(found, ComesBefore);
  std::vector<machine::NumberedFile> programs;
  for (const Found& one : found) {
    std::string uri_of_one = UriOfPath(one.path);
    std::string name = FileNameOfUri(uri_of_one);
    programs.push_back({one.number, std::move(uri_of_one), std::move(name)});
  }
  return programs;
}

Result<std::string> DiskFolder::Read(std::string_view uri) const {
  const std::optional<std::string> path = PathOfUri(uri);
  if (!path) return Error{ErrorCode::kCellFileUnreadable, std::string(uri) + " is no file", {}};
  std::error_code error;
  // A pipe would keep the editor waiting.
  const bool regular = fs::is_regular_file(*path, error);
  const std::uintmax_t size = regular ? fs::file_size(*path, error) : 0;
  std::ifstream file;
  if (regular && !error) file.open(*path, std::ios::binary);
  if (!file.is_open()) return Error{ErrorCode::kCellFileUnreadable, *path, {}};
  if (size > kProgramBytesMax) return Error{ErrorCode::kCellTooLarge, *path, {}};
  std::string text(static_cast<std::size_t>(size), '\0');
  file.read(text.data(), static_cast<std::streamsize>(size));
  if (file.bad()) return Error{ErrorCode::kCellFileUnreadable, *path, {}};
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

}  // namespace rmlcell::lsp
