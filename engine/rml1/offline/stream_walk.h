#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "engine/machine/bytes.h"
#include "engine/rml1/device.h"

namespace rmlcell::rml1 {

// The part of a stream that acts at once: a set of a command with sets, a group of !ZE, any other
// command as a whole, or bytes that are no command. Places are bytes of the stream.
struct Phrase {
  enum class Kind : std::uint8_t {
    kSet,         // one set of D I M R PA PR PU PD Z !ZZ, complete
    kBare,        // such a command without any number
    kLeftOver,    // numbers of such a command that were not carried out
    kGroup,       // one group of !ZE, complete or with its error
    kFixed,       // a command with a fixed number of parameters
    kSkipped,     // a vendor command that the profile skips
    kDiscarded,   // bytes that belong to no command
    kAbort,       // ESC.K
    kLinkError,   // a device control sequence that the machine refuses
    kIncomplete,  // the end of the stream inside a command, which was not carried out
  };
  struct Value {
    Number number{};
    char axis = 0;  // of !ZE; 0 elsewhere
    std::int64_t begin = 0;
    std::int64_t end = 0;
  };

  Kind kind = Kind::kDiscarded;
  Op op = Op::kCall;
  std::uint64_t command = 0;      // its number, from 1; 0: none
  std::int64_t name = 0;          // of the first byte of its name, or of the ^ that calls it
  std::int64_t begin = 0;         // of what belongs to this phrase: the name too, for the first one
  std::int64_t end = 0;           // behind its last byte
  bool first = true;              // of its command
  bool has_call = false;          // a ^ stands before the name
  std::span<const Value> values;  // at most kValuesMax
  std::span<const Action> actions;    // in their order
  std::span<const Finding> findings;  // errors and advice, at most kFindingsMax
  const Registers* before = nullptr;  // of the device, before and after
  const Registers* after = nullptr;
  Point logical_before;
  Point logical;  // where the commands lead
  Point physical_before;
  Point physical;  // where the tool is

  static constexpr std::size_t kValuesMax = 4;  // !ZE names X Y Z A; other letters are left out
  static constexpr std::size_t kFindingsMax = 4;
};

class PhraseListener {
 public:
  virtual ~PhraseListener() = default;
  // What the phrase refers to is valid during the call. False: the walk ends here.
  virtual bool OnPhrase(const Phrase& phrase) = 0;
};

// Leads a stream through a device (device.h), as a check does, and tells phrase by phrase what the
// device made of it. It has no grammar of its own, so nothing can be understood otherwise than the
// machine does. Memory is that of a device, however long the stream. A pause is passed as if the
// resume key were pressed at once. Advice about clipping comes with the phrase that caused it.
class StreamWalk final : private DeviceListener {
 public:
  StreamWalk(const Profile& profile, PhraseListener& listener);

  // Once. False: the listener ended it. What was read is released.
  bool Run(const machine::Bytes& stream);
  bool Run(std::string_view stream) { return Run(machine::Bytes::Borrowed(stream)); }

  const Device& device() const { return device_; }

 private:
  void OnFinding(const Finding& finding) override;
  void OnCounted(const Finding& finding) override { OnFinding(finding); }  // of a phrase of its own
  void OnReading(const Reading& reading, const CommandReader& reader, std::int64_t offset) override;
  void OnAbort(std::int64_t offset) override;

  void BeginCommand(const CommandReader& reader);
  void AddValue(const CommandReader& reader, std::int64_t end);
  void OnListEnd(std::int64_t offset);
  void Complete(Phrase::Kind kind, std::int64_t end);
  bool Emit();
  bool EmitLinkErrors(std::int64_t end);
  bool Tell(Phrase& phrase);

  Device device_;
  PhraseListener& listener_;
  Registers before_;
  Point logical_before_;
  Point physical_before_;

  Phrase phrase_;  // in collection
  std::array<Phrase::Value, Phrase::kValuesMax> values_;
  std::size_t value_count_ = 0;
  std::vector<Action> actions_;
  std::vector<Finding> findings_;
  std::vector<Finding> link_findings_;
  bool complete_ = false;  // the phrase acts in this step
  bool in_command_ = false;
  bool ran_ = false;        // a set of the command was complete
  bool dropped_ = false;    // a value was out of range, and the rest of its list is dropped
  std::int64_t call_ = -1;  // place of an open ^
};

// Whether what a device has read is a stream at all. Error: Rml1NoProgram (8007).
Status CheckIsStream(const Device& device);

}  // namespace rmlcell::rml1
