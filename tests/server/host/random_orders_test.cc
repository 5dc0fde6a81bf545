// Orders of every kind with any fields, at any time, with crashes between (live.md 10.01, 10.06).
#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "server/host/order_class.h"
#include "server/host/recovered.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

constexpr const char* kTeaching =
    "VI[3] = 0\n10 VI[3] = VI[3] + 1\nMOVE (1500., 500., -400., 0., 0.)\nOL[3] = ON\nDELAY 0.2\n"
    "MOVE (1600., 500., -400., 0., 0.)\nOL[3] = OFF\nIF VI[3] < 4 THEN 10\n";

// Messages whose fields are what a client might send, or should not.
class AnyMessages {
 public:
  explicit AnyMessages(std::uint32_t seed) : random_(seed) {}

  int Below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }

  std::string token;
  std::string session;
  std::int64_t next_key = 1;
  WallTime now{};

  v1::HostOrder Order() {
    v1::HostOrder order;
    const auto& fields = *order.GetDescriptor()->FindOneofByName("request");
    const FieldDescriptor* field = fields.field(Below(fields.field_count()));
    if (field->name() == "preview_start") field = fields.field(0);  // worked out beside the machine
    Fill(*order.GetReflection()->MutableMessage(&order, field), 0);
    if (Below(8) == 0) order.set_for_job(Text("job"));
    return order;
  }

 private:
  template <class Values>
  auto OneOf(const Values& values) {
    return values[static_cast<std::size_t>(Below(static_cast<int>(values.size())))];
  }

  std::string Text(const std::string& field) {
    static const std::array<const char*, 22> kKeys = {
        "START", "STOP",      "HOLD",       "SHIFT",    "ZERO",  "HOME", "JOG_ROB", "X+",
        "Z-",    "MODE_LEFT", "MODE_RIGHT", "REC",      "JOB",   "1",    "2",       "ENT",
        "MOV",   "DEL",       "PAUSE",      "CONTINUE", "COVER", "none"};
    if (field == "control_token") return Below(10) == 0 ? "another" : token;
    if (field == "session" || field == "name") return Below(10) == 0 ? "none" : session;
    if (field == "request_id") return Below(6) == 0 ? "" : "id " + std::to_string(Below(5'000));
    if (field == "key" || field == "keys_down") return OneOf(kKeys);
    if (field == "job" || field == "continues") return "jobs/" + std::to_string(Below(3));
    if (field == "variable" || field == "variables")
      return OneOf(std::array<const char*, 6>{"VR[0]", "VI[3]", "OL[3]", "IL[20]", "X", "VX[7]"});
    return OneOf(std::array<const char*, 3>{"", "a text", "VR[1]"});
  }
  double Number() {
    return OneOf(std::array<double, 10>{-1.0, 0.0, 0.3, 1.0, 10.0, 50.0, 100.0, 1e9,
                                        std::numeric_limits<double>::infinity(),
                                        std::numeric_limits<double>::quiet_NaN()});
  }
  std::int64_t Whole(const std::string& field) {
    if (field == "number") return Below(4) == 0 ? Below(20) : next_key++;
    if (field == "program" || field == "slot") return OneOf(std::array<int, 5>{0, 5, 6, 100, -1});
    return OneOf(std::array<std::int64_t, 8>{0, 1, 2, 3, 20, -1, 1'000'000'000'000,
                                             std::numeric_limits<std::int64_t>::min()});
  }

  void Fill(Message& message, int depth) {
    const auto& type = *message.GetDescriptor();
    if (type.full_name() == "google.protobuf.Timestamp") {
      static_cast<google::protobuf::Timestamp&>(message) = Stamp(now);
      return;
    }
    for (int i = 0; i < type.field_count(); ++i) {
      const FieldDescriptor& field = *type.field(i);
      if (field.is_map() || (field.real_containing_oneof() != nullptr && Below(3) != 0)) continue;
      if (!field.is_repeated()) {
        if (Below(5) != 0) Set(message, field, depth);
        continue;
      }
      for (int count = Below(3); count > 0; --count) Set(message, field, depth);
    }
  }

  void Set(Message& message, const FieldDescriptor& field, int depth) {
    const auto& to = *message.GetReflection();
    const bool more = field.is_repeated();
    switch (field.cpp_type()) {
      case FieldDescriptor::CPPTYPE_STRING:
        if (field.type() == FieldDescriptor::TYPE_BYTES) {
          more ? to.AddString(&message, &field, "PU0,0;")
               : to.SetString(&message, &field, "PU0,0;");
        } else {
          std::string text = Text(field.name());
          more ? to.AddString(&message, &field, text) : to.SetString(&message, &field, text);
        }
        break;
      case FieldDescriptor::CPPTYPE_DOUBLE:
        more ? to.AddDouble(&message, &field, Number()) : to.SetDouble(&message, &field, Number());
        break;
      case FieldDescriptor::CPPTYPE_INT32: {
        const auto value = static_cast<std::int32_t>(Whole(field.name()));
        more ? to.AddInt32(&message, &field, value) : to.SetInt32(&message, &field, value);
        break;
      }
      case FieldDescriptor::CPPTYPE_INT64:
        more ? to.AddInt64(&message, &field, Whole(field.name()))
             : to.SetInt64(&message, &field, Whole(field.name()));
        break;
      case FieldDescriptor::CPPTYPE_BOOL:
        more ? to.AddBool(&message, &field, Below(2) == 0)
             : to.SetBool(&message, &field, Below(2) == 0);
        break;
      case FieldDescriptor::CPPTYPE_ENUM: {
        const int value =
            Below(12) == 0
                ? 99
                : field.enum_type()->value(Below(field.enum_type()->value_count()))->number();
        more ? to.AddEnumValue(&message, &field, value) : to.SetEnumValue(&message, &field, value);
        break;
      }
      case FieldDescriptor::CPPTYPE_MESSAGE:
        if (depth >= 4) break;
        Fill(more ? *to.AddMessage(&message, &field) : *to.MutableMessage(&message, &field),
             depth + 1);
        break;
      default:
        break;
    }
  }

  std::mt19937 random_;
};

class RandomOrders : public HostMachineTest {
 protected:
  void MakeOf(const std::string& family, HostMachine::Setup setup = {}) {
    setup.name = "machines/any";
    setup.host = "workshop/1";
    setup.fence = ++fence_;
    setup.family = families::FindFamily(family);
    setup.profile = family == "rml1" ? "srm-20" : "";
    const auto parameters = machine::MakeParameters(*setup.family, setup.profile, {});
    machine::StoredProgram program{.name = "p", .object = machine::Bytes::Of(kSquare)};
    if (family != "rml1") {
      auto made = setup.family->Translate({.name = "5.S", .bytes = kTeaching}, *parameters,
                                          {.advice = false, .source = true});
      ASSERT_TRUE(made.ok);
      program.object = machine::Bytes::Of(made.object);
    }
    setup.memory.programs[5] = program;
    auto made = HostMachine::Make(std::move(setup), now_,
                                  [this] { return "token " + std::to_string(++tokens_); });
    ASSERT_TRUE(made) << made.error().detail;
    host_ = *std::move(made);
    host_->Begin({}, now_);
    last_time_ = 0;
  }
  // What a crash leaves: some of what was written.
  void Crash(const std::string& family, int keep) {
    disk_.resize(std::min(disk_.size(), static_cast<std::size_t>(keep)));
    MakeOf(family, SetupOf(RecoveredFrom(v1::HostWelcome(), disk_)));
  }
  static bool Moves(v1::MachineState state) {
    return state == v1::MACHINE_STATE_JOGGING || state == v1::MACHINE_STATE_RUNNING ||
           state == v1::MACHINE_STATE_STOPPING;
  }
  static std::vector<double> Axes(const v1::MachineStatus& status) {
    std::vector<double> axes;
    for (const v1::AxisValue& axis : status.axes()) axes.push_back(axis.value());
    return axes;
  }
  // A machine that stands stays where it stands, and time does not fall. LIVE-2.04
  void Look(const v1::MachineStatus& before) {
    const v1::MachineStatus now = host_->StatusAt(now_);
    ASSERT_GE(now.virtual_time_ns(), last_time_);
    last_time_ = now.virtual_time_ns();
    for (const v1::AxisValue& axis : now.axes()) ASSERT_TRUE(std::isfinite(axis.value()));
    if (!Moves(before.state()) && !Moves(now.state())) {
      ASSERT_EQ(Axes(before), Axes(now)) << now.ShortDebugString();
    }
  }
  void Play(const std::string& family, std::uint32_t seed, int orders) {
    AnyMessages any(seed);
    MakeOf(family);
    for (int i = 0; i < orders && !HasFatalFailure(); ++i) {
      if (i % 40 == 0) {
        any.token = Control(v1::ControlLease::ON_LOSS_GO_ON);
        v1::HostOrder open;
        open.mutable_create_session()->set_control_token(any.token);
        any.session = Do(open).session().name();
        any.next_key = 1;
      }
      any.now = now_.wall;
      const v1::MachineStatus before = host_->StatusAt(now_);
      v1::HostOrder order = any.Order();
      order.set_caller("anna");
      order.set_number(++number_);
      const bool waits = host_->WaitsForKeys(order, now_);
      if (!waits) static_cast<void>(host_->Do(order, now_));
      if (BeginsMotion(order) || waits) {
        Pass(10ms);
      } else {
        Look(before);
      }
      const v1::MachineStatus stands = host_->StatusAt(now_);
      Pass(std::chrono::milliseconds(10 * any.Below(30)));
      if (stands.state() == host_->StatusAt(now_).state() && !Moves(stands.state())) Look(stands);
      for (v1::JournalEntry& entry : host_->TakeEntries(now_, any.Below(2) == 0))
        disk_.push_back(std::move(entry));
      static_cast<void>(host_->TakeEdits());
      if (any.Below(200) == 0) Crash(family, static_cast<int>(disk_.size()) - any.Below(20));
      if (disk_.size() > 2'000) disk_.erase(disk_.begin(), disk_.end() - 1'000);
    }
  }
  std::vector<v1::JournalEntry> disk_;
  std::int64_t fence_ = 6;
  std::int64_t last_time_ = 0;
};

// LIVE-10.06, LIVE-2.04
TEST_F(RandomOrders, AMillTakesWhateverComes) {
  for (std::uint32_t seed = 1; seed <= 3 && !HasFatalFailure(); ++seed) Play("rml1", seed, 1'500);
}

// LIVE-10.06, LIVE-2.04
TEST_F(RandomOrders, AnOptimoTakesWhateverComes) {
  for (std::uint32_t seed = 1; seed <= 3 && !HasFatalFailure(); ++seed) Play("optimo", seed, 1'500);
}

// LIVE-10.06: whatever bytes a journal has, what can be read of it is read.
TEST(RandomJournals, AnyBytesAreRead) {
  std::mt19937 random(7);
  std::vector<v1::JournalEntry> entries(20);
  for (int i = 0; i < 20; ++i) {
    entries[static_cast<std::size_t>(i)].set_sequence(i + 1);
    entries[static_cast<std::size_t>(i)].mutable_mark()->set_state(std::string(100, 'x'));
  }
  const std::string whole = RecordsOf(entries);
  for (int round = 0; round < 2'000; ++round) {
    std::string bytes = whole;
    const int changes = 1 + static_cast<int>(random() % 5);
    for (int i = 0; i < changes; ++i) bytes[random() % bytes.size()] = static_cast<char>(random());
    bytes.resize(random() % (bytes.size() + 1));
    const ReadRecords read = ReadJournal(bytes);
    ASSERT_EQ(read.entries.size(), read.ends.size());
    for (std::size_t i = 0; i < read.entries.size(); ++i) {
      ASSERT_EQ(read.entries[i].sequence(), static_cast<std::int64_t>(i + 1));
      ASSERT_LE(read.ends[i], static_cast<std::int64_t>(bytes.size()));
    }
    static_cast<void>(SetupOf(RecoveredFrom(v1::HostWelcome(), read.entries)));
  }
}

}  // namespace
}  // namespace rmlcell::server
