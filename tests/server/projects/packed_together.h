// An archive as any tool packs it.
#pragma once

#include <archive.h>
#include <archive_entry.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace rmlcell::server {

inline std::string PackedTogether(const std::vector<std::pair<std::string, std::string>>& files) {
  std::string bytes(1 << 20, '\0');
  std::size_t used = 0;
  const std::unique_ptr<archive, int (*)(archive*)> made(archive_write_new(), archive_write_free);
  archive_write_set_format_zip(made.get());
  archive_write_open_memory(made.get(), bytes.data(), bytes.size(), &used);
  for (const auto& [name, content] : files) {
    archive_entry* entry = archive_entry_new();
    archive_entry_set_pathname(entry, name.c_str());
    archive_entry_set_size(entry, static_cast<la_int64_t>(content.size()));
    archive_entry_set_filetype(entry, AE_IFREG);
    archive_write_header(made.get(), entry);
    archive_write_data(made.get(), content.data(), content.size());
    archive_entry_free(entry);
  }
  archive_write_close(made.get());
  bytes.resize(used);
  return bytes;
}

}  // namespace rmlcell::server
