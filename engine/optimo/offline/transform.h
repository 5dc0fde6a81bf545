#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/machine/tools.h"
#include "engine/motion/geometry/frames.h"
#include "engine/motion/kinematics/kinematics.h"

// TRANSFOR and RMLSHIFT: moving a program by rewriting its numbers (optimo.md 8.4).
namespace rmlcell::optimo {

// The angles at which the tool points where the turned old tool points. Straight down A turns by
// the rotation about Z (OPT-B.80). Otherwise there are two solutions, (A', B') and (A' + pi, -B'),
// and whole turns of A:
//   - of the first move the one nearest to the old angles, A nearest to the old A; a rotation about
//     Z leaves B as it is, whatever is nearer. Half a turn goes the way of the rotation.
//   - behind that the one that swings A most nearly as `swing`, what A turned by before: chosen
//   anew
//     for each move, the head would swing by half a turn in the middle of a contour.
motion::HeadAngles TurnHead(const motion::HeadAngles& old, const motion::Rotation& turn,
                            std::optional<double> swing = {});

using Rewriting = machine::RewrittenText;

// Six decimals (OPT-8.77) say where the tip is to 5e-7 mm, and where the tool points to 1e-6. What
// they cannot keep is A near B = 0: there A turns the tool about itself, and half a unit of the
// sixth decimal of B is as much as A has meaning. The inverse brings A back to 1e-6 / sin B: to
// 1e-6 at B = pi / 2, to 1e-4 at B = 0.01, not at all at B = 1e-6. Rotations about Z alone leave B
// as it is and bring A back to 1e-6 whatever B is.
//
// TRANSFOR: every MOVE and /VIA, head angles included; numbers get up to six decimals, the rest of
// the text stays (OPT-8.76, OPT-8.77). Errors: 7851 for a coordinate, or a rotation of SYSDEF, that
// is no plain number; 7004 where a number would leave the range of REAL, as with a motion that is
// not finite; those of the parser.
Rewriting Transform(std::string_view text, const motion::RigidMotion& motion);

// RMLSHIFT: adds to the plain numbers that the program assigns to VR[86] to VR[91]: X, Y, Z, rz,
// ry, rx (OPT-8.74, OPT-B.81). Errors: 7852 when there is none; 7004 as above.
Rewriting Shift(std::string_view text, const std::array<double, 6>& offset);

}  // namespace rmlcell::optimo
