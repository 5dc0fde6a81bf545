#pragma once

namespace rmlcell::rml1 {

// Lowest and highest of what was added.
struct Extent {
  double low = 0.0;
  double high = 0.0;
  bool known = false;

  // True: it is another one now.
  bool Add(double value) {
    if (known && value >= low && value <= high) return false;
    if (!known || value < low) low = value;
    if (!known || value > high) high = value;
    known = true;
    return true;
  }
};

}  // namespace rmlcell::rml1
