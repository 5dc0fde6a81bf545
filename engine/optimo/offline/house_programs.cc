#include "engine/optimo/offline/house_programs.h"

#include <algorithm>
#include <array>

namespace rmlcell::optimo {
namespace {

// OPT-10.12. Where the reference block lies and how to come to it; the moves themselves belong to
// the machine that it stands at, and to the one who appends them. SYSDEF once more: program 2 may
// be another one than ours.
constexpr std::string_view kSensorCalibration = R"(; rmlcell: allow 7413 in file
; SENSOR CALIBRATION: head up, offset off, then tip coordinates of the machine, so that the TCP of 90
; makes up for another focus height. Append the moves onto the reference block: by ZWAY to ZNEAR, then ZBLOCK
DECLARE XBLOCK = VR[43]
DECLARE YBLOCK = VR[44]
DECLARE ZBLOCK = VR[45]
DECLARE ABLOCK = VR[46]
DECLARE BBLOCK = VR[47]
DECLARE ZNEAR  = VR[48]
DECLARE ZWAY   = VR[49]
CALL 2
XBLOCK = -105.5
YBLOCK = 2217.2
ZBLOCK = -962.0
ABLOCK = 0.0
BBLOCK = 0.0
ZNEAR = ZBLOCK + 20.0
ZWAY = -600.0
SYSDEF
COORD ABSOL
)";

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

constexpr std::array kPrograms = {
    machine::SpecialProgram{1, "SENSOR CALIBRATION", "1.S", kSensorCalibration},
    machine::SpecialProgram{2, "Z-UP", "2.S", kZUp},
    machine::SpecialProgram{4, "HOME RETURN", "4.S", kHomeReturn},
    machine::SpecialProgram{90, "TCP", "90.S", kTool}};

}  // namespace

std::span<const machine::SpecialProgram> HousePrograms() { return kPrograms; }

bool IsHouseProgram(int slot, std::string_view text) {
  const auto* const found = std::ranges::find(kPrograms, slot, &machine::SpecialProgram::slot);
  return found != kPrograms.end() && found->source == text;
}

}  // namespace rmlcell::optimo
