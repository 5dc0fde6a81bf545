#include "tests/storage/store_conformance.h"

#include <random>

namespace rmlcell::storage {

MachineRecord StoreConformance::PutMachine(const std::string& id) {
  return Must(store().PutMachine({.id = id, .family = "optimo"}, kAnyRevision));
}

ProgramSummary StoreConformance::PutProgram(const std::string& machine, int slot,
                                            const std::string& object) {
  return Must(store().PutPrograms(machine, {{.slot = slot, .object = object}}, {})).front();
}

JobRecord StoreConformance::Submit(const std::string& kind, const std::string& machine) {
  return Must(store().SubmitAndWait({.machine = machine, .kind = kind})).job;
}

LeasedJob StoreConformance::Acquire(const std::string& worker, const std::string& kind) {
  std::optional<LeasedJob> leased = Must(store().Acquire(worker, {kind}, kLease, {}));
  if (!leased) throw std::runtime_error("no job to lease");
  return *std::move(leased);
}

JobRecord StoreConformance::Finish(const Lease& lease, JobState state) {
  return Must(store().Finish(lease, {.outcome = {.state = state}}));
}

std::vector<EventRecord> StoreConformance::EventsOf(std::int64_t job) {
  std::vector<EventRecord> all;
  for (;;) {
    const std::int64_t after = all.empty() ? 0 : all.back().sequence;
    const std::vector<EventRecord> page = Must(store().JobEvents(job, after, 7));
    if (page.empty()) return all;
    all.insert(all.end(), page.begin(), page.end());
  }
}

std::string Numbered(std::string_view prefix, std::int64_t number) {
  std::string text(prefix);
  text += std::to_string(number);
  return text;
}

std::vector<std::string> KindsOf(const std::vector<EventRecord>& events) {
  std::vector<std::string> kinds;
  for (const EventRecord& event : events) kinds.push_back(event.kind);
  return kinds;
}

void ExpectWithoutGap(const std::vector<EventRecord>& events) {
  std::int64_t sequence = 0;
  std::int64_t position = 0;
  for (const EventRecord& event : events) {
    EXPECT_EQ(event.sequence, sequence + 1);
    EXPECT_GT(event.position, position);
    sequence = event.sequence;
    position = event.position;
  }
}

std::string Noise(std::size_t size, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::string bytes(size, '\0');
  for (std::size_t i = 0; i < size; i += 8) {
    std::uint64_t word = random();
    for (std::size_t j = i; j < size && j < i + 8; ++j) {
      bytes[j] = static_cast<char>(word & 0xFF);
      word >>= 8;
    }
  }
  return bytes;
}

std::string PlotText(std::size_t size) {
  std::string text;
  text.reserve(size + 32);
  for (int x = 0; text.size() < size; ++x) {
    text += Numbered("PD", x * 37 % 9000);
    text += Numbered(",", x * 53 % 6000);
    text += ";\n";
  }
  text.resize(size);
  return text;
}

}  // namespace rmlcell::storage
