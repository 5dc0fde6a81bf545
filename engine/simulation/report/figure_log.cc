#include "engine/simulation/report/figure_log.h"

#include "engine/simulation/report/slow_move_list.h"

namespace rmlcell::simulation {

void FigureLog::Add(const Motion& motion) {
  axes_.Add(motion.axes);
  corners_.Add(motion.done);
  if (motion.slow) Count(*motion.slow, shortfall_);
  tip_.Add(motion.tip);
  column_.Add(motion.column);
  if (motion.cuts) cut_.Add(motion.tip);
}

void FigureLog::TakeFigures(const FigureLog& other) {
  const BeamTimes beam = beam_;
  *this = other;
  beam_ = beam;
}

void FigureLog::WriteTo(ScopeFigures& figures, SimTime beam_on) const {
  figures.beam = beam_.Histogram(beam_on);
  figures.corners = corners_.corners();
  figures.shortfall = shortfall_;
  figures.programmed = programmed_;
  figures.tip = tip_;
  figures.cut = cut_;
  figures.column = column_;
  axes_.WriteTo(figures);
}

}  // namespace rmlcell::simulation
