#pragma once

#include <google/protobuf/text_format.h>
#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include <string>

namespace rmlcell::bridge {

// Field by field; the first difference is told. `expected` is in protobuf's text form.
template <class Message>
void ExpectMessage(const Message& message, const std::string& expected) {
  Message wanted;
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(expected, &wanted)) << expected;
  google::protobuf::util::MessageDifferencer differencer;
  std::string differences;
  differencer.ReportDifferencesToString(&differences);
  EXPECT_TRUE(differencer.Compare(wanted, message)) << differences;
}

}  // namespace rmlcell::bridge
