; A bracket plate, 200 x 120 mm, with two holes and rounded corners. Metric.
COORD ABSOL
PATH PTP
SPEED 40
SYSDEF (1200.0, 900.0, -650.0, 0.0, 0.0, 0.0)
WORKDEF 1,0 (8.0, 75.0, 0.5, 60.0)
MOVE (0.0, 0.0, 60.0, 0.0, 0.0)
OL[11] = ON                               ; height sensor
; two holes of 12 mm
VR[0] = 40.0
MOVE (VR[0], 60.0, 0.0, 0.0, 0.0)
GOSUB 100
PATH PTP
VR[0] = 160.0
MOVE (VR[0], 60.0, 0.0, 0.0, 0.0)
GOSUB 100
; outline, cut last; the piece is held until its last side
PATH PTP
MOVE (100.0, -6.0, 0.0, 0.0, 0.0)
SPEED 6
OVERSH 40
PATH LIN
WORK 1,0 /ON
MOVE (100.0, 0.0, 0.0, 0.0, 0.0)
MOVE (190.0, 0.0, 0.0, 0.0, 0.0)
PATH CIR
MOVE (200.0, 10.0, 0.0, 0.0, 0.0) /VIA (197.071, 2.929, 0.0, 0.0, 0.0)
PATH LIN
MOVE (200.0, 110.0, 0.0, 0.0, 0.0) /FLY
MOVE (190.0, 120.0, 0.0, 0.0, 0.0) /FLY
MOVE (10.0, 120.0, 0.0, 0.0, 0.0) /FLY
MOVE (0.0, 110.0, 0.0, 0.0, 0.0) /FLY
MOVE (0.0, 10.0, 0.0, 0.0, 0.0)
PATH CIR
MOVE (10.0, 0.0, 0.0, 0.0, 0.0) /VIA (2.929, 2.929, 0.0, 0.0, 0.0)
PATH LIN
MOVE (100.0, 0.0, 0.0, 0.0, 0.0)
WORK 1,0 /OFF
SPEED 20
MOVE (100.0, -6.0, 80.0, 0.0, 0.0)
OL[11] = OFF
SYSDEF
ENDTASK
; one hole round the present point
100 PATH HOLE (6.0)
SPEED 5
WORK 1,0 /ON
MOVE (VR[0], 60.0, 0.0, 0.0, 0.0) /VIA (VR[0], 60.0, 50.0, 0.0, 0.0)
WORK 1,0 /OFF
SPEED 20
RETURN
