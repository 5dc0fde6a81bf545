;=== sequence numbers go from 0 to 9999
; OPT-1.23 OPT-E.7006
0 SPEED 5
9999 SPEED 5
10000 SPEED 5            ; expect 7006
GOTO 10000               ; expect 7006

;=== a sequence number is never a name
; OPT-1.24
START1 SPEED 5           ; expect 7011

;=== a sequence number appears once, leading zeros do not count
; OPT-1.25 OPT-E.7007 OPT-B.48
10 SPEED 5
010 SPEED 6              ; expect 7007
0010 SPEED 7             ; expect 7007

;=== numbers need not ascend nor be used
; OPT-1.26
30 SPEED 5
20 SPEED 6
GOTO 20

;=== a lone number belongs to the next instruction
; OPT-1.27
GOTO 15
GOTO 16
GOTO 17
15 ;$cleft
16 MOVE (1.,2.,3.,0.,0.)
17

;=== digits at the start are the number, never part of an exponent
; OPT-1.28
DECLARE E1 = VR[1]
10 E1 = 5.
20E1 = 6.
GOTO 10
GOTO 20

;=== a jump to nowhere is a warning
; OPT-7.16 OPT-E.7008 OPT-7.19 OPT-2.56 OPT-3.59
IF VL[1] THEN 99                                ; expect 7008
GOTO VI[2] (98, 97)                             ; expect 7008 7008
MOVE (1.,2.,3.,0.,0.) /TIME (60., 999)          ; expect 7008
ERR 5                                           ; expect 7008
TIMER (1., 6)                                   ; expect 7008

;=== what was parted from its IF is one error
; OPT-1.30 OPT-1.33 OPT-7.23
IF VL[1]                 ; expect 7003
THEN 5
ELSE 6
5 SPEED 5
6 IF VL[1] THEN 5
ELSE 6                   ; expect 7003

;=== jumps take sequence numbers as literals
; OPT-B.51 OPT-7.25
GOSUB VI[2]              ; expect 7003
ERR VI[1]                ; expect 7003
GOTO VI[2]               ; expect 7003
IF VL[0] THEN SPEED 5    ; expect 7003
GOTO 5.                  ; expect 7003
