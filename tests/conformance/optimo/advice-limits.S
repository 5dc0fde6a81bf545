; Each rule of the advice from both sides: what is just inside of its limit is told nothing of.

;=== speeds of rapid moves (advice)
; OPT-5.46 OPT-E.7033
COORD ABSOL
PATH LIN
SPEED 70
MOVE (10.,2.,3.,0.,0.)
SPEED 70.01
MOVE (20.,2.,3.,0.,0.)               ; expect 7033
SPEED 100
MOVE (30.,2.,3.,0.,0.)               ; expect 7033

;=== speeds of the approach (advice)
; OPT-5.46
COORD ABSOL
PATH LIN
OL[11] = ON
SPEED 10
MOVE (10.,2.,3.,0.,0.)
WORK 0,0/ON
DELAY 1
MOVE (20.,2.,3.,0.,0.)
WORK 0,0/OFF
SPEED 20
MOVE (30.,2.,3.,0.,0.)
SPEED 10.01
MOVE (40.,2.,3.,0.,0.)               ; expect 7033
WORK 0,0/ON
DELAY 1
MOVE (50.,2.,3.,0.,0.)
WORK 0,0/OFF

;=== the approach to a schedule is none (advice)
; OPT-5.46
COORD ABSOL
PATH LIN
WORKDEF 2,5 (15)
SPEED 70
MOVE (10.,2.,3.,0.,0.)
WORK 2,5/ON
WORK 2,5/OFF

;=== speeds of the cut (advice)
; OPT-5.46
COORD ABSOL
PATH LIN
OL[11] = ON
SPEED 10
MOVE (10.,2.,3.,0.,0.)
WORK 0,0/ON
DELAY 1
SPEED 5
MOVE (20.,2.,3.,0.,0.)
SPEED 15
MOVE (30.,2.,3.,0.,0.)
SPEED 4.99
MOVE (40.,2.,3.,0.,0.)               ; expect 7033
SPEED 15.01
MOVE (50.,2.,3.,0.,0.)               ; expect 7033
WORK 0,0/OFF

;=== speeds of leaving (advice)
; OPT-5.46
COORD ABSOL
PATH LIN
OL[11] = ON
SPEED 10
WORK 0,0/ON
DELAY 1
MOVE (10.,2.,3.,0.,0.)
WORK 0,0/OFF
SPEED 20
MOVE (20.,2.,3.,0.,0.)
SPEED 70
MOVE (30.,2.,3.,0.,0.)
SPEED 10
WORK 0,0/ON
DELAY 1
MOVE (40.,2.,3.,0.,0.)
WORK 0,0/OFF
SPEED 20.01
MOVE (50.,2.,3.,0.,0.)               ; expect 7033
MOVE (60.,2.,3.,0.,0.)

;=== short moves with /FLY before a stop (advice)
; OPT-2.51 OPT-E.7314
COORD ABSOL
PATH LIN
SPEED 10
MOVE (10.,2.,3.,0.,0.)/FLY
MOVE (11.,2.,3.,0.,0.)/FLY
MOVE (20.,2.,3.,0.,0.)
MOVE (20.99,2.,3.,0.,0.)/FLY         ; expect 7314
MOVE (30.,2.,3.,0.,0.)
MOVE (30.99,2.,3.,0.,0.)/FLY
MOVE (40.,2.,3.,0.,0.)/FLY
MOVE (50.,2.,3.,0.,0.)

;=== tiny moves with /FLY in a row (advice)
; OPT-2.52 OPT-E.7314
COORD ABSOL
PATH LIN
SPEED 10
MOVE (0.,2.,3.,0.,0.)/FLY
MOVE (.0101,2.,3.,0.,0.)/FLY
MOVE (.0202,2.,3.,0.,0.)/FLY
MOVE (.0303,2.,3.,0.,0.)/FLY
MOVE (.0404,2.,3.,0.,0.)/FLY
MOVE (10.,2.,3.,0.,0.)/FLY
MOVE (10.009,2.,3.,0.,0.)/FLY
MOVE (10.018,2.,3.,0.,0.)/FLY
MOVE (20.,2.,3.,0.,0.)/FLY
MOVE (20.009,2.,3.,0.,0.)/FLY
MOVE (20.018,2.,3.,0.,0.)/FLY
MOVE (20.027,2.,3.,0.,0.)/FLY        ; expect 7314
MOVE (30.,2.,3.,0.,0.)/FLY
MOVE (40.,2.,3.,0.,0.)

;=== the normal point of a hole, 30 degrees off and not (advice)
; OPT-5.48 OPT-E.7033
COORD ABSOL
PATH HOLE (5.)
MOVE (20.,2.,3.,0.,0.)/VIA (25.77,2.,13.,0.,0.)
MOVE (20.,2.,3.,0.,0.)/VIA (25.78,2.,13.,0.,0.)      ; expect 7033
MOVE (20.,2.,3.,0.,0.)/VIA (20.,-3.77,13.,0.,0.)
MOVE (20.,2.,3.,0.,0.)/VIA (20.,-3.78,13.,0.,0.)     ; expect 7033
MOVE (20.,2.,3.,0.,1.5708)/VIA (20.,-8.,3.,0.,0.)
MOVE (20.,2.,3.,0.,1.5708)/VIA (20.,12.,3.,0.,0.)    ; expect 7033
MOVE (20.,2.,3.,1.5708,1.5708)/VIA (30.,2.,3.,0.,0.)
MOVE (20.,2.,3.,1.5708,1.5708)/VIA (20.,-8.,3.,0.,0.)  ; expect 7033
MOVE (20.,2.,3.,0.,0.)/VIA (20.,2.,-7.,0.,0.)        ; expect 7033

;=== the customer's REAL variables (advice)
; OPT-7.104 OPT-E.7413
VR[0] = 1.
VR[42] = 1.
VR[43] = 1.              ; expect 7413
VR[59] = 1.              ; expect 7413
VR[60] = 1.
VR[97] = 1.
VR[98] = 1.              ; expect 7413
VR[99] = 1.              ; expect 7413

;=== the customer's INTEGER and LOGICAL variables (advice)
; OPT-7.105 OPT-E.7413
VI[1] = 1
VI[69] = 1
VI[70] = 1               ; expect 7413
VI[97] = 1               ; expect 7413
VL[0] = ON
VL[79] = ON
VL[80] = ON              ; expect 7413
VL[99] = ON              ; expect 7413
ASSIGN VL[72] = 0 /8
ASSIGN VL[73] = 0 /8     ; expect 7413

;=== the customer's outputs (advice)
; OPT-7.106 OPT-E.7412
OL[0] = ON               ; expect 7412
OL[1] = ON               ; expect 7412
OL[2] = ON               ; expect 7412
OL[3] = ON               ; expect 7412
OL[7] = ON               ; expect 7412
OL[8] = ON
OL[8] = OFF
OL[9] = ON
OL[9] = OFF
OL[10] = ON              ; expect 7412
OL[11] = ON
OL[12] = ON              ; expect 7412
OL[15] = ON              ; expect 7412
OL[16] = ON
OL[17] = ON              ; expect 7412
OL[31] = ON              ; expect 7412
OL[32] = ON
OL[99] = ON
ASSIGN OL[32] = 0 /8
ASSIGN OL[31] = 0 /8     ; expect 7412
ASSIGN OL[11] = 0 /1
ASSIGN OL[11] = 0 /2     ; expect 7412

;=== reading is free (advice)
; OPT-7.104 OPT-7.105 OPT-7.106
VL[1] = OL[20] AND IL[20] AND VL[80]
VR[1] = VR[50] + VI[75] + VI[99] + VR[98]

;=== an offset of zero, of nearly zero, and none (advice)
; OPT-7.37 OPT-E.7311
SYSDEF (0,0,0,0,0,0)                 ; expect 7311
SYSDEF (0,0,0,0,0,.001)
SYSDEF (.001,0,0,0,0,0)
SYSDEF (0,0,0,0,VR[91],0)
SYSDEF

;=== tools (advice)
; OPT-4.70 OPT-4.71 OPT-B.90 OPT-E.7312 OPT-E.7315
TCP (0,0,3/0,0,2.999)
TCP (0,0,3/0,0,3)                    ; expect 7312
TCP (0,0,3/0,0,3.001)                ; expect 7315
TCP (.001,0,3/0,0,0)                 ; expect 7313
TCP (0,.001,3/0,0,0)                 ; expect 7313
TCP (0,0,3/.001,0,0)                 ; expect 7313
TCP (0,0,3/0,.001,0)                 ; expect 7313
TCP (0,0,VR[82]/0,0,VR[85])

;=== variables with a unit for the rotary table (advice)
; OPT-8.78 OPT-7.104
FUNCTION 99 (VR[25])     ; expect 7033
FUNCTION 99 (VR[26])
FUNCTION 99 (45.)
FUNCTION 98 (VR[91])
FUNCTION 99 (VR[80])     ; expect 7033

;=== SPEED 0 and the same place (advice)
; OPT-B.22 OPT-E.7307
COORD ABSOL
PATH LIN
SPEED 70
MOVE (1.,2.,3.,0.,0.)
SPEED 0
MOVE (1.,2.,3.,0.,0.)
MOVE (1.001,2.,3.,0.,0.) ; expect 7307
SPEED .1
MOVE (1.,2.,3.,0.,0.)

;=== a cut from its approach to its end, with nothing to be told (advice)
; OPT-5.45 OPT-5.46 OPT-5.47 OPT-3.09 OPT-3.34
COORD ABSOL
PATH LIN
WORKDEF 1,0 (8., 75., 1., 50.)
SPEED 70
MOVE (900.,900.,-300.,0.,0.)/FLY
SPEED 50
MOVE (1000.,1000.,-400.,0.,0.)
SPEED 10
MOVE (1000.,1000.,-450.,0.,0.)
OL[8] = ON
OL[11] = ON
WORK 1,0/ON
SPEED 12
MOVE (1100.,1000.,-450.,0.,0.)/FLY
MOVE (1100.,1100.,-450.,0.,0.)/FLY
PATH CIR
MOVE (1000.,1100.,-450.,0.,0.)/VIA (1050.,1150.,-450.,0.,0.)
PATH LIN
WORK 1,0/OFF
OL[11] = OFF
OL[8] = OFF
SPEED 20
MOVE (1000.,1100.,-400.,0.,0.)
ENDTASK

;=== loops, subroutines and conditions with nothing to be told (advice)
; OPT-7.15 OPT-7.20 OPT-7.23 OPT-1.17 OPT-3.47
DECLARE COUNT = VI[2]
DECLARE LAST = 5
COUNT = 0
10 GOSUB 100
COUNT = COUNT + 1
IF COUNT < LAST THEN 10
GOTO COUNT (20, 30)
20 VR[0] = 1.
30 ERR 900
SETERR 12
NOERR
ENDTASK
100 IF IL[16] THEN 110 ELSE 120
110 VL[3] = ON
120 RETURN
900 ENDTASK

;=== a FUNCTION with its parameters, with nothing to be told (advice)
; OPT-9.11 OPT-9.20 OPT-9.22
TASK 1
DEFINE PAR[1] = INT
DEFINE PAR[2] = LOGIC
VR[1] = PAR[0] * 2.
VI[2] = PAR[1] MOD 7
IF PAR[2] THEN 10
RETURN
10 VR[1] = -VR[1]
RETURN

;=== constants within their ranges (advice)
; OPT-7.78 OPT-7.79 OPT-7.83 OPT-B.36
VR[0] = 1/.001
VI[2] = 5 MOD -3
VR[0] = 0^0
VR[0] = 1E18*9.
VR[0] = 1E18*10.         ; expect 7202
VR[0] = SQRT(0)
VR[0] = SQRT(-.001)      ; expect 7204
VR[0] = ASIN(1) + ASIN(-1) + ACOS(1) + ACOS(-1)
VR[0] = ASIN(1.001)      ; expect 7204
VR[0] = ACOS(-1.001)     ; expect 7204
VR[0] = LN(.001) + LOG(.001)
VR[0] = LOG(0)           ; expect 7204
VR[0] = LN(-1)           ; expect 7204
VR[0] = EXP(32) + EXP(-32)
VR[0] = EXP(32.001)      ; expect 7204
VR[0] = EXP(-32.001)     ; expect 7204
VR[0] = (-8)^3
VR[0] = (-8)^.5          ; expect 7204
VI[2] = 32767.9
VI[2] = 32768            ; expect 7203
VI[2] = -32768.9
VI[2] = -32769           ; expect 7203
VI[2] = 32766 + 1

;=== an offset that does not turn leaves the normal points, one that turns does not (advice)
; OPT-5.48
COORD ABSOL
PATH HOLE (5.)
SYSDEF (10.,0.,0.,0.,0.,0.)
MOVE (20.,2.,3.,0.,0.)/VIA (29.,2.,9.,0.,0.)     ; expect 7033
SYSDEF (10.,0.,0.,0.,0.,.5)
MOVE (20.,2.,3.,0.,0.)/VIA (29.,2.,9.,0.,0.)
SYSDEF (10.,0.,0.,.5,0.,0.)
MOVE (20.,2.,3.,0.,0.)/VIA (29.,2.,9.,0.,0.)
SYSDEF
MOVE (20.,2.,3.,0.,0.)/VIA (29.,2.,9.,0.,0.)     ; expect 7033

;=== the normal point of a tilted hole (advice)
; OPT-5.48
COORD ABSOL
PATH HOLE (5.)
MOVE (20.,2.,3.,0.,1.)/VIA (20.,-6.415,8.403,0.,0.)
MOVE (20.,2.,3.,0.,1.)/VIA (20.,2.,13.,0.,0.)    ; expect 7033
MOVE (20.,2.,3.,0.,1.)/VIA (20.,-8.,3.,0.,0.)    ; expect 7033

;=== without an offset ROBOT moves may stand anywhere (advice)
; OPT-7.109
SYSDEF
COORD ABSOL
MOVE (10.,2.,3.,0.,0.)
COORD ROBOT
MOVE (10.,2.,3.,0.,0.)
COORD ABSOL
MOVE (20.,2.,3.,0.,0.)

;=== with an offset they may not stand between the others (advice)
; OPT-7.109 OPT-E.7033
SYSDEF (10.,0.,0.,0.,0.,0.)
COORD ROBOT
MOVE (10.,2.,3.,0.,0.)
COORD ABSOL
MOVE (10.,2.,3.,0.,0.)
COORD ROBOT
MOVE (10.,2.,3.,0.,0.)   ; expect 7033
COORD ABSOL
MOVE (20.,2.,3.,0.,0.)
COORD ROBOT
MOVE (10.,2.,3.,0.,0.)

;=== what a statement with an error sets is not known (advice)
; OPT-1.33 OPT-5.46
COORD ABSOL
PATH LIN
SPEED 101                ; expect 7004
MOVE (10.,2.,3.,0.,0.)
SPEED 100
MOVE (20.,2.,3.,0.,0.)   ; expect 7033

;=== a gas that an input switches may be off (advice)
; OPT-5.40
OL[8] = IL[20]
OL[9] = ON
OL[8] = OFF
OL[8] = ON               ; expect 7409

;=== a subroutine without moves is no ABSOL move (advice)
; OPT-7.109
SYSDEF (10.,0.,0.,0.,0.,0.)
COORD ABSOL
MOVE (10.,0.,0.,0.,0.)
COORD ROBOT
MOVE (20.,0.,0.,0.,0.)
COORD ABSOL
GOSUB 100
ENDTASK
100 SPEED 5
RETURN

;=== a subroutine that leads to ABSOL moves is one, however deep they are (advice)
; OPT-7.109 OPT-7.21
SYSDEF (10.,0.,0.,0.,0.,0.)
COORD ABSOL
MOVE (10.,0.,0.,0.,0.)
COORD ROBOT
MOVE (20.,0.,0.,0.,0.)   ; expect 7033
GOSUB 100
ENDTASK
100 GOSUB 200
RETURN
200 COORD ABSOL
MOVE (30.,0.,0.,0.,0.)
RETURN

;=== each subroutine has its own first and last ABSOL move (advice)
; OPT-7.109
SYSDEF (10.,0.,0.,0.,0.,0.)
COORD ROBOT
MOVE (1.,0.,0.,0.,0.)
GOSUB 100
GOSUB 200
COORD ROBOT
MOVE (2.,0.,0.,0.,0.)
ENDTASK
100 COORD ROBOT
MOVE (3.,0.,0.,0.,0.)
COORD ABSOL
MOVE (4.,0.,0.,0.,0.)
RETURN
200 COORD ABSOL
MOVE (5.,0.,0.,0.,0.)
COORD ROBOT
MOVE (6.,0.,0.,0.,0.)
RETURN

;=== TIMER in a subroutine of a subroutine may have come (advice)
; OPT-5.40 OPT-B.59 OPT-7.21
OL[8]=ON
GOSUB 40
OL[9]=ON
ENDTASK
10 OL[8]=OFF
RETURN
30 TIMER (5.,10)
DELAY 9
TIMER /DIS
RETURN
40 GOSUB 30
RETURN

;=== a subroutine without a TIMER leaves what the other one knows (advice)
; OPT-5.40 OPT-B.59
OL[8]=ON
GOSUB 40
OL[9]=ON                 ; expect 7409
OL[9]=OFF
GOSUB 30
ENDTASK
10 OL[8]=OFF
RETURN
30 TIMER (5.,10)
DELAY 9
TIMER /DIS
RETURN
40 SPEED 5
RETURN

;=== two TIMERs: what either of them touches is not known (advice)
; OPT-5.40 OPT-B.59 OPT-3.33
OL[11]=ON
TIMER (5.,10)
TIMER (6.,20)
OL[8]=ON
OL[9]=ON
OL[9]=OFF
WORK 0,0/ON
DELAY 1
CALL 2
ENDTASK
10 OL[8]=OFF
RETURN
20 WORK 0,0/OFF
RETURN

;=== in an error handler the beam is off and all processes are (advice)
; OPT-3.53 OPT-3.33 OPT-5.45
OL[11]=ON
ERR 900
WORK 0,0/ON
DELAY 1
WORK 0,0/OFF
ENDTASK
900 CALL 2
COORD ABSOL
PATH PTP
SPEED 5
MOVE (10.,0.,0.,0.,0.)
ENDTASK

;=== behind a CALL the beam, gases, sensor and places are not as before (advice)
; OPT-7.12 OPT-5.40 OPT-5.47 OPT-2.51
COORD ABSOL
PATH LIN
SPEED 10
OL[8]=ON
CALL 2
OL[9]=ON
WORK 0,0/ON
DELAY 1
MOVE (10.,0.,0.,0.,0.)
WORK 0,0/OFF
MOVE (20.,0.,0.,0.,0.)
CALL 2
MOVE (20.5,0.,0.,0.,0.)/FLY
MOVE (30.,0.,0.,0.,0.)
WORK 1,3/ON              ; expect 7401
WORK 1,3/OFF

;=== modal values and WORKDEFs come back behind a CALL (advice)
; OPT-7.12 OPT-2.21 OPT-5.46
WORKDEF 1,0 (8., 75., 1., 50.)
COORD ABSOL
PATH CIR
SPEED 90
CALL 2
MOVE (10.,0.,0.,0.,0.)   ; expect 7308 7033
OL[11]=ON
WORK 1,0/ON
WORK 1,0/OFF

;=== moves that change their place for other reasons are not short (advice)
; OPT-2.51 OPT-2.54 OPT-4.64 OPT-7.29
COORD ABSOL
PATH LIN
SPEED 10
MOVE (10.,0.,0.,0.,0.)
SYSDEF (5.,0.,0.,0.,0.,0.)
MOVE (10.5,0.,0.,0.,0.)/FLY
MOVE (20.,0.,0.,0.,0.)
SYSDEF
MOVE (30.,0.,0.,0.,0.)/END (IL[20])
MOVE (30.5,0.,0.,0.,0.)/FLY
MOVE (40.,0.,0.,0.,0.)
TCP (0,0,0/0,0,-5)
MOVE (40.5,0.,0.,0.,0.)/FLY
MOVE (50.,0.,0.,0.,0.)
MOVE (VR[64],0.,0.,0.,0.)
MOVE (50.5,0.,0.,0.,0.)/FLY
MOVE (60.,0.,0.,0.,0.)
MOVE (60.5,0.,0.,0.,0.)/FLY          ; expect 7314
MOVE (70.,0.,0.,0.,0.)
MOVE (70.,0.5,0.,0.,0.)/FLY          ; expect 7314
MOVE (70.,20.,0.,0.,0.)
MOVE (70.,20.,0.5,0.,0.)/FLY         ; expect 7314
MOVE (70.,20.,20.,0.,0.)
MOVE (70.6,20.6,20.6,0.,0.)/FLY
MOVE (90.,20.,20.,0.,0.)

;=== what ends the freshness of a beam (advice)
; OPT-3.20 OPT-3.45 OPT-3.49 OPT-7.27
COORD ABSOL
PATH LIN
SPEED 10
OL[11]=ON
WORK 0,0/ON
WAIT IL[20]
MOVE (10.,0.,0.,0.,0.)
WORK 0,0/OFF
WORK 0,0/ON
PAUSE
MOVE (20.,0.,0.,0.,0.)
WORK 0,0/OFF
WORK 0,0/ON
STOP
MOVE (30.,0.,0.,0.,0.)
WORK 0,0/OFF
WORK 0,0/ON
DELAY VR[64]
MOVE (40.,0.,0.,0.,0.)
WORK 0,0/OFF
WORK 0,0/ON
SPEED 10
MOVE (50.,0.,0.,0.,0.)               ; expect 7033
WORK 0,0/ON
MOVE (60.,0.,0.,0.,0.)
WORK 0,0/OFF
WORK 0,0/ON
WORK 0,0/OFF
MOVE (70.,0.,0.,0.,0.)
WORK 0,0/ON/START (IL[20])
MOVE (80.,0.,0.,0.,0.)
WORK 0,0/OFF

;=== an ASSIGN switches gases and the sensor by its bits (advice)
; OPT-7.102 OPT-5.40 OPT-5.47
ASSIGN OL[8] = 9 /4      ; expect 7412
OL[9]=ON                 ; expect 7409
OL[9]=OFF
WORK 0,0/ON
WORK 0,0/OFF
ASSIGN OL[11] = 0 /1
WORK 0,0/ON              ; expect 7033
WORK 0,0/OFF
ASSIGN OL[9] = VI[1] /1
OL[8]=OFF
OL[8]=ON

;=== what a /FLY meets on its way to the next MOVE (advice)
; OPT-2.48 OPT-2.49 OPT-2.50 OPT-E.7032
; rmlcell: allow 7033 in file
COORD ABSOL
PATH LIN
SPEED 10
WORKDEF 1,0 (8., 75., VR[67], 50.)
WORKDEF 1,1 (8., 75., 0., 50.)
WORKDEF 1,2 (8., 75., .1, 50.)
WORKDEF 2,0 (5)
MOVE (1.,0.,0.,0.,0.)/FLY
WORK 2,0/ON
ACCEL 50
OVERSH 50
PATH LIN
WORKDEF 0,1
VR[1] = 2. * VR[2]
ASSIGN OL[8] = 1 /1
DEFINE PAR[0] = INT
MOVE (2.,0.,0.,0.,0.)/FLY
WORK 1,0/ON
MOVE (3.,0.,0.,0.,0.)/FLY
WORK 1,0/OFF
MOVE (4.,0.,0.,0.,0.)/FLY
WORK 1,1/ON
MOVE (5.,0.,0.,0.,0.)/FLY
WORK 1,2/OFF
MOVE (6.,0.,0.,0.,0.)/FLY            ; expect 7032
WORK 1,2/ON
MOVE (7.,0.,0.,0.,0.)/FLY            ; expect 7032
WORK 0,0/ON/START (IL[20])
MOVE (8.,0.,0.,0.,0.)/FLY
TCP (0,0,0/0,0,-5)
MOVE (9.,0.,0.,0.,0.)/FLY
FUNCTION 3
MOVE (10.,0.,0.,0.,0.)/FLY           ; expect 7032
MOVE (11.,0.,0.,0.,0.)/START (IL[20])
MOVE (12.,0.,0.,0.,0.)/FLY           ; expect 7032
VL[1] = IL[20]
MOVE (13.,0.,0.,0.,0.)/FLY           ; expect 7032
IF IL[20] THEN 5
5 MOVE (14.,0.,0.,0.,0.)/FLY         ; expect 7032
NOERR
MOVE (15.,0.,0.,0.,0.)/FLY           ; expect 7032
SETERR 5
MOVE (16.,0.,0.,0.,0.)/FLY           ; expect 7032
UPDATE OL /ON
MOVE (17.,0.,0.,0.,0.)/FLY           ; expect 7032
PAUSE
MOVE (18.,0.,0.,0.,0.)/FLY           ; expect 7032
ZERO
MOVE (19.,0.,0.,0.,0.)/FLY           ; expect 7032
BREAK 5
MOVE (20.,0.,0.,0.,0.)

;=== jumps lead a /FLY on to what they lead to (advice)
; OPT-2.47 OPT-2.48 OPT-2.49 OPT-B.29
; rmlcell: allow 7033 in file
COORD ABSOL
PATH LIN
SPEED 10
MOVE (1.,0.,0.,0.,0.)/FLY
GOTO 10
5 DELAY 1
10 MOVE (2.,0.,0.,0.,0.)/FLY         ; expect 7032
GOTO 20
20 DELAY 1
MOVE (3.,0.,0.,0.,0.)/FLY
IF VL[1] THEN 30
DELAY 1
30 MOVE (4.,0.,0.,0.,0.)/FLY         ; expect 7032
IF VL[1] THEN 40 ELSE 50
MOVE (5.,0.,0.,0.,0.)
40 DELAY 1
50 DELAY 1
MOVE (6.,0.,0.,0.,0.)/FLY
GOTO VI[1] (60, 70)
60 DELAY 1
70 MOVE (7.,0.,0.,0.,0.)/FLY         ; expect 7032
GOTO 99
99

;=== into subroutines, and behind their GOSUB (advice)
; OPT-2.47 OPT-2.48 OPT-2.49 OPT-7.20
COORD ABSOL
PATH LIN
SPEED 10
MOVE (1.,0.,0.,0.,0.)/FLY
GOSUB 100
MOVE (2.,0.,0.,0.,0.)/FLY            ; expect 7032
GOSUB 200
MOVE (3.,0.,0.,0.,0.)/FLY
GOSUB 300
ENDTASK
100 MOVE (4.,0.,0.,0.,0.)/FLY
RETURN
200 DELAY 1
RETURN
300 SPEED 10
RETURN

;=== a RETURN leads behind each GOSUB (advice)
; OPT-2.47 OPT-2.48 OPT-7.20
COORD ABSOL
PATH LIN
SPEED 10
GOSUB 100
DELAY 1
GOSUB 100
ENDTASK
100 MOVE (4.,0.,0.,0.,0.)/FLY        ; expect 7032
SPEED 20
RETURN

;=== the end of a FUNCTION may be followed by a MOVE of its caller (advice)
; OPT-2.49 OPT-9.11
TASK 1
COORD ABSOL
PATH LIN
SPEED 10
MOVE (1.,0.,0.,0.,0.)/FLY
RETURN

;=== a statement with an error may be anything (advice)
; OPT-1.33 OPT-2.48
COORD ABSOL
PATH LIN
SPEED 10
MOVE (1.,0.,0.,0.,0.)/FLY
DELAY                    ; expect 7003
MOVE (2.,0.,0.,0.,0.)

;=== a speed that the GOSUB of a TIMER may change is not known (advice)
; OPT-B.59 OPT-5.46
COORD ABSOL
PATH LIN
SPEED 80
TIMER (5.,10)
MOVE (1.,0.,0.,0.,0.)
ENDTASK
10 SPEED 60
RETURN

;=== a path that the GOSUB of a TIMER may change is not known (advice)
; OPT-B.59 OPT-2.08
COORD ROBOT
PATH LIN
TIMER (5.,10)
MOVE (1.,0.,0.,0.,0.)
ENDTASK
10 PATH PTP
RETURN

;=== a beam that the GOSUB of a TIMER may change is not known (advice)
; OPT-B.59 OPT-5.46 OPT-3.34
COORD ABSOL
PATH LIN
SPEED 30
OL[11]=ON
WORK 0,0/ON
DELAY 1
TIMER (5.,10)
MOVE (1.,0.,0.,0.,0.)
ENDTASK
10 WORK 0,0/OFF
RETURN

;=== a gas that the GOSUB of a TIMER may change is not known (advice)
; OPT-B.59 OPT-5.40
OL[9]=ON
TIMER (5.,10)
OL[8]=ON
ENDTASK
10 OL[9]=OFF
RETURN

;=== a sensor that the GOSUB of a TIMER may change is not known (advice)
; OPT-B.59 OPT-5.47
TIMER (5.,10)
WORK 0,0/ON
WORK 0,0/OFF
ENDTASK
10 OL[11]=ON
RETURN

;=== a turn that the GOSUB of a TIMER may change is not known (advice)
; OPT-B.59 OPT-5.48
COORD ABSOL
PATH HOLE (5.)
TIMER (5.,10)
MOVE (20.,2.,3.,0.,0.)/VIA (29.,2.,9.,0.,0.)
ENDTASK
10 SYSDEF (0,0,0,.5,0,0)
RETURN

;=== a place that the GOSUB of a TIMER may change is not known (advice)
; OPT-B.59 OPT-B.22
COORD ABSOL
PATH LIN
SPEED 10
MOVE (0.,0.,0.,0.,0.)
TIMER (5.,10)
SPEED 0
MOVE (1.,0.,0.,0.,0.)
ENDTASK
10 MOVE (1.,0.,0.,0.,0.)
RETURN

;=== a definition that the GOSUB of a TIMER may change is not known (advice)
; OPT-B.59 OPT-3.09
TIMER (5.,10)
OL[11]=ON
WORK 1,3/ON
WORK 1,3/OFF
ENDTASK
10 WORKDEF 1,3 (8., 75., 1., 50.)
RETURN

;=== a variable that the GOSUB of a TIMER may change is not known (advice)
; OPT-B.59 OPT-1.17
TIMER (5.,10)
SPEED VR[1]
ENDTASK
10 VR[1]=2.
RETURN

;=== a TIMER whose GOSUB does something else leaves all of that known (advice)
; OPT-B.59 OPT-1.17 OPT-2.08 OPT-3.09 OPT-5.46
TIMER (5.,10)
SPEED VR[1]              ; expect 7033
OL[11]=ON
WORK 1,3/ON              ; expect 7401
WORK 1,3/OFF
COORD ABSOL
PATH LIN
SPEED 80
MOVE (1.,0.,0.,0.,0.)    ; expect 7033
SPEED 0
MOVE (2.,0.,0.,0.,0.)    ; expect 7307
SPEED 20
PATH HOLE (5.)
MOVE (20.,2.,3.,0.,0.)/VIA (29.,2.,9.,0.,0.)     ; expect 7033
PATH LIN
MOVE (2.,0.,0.,0.,0.)
OL[9]=ON
OL[8]=ON                 ; expect 7409
OL[8]=OFF
WORK 0,0/ON
DELAY 1
SPEED 30
MOVE (1.,0.,0.,0.,0.)    ; expect 7033
OL[11]=OFF
MOVE (2.,0.,0.,0.,0.)    ; expect 7033 7033
COORD ROBOT
MOVE (1.,0.,0.,0.,0.)    ; expect 7302 7033
ENDTASK                  ; expect 7408
10 OL[40]=ON
RETURN

;=== the last variables of each group may be read (advice)
; OPT-7.59 OPT-1.17
VR[0] = VR[99]
VI[2] = VI[99]
VL[0] = VL[99]
