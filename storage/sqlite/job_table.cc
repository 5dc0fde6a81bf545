#include "storage/sqlite/job_table.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <ranges>
#include <tuple>

#include "storage/content.h"

namespace rmlcell::storage::sqlite {
namespace {

// The columns in the order of Read().
std::string SelectJob(const std::string& from) {
  return "SELECT id, request_id, request_hash, machine, kind, title, caller, state,"
         " cancel_requested, attempts, attempts_max, attempts_begun, last_sequence,"
         " events_gone_until, created_at, started_at, finished_at, outcome_code, outcome_detail,"
         " outcome_program, outcome_step, outcome_judgement, pool, priority, held, not_before, blocked,"
         " place, family, outcome_verdict, labels FROM job " +
         from;
}

std::string TextOf(const std::vector<std::string>& labels) {
  std::string text;
  for (const std::string& label : labels) text += (text.empty() ? " " : "") + label + " ";
  return text;
}

std::vector<std::string> LabelsOf(std::string_view text) {
  std::vector<std::string> labels;
  for (const auto word : std::views::split(text, ' ')) {
    if (!word.empty()) labels.emplace_back(word.begin(), word.end());
  }
  return labels;
}

// The code is kept as people write it: its place in the catalogue moves from version to version.
std::optional<std::string> TextOf(const std::optional<ErrorCode>& code) {
  return code ? std::optional(CodeText(*code)) : std::nullopt;
}

void SetCode(JobOutcome& outcome, const std::string& text) {
  const std::vector<const CatalogueEntry*> found = FindByText(text);
  if (!found.empty()) {
    outcome.code = found.front()->code;
    return;
  }
  // Written by another version. The job must stay readable, and the code must not get lost.
  outcome.code = ErrorCode::kCellInternal;
  outcome.detail = text + ", which this version does not know: " + outcome.detail;
}

Result<JobRow> Read(const Query& row) {
  const std::int64_t state = row.Integer(7);
  if (state < 0 || state > static_cast<int>(JobState::kInterrupted)) {
    return Error{ErrorCode::kCellStoreCorrupt,
                 "job " + row.Text(0) + " has state " + std::to_string(state),
                 {}};
  }
  JobRow result{.job = {.id = row.Integer(0),
                        .request_id = row.Text(1),
                        .request_hash = row.Text(2),
                        .machine = row.Text(3),
                        .family = row.Text(28),
                        .kind = row.Text(4),
                        .pool = row.Text(22),
                        .title = row.Text(5),
                        .caller = row.Text(6),
                        .labels = LabelsOf(row.View(30)),
                        .specification = {},
                        .state = static_cast<JobState>(state),
                        .priority = row.Small(23),
                        .place = row.Real(27),
                        .held = row.Integer(24) != 0,
                        .not_before = row.OptionalTime(25),
                        .blocked = row.Small(26) != 0,
                        .cancel_requested = row.Integer(8) != 0,
                        .attempts = row.Small(9),
                        .attempts_max = row.Small(10),
                        .outcome = {},
                        .last_sequence = row.Integer(12),
                        .events_gone_until = row.Integer(13),
                        .created_at = row.Time(14),
                        .started_at = row.OptionalTime(15),
                        .finished_at = row.OptionalTime(16)},
                .attempts_begun = row.Small(11),
                .blocked = row.Small(26)};
  if (IsFinal(result.job.state)) {
    result.job.outcome = JobOutcome{.state = result.job.state,
                                    .code = {},
                                    .detail = row.Text(18),
                                    .program = row.Small(19),
                                    .step = row.Small(20),
                                    .judgement = row.Text(21),
                                    .verdict = row.Text(29)};
    if (!row.IsNull(17)) SetCode(*result.job.outcome, row.Text(17));
  }
  return result;
}

Result<JobRecord> ReadRecord(const Query& query) {
  Result<JobRow> row = Read(query);
  if (!row) return row.error();
  return std::move(row->job);
}

// What no index helps with: parameters 9 to 14.
constexpr std::string_view kDearFilter =
    " AND (?9 = '' OR family = ?9) AND (?10 = '' OR outcome_verdict = ?10)"
    " AND (?14 = '' OR instr(labels, ' ' || ?14 || ' ') > 0)"
    " AND (?11 = '' OR instr(lower(title), lower(?11)) > 0)"
    " AND created_at >= ?12 AND created_at < ?13";

bool Wants(const JobQuery& query, JobState state) {
  return (!query.state || *query.state == state) &&
         (!query.finished || *query.finished == IsFinal(state));
}

bool WantsFinished(const JobQuery& query) {
  return query.state ? Wants(query, *query.state) && IsFinal(*query.state)
                     : query.finished.value_or(true);
}

bool PlaceRunsBefore(const JobPlace& a, const JobPlace& b) {
  return std::tuple(a.blocked, -a.priority, a.place, a.id) <
         std::tuple(b.blocked, -b.priority, b.place, b.id);
}

bool RunsBefore(const JobRecord& a, const JobRecord& b) {
  return PlaceRunsBefore(PlaceOf(a), PlaceOf(b));
}

void Shorten(std::vector<JobRecord>& jobs, int limit) {
  if (jobs.size() > static_cast<std::size_t>(limit)) jobs.erase(jobs.begin() + limit, jobs.end());
}

std::string Number(JobState state) { return std::to_string(static_cast<int>(state)); }

}  // namespace

// The states stand as numbers in the statements below: SQLite sees only then that a partial index
// fits.
static_assert(static_cast<int>(JobState::kQueued) == 0);
static_assert(static_cast<int>(JobState::kRunning) == 1);

JobTable::JobTable(Database& database, BlobTable& blobs)
    : database_(database),
      blobs_(blobs),
      insert_(database,
              "INSERT INTO job (id, request_id, request_hash, machine, kind, title, caller, state,"
              " cancel_requested, attempts, attempts_max, attempts_begun, last_sequence,"
              " events_gone_until, created_at, pool, priority, place, special, held, not_before,"
              " blocked, family, labels)"
              " VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, 0, 0, 0, ?8, 0, ?9, 0, ?10, ?11, ?12, ?1, ?13,"
              " ?14, ?15, ?16, ?17, ?18)"
              " ON CONFLICT (request_id) DO NOTHING"),
      get_(database, SelectJob("WHERE id = ?1")),
      find_by_request_(database, SelectJob("WHERE request_id = ?1")),
      update_(
          database,
          "UPDATE job SET state = ?2, cancel_requested = ?3, attempts = ?4, attempts_begun = ?5,"
          " last_sequence = ?6, started_at = ?7, finished_at = ?8, outcome_code = ?9,"
          " outcome_detail = ?10, outcome_program = ?11, outcome_step = ?12,"
          " outcome_judgement = ?13, priority = ?14, place = ?15, special = ?16, held = ?17,"
          " not_before = ?18, blocked = ?19, outcome_verdict = ?20 WHERE id = ?1"),
      set_last_sequence_(database, "UPDATE job SET last_sequence = ?2 WHERE id = ?1"),
      set_events_gone_(database, "UPDATE job SET events_gone_until = ?2 WHERE id = ?1"),
      put_specification_(database,
                         "INSERT INTO job_specification"
                         " (job, specification, specification_blob, attachment_name,"
                         " attachment_media_type, attachment_sha256, attachment_size, attachment)"
                         " VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)"),
      specification_(
          database,
          "SELECT specification, specification_blob FROM job_specification WHERE job = ?1"),
      last_id_(database, "SELECT ifnull(max(id), 0) FROM job"),
      running_(
          database,
          "SELECT machine, id FROM job INDEXED BY job_unfinished WHERE state < 2 AND state = 1"),
      oldest_finished_(database,
                       "SELECT id FROM job INDEXED BY job_finished_by_time WHERE state >= 2"
                       " AND NOT (state = 5 AND EXISTS (SELECT 1 FROM machine_mark"
                       " WHERE machine_mark.machine = job.machine AND NOT clean))"
                       " ORDER BY finished_at, id LIMIT 1"),
      remove_(database, "DELETE FROM job WHERE id = ?1"),
      remove_specification_(database,
                            "DELETE FROM job_specification WHERE job = ?1"
                            " RETURNING specification_blob") {}

Result<bool> JobTable::Insert(const JobRecord& job, int blocked) {
  const std::string labels = TextOf(job.labels);
  if (const Status inserted =
          insert_
              .With(job.id, job.request_id, job.request_hash, job.machine, job.kind, job.title,
                    job.caller, job.attempts_max, job.last_sequence, job.created_at, job.pool,
                    job.priority, job.priority != 0, job.held, job.not_before, blocked, job.family,
                    labels)
              .Run();
      !inserted)
    return inserted.error();
  return insert_.changes() == 1;
}

Result<std::optional<JobRow>> JobTable::Get(std::int64_t id) {
  return FirstRow<JobRow>(get_.With(id), Read);
}

Result<std::optional<JobRow>> JobTable::FindByRequest(std::string_view request_id) {
  return FirstRow<JobRow>(find_by_request_.With(request_id), Read);
}

Status JobTable::Update(const JobRow& row) {
  const JobRecord& job = row.job;
  const JobOutcome none;
  const JobOutcome& outcome = job.outcome ? *job.outcome : none;
  const std::optional<std::string> code = TextOf(outcome.code);
  return update_
      .With(job.id, static_cast<int>(job.state), job.cancel_requested, job.attempts,
            row.attempts_begun, job.last_sequence, job.started_at, job.finished_at, code,
            outcome.detail, outcome.program, outcome.step, Bytes{outcome.judgement}, job.priority,
            job.place, row.special(), job.held, job.not_before, row.blocked, outcome.verdict)
      .Run();
}

Status JobTable::SetLastSequence(std::int64_t id, std::int64_t sequence) {
  return set_last_sequence_.With(id, sequence).Run();
}

Status JobTable::SetEventsGoneUntil(std::int64_t id, std::int64_t sequence) {
  return set_events_gone_.With(id, sequence).Run();
}

Status JobTable::PutSpecification(std::int64_t id, const ContentColumns& specification,
                                  const std::optional<Attachment>& attachment) {
  if (!attachment) {
    return put_specification_
        .With(id, specification.bytes, specification.blob, std::nullopt, std::nullopt, std::nullopt,
              std::nullopt, std::nullopt)
        .Run();
  }
  const auto& [artifact, content] = *attachment;
  return put_specification_
      .With(id, specification.bytes, specification.blob, artifact.name, artifact.media_type,
            Bytes{content.sha256}, content.bytes.size(), Bytes{content.encoded})
      .Run();
}

Result<std::string> JobTable::Specification(std::int64_t id) {
  Result<std::optional<std::string>> found = FirstRow<std::string>(
      specification_.With(id), [this](const Query& row) { return blobs_.Content(row, 0); });
  if (!found) return found.error();
  return *found ? **std::move(found) : std::string();
}

Result<std::int64_t> JobTable::LastId() { return FirstInteger(last_id_.With()); }

Status JobTable::AddRunning(MachineTally::Machines& machines) {
  Query running = running_.With();
  Result<bool> row = running.Step();
  for (; row && *row; row = running.Step())
    machines[running.Text(0)].running.insert(running.Integer(1));
  if (!row) return row.error();
  return {};
}

Result<std::optional<std::int64_t>> JobTable::OldestFinished() {
  return FirstRow<std::int64_t>(oldest_finished_.With(),
                                [](const Query& row) { return row.Integer(0); });
}

Result<std::optional<std::int64_t>> JobTable::Remove(std::int64_t id) {
  if (const Status removed = remove_.With(id).Run(); !removed) return removed.error();
  if (remove_.changes() != 1) {
    return Error{ErrorCode::kCellStoreCorrupt, "job " + std::to_string(id) + " is not there", {}};
  }
  Query query = remove_specification_.With(id);
  const Result<bool> row = query.Step();
  if (!row) return row.error();
  return *row ? query.OptionalInteger(0) : std::nullopt;
}

// A list is put together of lanes, each of which an index gives in the order wanted, so that a page
// costs the same however many jobs there are: one lane of finished jobs, and for those that wait or
// run one for each state, pool, kind and way of waiting.
Result<std::vector<JobRecord>> JobTable::List(const JobQuery& query) {
  std::vector<JobRecord> jobs;
  if (query.limit < 1) return jobs;
  if (query.order == JobOrder::kQueue) return ListQueue(query);
  const auto add = [&](Result<std::vector<JobRecord>> lane) -> Status {
    if (!lane) return lane.error();
    std::move(lane->begin(), lane->end(), std::back_inserter(jobs));
    return {};
  };
  for (const JobState state : {JobState::kQueued, JobState::kRunning}) {
    if (!Wants(query, state)) continue;
    if (const Status added = add(ListUnfinished(state, query)); !added) return added.error();
  }
  if (WantsFinished(query)) {
    if (const Status added = add(ListFinished(query)); !added) return added.error();
  }
  if (query.order == JobOrder::kOldestFirst) {
    std::ranges::sort(jobs, std::less(), &JobRecord::id);
  } else {
    std::ranges::sort(jobs, std::greater(), &JobRecord::id);
  }
  Shorten(jobs, query.limit);
  return jobs;
}

// In parts, up to a page of them. Those that wait are looked at all, as no index has their order
// over all pools.
Result<std::vector<JobRecord>> JobTable::ListQueue(const JobQuery& query) {
  std::vector<JobRecord> jobs;
  const std::optional<JobPlace>& behind = query.behind;
  const auto add = [&](Result<std::vector<JobRecord>> part) -> Status {
    if (!part) return part.error();
    std::move(part->begin(), part->end(), std::back_inserter(jobs));
    Shorten(jobs, query.limit);
    return {};
  };
  JobQuery part = query;
  part.order = JobOrder::kOldestFirst;
  if (Wants(query, JobState::kRunning) && (!behind || behind->state == JobState::kRunning)) {
    Result<std::vector<JobRecord>> running = ListUnfinished(JobState::kRunning, part);
    if (running) std::ranges::sort(*running, std::less(), &JobRecord::id);
    if (const Status added = add(std::move(running)); !added) return added.error();
  }
  const auto full = [&] { return jobs.size() >= static_cast<std::size_t>(query.limit); };
  if (Wants(query, JobState::kQueued) && !full() && !(behind && IsFinal(behind->state))) {
    part.behind.reset();
    part.limit = std::numeric_limits<int>::max();
    Result<std::vector<JobRecord>> waiting = ListUnfinished(JobState::kQueued, part);
    if (waiting) {
      std::ranges::sort(*waiting, RunsBefore);
      if (behind && behind->state == JobState::kQueued) {
        std::erase_if(*waiting, [&](const JobRecord& job) {
          return !PlaceRunsBefore(*behind, PlaceOf(job));
        });
      }
    }
    if (const Status added = add(std::move(waiting)); !added) return added.error();
  }
  if (WantsFinished(query) && !full()) {
    part = query;
    part.order = JobOrder::kNewestFirst;
    if (behind && !IsFinal(behind->state)) part.behind.reset();
    if (const Status added = add(ListFinished(part)); !added) return added.error();
  }
  return jobs;
}

Result<std::vector<JobRecord>> JobTable::ListUnfinished(JobState state, const JobQuery& query) {
  const std::string in_state =
      "INDEXED BY job_unfinished WHERE state < 2 AND state = " + Number(state) +
      " AND pool = ?6 AND blocked = ?7 AND special = ?8";
  const Result<std::vector<Lane>> lanes = LanesOf(state);
  if (!lanes) return lanes.error();
  std::vector<JobRecord> jobs;
  for (const Lane& lane : *lanes) {
    if (!query.kind.empty() && lane.kind != query.kind) continue;
    Result<std::vector<JobRecord>> of_lane = ListLane(in_state, query, lane);
    if (!of_lane) return of_lane.error();
    std::move(of_lane->begin(), of_lane->end(), std::back_inserter(jobs));
  }
  return jobs;
}

Result<std::vector<JobRecord>> JobTable::ListFinished(const JobQuery& query) {
  // Of several indexes the one that promises fewest rows; most jobs succeed.
  const bool rare = query.state && *query.state != JobState::kSucceeded;
  std::string index = "NOT INDEXED";
  if (query.state) index = "INDEXED BY job_finished_by_state";
  if (!query.machine.empty() && !rare) index = "INDEXED BY job_finished_by_machine";
  if (!query.caller.empty() && !rare) index = "INDEXED BY job_finished_by_caller";
  std::string lane = index + " WHERE state >= 2";
  if (query.state) lane += " AND state = " + Number(*query.state);
  return ListLane(lane, query, {});
}

Result<std::vector<JobRecord>> JobTable::ListLane(const std::string& jobs, const JobQuery& query,
                                                  const std::optional<Lane>& lane) {
  // A parameter that is not looked at still has to be named.
  std::string sql = SelectJob(jobs);
  sql += lane ? " AND kind = ?1" : " AND (?1 = '' OR kind = ?1) AND ?6 = '' AND ?7 = ?8";
  sql += query.machine.empty() ? " AND ?2 = ''" : " AND machine = ?2";
  sql += query.caller.empty() ? " AND ?3 = ''" : " AND caller = ?3";
  sql += kDearFilter;
  const bool oldest = query.order == JobOrder::kOldestFirst;
  sql += oldest ? " AND id > ?4 ORDER BY id LIMIT ?5" : " AND id < ?4 ORDER BY id DESC LIMIT ?5";
  const std::int64_t behind = query.behind ? query.behind->id : oldest ? 0 : INT64_MAX;
  const std::string kind = lane ? lane->kind : query.kind;
  const std::string pool = lane ? lane->pool : std::string();
  Statement statement(database_, std::move(sql));
  return AllRows<JobRecord>(
      statement.With(kind, query.machine, query.caller, behind, query.limit, pool,
                     lane ? lane->blocked : 0, lane ? lane->special : 0, query.family,
                     query.verdict, query.text, query.created_from.value_or(WallTime::min()),
                     query.created_before.value_or(WallTime::max()), query.label),
      ReadRecord);
}

Result<std::vector<JobTable::Lane>> JobTable::LanesOf(JobState state) {
  // Each step jumps to the next lane in the index: the cost is that of the lanes, not of the jobs.
  const std::string select =
      "SELECT pool, kind, blocked, special FROM job INDEXED BY job_unfinished"
      " WHERE state < 2 AND state = " +
      Number(state);
  const std::string order = " ORDER BY pool, kind, blocked, special LIMIT 1";
  Statement next(database_,
                 select + " AND (pool, kind, blocked, special) > (?1, ?2, ?3, ?4)" + order);
  Statement first(database_, select + order);
  const auto read = [](const Query& row) {
    return Lane{row.Text(0), row.Text(1), row.Small(2), row.Small(3)};
  };
  std::vector<Lane> lanes;
  Result<std::optional<Lane>> lane = FirstRow<Lane>(first.With(), read);
  while (lane && *lane) {
    if (!lanes.empty() && **lane <= lanes.back()) {  // a damaged index must not lead in circles
      return Error{
          ErrorCode::kCellStoreCorrupt, "the index of unfinished jobs is out of order", {}};
    }
    lanes.push_back(**std::move(lane));
    const Lane& last = lanes.back();
    lane = FirstRow<Lane>(next.With(last.pool, last.kind, last.blocked, last.special), read);
  }
  if (!lane) return lane.error();
  return lanes;
}

Result<std::vector<JobStateCount>> JobTable::CountByState(const JobQuery& query) {
  std::string sql = "SELECT state, count(*) FROM job WHERE (?1 = '' OR kind = ?1)";
  sql += query.machine.empty() ? " AND ?2 = ''" : " AND machine = ?2";
  sql += query.caller.empty() ? " AND ?3 = ''" : " AND caller = ?3";
  sql += " AND ?4 + ?5 + ?6 + ?7 + ?8 = 0";
  sql += kDearFilter;
  sql += " GROUP BY state";
  Statement statement(database_, std::move(sql));
  return AllRows<JobStateCount>(
      statement.With(query.kind, query.machine, query.caller, 0, 0, 0, 0, 0, query.family,
                     query.verdict, query.text, query.created_from.value_or(WallTime::min()),
                     query.created_before.value_or(WallTime::max()), query.label),
      [](const Query& row) {
        return JobStateCount{.state = static_cast<JobState>(row.Small(0)), .jobs = row.Integer(1)};
      });
}

}  // namespace rmlcell::storage::sqlite
