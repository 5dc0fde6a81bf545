#pragma once

#include <string>
#include <vector>

#include "engine/motion/kinematics/kinematics.h"
#include "engine/simulation/picture/plot.h"
#include "engine/simulation/picture/svg_text.h"
#include "engine/simulation/picture/time_envelope.h"

namespace rmlcell::simulation {

// The page of a plot: panels one below the other over the same time, each with a scale of its own.
class PlotPage {
 public:
  static_assert(PlotSeries::kFirstAxis + motion::kAxisCount <= TimeEnvelope::kSeriesMax);

  // An instant worth a line through all panels.
  struct Mark {
    SimTime at{0};
    std::string text;
    bool error = false;
  };
  struct Curves {
    TimeEnvelope envelope;
    std::vector<Mark> marks;
  };

  // All must outlive the page.
  PlotPage(const Curves& curves, const machine::MachineShape& shape, const RunReport& report,
           const PlotOptions& options);

  std::string Svg();

 private:
  struct Panel {
    std::string title;
    std::string unit;
    std::vector<std::size_t> series;  // the first one is drawn last, on top
    std::string_view colour;
    double height = 0.0;
    bool from_zero = false;
    bool hundred = false;  // the scale goes to 100
  };
  struct Scale {
    double low = 0.0;
    double high = 1.0;
    double top = 0.0;
    double height = 0.0;
    double At(double value) const { return top + height * (high - value) / (high - low); }
  };

  std::vector<Panel> PanelsOf(const PlotOptions& options) const;
  Scale ScaleOf(const Panel& panel, double top) const;
  double X(double time_s) const { return left_ + width_ * time_s / duration_s_; }
  void DrawHeader();
  void DrawTimeGrid(double top, double bottom);
  void DrawPanel(const Panel& panel, double top);
  void DrawMarks(double top, double bottom);
  std::string CurveData(std::size_t series, const Scale& scale) const;

  const Curves& curves_;
  const machine::MachineShape& shape_;
  const RunReport& report_;
  std::vector<Panel> panels_;
  double page_width_ = 0.0;
  double left_ = 0.0;
  double width_ = 0.0;
  double duration_s_ = 1.0;
  std::string body_;
};

}  // namespace rmlcell::simulation
