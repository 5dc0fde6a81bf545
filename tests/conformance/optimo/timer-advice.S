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
