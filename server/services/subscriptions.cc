#include "server/services/subscriptions.h"

#include <utility>

#include "server/base/names.h"
#include "server/jobs/job_filter.h"
#include "server/services/rates.h"

namespace rmlcell::server {
namespace {

// "machines/mill-1/programs/45" -> "machines/mill-1".
std::string_view MachineOf(std::string_view resource) {
  const std::size_t first = resource.find('/');
  if (first == std::string_view::npos) return resource;
  return resource.substr(0, resource.find('/', first + 1));
}

template <class Parse>
Status AddNames(const google::protobuf::RepeatedPtrField<std::string>& wanted, Parse parse,
                std::set<std::string, std::less<>>& names) {
  for (const std::string& name : wanted) {
    if (const auto parsed = parse(name); !parsed) return parsed.error();
    names.insert(name);
  }
  return {};
}

Error LaterSubscription(std::string_view what) {
  return {ErrorCode::kCellUnimplemented, "a subscription of " + std::string(what), {}};
}

}  // namespace

std::shared_ptr<const JobFacts> JobFactsBook::Of(std::int64_t job) {
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = kept_.find(job); found != kept_.end()) return found->second;
  }
  auto record = store_.GetJob(job);
  if (!record) return nullptr;
  auto facts = std::make_shared<const JobFacts>(JobFacts{.machine = std::move(record->machine),
                                                         .family = std::move(record->family),
                                                         .kind = std::move(record->kind),
                                                         .caller = std::move(record->caller),
                                                         .labels = std::move(record->labels)});
  const std::lock_guard lock(mutex_);
  kept_.emplace(job, facts);
  if (kept_.size() > kKept) kept_.erase(kept_.begin());
  return facts;
}

Result<CellSubscription> CellSubscription::Make(const v1::Subscription& wanted) {
  CellSubscription made;
  made.wanted_ = wanted;
  if (wanted.id().empty() || wanted.id().size() > kIdMax)
    return InvalidArgument("the id of a subscription has 1 to 64 characters");
  const Result<std::chrono::microseconds> interval = IntervalOf(wanted.max_rate_hz());
  if (!interval) return interval.error();
  made.interval_ = *interval;
  switch (wanted.what_case()) {
    case v1::Subscription::kJobs: {
      const v1::JobsSubscription& jobs = wanted.jobs();
      if (const Status good = AddNames(jobs.names(), ParseJobName, made.names_); !good)
        return good.error();
      if (const Status good = ApplyFilter(jobs.filter(), made.query_); !good) return good.error();
      const storage::JobQuery& query = made.query_;
      if (query.state || query.finished || !query.verdict.empty() || !query.text.empty() ||
          query.created_from || query.created_before) {
        return Error{
            ErrorCode::kCellBadFilter,
            "a subscription takes kind, machine, family, caller and label, which a job keeps",
            {}};
      }
      made.filtered_ = !jobs.filter().empty();
      if (made.filtered_ && !made.names_.empty())
        return InvalidArgument("a subscription of jobs takes names or a filter");
      break;
    }
    case v1::Subscription::kMachines:
      if (const Status good = AddNames(wanted.machines().names(), ParseMachineName, made.names_);
          !good)
        return good.error();
      break;
    case v1::Subscription::kProjects:
      if (const Status good = AddNames(wanted.projects().names(), ParseProjectName, made.names_);
          !good)
        return good.error();
      break;
    case v1::Subscription::kVariables:
      return LaterSubscription("variables");
    case v1::Subscription::kAudit:
      return LaterSubscription("the audit");
    case v1::Subscription::WHAT_NOT_SET:
      return InvalidArgument("subscription " + wanted.id() +
                             " says of nothing: jobs, machines or projects");
  }
  return made;
}

bool CellSubscription::WantsJob(std::int64_t job, JobFactsBook& facts) const {
  if (!names_.empty()) return names_.contains(JobName(job));
  if (!filtered_) return true;
  const auto of_job = facts.Of(job);
  if (of_job == nullptr) return true;  // it is gone, and nobody knows any more what it was
  return (query_.machine.empty() || query_.machine == of_job->machine) &&
         (query_.family.empty() || query_.family == of_job->family) &&
         (query_.kind.empty() || query_.kind == of_job->kind) &&
         (query_.caller.empty() || query_.caller == of_job->caller) &&
         (query_.label.empty() ||
          std::ranges::find(of_job->labels, query_.label) != of_job->labels.end());
}

bool CellSubscription::WantsMachine(std::string_view resource) const {
  return resource.starts_with("machines/") &&
         (names_.empty() || names_.contains(MachineOf(resource)));
}

bool CellSubscription::WantsEvent(const storage::EventRecord& event, JobFactsBook& facts) const {
  switch (wanted_.what_case()) {
    case v1::Subscription::kJobs:
      if (event.job > 0) {
        return !(wanted_.jobs().without_signals() && event.kind == "signal") &&
               WantsJob(event.job, facts);
      }
      return event.resource.starts_with("jobs/") && WantsJob(*ParseJobName(event.resource), facts);
    case v1::Subscription::kMachines:
      return event.job == 0 && WantsMachine(event.resource);
    case v1::Subscription::kProjects:
      return event.job == 0 && event.resource.starts_with("projects/") &&
             (names_.empty() || names_.contains(event.resource));
    default:
      return false;
  }
}

bool CellSubscription::WantsLatest(std::string_view resource, JobFactsBook& facts) const {
  switch (wanted_.what_case()) {
    case v1::Subscription::kJobs: {
      if (wanted_.jobs().events_only()) return false;
      const auto job = ParseJobName(resource);
      return job && WantsJob(*job, facts);
    }
    case v1::Subscription::kMachines:
      return !wanted_.machines().events_only() && WantsMachine(resource);
    default:
      return false;
  }
}

Result<std::vector<CellSubscription>> MakeSubscriptions(
    const google::protobuf::RepeatedPtrField<v1::Subscription>& wanted) {
  std::vector<CellSubscription> made;
  std::set<std::string_view> ids;
  for (const v1::Subscription& one : wanted) {
    Result<CellSubscription> subscription = CellSubscription::Make(one);
    if (!subscription) return subscription.error();
    if (!ids.insert(one.id()).second)
      return InvalidArgument("subscription " + one.id() + " stands twice");
    made.push_back(*std::move(subscription));
  }
  if (made.size() > kSubscriptionsMax) return InvalidArgument("more than 100 subscriptions");
  return made;
}

}  // namespace rmlcell::server
