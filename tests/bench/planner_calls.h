#pragma once

namespace rmlcell::bench {

// From here on what anybody asks of a planner is kept: the paths of real programs, as they are
// planned. For programs that are linked as drawn.cmake says.
void KeepPlannerCalls();

// Asks it again of planners that do nothing else, and prints how long one more segment takes, taken
// and given out: the least of some rounds for each, since other work on the machine is not the
// planner's. One JSON object. False: nothing was kept.
bool PrintTail();

}  // namespace rmlcell::bench
