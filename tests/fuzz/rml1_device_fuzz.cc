#include "tests/fuzz/rml1_device_fuzz.h"

#include <array>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "engine/core/check.h"
#include "engine/machine/run.h"
#include "engine/rml1/device.h"
#include "engine/rml1/profile.h"
#include "engine/rml1/rml1_family.h"

namespace rmlcell::rml1 {
namespace {

constexpr std::size_t kOptionBytes = 3;
constexpr std::size_t kStreamMax = 4096;  // longer inputs find nothing that short ones do not

machine::Parameters MachineFrom(std::uint8_t profile, std::uint8_t options) {
  machine::Parameters parameters(ParameterTable());
  const auto profiles = MachineProfiles();
  RMLCELL_CHECK(parameters.Apply(profiles[profile % profiles.size()]).ok());
  constexpr const char* kSettings[] = {"AUTO", "MODE1", "MODE2", "AUTO"};
  RMLCELL_CHECK(parameters.Set("COMMAND", std::string_view(kSettings[options & 3U])).ok());
  if ((options & 4U) != 0) RMLCELL_CHECK(parameters.Set("OVER_AREA", "PAUSE").ok());
  if ((options & 8U) != 0) RMLCELL_CHECK(parameters.Set("DATA_BITS", "7").ok());
  if ((options & 16U) != 0) RMLCELL_CHECK(parameters.Set("SEQUENCES", "ALL").ok());
  if ((options & 32U) != 0) RMLCELL_CHECK(parameters.Set("SKIP", "VPANEL").ok());
  if ((options & 64U) != 0) RMLCELL_CHECK(parameters.Set("BUFFER", 256.0).ok());
  if ((options & 128U) != 0) RMLCELL_CHECK(parameters.Set("ORIGIN_X", -12.5).ok());
  return parameters;
}

// The end points of the motions that a stream makes, and the registers it leaves.
struct Outcome {
  std::vector<Point> moves;
  int command_error = 0;
  int link_error = 0;

  bool operator==(const Outcome&) const = default;
};

// Without a clock. Pauses are resumed when the stream is over, or the buffer full, as a run does.
class ByteByByte final : public DeviceListener {
 public:
  explicit ByteByByte(const Profile& profile) : profile_(profile), device_(profile) {}

  Outcome Run(const std::string& stream, std::size_t copy_at) {
    std::size_t at = 0;
    for (;;) {
      Work();
      if (at == copy_at) device_ = Device(device_);  // a copy goes on as the original would
      const bool wait = device_.paused() && (at == stream.size() || device_.room() < 2);
      if (wait) {
        device_.actions().Pop();
      } else if (at == stream.size()) {
        break;
      } else {
        device_.Receive(static_cast<unsigned char>(stream[at]), static_cast<std::int64_t>(at),
                        *this);
        ++at;
      }
    }
    RMLCELL_CHECK(device_.waiting() == 0);
    outcome_.command_error = device_.command_errors().value();
    outcome_.link_error = device_.link_errors().value();
    return outcome_;
  }

 private:
  void Work() {
    for (;;) {
      while (!device_.actions().empty()) {
        if (device_.paused()) return;
        const Action action = device_.actions().front();
        device_.actions().Pop();
        if (action.kind == Action::Kind::kMotion) CheckMotion(action);
      }
      if (!device_.Step(*this)) return;
    }
  }

  void CheckMotion(const Action& action) {
    constexpr double kRounding = 1e-6;
    const Point& to = action.to;
    RMLCELL_CHECK(to.x >= profile_.x.low - kRounding && to.x <= profile_.x.high + kRounding);
    RMLCELL_CHECK(to.y >= profile_.y.low - kRounding && to.y <= profile_.y.high + kRounding);
    RMLCELL_CHECK(to.z >= profile_.z.low - kRounding && to.z <= profile_.z.high + kRounding);
    RMLCELL_CHECK(std::isfinite(to.a));
    RMLCELL_CHECK(action.speed_mm_s > 0.0);
    RMLCELL_CHECK(outcome_.moves.empty() || !(outcome_.moves.back() == to));
    outcome_.moves.push_back(to);
  }

  const Profile& profile_;
  Device device_;
  Outcome outcome_;
};

class MoveObserver final : public machine::RunObserver {
 public:
  void OnMotion(const machine::MotionDone& motion) override {
    RMLCELL_CHECK(motion.end >= motion.start && motion.start >= last_);
    last_ = motion.end;
  }
  void OnMove(const machine::MoveDone& move) override { moves.push_back(move); }
  std::vector<machine::MoveDone> moves;

 private:
  SimTime last_{0};
};

// Keys at even times, in an order that the bytes choose.
machine::InputScript KeysFrom(std::uint8_t order, std::uint8_t pace) {
  using machine::InputKind;
  constexpr std::array kKinds = {InputKind::kStop, InputKind::kStart, InputKind::kOverride,
                                 InputKind::kHold, InputKind::kStart};
  constexpr int kKeys = 24;
  machine::InputScript inputs;
  for (int i = 0; i < kKeys; ++i) {
    const auto choice = static_cast<std::size_t>(i * (1 + order % 7) + pace) % kKinds.size();
    inputs.push_back({.at = std::chrono::milliseconds((1 + pace) * (i + 1)),
                      .kind = kKinds[choice],
                      .index = 0,
                      .value = 10.0 + (i * 37 + order) % 190});
  }
  return inputs;
}

struct Course {
  int slice_ms = 0;  // length of the first call of Advance
  machine::InputScript inputs{};
};

// As a stored program in virtual time: where the tool goes is what the device said.
void CheckRun(const machine::Parameters& parameters, const std::string& stream,
              const Outcome& whole, const Course& course) {
  machine::RunSetup setup(parameters);
  setup.main_program = 1;
  setup.budget = {.steps = 0, .virtual_time = SimTime::zero()};
  setup.inputs = course.inputs;
  setup.programs[1] = {.name = {}, .object = machine::Bytes::Of(stream), .executable = nullptr};
  MoveObserver observer;
  const auto run = Rml1Family().NewRun(std::move(setup), observer).value();
  run->Advance(std::chrono::milliseconds(course.slice_ms));
  while (run->Advance(kForever) == machine::RunPhase::kHalted) {
    run->Apply({.at = run->state().time, .kind = machine::InputKind::kStart});
  }
  const double units = parameters.Number("UNITS_PER_MM");
  RMLCELL_CHECK(run->outcome().kind == machine::OutcomeKind::kCompleted);
  RMLCELL_CHECK(observer.moves.size() == whole.moves.size());
  for (std::size_t i = 0; i < whole.moves.size(); ++i) {
    const motion::MachinePoint& tip = observer.moves[i].tip.tip;
    RMLCELL_CHECK(std::abs(tip.x() * units - whole.moves[i].x) < 1e-3);
    RMLCELL_CHECK(std::abs(tip.z() * units - whole.moves[i].z) < 1e-3);
  }
  RMLCELL_CHECK(run->ReadVariable("ERR")->text == std::to_string(whole.command_error));
  RMLCELL_CHECK(run->ReadVariable("COM")->text == std::to_string(whole.link_error));
}

}  // namespace

void FuzzDevice(const std::uint8_t* data, std::size_t size) {
  if (size < kOptionBytes || size > kStreamMax) return;
  const machine::Parameters parameters = MachineFrom(data[0], data[1]);
  std::string stream;
  for (std::size_t i = kOptionBytes; i < size; ++i) stream += static_cast<char>(data[i]);

  const Profile profile = MakeProfile(parameters).value();
  const Outcome whole = ByteByByte(profile).Run(stream, stream.size() + 1);
  RMLCELL_CHECK(ByteByByte(profile).Run(stream, data[2]) == whole);

  CheckRun(parameters, stream, whole, {.slice_ms = data[2]});
  CheckRun(parameters, stream, whole, {.slice_ms = data[2], .inputs = KeysFrom(data[1], data[2])});
}

}  // namespace rmlcell::rml1

#ifdef RMLCELL_FUZZ_TARGET
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rmlcell::rml1::FuzzDevice(data, size);
  return 0;
}
#endif
