#pragma once

#include <string>
#include <vector>

#include "clients/cli/remote.h"

namespace rmlcell::cli {

// What is done with a machine that lives, by the words of `rmlcell machine`.
struct MachineAct {
  std::string machine;
  std::string take_over;  // why control is taken from whoever has it; empty: it is not
  int program = 0;
  double number = 0.0;              // override, factor
  std::string word;                 // operating mode
  std::int64_t alarm = 0;           // 0: all of them
  std::vector<std::string> values;  // variables, or NAME=VALUE
  double held_s = 0.0;              // a key; 0: it is tapped
  bool fast = false;                // likewise
  std::string step;                 // "45/10": where a run begins, or "10" of its program
  std::int64_t occurrence = 0;      // the how manieth time; 0: the first
  bool direct = false;              // without an approach
  bool off_until_work_on = false;
  std::string stock;  // block and tool on the table of a mill, as for `submit`
  std::string tool;
  bool untouched = false;         // nothing has been cut of that block
  bool look = false;              // what it would do, and no start
  bool halt = false;              // before the step
  bool goes_on = false;           // the step is begun at once
  std::vector<std::string> seen;  // what a person has seen to: clamps, tool, origin, table
  std::string reason;             // of a decision, for all to read
  std::vector<int> gates;         // the program of each; 0: none
  bool accept_displaced = false;  // it goes on from where keys have moved it
  bool restore_process = false;   // a spindle that a person stopped turns again
  std::string job;                // "17": one that a person starts
  bool follow = false;            // what comes, too
  std::string computer;           // whose host gets the machine; empty: this one
  std::int64_t undo = 0;          // the oldest entry of what was taught that is taken back; 0: none
};

int ShowMachine(const Remote& remote, const MachineAct& act);
int WatchMachine(const Remote& remote, const MachineAct& act);
int ShowMachineLog(const Remote& remote, const MachineAct& act);
// What was taught at its handbox, or the taking back of the newest of it.
int ShowTaught(const Remote& remote, const MachineAct& act);
int EnableMachine(const Remote& remote, const MachineAct& act);
int DisableMachine(const Remote& remote, const MachineAct& act);
// How it lives: told, or changed by NAME=VALUE.
int MachineOptions(const Remote& remote, const MachineAct& act);
int TakeMachine(const Remote& remote, const MachineAct& act);
// These need no control, and wait for nothing.
int HoldMachine(const Remote& remote, const MachineAct& act);
int StopMachine(const Remote& remote, const MachineAct& act);
int EmergencyStopMachine(const Remote& remote, const MachineAct& act);
int AbortRun(const Remote& remote, const MachineAct& act);
// These take control for a moment; a run goes on when it is given back.
int StartMachine(const Remote& remote, const MachineAct& act);
int ZeroMachine(const Remote& remote, const MachineAct& act);
int ResumeMachine(const Remote& remote, const MachineAct& act);
int SetMode(const Remote& remote, const MachineAct& act);
int SetOverride(const Remote& remote, const MachineAct& act);
int SetFactor(const Remote& remote, const MachineAct& act);
int AcknowledgeAlarms(const Remote& remote, const MachineAct& act);
int ConfirmMachine(const Remote& remote, const MachineAct& act);
int ReadVariables(const Remote& remote, const MachineAct& act);
int WriteVariables(const Remote& remote, const MachineAct& act);
int SetInputs(const Remote& remote, const MachineAct& act);
int SetGates(const Remote& remote, const MachineAct& act);
// A run that begins at a step: what it would do, and the start.
int StartAtStep(const Remote& remote, const MachineAct& act);
// Keys of the panel of a mill, or of a handbox, by their names.
int PressKeys(const Remote& remote, const MachineAct& act);

}  // namespace rmlcell::cli
