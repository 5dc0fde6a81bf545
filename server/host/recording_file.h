#pragma once

#include <string>

#include "server/host/machine_recorder.h"

namespace rmlcell::server {

// The recording of the newest run of a job, beside the journal of its host, so that there is one of
// a run that the death of the host cuts off. It is written before the entries of the journal that
// it has, and not brought to the disk: a process that is killed loses nothing of it, a computer
// that loses its power may. One thread at a time.
class RecordingFile {
 public:
  // What is there already is gone on with, until another recording begins.
  explicit RecordingFile(std::string path) : path_(std::move(path)) {}
  ~RecordingFile();
  RecordingFile(const RecordingFile&) = delete;
  RecordingFile& operator=(const RecordingFile&) = delete;

  // Where that fails it is dropped: the machine goes on, and so does what its host has in memory.
  void Add(const MachineRecorder::Fresh& fresh);
  // Half of a recording is none, and its room may be needed. Nothing is added until one begins.
  void Drop();

  // Of the host that keeps this journal.
  static std::string PathBeside(const std::string& journal) { return journal + ".run"; }

 private:
  void Open(int how);
  void Close();

  const std::string path_;
  int file_ = -1;
  bool dropped_ = false;
};

}  // namespace rmlcell::server
