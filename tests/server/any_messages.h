#pragma once

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <array>
#include <cstdint>
#include <limits>
#include <random>
#include <string>

#include "rmlcell/v1/host.pb.h"
#include "server/host/host_time.h"

namespace rmlcell::server {

// Messages whose fields are what a client might send, or should not.
class AnyMessages {
 public:
  explicit AnyMessages(std::uint32_t seed) : random_(seed) {}

  int Below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }

  std::string token;
  std::string session;
  std::int64_t next_key = 1;
  WallTime now{};

  // Its fields, and those of the messages in it.
  void Any(google::protobuf::Message& message) { Fill(message, 0); }

  v1::HostOrder Order() {
    v1::HostOrder order;
    const auto& fields = *order.GetDescriptor()->FindOneofByName("request");
    const google::protobuf::FieldDescriptor* field = fields.field(Below(fields.field_count()));
    if (field->name() == "preview_start") field = fields.field(0);  // worked out beside the machine
    Any(*order.GetReflection()->MutableMessage(&order, field));
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

  void Fill(google::protobuf::Message& message, int depth) {
    const auto& type = *message.GetDescriptor();
    if (type.full_name() == "google.protobuf.Timestamp") {
      static_cast<google::protobuf::Timestamp&>(message) = Stamp(now);
      return;
    }
    for (int i = 0; i < type.field_count(); ++i) {
      const google::protobuf::FieldDescriptor& field = *type.field(i);
      if (field.is_map() || (field.real_containing_oneof() != nullptr && Below(3) != 0)) continue;
      if (!field.is_repeated()) {
        if (Below(5) != 0) Set(message, field, depth);
        continue;
      }
      for (int count = Below(3); count > 0; --count) Set(message, field, depth);
    }
  }

  void Set(google::protobuf::Message& message, const google::protobuf::FieldDescriptor& field,
           int depth) {
    const auto& to = *message.GetReflection();
    const bool more = field.is_repeated();
    switch (field.cpp_type()) {
      case google::protobuf::FieldDescriptor::CPPTYPE_STRING:
        if (field.type() == google::protobuf::FieldDescriptor::TYPE_BYTES) {
          more ? to.AddString(&message, &field, "PU0,0;")
               : to.SetString(&message, &field, "PU0,0;");
        } else {
          std::string text = Text(field.name());
          more ? to.AddString(&message, &field, text) : to.SetString(&message, &field, text);
        }
        break;
      case google::protobuf::FieldDescriptor::CPPTYPE_DOUBLE:
        more ? to.AddDouble(&message, &field, Number()) : to.SetDouble(&message, &field, Number());
        break;
      case google::protobuf::FieldDescriptor::CPPTYPE_INT32: {
        const auto value = static_cast<std::int32_t>(Whole(field.name()));
        more ? to.AddInt32(&message, &field, value) : to.SetInt32(&message, &field, value);
        break;
      }
      case google::protobuf::FieldDescriptor::CPPTYPE_INT64:
        more ? to.AddInt64(&message, &field, Whole(field.name()))
             : to.SetInt64(&message, &field, Whole(field.name()));
        break;
      case google::protobuf::FieldDescriptor::CPPTYPE_BOOL:
        more ? to.AddBool(&message, &field, Below(2) == 0)
             : to.SetBool(&message, &field, Below(2) == 0);
        break;
      case google::protobuf::FieldDescriptor::CPPTYPE_ENUM: {
        const int value =
            Below(12) == 0
                ? 99
                : field.enum_type()->value(Below(field.enum_type()->value_count()))->number();
        more ? to.AddEnumValue(&message, &field, value) : to.SetEnumValue(&message, &field, value);
        break;
      }
      case google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE:
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

}  // namespace rmlcell::server
