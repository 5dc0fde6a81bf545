#include "server/jobs/job_filter.h"

#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "engine/core/letters.h"
#include "engine/core/number_text.h"
#include "engine/families/families.h"
#include "server/base/names.h"
#include "server/base/readable.h"
#include "server/jobs/job_request.h"
#include "server/records/job_messages.h"

namespace rmlcell::server {
namespace {

// Eleven fields once, with "=", a value and AND.
constexpr std::size_t kWordsMax = 43;

Error Bad(const Detail& detail) { return {ErrorCode::kCellBadFilter, detail, {}}; }

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

constexpr std::array<std::string_view, 6> kStates = {"QUEUED", "RUNNING",   "SUCCEEDED",
                                                     "FAILED", "CANCELLED", "INTERRUPTED"};
static_assert(kStates.size() == static_cast<std::size_t>(storage::JobState::kInterrupted) + 1,
              "one for each JobState, in its order");
constexpr std::array<std::string_view, 3> kKinds = {"CHECK", "SIMULATE", "RUN"};
constexpr std::array<std::string_view, 3> kVerdicts = {"GOOD", "DOUBTFUL", "BAD"};

// Which of the words it is, in capitals or not, with the prefix of the contract or without.
Result<std::size_t> WordOf(std::string_view what, const std::string& value, std::string_view prefix,
                           std::span<const std::string_view> words) {
  std::string word = UpperCase(value);
  if (word.starts_with(prefix)) word.erase(0, prefix.size());
  const auto found = std::ranges::find(words, word);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  std::string all;
  for (const std::string_view one : words) all += (all.empty() ? "" : ", ") + std::string(one);
  return Bad("no " + std::string(what) + " '" + Readable(value) + "'; there are " + all);
}

// Times as the contract writes them in JSON: "2026-11-25T10:00:00Z".
Result<storage::WallTime> TimeOf(const std::string& field, const std::string& value) {
  google::protobuf::Timestamp time;
  if (!google::protobuf::util::TimeUtil::FromString(value, &time))
    return Bad(field + " is a time such as 2026-11-25T10:00:00Z, not '" + Readable(value) + "'");
  return FromProto(time);
}

Status Apply(const std::string& field, const std::string& value, storage::JobQuery& query) {
  if (field == "state") {
    const Result<std::size_t> state = WordOf(field, value, "STATE_", kStates);
    if (!state) return state.error();
    query.state = static_cast<storage::JobState>(*state);
  } else if (field == "machine") {
    const Result<std::string> id =
        ParseMachineName(value.find('/') == std::string::npos ? MachineName(value) : value);
    if (!id) return Bad("machine: " + id.error().detail);
    query.machine = *id;
  } else if (field == "kind") {
    const Result<std::size_t> kind = WordOf(field, value, "JOB_KIND_", kKinds);
    if (!kind) return kind.error();
    query.kind = kKinds[*kind];
  } else if (field == "verdict") {
    const Result<std::size_t> verdict = WordOf(field, value, "VERDICT_", kVerdicts);
    if (!verdict) return verdict.error();
    query.verdict = kVerdicts[*verdict];
  } else if (field == "family") {
    if (families::FindFamily(value) == nullptr) return Bad("no family '" + Readable(value) + "'");
    query.family = value;
  } else if (field == "label") {
    if (!IsLabel(value)) return Bad("no label '" + Readable(value) + "'");
    query.label = value;
  } else if (field == "text") {
    if (value.empty()) return Bad("text is empty");
    query.text = value;
  } else if (field == "since" || field == "until") {
    const Result<storage::WallTime> time = TimeOf(field, value);
    if (!time) return time.error();
    (field == "since" ? query.created_from : query.created_before) = *time;
  } else if (field == "caller") {
    if (value.empty()) return Bad("caller is empty");
    query.caller = value;
  } else if (field == "finished") {
    if (value != "true" && value != "false")
      return Bad("finished is true or false, not '" + Readable(value) + "'");
    query.finished = value == "true";
  } else {
    return Bad(
        "no field '" + Readable(field) +
        "'; there are state, machine, kind, caller, finished, family, verdict, label, text, since, "
        "until");
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

Result<storage::JobOrder> ReadJobOrder(std::string_view order_by) {
  if (order_by.empty() || order_by == "create_time desc") return storage::JobOrder::kNewestFirst;
  if (order_by == "create_time") return storage::JobOrder::kOldestFirst;
  if (order_by == "queue") return storage::JobOrder::kQueue;
  return Error{
      ErrorCode::kCellInvalidArgument,
      "order_by: '" + Readable(order_by) + "'; there are create_time desc, create_time, queue",
      {}};
}

std::string WriteJobPlace(const storage::JobPlace& place) {
  return std::to_string(place.id) + "," + std::to_string(static_cast<int>(place.state)) + "," +
         (place.blocked ? "1" : "0") + "," + std::to_string(place.priority) + "," +
         ShortestText(place.place);
}

Result<storage::JobPlace> ReadJobPlace(std::string_view token) {
  const Error bad{ErrorCode::kCellBadPageToken, {}, {}};
  std::array<std::optional<double>, 5> values;
  for (std::optional<double>& value : values) {
    const std::size_t end = std::min(token.find(','), token.size());
    value = ParseDouble(token.substr(0, end));
    const bool last = &value == &values.back();
    if (!value || last != (end == token.size())) return bad;
    token.remove_prefix(std::min(end + 1, token.size()));
  }
  const auto& [id, state, blocked, priority, place] = values;
  constexpr double kIdMax = 1e15;  // whole numbers up to here are exact
  const auto whole = [](double value, double low, double high) {
    return value == std::trunc(value) && value >= low && value <= high;
  };
  if (!whole(*id, 1, kIdMax) || !whole(*blocked, 0, 1) || !whole(*priority, -1000, 1000) ||
      !whole(*state, 0, static_cast<double>(storage::JobState::kInterrupted)))
    return bad;
  return storage::JobPlace{.id = static_cast<std::int64_t>(*id),
                           .state = static_cast<storage::JobState>(static_cast<int>(*state)),
                           .blocked = *blocked != 0.0,
                           .priority = static_cast<int>(*priority),
                           .place = *place};
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
