#pragma once

#include "storage/sqlite/artifact_table.h"
#include "storage/sqlite/blob_table.h"
#include "storage/sqlite/event_table.h"
#include "storage/sqlite/host_table.h"
#include "storage/sqlite/job_table.h"
#include "storage/sqlite/lease_table.h"
#include "storage/sqlite/machine_table.h"
#include "storage/sqlite/mark_table.h"
#include "storage/sqlite/order_table.h"
#include "storage/sqlite/program_table.h"
#include "storage/sqlite/project_table.h"
#include "storage/sqlite/queue_table.h"
#include "storage/sqlite/schedule_table.h"
#include "storage/sqlite/taught_table.h"
#include "storage/sqlite/transaction.h"
#include "storage/sqlite/upload_table.h"

namespace rmlcell::storage::sqlite {

// All tables as one connection sees them. SQL stands in these classes and in the migrations only.
struct Tables {
  explicit Tables(Database& database)
      : blobs(database),
        machines(database),
        programs(database, blobs),
        schedules(database),
        projects(database, blobs),
        jobs(database, blobs),
        queue(database),
        leases(database),
        attempts(database),
        orders(database),
        hosts(database),
        taught(database),
        events(database),
        artifacts(database),
        uploads(database),
        marks(database),
        machine_jobs(database),
        log_parts(database),
        buried(database) {}

  BlobTable blobs;
  MachineTable machines;
  ProgramTable programs;
  ScheduleTable schedules;
  ProjectTable projects;
  JobTable jobs;
  QueueTable queue;
  LeaseTable leases;
  AttemptTable attempts;
  OrderTable orders;
  HostTable hosts;
  TaughtTable taught;
  EventTable events;
  ArtifactTable artifacts;
  UploadTable uploads;
  MarkTable marks;
  MachineJobsTable machine_jobs;
  LogPartTable log_parts;
  BuriedTable buried;
};

// A connection with its statements. Stays where it is: the tables refer to the database.
struct Connection {
  explicit Connection(Database opened)
      : database(std::move(opened)), transactions(database), tables(database) {}
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  Database database;
  TransactionStatements transactions;
  Tables tables;
};

}  // namespace rmlcell::storage::sqlite
