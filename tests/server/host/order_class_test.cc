// What acts first, what is written first (live.md 3.20): of every order there is.
#include "server/host/order_class.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

namespace rmlcell::server {
namespace {

v1::HostOrder OrderOf(const google::protobuf::FieldDescriptor& request) {
  v1::HostOrder order;
  order.GetReflection()->MutableMessage(&order, &request);
  return order;
}

// LIVE-3.20: STOP and the like act first; what can take a machine into motion, or makes that
// possible, is written before it acts; the rest acts, and is answered when it is written.
TEST(OrderClass, OfEachOrder) {
  using enum OrderClass;
  const std::map<std::string, OrderClass> classes = {{"stop", kActsFirst},
                                                     {"hold", kActsFirst},
                                                     {"emergency_stop", kActsFirst},
                                                     {"abort", kActsFirst},
                                                     {"disarm", kActsFirst},
                                                     {"start", kWrittenFirst},
                                                     {"start_at_step", kWrittenFirst},
                                                     {"run_job", kWrittenFirst},
                                                     {"continue_job", kWrittenFirst},
                                                     {"resume", kWrittenFirst},
                                                     {"zero", kWrittenFirst},
                                                     {"mode", kWrittenFirst},
                                                     {"arm", kWrittenFirst},
                                                     {"acknowledge_alarm", kWrittenFirst},
                                                     {"confirm", kWrittenFirst},
                                                     {"acquire_control", kWrittenFirst},
                                                     {"release_control", kWrittenBehind},
                                                     {"override", kWrittenBehind},
                                                     {"factor", kWrittenBehind},
                                                     {"write_variables", kWrittenBehind},
                                                     {"inputs", kWrittenBehind},
                                                     {"gates", kWrittenBehind},
                                                     {"breakpoints", kWrittenBehind},
                                                     {"simulation", kWrittenBehind},
                                                     {"create_session", kWrittenBehind},
                                                     {"renew_control", kAsks},
                                                     {"read_variables", kAsks},
                                                     {"run_state", kAsks},
                                                     {"preview_start", kAsks},
                                                     {"recording", kAsks},
                                                     {"panel_heartbeat", kAsks},
                                                     {"handbox_heartbeat", kAsks},
                                                     {"delete_session", kAsks},
                                                     {"undo_teaching", kAsks},
                                                     {"panel_key", kWrittenFirst},
                                                     {"key", kWrittenFirst}};
  const auto* requests = v1::HostOrder::descriptor()->FindOneofByName("request");
  for (int i = 0; i < requests->field_count(); ++i) {
    const auto& field = *requests->field(i);
    const auto expected = classes.find(std::string(field.name()));
    ASSERT_NE(expected, classes.end()) << field.name() << " has no class in this table";
    EXPECT_EQ(ClassOf(OrderOf(field)), expected->second) << field.name();
  }
  EXPECT_EQ(static_cast<std::size_t>(requests->field_count()), classes.size());
}

// LIVE-3.20, LIVE-7.04: of keys those that halt act first, those that are let go at once.
TEST(OrderClass, OfKeys) {
  const auto of = [](const char* key, v1::KeyAction action) {
    v1::HostOrder order;
    order.mutable_key()->set_key(key);
    order.mutable_key()->set_action(action);
    return order;
  };
  EXPECT_EQ(ClassOf(of("STOP", v1::KEY_ACTION_TAP)), OrderClass::kActsFirst);
  EXPECT_EQ(ClassOf(of("EMERGENCY_STOP", v1::KEY_ACTION_PRESS)), OrderClass::kActsFirst);
  EXPECT_EQ(ClassOf(of("X+", v1::KEY_ACTION_PRESS)), OrderClass::kWrittenFirst);
  EXPECT_EQ(ClassOf(of("X+", v1::KEY_ACTION_RELEASE)), OrderClass::kLetsGo);
  EXPECT_EQ(ClassOf(of("COVER", v1::KEY_ACTION_TAP)), OrderClass::kLetsGo);
  EXPECT_EQ(ClassOf(of("OVERRIDE_MINUS", v1::KEY_ACTION_TAP)), OrderClass::kLetsGo);
  EXPECT_EQ(ClassOf(of("OVERRIDE_PLUS", v1::KEY_ACTION_TAP)), OrderClass::kWrittenFirst);
  EXPECT_TRUE(BeginsMotion(of("X+", v1::KEY_ACTION_PRESS)));
  EXPECT_FALSE(BeginsMotion(of("X+", v1::KEY_ACTION_RELEASE)));
}

// LIVE-3.20: a gate begins a run, and the other inputs do not.
TEST(OrderClass, OfInputs) {
  v1::HostOrder order;
  order.mutable_inputs()->add_inputs()->set_door_open(false);
  EXPECT_EQ(ClassOf(order), OrderClass::kWrittenBehind);
  order.mutable_inputs()->mutable_inputs(0)->set_door_open(true);  // it stops what cuts
  EXPECT_EQ(ClassOf(order), OrderClass::kLetsGo);
  EXPECT_FALSE(BeginsMotion(order));
  order.mutable_inputs()->add_inputs()->set_gate(2);
  EXPECT_EQ(ClassOf(order), OrderClass::kWrittenFirst);
  EXPECT_TRUE(BeginsMotion(order));
}

// LIVE-3.20: STOP goes before all that waits, and takes back what would begin a motion.
TEST(OrderClass, AStopTakesBackWhatWaits) {
  std::deque<v1::HostResponse> messages(4);
  messages[0].mutable_order()->mutable_start();
  messages[1].mutable_order()->mutable_read_variables();
  messages[2].mutable_order()->mutable_stop();
  messages[3].mutable_order()->mutable_resume();
  const auto taken = StopFirst(messages);
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_TRUE(taken[0].has_start());
  ASSERT_EQ(messages.size(), 3U);
  EXPECT_TRUE(messages[0].order().has_stop());
  EXPECT_TRUE(messages[1].order().has_read_variables());
  EXPECT_TRUE(messages[2].order().has_resume());  // it came behind
}

}  // namespace
}  // namespace rmlcell::server
