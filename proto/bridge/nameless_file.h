#pragma once

#include <cstdio>
#include <memory>

namespace rmlcell::bridge {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using OpenFile = std::unique_ptr<std::FILE, CloseFile>;

// A file of our own in the temporary folder (TMPDIR, else /tmp) that nobody else can change or
// shorten, and that is gone with its handle. Null: there is no room.
OpenFile NamelessFile();

}  // namespace rmlcell::bridge
