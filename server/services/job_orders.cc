// Orders for jobs that run, or wait: HOLD, STOP, resume, override, cancel. Those for a job that a
// machine runs go to its host, all others to its worker.
#include "server/base/names.h"
#include "server/jobs/dispatcher.h"
#include "server/jobs/job_book.h"
#include "server/records/job_messages.h"
#include "server/runs/run_queue.h"
#include "server/services/host_refusal.h"
#include "server/services/job_service.h"

namespace rmlcell::server {

namespace {

v1::Job* JobOf(v1::Job* response) { return response; }
v1::Job* JobOf(v1::HaltJobResponse* response) { return response->mutable_job(); }

void NoteActed(const v1::Job*) {}
void NoteActed(v1::HaltJobResponse* response) {
  *response->mutable_acted_at() =
      ToProto(std::chrono::floor<std::chrono::microseconds>(std::chrono::system_clock::now()));
}

// The same order for a machine that lives: STOP or HOLD.
template <class Request>
v1::HostOrder OrderOf(v1::WorkerControl::Kind kind, const Request& request) {
  v1::HostOrder order;
  if (kind == v1::WorkerControl::KIND_STOP) {
    order.mutable_stop()->set_request_id(request.request_id());
  } else {
    order.mutable_hold()->set_request_id(request.request_id());
  }
  return order;
}

v1::HostOrder OrderOf(v1::WorkerControl::Kind, const v1::ResumeJobRequest& request) {
  v1::HostOrder order;
  v1::ResumeMachineRequest& resume = *order.mutable_resume();
  resume.set_control_token(request.control_token());
  resume.set_request_id(request.request_id());
  resume.set_accept_displaced(request.accept_displaced());
  resume.set_restore_process(request.restore_process());
  return order;
}

}  // namespace

grpc::ServerUnaryReactor* JobService::CancelJob(grpc::CallbackServerContext* context,
                                                const v1::CancelJobRequest* request,
                                                v1::Job* response) {
  const Result<std::int64_t> id = ParseJobName(request->name());
  const bool is_heard = id && !runs_.MachineOf(request->name()).empty();
  return AnswerAfter(
      needs_, context, *request, "JobService/CancelJob",
      [this, id, is_heard, request](const Caller& caller) {
        if (!id) return;
        if (is_heard) return runs_.Abort(request->name(), caller.identity, request->request_id());
        dispatcher_.OrderAtOnce(
            *id, {v1::WorkerControl::KIND_CANCEL, 0.0, caller.identity, request->request_id()});
      },
      [this, id, is_heard, request, response](const Caller& caller) {
        if (!id) return ToGrpcStatus(id.error());
        const auto job = dispatcher_.Cancel(*id, caller.identity, request->request_id());
        if (!job) return ToGrpcStatus(job.error());
        // Its run may be over by now, and the store not know it yet.
        if (job->kind == storage::kRunKind && job->state == storage::JobState::kRunning &&
            !is_heard && runs_.MachineOf(request->name()).empty())
          return ToGrpcStatus(Error{
              ErrorCode::kCellNotLive,
              "the host of its machine is not heard of: it is told when it is, or the run is cut off then",
              {}});
        *response = ToProto(*job);
        return grpc::Status::OK;
      });
}

template <class Request, class Response>
grpc::ServerUnaryReactor* JobService::OrderRun(grpc::CallbackServerContext* context,
                                               std::string_view method, const Request& request,
                                               v1::HostOrder order, Response* response) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  const Result<Caller> caller = Admit(needs_.gate, *context, method, &request);
  const Status good = caller ? CheckRequest(needs_, request) : Status();
  if (!caller || !good) {
    reactor->Finish(ToGrpcStatus(caller ? good.error() : caller.error()));
    return reactor;
  }
  order.set_caller(caller->identity);
  const auto begin = std::chrono::steady_clock::now();
  const auto end = [reactor, method, begin, who = *caller](const grpc::Status& status) {
    LogCall(method, who, status, std::chrono::steady_clock::now() - begin);
    reactor->Finish(status);
  };
  runs_.Ask(request.name(), std::move(order),
            [this, method, end, response,
             name = request.name()](const Result<v1::HostOrderAnswer>& answer) {
              if (!answer) return end(ToGrpcStatus(answer.error()));
              if (answer->has_refusal()) return end(RefusalOf(*answer));
              NoteActed(response);
              needs_.executor.Post(EndingWhereThrown(
                  method, [this, end, response, name] { end(Give(name, JobOf(response))); }, end));
            });
  return reactor;
}

// The host has the last word on whether its machine waits for a decision. LIVE-5.10
grpc::ServerUnaryReactor* JobService::DecideInterrupted(grpc::CallbackServerContext* context,
                                                        const v1::DecideInterruptedRequest* request,
                                                        v1::DecideInterruptedResponse* response) {
  constexpr std::string_view kMethod = "JobService/DecideInterrupted";
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  const Result<Caller> caller = Admit(needs_.gate, *context, kMethod, request);
  const Status good = caller ? CheckRequest(needs_, *request) : Status();
  if (!caller || !good) {
    reactor->Finish(ToGrpcStatus(caller ? good.error() : caller.error()));
    return reactor;
  }
  const auto begin = std::chrono::steady_clock::now();
  const auto end = [reactor, kMethod, begin, who = *caller](const grpc::Status& status) {
    LogCall(kMethod, who, status, std::chrono::steady_clock::now() - begin);
    reactor->Finish(status);
  };
  const auto confirmed = [this, request, response, end, who = *caller] {
    if (request->decision() != v1::DecideInterruptedRequest::DECISION_RESTART)
      return end(grpc::Status::OK);
    book_.Again(request->name(), who.identity, request->request_id(), false,
                [response, end](const Result<v1::Job>& job) {
                  if (!job) return end(ToGrpcStatus(job.error()));
                  response->set_job(job->name());
                  end(grpc::Status::OK);
                });
  };
  const auto decide = [this, request, response, end, confirmed, who = *caller] {
    const Result<std::string> machine = book_.MachineToDecide(*request);
    if (!machine) return end(ToGrpcStatus(machine.error()));
    if (request->decision() == v1::DecideInterruptedRequest::DECISION_RESUME_AT_STEP)
      return ResumeAtStep(*request, *machine, who.identity, *response, end);
    v1::HostOrder order;
    order.set_caller(who.identity);
    order.set_reason(request->reason());
    order.set_for_job(request->name());
    v1::ConfirmMachineRequest& confirm = *order.mutable_confirm();
    confirm.set_control_token(request->control_token());
    confirm.set_request_id(request->request_id());
    confirm.add_confirmations(v1::CONFIRMATION_INSPECTED);
    runs_.AskMachine(*machine, std::move(order),
                     [this, end, confirmed](const Result<v1::HostOrderAnswer>& answer) {
                       if (!answer) return end(ToGrpcStatus(answer.error()));
                       if (answer->has_refusal()) return end(RefusalOf(*answer));
                       needs_.executor.Post(confirmed);
                     });
  };
  if (!needs_.executor.TryPost(decide)) reactor->Finish(ToGrpcStatus(LaneFull()));
  return reactor;
}

// A new job goes on; where its start is refused it ends, and the machine waits for another
// decision.
void JobService::ResumeAtStep(const v1::DecideInterruptedRequest& request,
                              const std::string& machine, const std::string& caller,
                              v1::DecideInterruptedResponse& response,
                              const std::function<void(const grpc::Status&)>& end) {
  v1::HostOrder order;
  order.set_caller(caller);
  order.set_reason(request.reason());
  v1::StartAtStepRequest& start = *order.mutable_continue_job()->mutable_start();
  start.set_machine(MachineName(machine));
  start.set_control_token(request.control_token());
  start.set_request_id(request.request_id());
  start.set_preview_token(request.preview_token());
  *start.mutable_confirmations() = request.confirmations();
  if (request.has_halt_at_entry()) start.set_halt_at_entry(request.halt_at_entry());
  const auto made = [this, order, &response, end](const Result<v1::Job>& job) {
    if (!job) return end(ToGrpcStatus(job.error()));
    needs_.executor.Post([this, order, name = job->name(), &response, end] {
      const Result<std::int64_t> id = ParseJobName(name);
      const auto answered = [name, &response, end](const Result<v1::HostOrderAnswer>& answer) {
        if (!answer) return end(ToGrpcStatus(answer.error()));
        if (answer->has_refusal()) return end(RefusalOf(*answer));
        response.set_job(name);
        end(grpc::Status::OK);
      };
      runs_.BeginByPerson(*id, order, answered);
    });
  };
  book_.Again(request.name(), caller, request.request_id(), true, made);
}

void JobService::TellCancel(const storage::JobRecord& job, const Caller& caller) {
  if (job.kind == storage::kRunKind && job.state == storage::JobState::kRunning)
    return runs_.Abort(JobName(job.id), caller.identity, {});
  dispatcher_.TellCancel(job, caller.identity);
}

// Stops stand behind nothing: what the worker of a running job is to do goes out on the thread of
// the call; the store is asked afterwards, and for a job that this server has given to nobody.
template <class Request, class Response>
grpc::ServerUnaryReactor* JobService::Order(grpc::CallbackServerContext* context,
                                            std::string_view method, const Request& request,
                                            v1::WorkerControl::Kind kind, Response* response) {
  if (!runs_.MachineOf(request.name()).empty())
    return OrderRun(context, method, request, OrderOf(kind, request), response);
  const Result<std::int64_t> id = ParseJobName(request.name());
  auto ordered = std::make_shared<bool>(false);
  return AnswerAfter(
      needs_, context, request, method,
      [this, id, kind, ordered, &request, response](const Caller& caller) {
        *ordered =
            id && dispatcher_.OrderAtOnce(*id, {kind, 0.0, caller.identity, request.request_id()});
        if (*ordered) NoteActed(response);
      },
      [this, id, &request, kind, ordered, response](const Caller& caller) {
        if (!id) return ToGrpcStatus(id.error());
        if (!*ordered) {
          Status late =
              dispatcher_.Control(*id, {kind, 0.0, caller.identity, request.request_id()});
          // It may wait in the queue.
          if (!late && late.error().code == ErrorCode::kCellPrecondition)
            late = OrderWaiting(request.name(), kind, caller.identity);
          if (!late) return ToGrpcStatus(late.error());
          NoteActed(response);
        }
        return Give(request.name(), JobOf(response));
      });
}

Status JobService::OrderWaiting(const std::string& name, v1::WorkerControl::Kind kind,
                                const std::string& caller) {
  Result<v1::Job> job = InvalidArgument(name);
  if (kind == v1::WorkerControl::KIND_HOLD) {
    job = book_.HoldBack(name, caller);
  } else if (kind == v1::WorkerControl::KIND_RESUME) {
    job = book_.LetGo(name, caller);
  } else {
    return Error{ErrorCode::kCellPrecondition, name + " does not run", {}};
  }
  return job ? Status() : Status(job.error());
}

grpc::ServerUnaryReactor* JobService::HoldJob(grpc::CallbackServerContext* context,
                                              const v1::HoldJobRequest* request,
                                              v1::HaltJobResponse* response) {
  return Order(context, "JobService/HoldJob", *request, v1::WorkerControl::KIND_HOLD, response);
}

grpc::ServerUnaryReactor* JobService::StopJob(grpc::CallbackServerContext* context,
                                              const v1::StopJobRequest* request,
                                              v1::HaltJobResponse* response) {
  return Order(context, "JobService/StopJob", *request, v1::WorkerControl::KIND_STOP, response);
}

grpc::ServerUnaryReactor* JobService::ResumeJob(grpc::CallbackServerContext* context,
                                                const v1::ResumeJobRequest* request,
                                                v1::Job* response) {
  return Order(context, "JobService/ResumeJob", *request, v1::WorkerControl::KIND_RESUME, response);
}

grpc::ServerUnaryReactor* JobService::SetJobOverride(grpc::CallbackServerContext* context,
                                                     const v1::SetJobOverrideRequest* request,
                                                     v1::Job* response) {
  if (!runs_.MachineOf(request->name()).empty()) {
    v1::HostOrder order;
    v1::SetOverrideRequest& change = *order.mutable_override();
    change.set_control_token(request->control_token());
    change.set_request_id(request->request_id());
    change.set_override_percent(request->override_percent());
    return OrderRun(context, "JobService/SetJobOverride", *request, std::move(order), response);
  }
  return Answer(needs_, context, *request, "JobService/SetJobOverride",
                [this, request, response](const Caller& caller) {
                  const double percent = request->override_percent();
                  const Result<std::int64_t> id = ParseJobName(request->name());
                  if (!id) return ToGrpcStatus(id.error());
                  if (const Status valid = book_.CheckOverride(request->name(), percent); !valid)
                    return ToGrpcStatus(valid.error());
                  const Status ordered =
                      dispatcher_.Control(*id, {v1::WorkerControl::KIND_OVERRIDE, percent,
                                                caller.identity, request->request_id()});
                  return ordered ? Give(request->name(), response) : ToGrpcStatus(ordered.error());
                });
}

}  // namespace rmlcell::server
