#pragma once

#include <string_view>

namespace rmlcell::storage::sqlite {

// Version 1 of the schema. Released text: a change is a new migration, never an edit here.
//
// Times are microseconds since 1970 UTC. A column `x` beside `x_blob` holds small bytes itself or
// names a blob that does (storage/content.h). Columns that name a blob are counted in blob.refs;
// blob.holds counts the writers that are still busy with one.
//
// Submitting is the hot path: each index it touches is a page more in the log of that commit. So
// jobs that wait or run have one small index, and those by which people look for old jobs take a
// job in only when it ends.
inline constexpr std::string_view kFirstSchema = R"sql(
CREATE TABLE mark (            -- counters whose highest rows may have been removed
  name TEXT PRIMARY KEY,
  value INTEGER NOT NULL
) WITHOUT ROWID;

CREATE TABLE buried (          -- where a record that is made again goes on counting its revisions
  kind INTEGER NOT NULL,
  owner TEXT NOT NULL,
  name TEXT NOT NULL,
  revision INTEGER NOT NULL,
  PRIMARY KEY (kind, owner, name)
) WITHOUT ROWID;

CREATE TABLE blob (
  id INTEGER PRIMARY KEY,
  sha256 BLOB UNIQUE,          -- NULL while it is not whole: being written, or being removed
  size INTEGER NOT NULL,       -- bytes before compression
  refs INTEGER NOT NULL,
  holds INTEGER NOT NULL,
  content BLOB                 -- encoded, where it is small; else it lies in chunks
);
CREATE INDEX blob_garbage ON blob (id) WHERE refs = 0 AND holds = 0;

CREATE TABLE blob_chunk (
  blob INTEGER NOT NULL,
  number INTEGER NOT NULL,
  content BLOB NOT NULL,       -- encoded
  PRIMARY KEY (blob, number)
) WITHOUT ROWID;

CREATE TABLE machine (
  id TEXT PRIMARY KEY,
  family TEXT NOT NULL,
  title TEXT NOT NULL,
  profile TEXT NOT NULL,
  revision INTEGER NOT NULL,
  created_at INTEGER NOT NULL,
  updated_at INTEGER NOT NULL,
  state BLOB,
  state_blob INTEGER
);

CREATE TABLE machine_parameter (
  machine TEXT NOT NULL,
  name TEXT NOT NULL,
  value TEXT NOT NULL,
  PRIMARY KEY (machine, name)
) WITHOUT ROWID;

CREATE TABLE program (
  machine TEXT NOT NULL,
  slot INTEGER NOT NULL,
  name TEXT NOT NULL,
  source_name TEXT NOT NULL,
  revision INTEGER NOT NULL,
  created_at INTEGER NOT NULL,
  updated_at INTEGER NOT NULL,
  object_blob INTEGER NOT NULL,
  source_blob INTEGER,
  executable_blob INTEGER,
  PRIMARY KEY (machine, slot)
) WITHOUT ROWID;

CREATE TABLE schedule (
  machine TEXT NOT NULL,
  number INTEGER NOT NULL,
  name TEXT NOT NULL,
  mode TEXT NOT NULL,
  power_percent REAL NOT NULL,
  revision INTEGER NOT NULL,
  updated_at INTEGER NOT NULL,
  PRIMARY KEY (machine, number)
) WITHOUT ROWID;

CREATE TABLE project (
  id TEXT PRIMARY KEY,
  title TEXT NOT NULL,
  revision INTEGER NOT NULL,
  created_at INTEGER NOT NULL,
  updated_at INTEGER NOT NULL,
  body BLOB,
  body_blob INTEGER
);

CREATE TABLE job (
  id INTEGER PRIMARY KEY,
  request_id TEXT NOT NULL UNIQUE,
  request_hash TEXT NOT NULL,
  machine TEXT NOT NULL,
  kind TEXT NOT NULL,
  title TEXT NOT NULL,
  caller TEXT NOT NULL,
  state INTEGER NOT NULL,            -- 0 queued, 1 running, 2 and above: final
  cancel_requested INTEGER NOT NULL,
  attempts INTEGER NOT NULL,         -- those that count
  attempts_max INTEGER NOT NULL,
  attempts_begun INTEGER NOT NULL,   -- all of them, for their numbers
  last_sequence INTEGER NOT NULL,
  events_gone_until INTEGER NOT NULL,
  created_at INTEGER NOT NULL,
  started_at INTEGER,
  finished_at INTEGER,
  outcome_code TEXT,
  outcome_detail TEXT,
  outcome_program INTEGER,
  outcome_step INTEGER
);
CREATE INDEX job_unfinished ON job (state, kind) WHERE state < 2;
CREATE INDEX job_finished_by_state ON job (state) WHERE state >= 2;
CREATE INDEX job_finished_by_machine ON job (machine) WHERE state >= 2;
CREATE INDEX job_finished_by_caller ON job (caller) WHERE state >= 2;
CREATE INDEX job_finished_by_time ON job (finished_at) WHERE state >= 2;

CREATE TABLE job_specification (     -- not in `job`: that row is written again with every event
  job INTEGER PRIMARY KEY,
  specification BLOB,
  specification_blob INTEGER
);

CREATE TABLE lease (                 -- of the running jobs
  job INTEGER PRIMARY KEY,
  attempt INTEGER NOT NULL,
  fence INTEGER NOT NULL,
  worker TEXT NOT NULL,
  until INTEGER NOT NULL
);

CREATE TABLE attempt (
  job INTEGER NOT NULL,
  number INTEGER NOT NULL,
  worker TEXT NOT NULL,
  fence INTEGER NOT NULL,
  started_at INTEGER NOT NULL,
  ended_at INTEGER,
  how_it_ended TEXT NOT NULL,
  PRIMARY KEY (job, number)
) WITHOUT ROWID;

CREATE TABLE event (
  position INTEGER PRIMARY KEY,
  job INTEGER NOT NULL,
  sequence INTEGER NOT NULL,
  attempt INTEGER NOT NULL,
  at INTEGER NOT NULL,
  kind TEXT NOT NULL,
  payload BLOB NOT NULL
);
CREATE UNIQUE INDEX event_by_job ON event (job, sequence);

CREATE TABLE artifact (
  job INTEGER NOT NULL,
  name TEXT NOT NULL,
  media_type TEXT NOT NULL,
  blob INTEGER NOT NULL,
  PRIMARY KEY (job, name)
) WITHOUT ROWID;
)sql";

}  // namespace rmlcell::storage::sqlite
