#include "tests/storage/failing_statements.h"

#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <string_view>
#include <utility>

namespace rmlcell::storage::failing_statements {
namespace {

struct Plan {
  std::mutex mutex;
  bool armed = false;
  Of of = Of::kWriter;
  int left = 0;
  std::string text;  // of the statement that fails; empty: it has not come yet
};

Plan& ThePlan() {
  static Plan plan;  // SQLite's callbacks have no other place to find it
  return plan;
}

bool MayFail(Of of, std::string_view text) {
  constexpr std::array<std::string_view, 5> kBeginnings = {"SELECT ", "INSERT ", "UPDATE ",
                                                           "DELETE ", "PRAGMA user_version"};
  constexpr std::array<std::string_view, 4> kSweeping = {
      "SELECT blob FROM upload", "SELECT id FROM blob WHERE refs = 0",
      "UPDATE blob SET sha256 = NULL", "DELETE FROM blob"};
  const auto begins = [&](std::string_view beginning) { return text.starts_with(beginning); };
  return std::ranges::any_of(kBeginnings, begins) &&
         std::ranges::any_of(kSweeping, begins) == (of == Of::kSweeping);
}

int StatementBegins(unsigned, void* connection, void* statement, void*) {
  auto* const handle = static_cast<sqlite3*>(connection);
  const std::string_view text = sqlite3_sql(static_cast<sqlite3_stmt*>(statement));
  Plan& plan = ThePlan();
  const std::lock_guard lock(plan.mutex);
  const bool reads = sqlite3_db_readonly(handle, "main") == 1;
  if (!plan.armed || reads != (plan.of == Of::kReaders) || !MayFail(plan.of, text)) return 0;
  if (plan.text.empty() && plan.left-- == 0) plan.text = text;
  if (plan.text == text) sqlite3_interrupt(handle);
  return 0;
}

int ConnectionOpens(sqlite3* handle, char**, const void*) {
  return sqlite3_trace_v2(handle, SQLITE_TRACE_STMT, StatementBegins, handle);
}

}  // namespace

void Register() { sqlite3_auto_extension(reinterpret_cast<void (*)()>(ConnectionOpens)); }

void Fail(Of of, int number) {
  Plan& plan = ThePlan();
  const std::lock_guard lock(plan.mutex);
  plan.armed = true;
  plan.of = of;
  plan.left = number;
  plan.text.clear();
}

std::string Heal() {
  Plan& plan = ThePlan();
  const std::lock_guard lock(plan.mutex);
  plan.armed = false;
  return std::exchange(plan.text, {});
}

}  // namespace rmlcell::storage::failing_statements
