#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "engine/simulation/picture/path_difference.h"
#include "engine/simulation/picture/picture.h"

// A picture of what two programs do differently: what is removed, added and common.
namespace rmlcell::simulation {

// One of the two paths; must outlive the drawing.
struct ComparedPath {
  const PathSketch& path;
  std::string title;   // of the program
  std::string note{};  // "stopped at 1/7, OPT-E348"; empty: it ran to its end
};

// A figure of both runs, as a row beside the picture.
struct ComparedFigure {
  std::string name;
  std::string unit;
  double before = 0.0;
  double after = 0.0;
};

// A standalone SVG document as PictureRecorder::Svg makes: both paths in the panels of the machine,
// and where the difference is small a panel that shows it alone. At most `elements_max` lines and
// arcs; what is drawn coarser for that says so. `machine`: that both ran on, for the caption.
std::string PictureOfDifference(const ComparedPath& before, const ComparedPath& after,
                                const machine::MachineShape& shape,
                                const std::vector<ComparedFigure>& figures,
                                const PictureOptions& options,
                                std::size_t elements_max = kPictureElementsMax,
                                const std::string& machine = {});

}  // namespace rmlcell::simulation
