#include "server/jobs/job_filter.h"

#include <algorithm>
#include <cctype>
#include <vector>

#include "server/names.h"

namespace rmlcell::server {
namespace {

Error Bad(const std::string& detail) { return {ErrorCode::kCellBadFilter, detail, {}}; }

// Words and "=" signs; a text in double quotes is one word.
Result<std::vector<std::string>> Words(std::string_view filter) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < filter.size();) {
    const char c = filter[i];
    if (std::isspace(static_cast<unsigned char>(c)) != 0) {
      ++i;
    } else if (c == '=') {
      words.emplace_back("=");
      ++i;
    } else if (c == '"') {
      const std::size_t end = filter.find('"', i + 1);
      if (end == std::string_view::npos) return Bad("a quoted text has no end");
      words.emplace_back(filter.substr(i + 1, end - i - 1));
      i = end + 1;
    } else {
      std::size_t end = i;
      while (end < filter.size() && filter[end] != '=' && filter[end] != '"' &&
             std::isspace(static_cast<unsigned char>(filter[end])) == 0) {
        ++end;
      }
      words.emplace_back(filter.substr(i, end - i));
      i = end;
    }
  }
  return words;
}

std::string Upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

Status Apply(const std::string& field, const std::string& value, storage::JobQuery& query) {
  using storage::JobState;
  if (field == "state") {
    std::string state = Upper(value);
    if (state.starts_with("STATE_")) state.erase(0, 6);
    if (state == "QUEUED") {
      query.state = JobState::kQueued;
    } else if (state == "RUNNING") {
      query.state = JobState::kRunning;
    } else if (state == "SUCCEEDED") {
      query.state = JobState::kSucceeded;
    } else if (state == "FAILED") {
      query.state = JobState::kFailed;
    } else if (state == "CANCELLED") {
      query.state = JobState::kCancelled;
    } else if (state == "INTERRUPTED") {
      query.state = JobState::kInterrupted;
    } else {
      return Bad("no state '" + value + "'; there are QUEUED, RUNNING, SUCCEEDED, FAILED, CANCELLED, INTERRUPTED");
    }
  } else if (field == "machine") {
    const Result<std::string> id = ParseMachineName(value.find('/') == std::string::npos ? MachineName(value) : value);
    if (!id) return Bad("machine: " + id.error().detail);
    query.machine = *id;
  } else if (field == "kind") {
    std::string kind = Upper(value);
    if (kind.starts_with("JOB_KIND_")) kind.erase(0, 9);
    if (kind != "CHECK" && kind != "SIMULATE" && kind != "RUN") {
      return Bad("no kind '" + value + "'; there are CHECK, SIMULATE, RUN");
    }
    query.kind = kind;
  } else if (field == "caller") {
    query.caller = value;
  } else if (field == "finished") {
    if (value != "true" && value != "false") return Bad("finished is true or false, not '" + value + "'");
    query.finished = value == "true";
  } else {
    return Bad("no field '" + field + "'; there are state, machine, kind, caller, finished");
  }
  return {};
}

}  // namespace

Status ApplyFilter(std::string_view filter, storage::JobQuery& query) {
  const Result<std::vector<std::string>> words = Words(filter);
  if (!words) return words.error();
  for (std::size_t i = 0; i < words->size(); i += 4) {
    if (i + 2 >= words->size() || (*words)[i + 1] != "=") {
      return Bad("expected is FIELD = VALUE after '" + (i > 0 ? (*words)[i - 1] : std::string()) + "'");
    }
    const Status applied = Apply((*words)[i], (*words)[i + 2], query);
    if (!applied) return applied;
    if (i + 3 < words->size() && (Upper((*words)[i + 3]) != "AND" || i + 4 >= words->size())) {
      return Bad("comparisons are joined by AND, found '" + (*words)[i + 3] + "'");
    }
  }
  return {};
}

}  // namespace rmlcell::server
