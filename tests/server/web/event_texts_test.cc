#include "server/web/event_texts.h"

#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include <barrier>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "rmlcell/v1/cell.pb.h"
#include "rmlcell/v1/job.pb.h"

namespace rmlcell::web {
namespace {

using nlohmann::json;

v1::WatchCellResponse Told(std::int64_t sequence) {
  v1::WatchCellResponse message;
  message.set_sequence(sequence);
  message.set_log_id("l0g");
  message.add_subscriptions("jobs");
  return message;
}

std::string TextOf(EventTexts& texts, const v1::WatchCellResponse& message) {
  const auto text = texts.Of(*v1::WatchCellResponse::descriptor(), message.SerializeAsString());
  return text ? **text : "no text";
}

TEST(EventTexts, AMessageIsAnEvent) {
  EventTexts texts;
  v1::WatchCellResponse message = Told(41);
  message.mutable_event()->set_sequence(41);
  const std::string text = TextOf(texts, message);
  EXPECT_TRUE(text.starts_with("id: 41.l0g\ndata: {")) << text;
  EXPECT_TRUE(text.ends_with("}\n\n"));
  const json data = json::parse(text.substr(text.find('{')));
  EXPECT_EQ(data["sequence"], "41");
  EXPECT_EQ(data["event"]["sequence"], "41");
}

// A browser is told of one event at a time, each with the number to come back with.
TEST(EventTexts, SeveralEventsAreAsManyTexts) {
  EventTexts texts;
  v1::WatchCellResponse several = Told(43);
  std::string expected;
  for (const std::int64_t sequence : {41, 43}) {
    v1::CellEvent event;
    event.set_sequence(sequence);
    event.set_resource("jobs/" + std::to_string(sequence));
    *several.mutable_events()->add_events() = event;
    v1::WatchCellResponse alone = Told(sequence);
    *alone.mutable_event() = event;
    expected += TextOf(texts, alone);
  }
  EXPECT_EQ(TextOf(texts, several), expected);
  EXPECT_NE(expected.find("id: 41.l0g\n"), std::string::npos);
  EXPECT_NE(expected.find("id: 43.l0g\n"), std::string::npos);
}

TEST(EventTexts, IsMadeOnceForAll) {
  EventTexts texts;
  const auto happened = [](std::int64_t sequence) {
    v1::WatchCellResponse message = Told(sequence);
    message.mutable_event()->set_sequence(sequence);
    return message;
  };
  const std::string text = TextOf(texts, happened(1));
  EXPECT_EQ(texts.made(), 1U);
  EXPECT_EQ(TextOf(texts, happened(1)), text);
  EXPECT_EQ(texts.made(), 1U);
  TextOf(texts, happened(2));
  EXPECT_EQ(texts.made(), 2U);
  // What is told to one alone leaves no trace.
  v1::WatchCellResponse snapshot = Told(2);
  snapshot.mutable_snapshot();
  TextOf(texts, snapshot);
  EXPECT_EQ(texts.made(), 2U);
}

// However many there are, they take a bounded room; what is large is not kept at all.
TEST(EventTexts, TheOldestAreForgotten) {
  EventTexts texts;
  const auto with = [](std::int64_t sequence, std::size_t bytes) {
    v1::WatchCellResponse message = Told(sequence);
    message.mutable_event()->mutable_job()->mutable_message()->set_text(std::string(bytes, 'x'));
    return message;
  };
  constexpr std::size_t kPart = 100'000;  // twice that with its text
  for (int i = 0; i < 60; ++i) TextOf(texts, with(i, kPart));
  EXPECT_EQ(texts.made(), 60U);
  TextOf(texts, with(59, kPart));
  EXPECT_EQ(texts.made(), 60U);
  TextOf(texts, with(0, kPart));
  EXPECT_EQ(texts.made(), 61U);
  for (int i = 0; i < 2; ++i) TextOf(texts, with(100, EventTexts::kKeptMax));
  EXPECT_EQ(texts.made(), 63U);
}

// Takes so many bytes with its text.
v1::WatchCellResponse OfSize(std::int64_t sequence, std::size_t bytes) {
  v1::WatchCellResponse message = Told(sequence);
  std::string& text = *message.mutable_event()->mutable_job()->mutable_message()->mutable_text();
  text.assign(bytes / 2 - 1'000, 'x');
  const auto size = [&] {
    EventTexts texts;
    return message.SerializeAsString().size() + TextOf(texts, message).size();
  };
  // Each character of the log stands in three places, each of the text in two.
  if ((bytes - size()) % 2 != 0) message.set_log_id("l0gs");
  text.append((bytes - size()) / 2, 'x');
  EXPECT_EQ(size(), bytes);
  return message;
}

// As large as a text may be that is kept, and as many of them as there is room for.
TEST(EventTexts, TheRoomIsUsedUp) {
  EventTexts texts;
  const v1::WatchCellResponse larger = OfSize(9, EventTexts::kKeptMax + 1);
  for (int i = 0; i < 2; ++i) TextOf(texts, larger);
  EXPECT_EQ(texts.made(), 2U);
  constexpr int kRoom = EventTexts::kBytesMax / EventTexts::kKeptMax;
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < kRoom; ++i) TextOf(texts, OfSize(10 + i, EventTexts::kKeptMax));
    EXPECT_EQ(texts.made(), 2U + kRoom);
  }
  TextOf(texts, OfSize(10 + kRoom, EventTexts::kKeptMax));
  TextOf(texts, OfSize(11, EventTexts::kKeptMax));
  EXPECT_EQ(texts.made(), 3U + kRoom);  // the oldest alone is forgotten
  TextOf(texts, OfSize(10, EventTexts::kKeptMax));
  EXPECT_EQ(texts.made(), 4U + kRoom);
}

// Whoever asks at the same time may make the text for himself; one of them is kept, and forgotten
// once.
TEST(EventTexts, OfThoseWhoAskAtOnceOneIsKept) {
  constexpr int kAsking = 4;
  constexpr int kMessages = 100;
  constexpr std::size_t kCharacters = 100'000;  // twice that with its text: some forty have room
  EventTexts texts;
  std::barrier together(kAsking);
  const auto message = [](std::int64_t sequence) {
    v1::WatchCellResponse told = Told(sequence);
    told.mutable_event()->mutable_job()->mutable_message()->set_text(std::string(kCharacters, 'x'));
    return told;
  };
  std::vector<std::thread> asking;
  for (int i = 0; i < kAsking; ++i) {
    asking.emplace_back([&] {
      for (int sequence = 0; sequence < kMessages; ++sequence) {
        together.arrive_and_wait();
        TextOf(texts, message(sequence));
      }
    });
  }
  for (std::thread& thread : asking) thread.join();
  const std::size_t made = texts.made();
  EXPECT_GE(made, std::size_t{kMessages});
  TextOf(texts, message(kMessages - 1));
  EXPECT_EQ(texts.made(), made);
  TextOf(texts, message(0));
  EXPECT_EQ(texts.made(), made + 1);
}

TEST(EventTexts, WhatIsNoMessageIsAnError) {
  EventTexts texts;
  for (const auto* type :
       {v1::WatchJobResponse::descriptor(), v1::WatchCellResponse::descriptor()}) {
    const auto text = texts.Of(*type, "\xFF\xFF");
    ASSERT_FALSE(text) << type->name();
    EXPECT_EQ(text.error().code, ErrorCode::kCellInternal) << type->name();
  }
  EXPECT_EQ(texts.made(), 0U);
}

// One that cannot be written as JSON is an error, also among others that can.
TEST(EventTexts, WhatHasNoTextIsAnError) {
  EventTexts texts;
  v1::WatchCellResponse several = Told(43);
  several.mutable_events()->add_events()->set_sequence(41);
  v1::CellEvent& wrong = *several.mutable_events()->add_events();
  wrong.set_sequence(43);
  wrong.mutable_time()->set_seconds(1'000'000'000'000);  // behind the year 9999
  const auto text = texts.Of(*v1::WatchCellResponse::descriptor(), several.SerializeAsString());
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error().code, ErrorCode::kCellInternal);
  EXPECT_EQ(texts.made(), 0U);
}

}  // namespace
}  // namespace rmlcell::web
