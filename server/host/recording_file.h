#pragma once

#include <string>

#include "server/host/machine_recorder.h"

namespace rmlcell::server {

// The recording of the newest run of a job, beside the journal of its host, so that there is one of
// a run that the death of the host cuts off. It is written before the entries of the journal that
// it has, and not waited for: a process that is killed loses nothing of it, a computer that loses
// its power may. One thread at a time.
class RecordingFile {
 public:
  explicit RecordingFile(std::string path) : path_(std::move(path)) {}
  ~RecordingFile();
  RecordingFile(const RecordingFile&) = delete;
  RecordingFile& operator=(const RecordingFile&) = delete;

  // Where that fails there is none: the machine goes on, and so does what its host has in memory.
  void Add(const MachineRecorder::Fresh& fresh);

  // Of the host that keeps this journal.
  static std::string PathBeside(const std::string& journal) { return journal + ".run"; }

 private:
  void Close();

  const std::string path_;
  int file_ = -1;
};

}  // namespace rmlcell::server
