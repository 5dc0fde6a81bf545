#include "server/jobs/job_filter.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <vector>

#include "engine/core/letters.h"
#include "server/base/names.h"
#include "server/base/readable.h"

namespace rmlcell::server {
namespace {

// Five fields once, with "=", a value and AND.
constexpr std::size_t kWordsMax = 19;

Error Bad(const std::string& detail) { return {ErrorCode::kCellBadFilter, detail, {}}; }

struct Word {
  std::string text;
  bool quoted = false;

  bool Is(std::string_view sign) const { return !quoted && text == sign; }
};

// Words and "=" signs; a text in double quotes is one word and no sign.
Result<std::vector<Word>> Words(std::string_view filter) {
  std::vector<Word> words;
  for (std::size_t i = 0; i < filter.size();) {
    const char c = filter[i];
    if (std::isspace(static_cast<unsigned char>(c)) != 0) {
      ++i;
    } else if (c == '=') {
      words.push_back({.text = "="});
      ++i;
    } else if (c == '"') {
      const std::size_t end = filter.find('"', i + 1);
      if (end == std::string_view::npos) return Bad("a quoted text has no end");
      words.push_back({.text = std::string(filter.substr(i + 1, end - i - 1)), .quoted = true});
      i = end + 1;
    } else {
      std::size_t end = i;
      while (end < filter.size() && filter[end] != '=' && filter[end] != '"' &&
             std::isspace(static_cast<unsigned char>(filter[end])) == 0) {
        ++end;
      }
      words.push_back({.text = std::string(filter.substr(i, end - i))});
      i = end;
    }
    if (words.size() > kWordsMax) return Bad("the filter has too many words");
  }
  return words;
}

Status Apply(const std::string& field, const std::string& value, storage::JobQuery& query) {
  using storage::JobState;
  if (field == "state") {
    std::string state = UpperCase(value);
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
      return Bad("no state '" + Readable(value) +
                 "'; there are QUEUED, RUNNING, SUCCEEDED, FAILED, CANCELLED, INTERRUPTED");
    }
  } else if (field == "machine") {
    const Result<std::string> id =
        ParseMachineName(value.find('/') == std::string::npos ? MachineName(value) : value);
    if (!id) return Bad("machine: " + id.error().detail);
    query.machine = *id;
  } else if (field == "kind") {
    std::string kind = UpperCase(value);
    if (kind.starts_with("JOB_KIND_")) kind.erase(0, 9);
    if (kind != "CHECK" && kind != "SIMULATE" && kind != "RUN") {
      return Bad("no kind '" + Readable(value) + "'; there are CHECK, SIMULATE, RUN");
    }
    query.kind = kind;
  } else if (field == "caller") {
    if (value.empty()) return Bad("caller is empty");
    query.caller = value;
  } else if (field == "finished") {
    if (value != "true" && value != "false")
      return Bad("finished is true or false, not '" + Readable(value) + "'");
    query.finished = value == "true";
  } else {
    return Bad("no field '" + Readable(field) +
               "'; there are state, machine, kind, caller, finished");
  }
  return {};
}

}  // namespace

Status ReadFilter(std::string_view filter, const ApplyComparison& apply) {
  const Result<std::vector<Word>> words = Words(filter);
  if (!words) return words.error();
  std::set<std::string_view> fields;
  for (std::size_t i = 0; i < words->size(); i += 4) {
    const Word* const word = &(*words)[i];
    const std::size_t left = words->size() - i;
    if (left < 3 || word[0].quoted || word[0].Is("=") || !word[1].Is("=") || word[2].Is("=")) {
      return Bad("expected is FIELD = VALUE, found '" + Readable(word[0].text) + "'");
    }
    if (!fields.insert(word[0].text).second) {
      return Bad("'" + Readable(word[0].text) + "' stands twice");
    }
    if (const Status applied = apply(word[0].text, word[2].text); !applied) return applied.error();
    if (left == 3) break;
    if (word[3].quoted || UpperCase(word[3].text) != "AND" || left == 4) {
      return Bad("comparisons are joined by AND, found '" + Readable(word[3].text) + "'");
    }
  }
  return {};
}

Status ApplyFilter(std::string_view filter, storage::JobQuery& query) {
  storage::JobQuery changed = query;
  const Status read = ReadFilter(filter, [&](const std::string& field, const std::string& value) {
    return Apply(field, value, changed);
  });
  if (read) query = std::move(changed);
  return read;
}

}  // namespace rmlcell::server
