// A plain face on LinuxCNC's trajectory planner, for motion_linuxcnc.cc to open: compiled by
// motion_linuxcnc.sh against the headers of linuxcnc-uspace-dev, loaded together with tpmod.so. The
// planner wants to live in a real-time host; what it asks of one is answered here.
#include <rtapi.h>
#include <stdarg.h>
#include <string.h>

#include "motion.h"
#include "motion_types.h"
#include "tp.h"

int hal_init(const char* name) { (void)name; return 1; }
int hal_ready(int id) { (void)id; return 0; }
int hal_exit(int id) { (void)id; return 0; }
void rtapi_print(const char* format, ...) { (void)format; }
void rtapi_print_msg(msg_level_t level, const char* format, ...) { (void)level; (void)format; }

static TP_STRUCT planner;
static emcmot_status_t status;
static emcmot_config_t config;
static double axis_speed;
static double axis_acceleration;

static void WriteDigital(int index, char value) { (void)index; (void)value; }
static void WriteAnalogue(int index, double value) { (void)index; (void)value; }
static void SetUnlock(int axis, int unlock) { (void)axis; (void)unlock; }
static int GetUnlock(int axis) { (void)axis; return 1; }
static double SpeedOf(int axis) { (void)axis; return axis_speed; }
static double AccelerationOf(int axis) { (void)axis; return axis_acceleration; }

// mm, s. `tolerance` 0: no limit to how far a blend may leave the path (G64 without P).
int peer_open(double cycle_s, double speed, double acceleration, double tolerance, const double* xyz) {
  EmcPose at;
  memset(&status, 0, sizeof status);
  memset(&config, 0, sizeof config);
  memset(&planner, 0, sizeof planner);
  ZERO_EMC_POSE(at);
  at.tran.x = xyz[0];
  at.tran.y = xyz[1];
  at.tran.z = xyz[2];
  axis_speed = speed;
  axis_acceleration = acceleration;
  status.net_feed_scale = status.feed_scale = status.rapid_scale = 1.0;
  status.carte_pos_cmd = at;
  config.trajCycleTime = config.servoCycleTime = cycle_s;
  config.numDIO = config.numAIO = 4;
  config.arcBlendEnable = 1;  // the defaults of its documentation
  config.arcBlendFallbackEnable = 0;
  config.arcBlendOptDepth = 50;
  config.arcBlendGapCycles = 4;
  config.arcBlendRampFreq = 100.0;
  config.arcBlendTangentKinkRatio = 0.1;
  config.maxFeedScale = 1.0;
  tpMotFunctions(WriteDigital, WriteAnalogue, SetUnlock, GetUnlock, SpeedOf, AccelerationOf);
  tpMotData(&status, &config);
  if (tpCreate(&planner, DEFAULT_TC_QUEUE_SIZE, 1) != 0) return -1;
  tpSetCycleTime(&planner, cycle_s);
  tpSetVmax(&planner, speed, speed);
  tpSetVlimit(&planner, speed);
  tpSetAmax(&planner, acceleration);
  tpSetPos(&planner, &at);
  return tpSetTermCond(&planner, TC_TERM_COND_PARABOLIC, tolerance);
}

int peer_add_line(const double* xyz, double speed, double acceleration, int id) {
  struct state_tag_t tag;
  EmcPose end;
  memset(&tag, 0, sizeof tag);
  ZERO_EMC_POSE(end);
  end.tran.x = xyz[0];
  end.tran.y = xyz[1];
  end.tran.z = xyz[2];
  tpSetId(&planner, id);
  return tpAddLine(&planner, end, EMC_MOTION_TYPE_FEED, speed, axis_speed, acceleration, 0, 0, -1, tag);
}

void peer_run_cycle(long period_ns) { tpRunCycle(&planner, period_ns); }
int peer_done(void) { return tpIsDone(&planner); }
int peer_depth(void) { return tpQueueDepth(&planner); }
int peer_full(void) { return tcqFull(&planner.queue); }
void peer_position(double* xyz) {
  EmcPose at;
  tpGetPos(&planner, &at);
  xyz[0] = at.tran.x;
  xyz[1] = at.tran.y;
  xyz[2] = at.tran.z;
}
