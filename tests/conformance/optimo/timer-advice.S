; Advice where a GOSUB comes at a time, not at a place: TIMER and /TIME.

;=== what the GOSUB of a TIMER touches is not known, the rest is (advice)
; OPT-5.40 OPT-B.59
OL[11]=ON
OL[8]=ON
TIMER (5.,10)
OL[9]=ON
WORK 0,0/ON
DELAY 1
CALL 2                   ; expect 7407
ENDTASK
10 OL[8]=OFF
RETURN

;=== the GOSUB of a /TIME may be made or not (advice)
; OPT-2.54 OPT-5.40
COORD ABSOL
PATH LIN
SPEED 10
MOVE (10.,2.,3.,0.,0.)/TIME (5.,10)
OL[9]=ON                 ; expect 7409
ENDTASK
10 OL[8]=ON
RETURN

;=== before the TIMER, and behind TIMER /DIS, all is known (advice)
; OPT-5.40 OPT-B.59
OL[11]=ON
OL[8]=ON
OL[9]=ON                 ; expect 7409
OL[9]=OFF
TIMER (5.,10)
DELAY 1
OL[9]=ON
OL[9]=OFF
TIMER /DIS
OL[8]=ON
OL[9]=ON                 ; expect 7409
ENDTASK
10 OL[8]=OFF
RETURN

;=== a program without a TIMER that is reached (advice)
; OPT-5.40 OPT-B.59
GOTO 5
TIMER (5.,10)            ; expect 7033
5 OL[8]=ON
OL[9]=ON                 ; expect 7409
ENDTASK
10 OL[8]=OFF             ; expect 7033
RETURN

;=== a TIMER that a subroutine arms, and one that lives in a subroutine only (advice)
; OPT-5.40 OPT-B.59 OPT-7.20
OL[8]=ON
GOSUB 20
OL[9]=ON
OL[9]=OFF
TIMER /DIS
OL[8]=ON
OL[9]=ON                 ; expect 7409
OL[9]=OFF
GOSUB 30
OL[9]=ON
ENDTASK
10 OL[8]=OFF
RETURN
20 TIMER (5.,10)
RETURN
30 TIMER (5.,10)
DELAY 9
TIMER /DIS
RETURN

;=== a TIMER that cancels itself, or sets itself anew, may still come once (advice)
; OPT-5.40 OPT-B.59
OL[8]=ON
TIMER (5.,10)
OL[9]=ON
ENDTASK
10 OL[8]=OFF
TIMER /DIS
RETURN

;=== a FUNCTION arms no TIMER here, and leaves one that is armed (advice)
; OPT-9.15 OPT-B.59
FUNCTION 44
OL[8]=ON
OL[9]=ON                 ; expect 7409
OL[9]=OFF
TIMER (5.,10)
FUNCTION 44
OL[8]=ON
OL[9]=ON
ENDTASK
10 OL[8]=OFF
RETURN

;=== the GOSUB of a /TIME begins behind its MOVE (advice)
; OPT-2.54 OPT-3.33 OPT-B.59
COORD ABSOL
PATH LIN
SPEED 10
OL[11]=ON
WORK 0,0/ON
DELAY 1
MOVE (10.,2.,3.,0.,0.)/TIME (5.,10)
WORK 0,0/OFF
ENDTASK
10 CALL 2                ; expect 7407
RETURN

;=== the GOSUB of a TIMER begins anywhere: nothing is told of where it stands (advice)
; OPT-3.33 OPT-B.59
OL[11]=ON
WORK 0,0/ON
DELAY 1
TIMER (5.,10)
DELAY 9
WORK 0,0/OFF
ENDTASK
10 CALL 2
RETURN

;=== what the GOSUB of a TIMER changes may be changed behind it: speed (advice)
; OPT-5.46 OPT-B.59
COORD ABSOL
PATH LIN
SPEED 90
MOVE (10.,2.,3.,0.,0.)               ; expect 7033
TIMER (5.,10)
MOVE (20.,2.,3.,0.,0.)
ENDTASK
10 SPEED 5
RETURN

;=== and what it leaves is not: speed (advice)
; OPT-5.46 OPT-B.59
COORD ABSOL
PATH LIN
SPEED 90
TIMER (5.,10)
MOVE (20.,2.,3.,0.,0.)               ; expect 7033
ENDTASK
10 OL[16] = ON
RETURN

;=== COORD and PATH of a TIMER's GOSUB (advice)
; OPT-2.08 OPT-B.59 OPT-E.7302
COORD ROBOT
PATH LIN
TIMER (5.,10)
MOVE (1000.,900.,-500.,0.,0.)
ENDTASK
10 COORD ABSOL
RETURN

;=== COORD and PATH that it leaves (advice)
; OPT-2.08 OPT-B.59 OPT-E.7302
COORD ROBOT
PATH LIN
TIMER (5.,10)
MOVE (1000.,900.,-500.,0.,0.)        ; expect 7302
ENDTASK
10 OL[16] = ON
RETURN

;=== the beam that it switches off (advice)
; OPT-5.46 OPT-B.59
COORD ABSOL
PATH LIN
OL[11] = ON
WORK 0,0/ON
DELAY 1
SPEED 30
TIMER (5.,10)
MOVE (10.,2.,3.,0.,0.)
WORK 0,0/OFF
ENDTASK
10 WORK 0,0/OFF
RETURN

;=== the beam that it leaves on (advice)
; OPT-5.46 OPT-B.59
COORD ABSOL
PATH LIN
OL[11] = ON
WORK 0,0/ON
DELAY 1
SPEED 30
TIMER (5.,10)
MOVE (10.,2.,3.,0.,0.)               ; expect 7033
WORK 0,0/OFF
ENDTASK
10 OL[16] = ON
RETURN

;=== the sensor that it switches on, and leaves off (advice)
; OPT-5.47 OPT-B.59
TIMER (5.,10)
WORK 0,0/ON
WORK 0,0/OFF
TIMER (5.,20)
OL[11] = OFF
WORK 0,0/ON
WORK 0,0/OFF
ENDTASK
10 OL[11] = ON
RETURN
20 OL[16] = ON
RETURN

;=== the sensor that it leaves off (advice)
; OPT-5.47 OPT-B.59
TIMER (5.,20)
WORK 0,0/ON              ; expect 7033
WORK 0,0/OFF
ENDTASK
20 OL[16] = ON
RETURN

;=== the offset that it turns (advice)
; OPT-5.48 OPT-B.59
COORD ABSOL
PATH HOLE (5.)
MOVE (20.,2.,3.,0.,0.)/VIA (29.,2.,9.,0.,0.)     ; expect 7033
TIMER (5.,10)
MOVE (20.,2.,3.,0.,0.)/VIA (29.,2.,9.,0.,0.)
ENDTASK
10 SYSDEF (0.,0.,0.,0.,1.,0.)
RETURN

;=== the offset that it leaves (advice)
; OPT-5.48 OPT-B.59
COORD ABSOL
PATH HOLE (5.)
TIMER (5.,10)
MOVE (20.,2.,3.,0.,0.)/VIA (29.,2.,9.,0.,0.)     ; expect 7033
ENDTASK
10 OL[16] = ON
RETURN

;=== a WORKDEF of its own (advice)
; OPT-3.09 OPT-B.59 OPT-E.7401
; rmlcell: allow 7033 in file
TIMER (5.,10)
WORK 1,3/ON
WORK 1,3/OFF
ENDTASK
10 WORKDEF 1,3 (8., 75., 1., 50.)
RETURN

;=== no WORKDEF of its own (advice)
; OPT-3.09 OPT-B.59 OPT-E.7401
TIMER (5.,10)
OL[11] = ON
WORK 1,4/ON              ; expect 7401
WORK 1,4/OFF
ENDTASK
10 OL[16] = ON
RETURN

;=== a tool of its own: where the tip is, is not known (advice)
; OPT-B.22 OPT-B.59 OPT-E.7307
COORD ABSOL
PATH LIN
SPEED 70
MOVE (1.,2.,3.,0.,0.)
SPEED 0
TIMER (5.,10)
MOVE (9.,2.,3.,0.,0.)
ENDTASK
10 TCP (0,0,6/0,0,1)
RETURN

;=== no tool of its own (advice)
; OPT-B.22 OPT-B.59 OPT-E.7307
COORD ABSOL
PATH LIN
SPEED 70
MOVE (1.,2.,3.,0.,0.)
SPEED 0
TIMER (5.,10)
MOVE (9.,2.,3.,0.,0.)    ; expect 7307
ENDTASK
10 OL[16] = ON
RETURN

;=== a TIMER that is set on one path may come (advice)
; OPT-5.40 OPT-B.59
IF IL[20] THEN 5
TIMER (5.,10)
5 OL[8]=ON
OL[9]=ON
ENDTASK
10 OL[8]=OFF
RETURN

;=== also where the path is one of a subroutine (advice)
; OPT-5.40 OPT-B.59 OPT-7.20
GOSUB 20
OL[8]=ON
OL[9]=ON
ENDTASK
10 OL[8]=OFF
RETURN
20 IF IL[20] THEN 21
TIMER (5.,10)
21 RETURN

;=== one that was cancelled on one path, too (advice)
; OPT-5.40 OPT-B.59
TIMER (5.,10)
IF IL[20] THEN 5
TIMER /DIS
5 OL[8]=ON
OL[9]=ON
ENDTASK
10 OL[8]=OFF
RETURN

;=== and in an error handler (advice)
; OPT-3.53 OPT-5.40 OPT-B.59
TIMER (5.,10)
ERR 900
DELAY 1
ENDTASK
10 OL[8]=OFF
RETURN
900 OL[8]=ON
OL[9]=ON
ENDTASK

;=== a short move from which its GOSUB may have gone on (advice)
; OPT-2.51 OPT-B.59
COORD ABSOL
PATH LIN
SPEED 10
MOVE (0.,0.,0.,0.,0.)
MOVE (.9,0.,0.,0.,0.)/FLY            ; expect 7032
TIMER (9.,10)
MOVE (20.,0.,0.,0.,0.)
ENDTASK
10 MOVE (5.,0.,0.,0.,0.)
RETURN

;=== a short move that it leaves (advice)
; OPT-2.51 OPT-B.59
COORD ABSOL
PATH LIN
SPEED 10
MOVE (0.,0.,0.,0.,0.)
MOVE (.9,0.,0.,0.,0.)/FLY            ; expect 7032 7314
TIMER (9.,10)
MOVE (20.,0.,0.,0.,0.)
ENDTASK
10 OL[16] = ON
RETURN
