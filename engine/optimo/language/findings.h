#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/untold_findings.h"

namespace rmlcell::optimo {

// A place before it is a line and a column: cheap to make, resolved only for what is reported.
struct Place {
  std::int64_t offset = -1;  // byte in the text; -1: no text
  int length = 0;
  int step = 0;
};

// So many bytes, as digits: "the object has " + ToldSize("bytes", 34001) + " bytes".
Detail ToldSize(std::string_view name, std::uint64_t bytes);

// Collects what there is to say about one text; keeps the first `limit` findings, the first error
// among them (KeepFinding), and counts the rest by kind.
class Findings {
 public:
  explicit Findings(std::size_t limit = 1000) : limit_(limit) {}

  void Add(ErrorCode code, Place place, Detail detail, std::string_view rule = {},
           std::vector<Fix> fixes = {});
  void AddAs(Severity severity, ErrorCode code, Place place, Detail detail,
             std::string_view rule = {}, std::vector<Fix> fixes = {});

  // Nothing more is kept, not even an error.
  bool full() const { return found_.size() >= limit_ && errors_ > 0; }
  // Errors so far, those that were not kept included.
  std::uint64_t error_count() const { return errors_; }
  // Those that were not kept; behind Take with lines and columns.
  const UntoldFindings& dropped() const { return dropped_; }

  // In order of place, with lines and columns of `text`, named `file`. Empties the collection.
  std::vector<Diagnostic> Take(std::string_view text, std::string_view file);

 private:
  std::size_t limit_;
  std::vector<Diagnostic> found_;
  std::uint64_t errors_ = 0;
  UntoldFindings dropped_;
};

}  // namespace rmlcell::optimo
