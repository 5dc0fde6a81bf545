#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "clients/cli/milling.h"

namespace rmlcell::cli {

// Verbs that speak to a server.
struct Remote {
  std::string server = "127.0.0.1:50051";  // host:port or unix:/path
  bool json = false;
  // With an answer that nobody is kept for: how a machine stands, what is given back.
  std::chrono::seconds short_patience{5};
};

int Machines(const Remote& remote);
int Programs(const Remote& remote, const std::string& machine);
struct PutOptions {
  std::string etag;
  bool check_only = false;
  bool force = false;  // what looks like no program of the machine at all, too
};
int PutProgram(const Remote& remote, const std::string& machine, int slot, const std::string& file,
               const PutOptions& options);
int GetProgram(const Remote& remote, const std::string& machine, int slot, const std::string& form,
               const std::string& output);
int DeleteProgram(const Remote& remote, const std::string& machine, int slot);
int StaleExecutables(const Remote& remote, const std::string& machine);

int Projects(const Remote& remote);
int GetProject(const Remote& remote, const std::string& project);
int CreateProject(const Remote& remote, const std::string& project, const std::string& path);
int UpdateProject(const Remote& remote, const std::string& project, const std::string& path);
int DeleteProject(const Remote& remote, const std::string& project);
int TransferProject(const Remote& remote, const std::string& project, const std::string& machine,
                    bool insert, bool check_only);
// Of what a machine holds; of these slots, or all of them.
int TakeProject(const Remote& remote, const std::string& project, const std::string& machine,
                const std::vector<int>& slots, bool inch);
// `output` is empty: PROJECT.zip.
int ExportProject(const Remote& remote, const std::string& project, const std::string& output);
int ImportProject(const Remote& remote, const std::string& project, const std::string& file);

struct SubmitRequest {
  std::string machine;
  std::string file;  // a file, or empty
  int slot = 0;      // of a stored program, or where the file goes
  std::string kind = "simulate";
  bool unzeroed = false;          // of a run: the program zeroes the axes itself
  std::string ticket;             // of a run: the simulation that proves it, "17"; empty: none
  std::string step;               // of a run: where it begins, "45/10"; empty: at its beginning
  std::vector<std::string> seen;  // likewise: what somebody has looked at
  std::int64_t occurrence = 0;    // likewise: the how manieth time; 0: the first
  bool off_until_work_on = false;
  std::string title;
  std::vector<std::string> labels;
  std::string request_id;
  std::string inputs_file;
  double override_percent = 0.0;
  double pace = 0.0;  // virtual seconds a real second; 0: as fast as possible
  JobMillingOptions milling;
  std::string milling_project;  // whose block and tool count; empty: none
  bool trace = false;
  int priority = 0;
  bool hold = false;               // it waits until it is resumed
  std::string not_before;          // a time as JSON has it; empty: at once
  std::vector<std::string> after;  // jobs that must have succeeded
  bool watch = false;
  bool strict = false;  // with watch: a DOUBTFUL verdict is an exit code of 1, too
};
int SubmitJob(const Remote& remote, const SubmitRequest& request);
int WatchJob(const Remote& remote, const std::string& job, std::int64_t after, bool strict);
int Jobs(const Remote& remote, const std::string& filter, const std::string& order, int limit);
int ShowJob(const Remote& remote, const std::string& job);
int CancelJob(const Remote& remote, const std::string& job);
// Of a job that waits: it does not start until it is resumed. Of one that runs: its run is held.
int HoldJob(const Remote& remote, const std::string& job);
int ResumeJob(const Remote& remote, const std::string& job);
// In front of another job that waits, or behind all of its priority.
int MoveJob(const Remote& remote, const std::string& job, const std::string& before,
            std::optional<int> priority);
int JobReport(const Remote& remote, const std::string& job, bool machine_coordinates);
int JobPicture(const Remote& remote, const std::string& job, const std::string& output);
int JobArtifact(const Remote& remote, const std::string& job, const std::string& artifact,
                const std::string& output);

}  // namespace rmlcell::cli
