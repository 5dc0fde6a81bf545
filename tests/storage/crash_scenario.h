#pragma once

#include <cstdint>
#include <string>

#include "storage/store.h"

// What the child process of the crash tests writes, so that its parent can tell what has to be
// there.
namespace rmlcell::storage::crash {

inline std::string RequestId(const std::string& run, int client, int number) {
  return run + "." + std::to_string(client) + "." + std::to_string(number);
}

inline NewJob JobOf(const std::string& request_id) {
  NewJob job;
  job.request_id = request_id;
  job.request_hash = "hash of " + request_id;
  job.kind = "SIMULATE";
  job.specification = "specification of " + request_id;
  job.attachments.push_back({});
  job.attachments.back().name = "program";
  job.attachments.back().bytes = "program of " + request_id;
  job.events.push_back({});
  job.events.back().kind = "queued";
  return job;
}

// A text that depends on its name, of any size: "name name name ...".
inline std::string Repeated(const std::string& name, std::size_t size) {
  std::string text;
  while (text.size() < size) text += name + " ";
  text.resize(size);
  return text;
}

// Every third report needs more than one chunk.
inline std::string ReportOf(std::int64_t job) {
  return Repeated("report of " + std::to_string(job), job % 3 == 0 ? 1'300'000 : 900);
}

inline std::string ObjectOf(int slot, Revision revision) {
  std::string name = "slot " + std::to_string(slot);
  name += " revision " + std::to_string(revision);
  return Repeated(name, slot == 3 ? 1'100'000 : 3'000);
}

}  // namespace rmlcell::storage::crash
