#include "server/host/further_lines.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <condition_variable>
#include <optional>
#include <thread>
#include <utility>

#include "server/host/host_clock.h"
#include "server/host/host_line.h"
#include "server/host/order_class.h"

namespace rmlcell::server {
namespace {

constexpr std::chrono::milliseconds kLooksAgain{500};
constexpr std::size_t kAskedMax = 10'000;

}  // namespace

// Is looked for again and again, on a thread of its own.
class FurtherLines::Line {
 public:
  Line(FurtherLines& lines, std::string server)
      : lines_(lines), server_(std::move(server)), thread_([this] { Run(); }) {}
  ~Line() {
    End();
    thread_.join();
  }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

  // It is looked for no more. Returns at once: a server may be asked at this moment.
  void End() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    changed_.notify_all();
  }
  bool over() const { return over_; }

  const std::string& server() const { return server_; }
  std::int64_t count() const { return count_; }
  bool Stands(std::int64_t count) const {
    const std::lock_guard lock(mutex_);
    return line_ != nullptr && count == count_;
  }

  // On the line that is the `count`th alone; 0: on whichever stands.
  void Send(v1::HostRequest message, std::int64_t count = 0) {
    const std::lock_guard lock(mutex_);
    if (line_ != nullptr && (count == 0 || count == count_)) line_->Send(std::move(message));
  }
  void SendStatus(const v1::MachineStatus& status) {
    const std::lock_guard lock(mutex_);
    if (line_ != nullptr) line_->SendStatus(status);
  }
  bool IsHeard() const {
    const std::lock_guard lock(mutex_);
    return line_ != nullptr &&
           Now().steady - std::chrono::nanoseconds(heard_at_) <= lines_.silence_;
  }

 private:
  void Run() {
    while (!Ends(std::chrono::milliseconds(0))) {
      Stand();
      if (Ends(kLooksAgain)) break;
    }
    over_ = true;
  }
  bool Ends(std::chrono::milliseconds within) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, within, [this] { return ending_; });
  }

  // Until the line is gone.
  void Stand() {
    {
      const std::lock_guard lock(mutex_);
      gone_ = false;
      stood_ = false;
      ++count_;
    }
    auto joined = HostLine::Join(
        server_, lines_.hello(), [this](v1::HostResponse message) { Hear(std::move(message)); },
        [this] {
          const std::lock_guard lock(mutex_);
          gone_ = true;
          changed_.notify_all();
        });
    if (!joined) return;
    spdlog::info("a line to {}, too", server_);
    std::unique_ptr<HostLine> ended;
    {
      const std::lock_guard lock(mutex_);
      line_ = std::move(joined->line);
      stood_ = true;
      heard_at_ = Now().steady.count();
    }
    changed_.notify_all();
    lines_.NoteCome();
    {
      std::unique_lock lock(mutex_);
      while (!ending_ && !gone_ &&
             Now().steady - std::chrono::nanoseconds(heard_at_) <= lines_.silence_)
        changed_.wait_for(lock, lines_.silence_ / 2);
      ended = std::move(line_);
    }
    ended->Cut();  // what it did not take is of no use to anybody later
    spdlog::info("no line to {}", server_);
  }

  void Hear(v1::HostResponse message) {
    heard_at_ = Now().steady.count();
    if (!message.has_order() && !message.has_stop()) return;
    {
      // One that comes with the welcome is not taken for one of a line that is gone.
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stood_; });
    }
    lines_.Hear(*this, std::move(message));
  }

  FurtherLines& lines_;
  const std::string server_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::unique_ptr<HostLine> line_;         // guarded by mutex_
  std::atomic<std::int64_t> count_{0};     // of the lines to this server
  std::atomic<std::int64_t> heard_at_{0};  // ns
  bool gone_ = false;                      // guarded by mutex_
  bool stood_ = false;                     // guarded by mutex_; of the newest line
  bool ending_ = false;                    // guarded by mutex_
  std::atomic<bool> over_ = false;
  std::thread thread_;  // the last member: it begins with the others made
};

FurtherLines::FurtherLines(std::function<void()> wake, std::chrono::nanoseconds silence)
    : wake_(std::move(wake)), silence_(silence) {}

FurtherLines::~FurtherLines() = default;

v1::HostHello FurtherLines::hello() const {
  const std::lock_guard lock(mutex_);
  return hello_;
}

void FurtherLines::Keep(const std::vector<std::string>& servers, v1::HostHello hello) {
  {
    const std::lock_guard lock(mutex_);
    hello_ = std::move(hello);
  }
  std::erase_if(ended_, [](const auto& line) { return line->over(); });
  for (auto line = lines_.begin(); line != lines_.end();) {
    if (std::ranges::find(servers, line->first) != servers.end()) {
      ++line;
      continue;
    }
    line->second->End();
    ended_.push_back(std::move(line->second));
    line = lines_.erase(line);
  }
  for (const std::string& server : servers) {
    if (lines_.size() >= kServersMax) return;
    if (!lines_.contains(server)) lines_.emplace(server, std::make_unique<Line>(*this, server));
  }
}

void FurtherLines::Hear(Line& line, v1::HostResponse message) {
  {
    const std::lock_guard lock(mutex_);
    if (message.has_order()) {
      // One that is not answered is given up by its server.
      if (asked_.size() >= kAskedMax) asked_.erase(std::prev(asked_.end()));
      v1::HostOrder& order = *message.mutable_order();
      asked_[next_] = {.server = line.server(), .line = line.count(), .number = order.number()};
      order.set_number(next_--);
    }
    messages_.Add(std::move(message));
  }
  wake_();
}

// What a server has given up begins nothing; what halts acts all the same.
WaitingMessages::Taken FurtherLines::TakeMessages() {
  WaitingMessages::Taken taken;
  {
    const std::lock_guard lock(mutex_);
    taken = messages_.Take();
  }
  std::erase_if(taken.messages, [this](const v1::HostResponse& message) {
    return message.has_order() && !Halts(message) && !IsAskedFor(message.order().number());
  });
  return taken;
}

bool FurtherLines::IsAskedFor(std::int64_t number) const {
  if (number >= 0) return true;
  Asked asked;
  {
    const std::lock_guard lock(mutex_);
    const auto found = asked_.find(number);
    if (found == asked_.end()) return false;
    asked = found->second;
  }
  const auto line = lines_.find(asked.server);
  return line != lines_.end() && line->second->Stands(asked.line);
}

void FurtherLines::NoteCome() {
  {
    const std::lock_guard lock(mutex_);
    fresh_ = true;
  }
  wake_();
}

bool FurtherLines::TakeFresh() {
  const std::lock_guard lock(mutex_);
  return std::exchange(fresh_, false);
}

bool FurtherLines::Answer(const v1::HostOrderAnswer& answer) {
  if (answer.number() >= 0) return false;
  std::optional<Asked> asked;
  {
    const std::lock_guard lock(mutex_);
    const auto found = asked_.find(answer.number());
    if (found != asked_.end()) {
      asked = std::move(found->second);
      asked_.erase(found);
    }
  }
  const auto line = asked ? lines_.find(asked->server) : lines_.end();
  if (line == lines_.end()) return true;
  v1::HostRequest request;
  *request.mutable_answer() = answer;
  request.mutable_answer()->set_number(asked->number);
  line->second->Send(std::move(request), asked->line);
  return true;
}

void FurtherLines::SendStatus(const v1::MachineStatus& status) {
  for (const auto& [server, line] : lines_) line->SendStatus(status);
}

void FurtherLines::SendPanel(const v1::HandboxPanel& panel) {
  for (const auto& [server, line] : lines_) {
    v1::HostRequest request;
    *request.mutable_panel() = panel;
    line->Send(std::move(request));
  }
}

bool FurtherLines::IsHeard() const {
  return std::ranges::any_of(lines_, [](const auto& one) { return one.second->IsHeard(); });
}

}  // namespace rmlcell::server
