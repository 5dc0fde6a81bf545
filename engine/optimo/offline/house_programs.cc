#include "engine/optimo/offline/house_programs.h"

#include <array>

namespace rmlcell::optimo {
namespace {

// OPT-B.83. Variables of Amada's range (OPT-7.104). Z and B go first: the head is clear of the part
// before A turns.
constexpr std::string_view kZUp = R"(; rmlcell: allow 7412 7413 in file
; Z-UP: raise the head, switch the program outputs off, cancel the offset, take the tool of 90
DECLARE XNOW = VR[43]
DECLARE YNOW = VR[44]
DECLARE ANOW = VR[46]
DECLARE ZUP  = -50.0
UPDATE IA /ON
SPEED 40
PATH PTP
COORD ROBOT
XNOW = IA[0]
YNOW = IA[1]
ANOW = IA[3]
MOVE (XNOW, YNOW, ZUP, ANOW, 0.0)
MOVE (XNOW, YNOW, ZUP, 0.0, 0.0)
ASSIGN OL[22] = 0 /8
ASSIGN OL[12] = 0 /4
OL[8] = OFF
OL[9] = OFF
OL[11] = OFF
SYSDEF
CALL 90
)";

// OPT-B.84
constexpr std::string_view kHomeReturn = R"(; HOME RETURN: up first, then home
CALL 2
SPEED 40
PATH PTP
COORD ROBOT
MOVE (21.02, 2201.2, -50.0, 0.0, 0.0)
CALL 2
)";

constexpr std::string_view kTool = R"(; TCP: the calibrated tool; change it for another focus height
TCP (0.0, 0.0, 0.0 / 0.0, 0.0, -5.0)
)";

constexpr std::array kPrograms = {HouseProgram{2, "Z-UP", kZUp},
                                  HouseProgram{4, "HOME RETURN", kHomeReturn},
                                  HouseProgram{90, "TCP", kTool}};

}  // namespace

std::span<const HouseProgram> HousePrograms() { return kPrograms; }

}  // namespace rmlcell::optimo
