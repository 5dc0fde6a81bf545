;=== a WORK without WORKDEF (advice)
; OPT-3.09 OPT-3.10 OPT-E.7401
; rmlcell: allow 7033 in file
WORK 0,0/ON
WORK 0,0/OFF
WORK 1,3 /ON             ; expect 7401
WORK 1,3 /OFF

;=== a WORKDEF on one path only (advice)
; OPT-3.09 OPT-3.11
; rmlcell: allow 7033 in file
IF VL[1] THEN 10
WORKDEF 1,0 (8., 75., 1., 50.)
10 WORK 1,0 /ON          ; expect 7401
WORK 1,0 /OFF
WORKDEF 1,0 (8., 75., 1., 50.)
WORK 1,0 /ON
WORK 1,0 /OFF

;=== a process that is ON at the end or at a CALL (advice)
; OPT-3.33 OPT-3.34 OPT-E.7407 OPT-E.7408
; rmlcell: allow 7033 in file
WORK 0,0/ON
CALL 2                   ; expect 7407
WORK 0,1/ON              ; expect 7401
SPEED 10                 ; expect 7408

;=== a WORK with /END switches itself off (advice)
; OPT-3.34 OPT-3.38 OPT-E.7407 OPT-E.7408
; rmlcell: allow 7033 in file
WORK 0,0/ON
WORK 0,0/ON/END (IL[20])
WAIT NOT IL[87]
CALL 2
WORK 0,0/ON/END (IL[20])
WAIT NOT IL[87]

;=== WORK 2 OFF with the beam on (advice)
; OPT-3.24 OPT-E.7411
; rmlcell: allow 7033 in file
WORKDEF 2,5 (15)
WORK 2,5/ON
WORK 0,0/ON
WORK 2,5/OFF             ; expect 7411
WORK 0,0/OFF

;=== what a subroutine does not touch is as before (advice)
; OPT-3.09 OPT-3.10 OPT-7.20
; rmlcell: allow 7033 in file
GOSUB 10
WORK 1,3/ON              ; expect 7401
WORK 1,3/OFF
ENDTASK
10 WORK 0,0/OFF
RETURN

;=== a process that a subroutine switched on is ON at a CALL (advice)
; OPT-3.33 OPT-3.36 OPT-E.7407
OL[11]=ON
GOSUB 10
CALL 2                   ; expect 7407
ENDTASK
10 WORK 0,0/ON
DELAY 1
RETURN

;=== and at the end (advice)
; OPT-3.34 OPT-3.36 OPT-E.7408
OL[11]=ON
GOSUB 10
ENDTASK                  ; expect 7408
10 WORK 0,0/ON
DELAY 1
RETURN

;=== on one path of a subroutine, two GOSUBs deep (advice)
; OPT-3.09 OPT-3.34 OPT-7.21
OL[11]=ON
GOSUB 10
WORK 1,3/ON              ; expect 7401
WORK 1,3/OFF
WORK 1,4/ON
WORK 1,4/OFF
ENDTASK                  ; expect 7408
10 GOSUB 20
WORKDEF 1,4 (8., 75., 1., 50.)
RETURN
20 IF IL[20] THEN 21
WORKDEF 1,3 (8., 75., 1., 50.)
WORK 0,0/ON
21 RETURN

;=== COORD and PATH are as before behind a subroutine (advice)
; OPT-2.08 OPT-7.20 OPT-E.7302
COORD ROBOT
PATH LIN
GOSUB 10
MOVE (1000.,900.,-500.,0.,0.)        ; expect 7302
ENDTASK
10 SPEED 5
RETURN

;=== an assignment to a variable leaves the gases (advice)
; OPT-5.40 OPT-7.20 OPT-E.7409
OL[8]=ON
GOSUB 10
OL[9]=ON                 ; expect 7409
ENDTASK
10 VR[1]=5
RETURN

;=== a subroutine may switch the process (advice)
; OPT-3.36
; rmlcell: allow 7033 in file
WORK 0,0/ON
GOSUB 100
CALL 2
ENDTASK
100 WORK 0,0/OFF
RETURN

;=== /FLY where the machine must stop (advice)
; OPT-2.47 OPT-2.48 OPT-2.49 OPT-E.7032 OPT-2.45
COORD ABSOL
PATH LIN
MOVE (1.,2.,3.,0.,0.)/FLY
SPEED 10
OL[11] = ON
MOVE (10.,2.,3.,0.,0.)/FLY           ; expect 7032
DELAY 1
MOVE (20.,2.,3.,0.,0.)/FLY           ; expect 7032
VR[0] = IA[0]
MOVE (30.,2.,3.,0.,0.)/FLY           ; expect 7032
MOVE (40.,2.,3.,0.,0.)/START (IL[16])
MOVE (50.,2.,3.,0.,0.)/FLY           ; expect 7303
COORD ROBOT
PATH PTP
MOVE (60.,2.,3.,0.,0.)/FLY           ; expect 7032

;=== /FLY in a loop with a counter is fine (advice)
; OPT-B.29 OPT-2.49
COORD ABSOL
PATH LIN
SPEED 50
VI[2] = 0
10 MOVE (10.,2.,3.,0.,0.)/FLY
VI[2] = VI[2] + 1
MOVE (20.,2.,3.,0.,0.)/FLY
IF VI[2] < 5 THEN 10
MOVE (30.,2.,3.,0.,0.)

;=== /FLY before WORK with and without a dwell (advice)
; OPT-2.50 OPT-3.20 OPT-3.21
COORD ABSOL
PATH LIN
SPEED 10
OL[11] = ON
WORKDEF 1,0 (8., 75., 1., 50.)
WORKDEF 1,1 (8., 75., 0., 50.)
MOVE (10.,2.,3.,0.,0.)/FLY           ; expect 7032
WORK 1,0/ON
MOVE (20.,2.,3.,0.,0.)
WORK 1,0/OFF
MOVE (30.,2.,3.,0.,0.)/FLY
WORK 1,1/ON
MOVE (40.,2.,3.,0.,0.)               ; expect 7033
WORK 1,1/OFF

;=== /FLY around a hole (advice)
; OPT-2.53
COORD ABSOL
PATH LIN
SPEED 10
MOVE (10.,2.,3.,0.,0.)/FLY           ; expect 7032
PATH HOLE (5.)
MOVE (20.,2.,3.,0.,0.)/VIA (20.,2.,9.,0.,0.)/FLY     ; expect 7032
PATH LIN
MOVE (30.,2.,3.,0.,0.)

;=== short moves with /FLY (advice)
; OPT-2.51 OPT-2.52 OPT-E.7314
COORD ABSOL
PATH LIN
SPEED 10
MOVE (10.,2.,3.,0.,0.)/FLY
MOVE (10.5,2.,3.,0.,0.)/FLY          ; expect 7314
MOVE (20.,2.,3.,0.,0.)
MOVE (20.005,2.,3.,0.,0.)/FLY
MOVE (20.010,2.,3.,0.,0.)/FLY
MOVE (20.015,2.,3.,0.,0.)/FLY        ; expect 7314
MOVE (30.,2.,3.,0.,0.)/FLY
MOVE (40.,2.,3.,0.,0.)

;=== a wait, a pause and a stop are no way (advice)
; OPT-2.51 OPT-E.7314
COORD ABSOL
PATH LIN
SPEED 10
MOVE (10.,2.,3.,0.,0.)
WAIT IL[1]
MOVE (10.5,2.,3.,0.,0.)/FLY          ; expect 7314
MOVE (20.,2.,3.,0.,0.)
PAUSE
MOVE (20.5,2.,3.,0.,0.)/FLY          ; expect 7314
MOVE (30.,2.,3.,0.,0.)
STOP
MOVE (30.5,2.,3.,0.,0.)/FLY          ; expect 7314
MOVE (40.,2.,3.,0.,0.)

;=== a WORKDEF leaves its process as it is (advice)
; OPT-3.33 OPT-E.7407
; rmlcell: allow 7033 in file
WORKDEF 1,0 (8., 75., 1., 50.)
WORK 1,0/ON
WORKDEF 1,0 (8., 75., 1., 50.)
CALL 2                               ; expect 7407

;=== a contour in the COORD of the machine (advice)
; OPT-2.09 OPT-2.08 OPT-E.7302
PATH LIN
SPEED 10
MOVE (10.,2.,3.,0.,0.)               ; expect 7302
MOVE (20.,2.,3.,0.,0.)
PATH PTP
MOVE (10.,2.,3.,0.,0.)

;=== an arc in COORD ROBOT fails, with or without /VIA (advice)
; OPT-2.08 OPT-E.7302
COORD ROBOT
PATH CIR
MOVE (10.,2.,3.,0.,0.)               ; expect 7302

;=== TASK 1 twice (advice)
; OPT-9.11 OPT-9.12
TASK 1
SPEED 5
TASK 1                               ; expect 7033
SPEED 6

;=== contour paths in COORD ROBOT, and arcs without /VIA (advice)
; OPT-2.08 OPT-2.21 OPT-2.29 OPT-E.7308 OPT-E.7302
COORD ROBOT
PATH LIN
SPEED 10
MOVE (10.,2.,3.,0.,0.)               ; expect 7302
PATH PTP
MOVE (10.,2.,3.,0.,0.)
COORD ABSOL
PATH CIR
MOVE (20.,2.,3.,0.,0.)               ; expect 7308
PATH HOLE (5.)
MOVE (30.,2.,3.,0.,0.)               ; expect 7308

;=== speeds, path and sensor of a cut (advice)
; OPT-5.45 OPT-5.46 OPT-5.47 OPT-E.7033
COORD ABSOL
PATH PTP
SPEED 90.
MOVE (10.,2.,3.,0.,0.)               ; expect 7033
SPEED 10
MOVE (20.,2.,3.,0.,0.)
WORK 0,0/ON                          ; expect 7033
DELAY .5
MOVE (30.,2.,3.,0.,0.)               ; expect 7033
WORK 0,0/OFF
PATH LIN
OL[11] = ON
WORK 0,0/ON
DELAY .5
SPEED 30
MOVE (40.,2.,3.,0.,0.)               ; expect 7033
WORK 0,0/OFF

;=== pierce without dwell, fast approach and retract (advice)
; OPT-3.20 OPT-5.46
COORD ABSOL
PATH LIN
OL[11] = ON
SPEED 30
MOVE (10.,2.,3.,0.,0.)               ; expect 7033
WORK 0,0/ON
SPEED 10
MOVE (20.,2.,3.,0.,0.)               ; expect 7033
WORK 0,0/OFF
SPEED 30
MOVE (30.,2.,3.,0.,0.)               ; expect 7033
MOVE (40.,2.,3.,0.,0.)

;=== WORK 1 with a delay of 0 does not dwell, a DELAY of 0 neither (advice)
; OPT-3.20 OPT-3.21 OPT-3.45
COORD ABSOL
PATH LIN
OL[11] = ON
SPEED 10
WORKDEF 1,0 (8., 75., 0., 50.)
WORKDEF 1,1 (8., 75., 1., 50.)
WORK 1,0/ON
MOVE (10.,2.,3.,0.,0.)               ; expect 7033
WORK 1,0/OFF
MOVE (20.,2.,3.,0.,0.)
WORK 1,1/ON
MOVE (30.,2.,3.,0.,0.)
WORK 1,1/OFF
WORK 0,0/ON
DELAY 0
MOVE (40.,2.,3.,0.,0.)               ; expect 7033
WORK 0,0/OFF
WORK 0,0/ON
MOVE (50.,2.,3.,0.,0.)/START (IL[20])
WORK 0,0/OFF

;=== the sensor is switched off while the beam cuts (advice)
; OPT-5.47
COORD ABSOL
PATH LIN
SPEED 10
OL[11] = ON
WORK 0,0/ON
DELAY 1
OL[11] = OFF
MOVE (10.,2.,3.,0.,0.)               ; expect 7033
MOVE (20.,2.,3.,0.,0.)
WORK 0,0/OFF
OL[11] = ON
WORK 0,0/ON
DELAY 1
MOVE (30.,2.,3.,0.,0.)
OL[11] = OFF
WORK 0,0/OFF

;=== a contour without a PATH is in the machine's default, told once (advice)
; OPT-2.10 OPT-5.45
COORD ABSOL
SPEED 10
OL[11] = ON
WORK 0,0/ON
DELAY 1
MOVE (10.,2.,3.,0.,0.)               ; expect 7033
MOVE (20.,2.,3.,0.,0.)
WORK 0,0/OFF

;=== a wrong normal point (advice)
; OPT-5.48
COORD ABSOL
PATH HOLE (5.)
MOVE (20.,2.,3.,0.,0.)/VIA (20.,2.,9.,0.,0.)
MOVE (20.,2.,3.,0.,0.)/VIA (29.,2.,9.,0.,0.)     ; expect 7033
MOVE (20.,2.,3.,0.,0.)/VIA (23.,2.,9.,0.,0.)
MOVE (0.0, 0.0, 1016.0, -2.871643, -1.570796)/via(0.0, -254.0, 1016.0, -2.871643, -1.570796)

;=== ROBOT moves inside a program with SYSDEF (advice)
; OPT-7.109
SYSDEF (1.,2.,3.,0.,0.,0.)
PATH PTP
COORD ROBOT
MOVE (10.,2.,3.,0.,0.)
COORD ABSOL
MOVE (20.,2.,3.,0.,0.)
COORD ROBOT
MOVE (30.,2.,3.,0.,0.)               ; expect 7033
COORD ABSOL
MOVE (40.,2.,3.,0.,0.)
COORD ROBOT
MOVE (50.,2.,3.,0.,0.)

;=== subroutines stand behind the last retract, and count where they are called (advice)
; OPT-7.109 OPT-3.47
SYSDEF (1.,2.,3.,0.,0.,0.)
PATH PTP
COORD ROBOT
MOVE (10.,2.,3.,0.,0.)
GOSUB 100
COORD ROBOT
MOVE (20.,2.,3.,0.,0.)               ; expect 7033
GOSUB 100
COORD ROBOT
MOVE (30.,2.,3.,0.,0.)
ENDTASK
100 COORD ABSOL
MOVE (40.,2.,3.,0.,0.)
COORD ROBOT
MOVE (50.,2.,3.,0.,0.)               ; expect 7033
COORD ABSOL
MOVE (60.,2.,3.,0.,0.)
RETURN

;=== contours in COORD ROBOT, and arcs without /VIA, on one path (advice)
; OPT-2.08 OPT-2.21 OPT-E.7302 OPT-E.7308
IF IL[20] THEN 5
COORD ROBOT
PATH LIN
5 MOVE (10.,2.,3.,0.,0.)             ; expect 7302
COORD ABSOL
IF IL[20] THEN 6
PATH CIR
6 MOVE (20.,2.,3.,0.,0.)             ; expect 7308

;=== COORD ROBOT on one path and PATH LIN on the other are no contour (advice)
; OPT-2.08
IF IL[20] THEN 5
COORD ROBOT
PATH PTP
GOTO 6
5 COORD ABSOL
PATH LIN
6 MOVE (10.,2.,3.,0.,0.)

;=== one assist gas at a time (advice)
; OPT-5.40 OPT-E.7409
OL[8] = ON
OL[9] = ON                           ; expect 7409
OL[8] = OFF
OL[9] = OFF
OL[8] = ON

;=== the other assist gas on one path, and both by one ASSIGN (advice)
; OPT-5.40 OPT-7.102 OPT-E.7409
IF IL[20] THEN 5
OL[8] = ON
5 OL[9] = ON             ; expect 7409
ASSIGN OL[8] = 2 /2
ASSIGN OL[8] = 3 /2      ; expect 7409
ASSIGN OL[8] = 1 /2
ASSIGN OL[9] = 1 /1      ; expect 7409

;=== code that is never reached (advice)
; OPT-3.47
GOTO 20
SPEED 5                              ; expect 7033
SPEED 6
20 ENDTASK

;=== subroutines and their returns (advice)
; OPT-7.20 OPT-7.22 OPT-E.7504
GOSUB 100
GOSUB 200
100 SPEED 5
RETURN                               ; expect 7504
200 SPEED 6                          ; expect 7033
ENDTASK

;=== ENDTASK keeps the program out of its subroutine (advice)
; OPT-3.47 OPT-7.20
GOSUB 100
ENDTASK
100 SPEED 5
RETURN

;=== behind a subroutine that never comes back nothing is known (advice)
; rmlcell: allow 7033 in file
GOSUB 10
WORK 1,3/ON
WORK 1,3/OFF
ENDTASK
10 GOTO 10

;=== a RETURN that no GOSUB leads to (advice)
; OPT-7.22 OPT-E.7504
SPEED 5
RETURN                   ; expect 7504

;=== a FUNCTION ends with its RETURN (advice)
; OPT-7.22 OPT-9.11
TASK 1
SPEED 5
RETURN

;=== variables that nothing in the program sets are told once (advice)
; OPT-1.16 OPT-1.17 OPT-7.104 OPT-7.105
VR[0] = VR[1] + 1        ; expect 7033
VR[0] = VR[1] + VR[2]    ; expect 7033
SPEED VR[64]
CALL VI[1] (VL[3])       ; expect 7033
VR[0] = VR[3] + VI[5]

;=== an ASSIGN, a subroutine and a FUNCTION set variables (advice)
; OPT-1.17 OPT-7.20 OPT-7.102 OPT-9.16
ASSIGN VL[3] = 5 /4
IF VL[6] THEN 10
10 GOSUB 20
SPEED VR[1]
DELAY VR[2]              ; expect 7033
VR[2] = 1.
FUNCTION 44
SPEED VR[3]
ENDTASK
20 VR[1] = 5.
RETURN

;=== variables that are read before the program sets them (advice)
; OPT-1.17
SPEED VR[64]
VR[0] = VR[1]                        ; expect 7033
IF IL[20] THEN 10
VR[1] = 5.
10 VR[2] = VR[1]                     ; expect 7033
VR[3] = VR[2]

;=== the end is told where the program comes to it (advice)
; OPT-3.34 OPT-E.7408 OPT-1.27
OL[11] = ON
GOSUB 50
WORK 0,0/ON
DELAY 1
GOTO 99                  ; expect 7408
50 SPEED 5
RETURN
99

;=== errors hide nothing that does not depend on them (advice)
; OPT-1.33 OPT-3.09 OPT-3.34 OPT-5.40
OL[8] = ON
OL[9] = ON               ; expect 7409
OL[11] = ON
WORK 1,3/ON              ; expect 7401
WORK 1,3/OFF
WORK 0,0/OF              ; expect 7003
OL[8] = ON
OL[9] = ON               ; expect 7409
GOSUB 20
OL[8] = SPED             ; expect 7011
OL[9] = ON
ENDTASK
20 SPEED 5

;=== comments silence findings, never errors (advice)
; OPT-1.18
OL[20] = ON              ; rmlcell: allow 7412
OL[20] = ON              ; rmlcell: allow 7413, expect 7412
; rmlcell: allow 7412
OL[20] = ON
OL[20] = ON              ; expect 7412
SPEED 101                ; rmlcell: allow 7004, expect 7004 7033

;=== a subroutine that calls itself (advice)
; OPT-7.21 OPT-E.7503
GOSUB 100
ENDTASK
100 IF IL[20] THEN 110
GOSUB 200
110 RETURN
200 GOSUB 100            ; expect 7503
RETURN

;=== sixteen GOSUBs inside each other fit, seventeen do not (advice)
; OPT-7.21 OPT-E.7503
GOSUB 1
GOSUB 2
ENDTASK
1 GOSUB 2
RETURN
2 GOSUB 3
RETURN
3 GOSUB 4
RETURN
4 GOSUB 5
RETURN
5 GOSUB 6
RETURN
6 GOSUB 7
RETURN
7 GOSUB 8
RETURN
8 GOSUB 9
RETURN
9 GOSUB 10
RETURN
10 GOSUB 11
RETURN
11 GOSUB 12
RETURN
12 GOSUB 13
RETURN
13 GOSUB 14
RETURN
14 GOSUB 15
RETURN
15 GOSUB 16
RETURN
16 GOSUB 17              ; expect 7503
RETURN
17 SPEED 5
RETURN

;=== what an assignment by a name without a value changes is not known (advice)
; OPT-1.33 OPT-1.17 OPT-5.40
DECLARE GAS = OL[8] + 1  ; expect 7014
DECLARE N = VR[1] + 1    ; expect 7014
OL[8] = ON
GAS = OFF
OL[9] = ON
VR[N] = 5.
SPEED VR[2]

;=== where a jump is wrong, any sequence number may be come to (advice)
; OPT-1.33 OPT-5.46
COORD ABSOL
PATH LIN
SPEED 80
10 MOVE (1.,2.,3.,0.,0.)
SPEED 80
MOVE (2.,2.,3.,0.,0.)    ; expect 7033
GOTO                     ; expect 7003

;=== a GOSUB to the end of the text (advice)
; OPT-1.27 OPT-7.20
GOSUB 99
ENDTASK
99

;=== a DEFINE is nothing that has to be reached (advice)
; OPT-3.47 OPT-9.22
GOTO 20
DEFINE PAR[0] = INT
20 SPEED 5

;=== a process that a GOSUB, not the program, takes to the end (advice)
; OPT-3.34 OPT-7.20
OL[11] = ON
WORK 0,0/ON
DELAY 1
GOSUB 99
WORK 0,0/OFF
ENDTASK
99

;=== behind a FUNCTION nothing is known (advice)
; OPT-9.16 OPT-3.09 OPT-5.47 OPT-5.48
FUNCTION 44
WORK 1,3/ON
WORK 1,3/OFF
COORD ABSOL
PATH HOLE (5.)
MOVE (20.,2.,3.,0.,0.)/VIA (29.,2.,9.,0.,0.)

;=== nor where there was one on a path (advice)
; OPT-9.16 OPT-5.47 OPT-5.48
IF IL[20] THEN 10
FUNCTION 44
10 WORK 0,0/ON
WORK 0,0/OFF
COORD ABSOL
PATH HOLE (5.)
MOVE (20.,2.,3.,0.,0.)/VIA (29.,2.,9.,0.,0.)

;=== behind a CALL the beam is off, no process is ON, and an offset may turn (advice)
; OPT-7.12 OPT-3.33 OPT-5.46 OPT-5.48
COORD ABSOL
PATH LIN
OL[11] = ON
WORK 0,0/ON
DELAY 1
CALL 2                   ; expect 7407
SPEED 30
MOVE (10.,0.,0.,0.,0.)
PATH HOLE (5.)
MOVE (20.,2.,3.,0.,0.)/VIA (29.,2.,9.,0.,0.)
CALL 2
ENDTASK

;=== a speed that is computed is not known (advice)
; OPT-2.34 OPT-5.46
COORD ABSOL
PATH LIN
SPEED 80
SPEED VR[64]
MOVE (1.,0.,0.,0.,0.)

;=== moves from where the way ends nobody knows, or along an arc, are not short (advice)
; OPT-2.51 OPT-2.54 OPT-2.18
COORD ABSOL
PATH LIN
SPEED 10
MOVE (10.,0.,0.,0.,0.)/TIME (1.,900)
MOVE (10.5,0.,0.,0.,0.)/FLY
MOVE (20.,0.,0.,0.,0.)
PATH CIR
MOVE (20.5,0.,0.,0.,0.)/VIA (25.,5.,0.,0.,0.)/FLY
MOVE (30.,0.,0.,0.,0.)/VIA (25.,5.,0.,0.,0.)
PATH PTP
MOVE (30.5,0.,0.,0.,0.)/FLY          ; expect 7314
MOVE (40.,0.,0.,0.,0.)
PATH HOLE (5.)
MOVE (40.,0.,0.,0.,0.)/VIA (40.,0.,6.,0.,0.)
PATH PTP
MOVE (40.5,0.,0.,0.,0.)/FLY
MOVE (50.,0.,0.,0.,0.)
ENDTASK
900 RETURN

;=== a program goes on from where its subroutine went (advice)
; OPT-7.20 OPT-2.51 OPT-B.22
COORD ABSOL
PATH LIN
SPEED 10
MOVE (0.,0.,0.,0.,0.)
MOVE (.9,0.,0.,0.,0.)/FLY            ; expect 7314
GOSUB 100
MOVE (20.,0.,0.,0.,0.)
GOSUB 200
SPEED 0
MOVE (10.,0.,0.,0.,0.)
MOVE (11.,0.,0.,0.,0.)   ; expect 7307
ENDTASK
100 MOVE (10.,0.,0.,0.,0.)
RETURN
200 MOVE (10.,0.,0.,0.,0.)
RETURN

;=== moves of 0.01 mm, to the last bit, are not shorter than that (advice)
; OPT-2.52
COORD ABSOL
PATH LIN
SPEED 10
MOVE (0.,0.,0.,0.,0.)/FLY
MOVE (.009999999,4.8059123E-6,2.2585351E-9,0.,0.)/FLY
MOVE (0.,0.,0.,0.,0.)/FLY
MOVE (.009999999,4.8059123E-6,2.2585351E-9,0.,0.)/FLY
MOVE (.005,0.,0.,0.,0.)/FLY
MOVE (0.,0.,0.,0.,0.)/FLY
MOVE (.009999999,4.8059123E-6,2.2585351E-9,0.,0.)/FLY
MOVE (10.,0.,0.,0.,0.)/FLY
MOVE (20.,0.,0.,0.,0.)

;=== a group that runs past the last variable (advice)
; OPT-7.103 OPT-7.105 OPT-E.7206
ASSIGN VL[95] = 0 /8     ; expect 7206 7413
