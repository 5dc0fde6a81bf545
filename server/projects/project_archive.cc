#include "server/projects/project_archive.h"

#include <archive.h>
#include <archive_entry.h>
#include <google/protobuf/util/json_util.h>
#include <locale.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "server/base/names.h"

namespace rmlcell::server {
namespace {

constexpr std::string_view kProjectFile = "project.json";
constexpr int kFilesMax = 1000;  // a project has at most 99 programs with a target each

struct EndWriting {
  void operator()(archive* written) const { archive_write_free(written); }
};
struct EndReading {
  void operator()(archive* read) const { archive_read_free(read); }
};
struct EndEntry {
  void operator()(archive_entry* entry) const { archive_entry_free(entry); }
};

// Names are in UTF-8, and libarchive reads and writes those that are marked so in the locale of its
// thread alone: in that of C it knows no letter beyond ASCII.
class NamesInUtf8 {
 public:
  NamesInUtf8()
      : own_(::newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr)), before_(::uselocale(own_)) {}
  ~NamesInUtf8() {
    ::uselocale(before_);
    if (own_ != nullptr) ::freelocale(own_);
  }
  NamesInUtf8(const NamesInUtf8&) = delete;
  NamesInUtf8& operator=(const NamesInUtf8&) = delete;

 private:
  locale_t own_;
  locale_t before_;
};

Error TooLarge() {
  return {ErrorCode::kCellTooLarge,
          "a project has more than " + std::to_string(kProjectBytesMax) + " bytes",
          {}};
}

// Whether a file of a folder can be called so.
bool IsFileName(std::string_view name) {
  return !name.empty() && name.size() <= 255 && name != "." && name != ".." &&
         std::ranges::all_of(name, [](char c) {
           return static_cast<unsigned char>(c) >= ' ' && c != '/' && c != '\\' && c != ':';
         });
}

// Each text of the project that has a file name and bytes, with the folder for its file.
void ForEachText(
    v1::Project& project,
    const std::function<void(std::string folder, std::string& name, std::string& bytes)>& visit) {
  const auto text = [&visit](const std::string& folder, auto& one) {
    visit(folder, *one.mutable_file_name(), *one.mutable_content());
  };
  for (v1::ProjectProgram& program : *project.mutable_programs()) {
    const std::string slot = std::to_string(program.slot());
    text("programs/" + slot, *program.mutable_source());
    if (!program.milling().has_target()) continue;
    v1::MillTarget& target = *program.mutable_milling()->mutable_target();
    if (target.has_file()) text("targets/" + slot, *target.mutable_file());
    if (target.has_inline_program()) text("targets/" + slot, *target.mutable_inline_program());
  }
}

class ArchiveWriter {
 public:
  ArchiveWriter() : archive_(archive_write_new()) {
    archive_write_set_format_zip(archive_.get());
    // Whole at any moment: nothing is gathered into blocks.
    archive_write_set_bytes_per_block(archive_.get(), 0);
    Note(archive_write_open2(archive_.get(), &bytes_, nullptr, &ArchiveWriter::Take, nullptr,
                             nullptr));
  }

  void Add(const std::string& name, std::string_view bytes) {
    const std::unique_ptr<archive_entry, EndEntry> entry(archive_entry_new());
    archive_entry_set_pathname_utf8(entry.get(), name.c_str());
    archive_entry_set_size(entry.get(), static_cast<la_int64_t>(bytes.size()));
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), 0644);
    archive_entry_set_mtime(entry.get(), kWritten, 0);
    Note(archive_write_header(archive_.get(), entry.get()));
    if (archive_write_data(archive_.get(), bytes.data(), bytes.size()) < 0) Note(ARCHIVE_FATAL);
  }

  Result<std::string> End() {
    Note(archive_write_close(archive_.get()));
    if (!fault_.empty()) return Error{ErrorCode::kCellInternal, "the archive: " + fault_, {}};
    return std::move(bytes_);
  }

 private:
  static constexpr time_t kWritten = 946'684'800;  // 2000-01-01: the same project, the same bytes

  static la_ssize_t Take(archive*, void* bytes, const void* data, std::size_t size) {
    static_cast<std::string*>(bytes)->append(static_cast<const char*>(data), size);
    return static_cast<la_ssize_t>(size);
  }

  void Note(int result) {
    if (result >= ARCHIVE_WARN || !fault_.empty()) return;
    const char* said = archive_error_string(archive_.get());
    fault_ = said == nullptr ? "it cannot be written" : said;
  }

  std::string bytes_;
  std::string fault_;
  std::unique_ptr<archive, EndWriting> archive_;  // writes into bytes_ until it is gone
};

Error Damaged(archive* read) {
  const char* said = archive_error_string(read);
  return InvalidArgument("the archive cannot be read: " +
                         std::string(said == nullptr ? "it is damaged" : said));
}

Result<std::string> ReadEntry(archive* read, std::size_t room) {
  std::string bytes;
  char part[16 << 10];
  for (;;) {
    const la_ssize_t size = archive_read_data(read, part, sizeof part);
    if (size < 0) return Damaged(read);
    if (size == 0) return bytes;
    if (static_cast<std::size_t>(size) > room - bytes.size()) return TooLarge();
    bytes.append(part, static_cast<std::size_t>(size));
  }
}

// By name.
Result<std::map<std::string, std::string>> ReadFiles(std::string_view bytes) {
  const NamesInUtf8 locale;
  const std::unique_ptr<archive, EndReading> read(archive_read_new());
  archive_read_support_format_zip(read.get());
  if (archive_read_open_memory(read.get(), bytes.data(), bytes.size()) != ARCHIVE_OK)
    return Damaged(read.get());
  std::map<std::string, std::string> files;
  std::size_t room = kProjectBytesMax;
  archive_entry* entry = nullptr;
  for (int met = 0;; ++met) {
    const int result = archive_read_next_header(read.get(), &entry);
    if (result == ARCHIVE_EOF) return files;
    if (result < ARCHIVE_WARN) return Damaged(read.get());
    if (met >= kFilesMax) return InvalidArgument("the archive has more than 1,000 files");
    const char* name = archive_entry_pathname(entry);
    if (name == nullptr || archive_entry_filetype(entry) != AE_IFREG) continue;
    Result<std::string> content = ReadEntry(read.get(), room);
    if (!content) return content.error();
    room -= content->size();
    files[name] = *std::move(content);
  }
}

// The project.json that lies least deep: a folder may have been packed with its own name.
const std::string* FindProjectFile(const std::map<std::string, std::string>& files) {
  const std::string* found = nullptr;
  for (const auto& [name, bytes] : files) {
    const std::size_t slash = name.rfind('/');
    const std::string_view base = std::string_view(name).substr(slash + 1);  // npos + 1 is 0
    if (base == kProjectFile && (found == nullptr || name.size() < found->size())) found = &name;
  }
  return found;
}

}  // namespace

Result<std::string> WriteProjectArchive(const v1::Project& project) {
  if (project.ByteSizeLong() > kProjectBytesMax) return TooLarge();
  const NamesInUtf8 locale;
  v1::Project kept = project;
  kept.clear_name();
  kept.clear_etag();
  kept.clear_create_time();
  kept.clear_update_time();
  std::vector<std::pair<std::string, std::string>> files;
  ForEachText(kept, [&](const std::string& folder, std::string& name, std::string& bytes) {
    if (!IsFileName(name) || bytes.empty()) return;  // such bytes stay in project.json
    name = folder + "/" + name;
    files.emplace_back(name, std::move(bytes));
    bytes.clear();
  });
  std::string json;
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  const auto printed = google::protobuf::util::MessageToJsonString(kept, &json, options);
  if (!printed.ok()) return Error{ErrorCode::kCellInternal, std::string(printed.message()), {}};
  ArchiveWriter writer;
  writer.Add(std::string(kProjectFile), json);
  for (const auto& [name, bytes] : files) writer.Add(name, bytes);
  return writer.End();
}

Result<v1::Project> ReadProjectArchive(std::string_view bytes) {
  if (bytes.size() > kProjectBytesMax) return TooLarge();
  const auto files = ReadFiles(bytes);
  if (!files) return files.error();
  const std::string* file = FindProjectFile(*files);
  if (file == nullptr) return InvalidArgument("the archive has no project.json");
  const std::string folder = file->substr(0, file->size() - kProjectFile.size());
  v1::Project project;
  const auto parsed = google::protobuf::util::JsonStringToMessage(files->at(*file), &project);
  if (!parsed.ok())
    return InvalidArgument("project.json of the archive: " + std::string(parsed.message()));
  Status whole;
  std::size_t room = kProjectBytesMax;  // one file may be named many times
  ForEachText(project, [&](const std::string&, std::string& name, std::string& content) {
    if (!whole || !content.empty() || name.empty()) return;
    const auto found = files->find(folder + name);
    if (found == files->end()) {
      whole = InvalidArgument("the archive has no file " + name + ", which its project.json names");
      return;
    }
    if (found->second.size() > room) {
      whole = TooLarge();
      return;
    }
    room -= found->second.size();
    content = found->second;
    name = name.substr(name.rfind('/') + 1);
  });
  if (!whole) return whole.error();
  project.clear_name();
  project.clear_etag();
  project.clear_create_time();
  project.clear_update_time();
  return project;
}

}  // namespace rmlcell::server
