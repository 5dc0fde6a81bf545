#include "server/web/session_table.h"

#include <gtest/gtest.h>

#include <optional>

namespace rmlcell::web::testing {
namespace {

using std::chrono::milliseconds;

// What a connection holds, and what the table says while that goes.
struct HeldSocket {
  SessionTable& table;
  std::optional<bool>& empty;
  ~HeldSocket() { empty = table.WaitUntilEmpty(milliseconds(0)); }
};

class TabledSession final : public OpenSession {
 public:
  TabledSession(SessionTable& table, std::optional<bool>& empty)
      : OpenSession(table), table_(table), socket_{table, empty} {
    table_.Add(this);
  }
  ~TabledSession() override { table_.Remove(this); }
  void End(bool at_once) override { ended_at_once = at_once; }

  std::optional<bool> ended_at_once;

 private:
  SessionTable& table_;
  HeldSocket socket_;
};

// Whoever has waited frees what sockets live in: the last thread to hold one may be any.
TEST(SessionTableTest, IsEmptyWhenAllThatAConnectionHeldIsGone) {
  SessionTable table;
  std::optional<bool> empty;
  {
    TabledSession session(table, empty);
    EXPECT_EQ(table.size(), 1U);
    EXPECT_FALSE(table.WaitUntilEmpty(milliseconds(0)));
    table.EndAll(true);
    EXPECT_EQ(session.ended_at_once, true);
  }
  EXPECT_EQ(empty, false);
  EXPECT_EQ(table.size(), 0U);
  EXPECT_TRUE(table.WaitUntilEmpty(milliseconds(0)));
}

// Its connection is half gone by then.
TEST(SessionTableTest, TellsNothingToWhatHasLeft) {
  SessionTable table;
  std::optional<bool> empty;
  TabledSession session(table, empty);
  table.Remove(&session);
  table.EndAll(false);
  EXPECT_EQ(session.ended_at_once, std::nullopt);
  EXPECT_EQ(table.size(), 1U);
}

}  // namespace
}  // namespace rmlcell::web::testing
