; Each limit of the compiler from both sides: what is just inside is no finding of any kind.

;=== percentages end at 0 and 100
; OPT-2.35 OPT-2.36 OPT-2.38 OPT-E.7004
SPEED 100
SPEED 100.01             ; expect 7004
SPEED 0
SPEED -.01               ; expect 7004
ACCEL 100.
ACCEL 100.01             ; expect 7004
ACCEL 0
ACCEL -(.01)             ; expect 7004
OVERSH 100
OVERSH 100.01            ; expect 7004
OVERSH 0
OVERSH -.01              ; expect 7004

;=== a delay begins at 0 and has no end
; OPT-3.45 OPT-2.54 OPT-B.59 OPT-E.7004
5 DELAY 0
DELAY -.001              ; expect 7004
DELAY 1E6
TIMER (0.,5)
TIMER (-.001,5)          ; expect 7004
MOVE (1.,2.,3.,0.,0.)/TIME (0.,5)
MOVE (1.,2.,3.,0.,0.)/TIME (-.001,5) ; expect 7004

;=== error numbers go from 1 to 9999, programs from 1 to 99
; OPT-3.61 OPT-7.06 OPT-9.01 OPT-E.7004
SETERR 1
SETERR 9999
SETERR 0                 ; expect 7004
SETERR 10000             ; expect 7004
GO 1
GO 99
GO 0                     ; expect 7004
GO 100                   ; expect 7004
CALL 1
CALL 99
CALL 0                   ; expect 7004
CALL 100                 ; expect 7004
FUNCTION 1
FUNCTION 99
FUNCTION 0               ; expect 7004
FUNCTION 100             ; expect 7004

;=== steps go from 1 to 9999, their programs to 99
; OPT-6.15 OPT-E.7004
BREAK 1
BREAK 9999, 99
BREAK 0                  ; expect 7004
BREAK 10000              ; expect 7004
BREAK 5, 1
BREAK 5, 100             ; expect 7004
SIMUL 1
SIMUL 9999, 99
SIMUL 0                  ; expect 7004
SIMUL 10000              ; expect 7004
SIMUL 5, 100             ; expect 7004

;=== values of WORKDEF 1
; OPT-3.06 OPT-3.07 OPT-3.08 OPT-E.7403
WORKDEF 1,0 (.01, 0., 0., 0.)
WORKDEF 1,0 (100., 100., 99., 100.)
WORKDEF 1,0 (0., 80., 1., 90.)       ; expect 7004
WORKDEF 1,0 (100.01, 80., 1., 90.)   ; expect 7004
WORKDEF 1,0 (8., 100.01, 1., 90.)    ; expect 7004
WORKDEF 1,0 (8., -.01, 1., 90.)      ; expect 7004
WORKDEF 1,0 (8., 80., -.01, 90.)     ; expect 7004
WORKDEF 1,0 (8., 80., 1., -.01)      ; expect 7004
WORKDEF 1,0 (8., 80., 1., 90., 1)
WORKDEF 1,0 (8., 80., 1., 90., 63)
WORKDEF 1,0 (8., 80., 1., 90., 0)    ; expect 7403
WORKDEF 1,0 (8., 80., 1., 90., 64)   ; expect 7403
WORKDEF 2,0 (1)
WORKDEF 2,0 (63)
WORKDEF 2,0 (1.9)
WORKDEF 2,0 (63.99999)
WORKDEF 2,0 (64.)                    ; expect 7403
WORKDEF 2,0 (.999)                   ; expect 7403
WORKDEF 2,0 (0)                      ; expect 7403
WORKDEF 2,0 (64)                     ; expect 7403

;=== kinds of processes and their numbers
; OPT-3.02 OPT-3.13 OPT-E.7402
WORKDEF 2,9 (5)
WORKDEF 0,9
WORKDEF 3,0              ; expect 7402
WORKDEF 0,10             ; expect 7402
WORKDEF 2,10 (5)         ; expect 7402
WORK 2,9/OFF
WORK 3,9/OFF             ; expect 7402
WORK 2,10/OFF            ; expect 7402

;=== counts of values
; OPT-2.01 OPT-2.31 OPT-7.28 OPT-4.64 OPT-E.7019
MOVE (1,2,3,4,5)
MOVE (1,2,3,4)           ; expect 7019
MOVE (1,2,3,4,5,6)       ; expect 7019
MOVE (1,2,3,4,5)/VIA (1,2,3,4,5)
MOVE (1,2,3,4,5)/VIA (1,2,3,4)       ; expect 7019
MOVE (1,2,3,4,5)/VIA (1,2,3,4,5,6)   ; expect 7019
SYSDEF (1,2,3,4,5,6)
SYSDEF (1,2,3,4,5)       ; expect 7019
SYSDEF (1,2,3,4,5,6,7)   ; expect 7019
TCP (0,0,6,0,0,1)
TCP (0,0,6,0,0)          ; expect 7019
TCP (0,0,6,0,0,1,2)      ; expect 7019
TCP (0,0/6,0,0,1)        ; expect 7019
TCP (0,0,6,0/0,1)        ; expect 7019

;=== counts of values of WORKDEF
; OPT-3.03 OPT-3.04 OPT-3.06 OPT-E.7019
WORKDEF 1,0 (8., 80., 1., 90.)
WORKDEF 1,0 (8., 80., 1., 90., 5)
WORKDEF 1,0 (8., 80., 1.)            ; expect 7019
WORKDEF 1,0 (8., 80., 1., 90., 5, 6) ; expect 7019
WORKDEF 2,0              ; expect 7019
WORKDEF 2,0 (5, 6)       ; expect 7019
WORKDEF 0,0 (5)          ; expect 7019

;=== the indices of each group
; OPT-7.59 OPT-9.21 OPT-E.7017
VR[99] = VR[0]
VR[0] = VR[100]          ; expect 7017
VI[2] = VI[99]
VI[100] = 1              ; expect 7017
VL[99] = VL[0]
VL[100] = ON             ; expect 7017
VL[0] = IL[99]
VL[0] = IL[100]          ; expect 7017
OL[99] = OL[0]
OL[100] = ON             ; expect 7017
VR[0] = IA[99] + OA[99]
VR[0] = IA[100]          ; expect 7017
OA[100] = 1.             ; expect 7017
VR[0] = PAR[7]
VR[0] = PAR[8]           ; expect 7017
DEFINE PAR[0] = INT

;=== groups of ASSIGN
; OPT-7.102 OPT-7.103 OPT-E.7206 OPT-E.7004
ASSIGN OL[32]=15 /4
ASSIGN OL[32]=16 /4      ; expect 7206
ASSIGN OL[32]=0 /4
ASSIGN OL[32]=-1 /4      ; expect 7206
ASSIGN OL[92]=255 /8
ASSIGN OL[92]=256 /8     ; expect 7206
ASSIGN OL[93]=0 /8       ; expect 7206
ASSIGN OL[99]=1 /1
ASSIGN OL[99]=2 /1       ; expect 7206
ASSIGN OL[84]=32767 /16
ASSIGN OL[85]=0 /16      ; expect 7206
ASSIGN OL[32]=0 /17      ; expect 7004
ASSIGN OL[32]=0 /0       ; expect 7004

;=== numbers of REAL end at 2^63, exponents at 99
; OPT-7.55 OPT-7.62 OPT-E.7004 OPT-E.7005
VR[0] = 9.223372E18
VR[0] = -9.223372E18
VR[0] = 9.223373E18      ; expect 7004
VR[0] = -9.223373E18     ; expect 7004
VR[0] = 0E99
VR[0] = 1E-99
VR[0] = 0E100            ; expect 7005
VR[0] = 1E-100           ; expect 7005

;=== names of eight characters are whole, reserved words are whole words
; OPT-7.46 OPT-7.48 OPT-E.7009 OPT-E.7012
DECLARE ABCDEFGH = VR[1]
DECLARE ABCDEFGX1 = VR[2]            ; expect 7012
ABCDEFGX = ABCDEFGH
DECLARE SPEEDS = VR[3]
DECLARE FUNCTIO = VR[4]
DECLARE FUNCTIONS = VR[5]            ; expect 7009
DECLARE D = VR[6]
DECLARE S = VR[7]                    ; expect 7009

;=== what is written and what is read only
; OPT-7.66 OPT-E.7016
VI[97] = 1
VI[98] = 1               ; expect 7016
VI[99] = 1               ; expect 7016
OA[1] = 1.
OA[0] = 1.               ; expect 7016
IL[99] = ON              ; expect 7016
IA[99] = 1.              ; expect 7016
VR[98] = 1.
VL[99] = ON
ASSIGN IL[32] = 0 /4     ; expect 7016

;=== jumps to what is there, each way
; OPT-7.16 OPT-E.7008
10 GOTO 20
20 GOSUB 10
IF VL[1] THEN 10 ELSE 20
ERR 20
GOTO VI[2] (10, 20)
TIMER (1.,10)
MOVE (1.,2.,3.,0.,0.)/TIME (1.,20)
GOTO 21                  ; expect 7008
GOSUB 11                 ; expect 7008
IF VL[1] THEN 10 ELSE 21 ; expect 7008
IF VL[1] THEN 11 ELSE 20 ; expect 7008
ERR 21                   ; expect 7008
GOTO VI[2] (10, 21)      ; expect 7008
TIMER (1.,11)            ; expect 7008
MOVE (1.,2.,3.,0.,0.)/TIME (1.,21)   ; expect 7008

;=== sequence numbers at both ends
; OPT-1.23 OPT-E.7006
0 GOTO 9999
9999 GOTO 0
10000 SPEED 5            ; expect 7006
GOSUB 10000              ; expect 7006

;=== eight parameters
; OPT-9.20 OPT-E.7027
CALL 6 (1,2,3,4,5,6,7,8)
CALL 6 (1,2,3,4,5,6,7,8,9)           ; expect 7027
FUNCTION 6 (1,2,3,4,5,6,7,8)
FUNCTION 6 (1,2,3,4,5,6,7,8,9)       ; expect 7027
FUNCTION 6
CALL 6

;=== DEFINE before its first use, of an index that PAR has
; OPT-9.22 OPT-9.25 OPT-E.7025 OPT-E.7026
DEFINE PAR[7] = INT
DEFINE PAR[6] = LOGIC
VR[1] = PAR[7]
VR[1] = PAR[5]
DEFINE PAR[6] = INT      ; expect 7025
DEFINE PAR[5] = INT      ; expect 7026
DEFINE PAR[4] = FLOAT
DEFINE PAR[8] = FLOAT    ; expect 7017

;=== what is told of a TASK
; OPT-9.11 OPT-W.44 OPT-E.7023
TASK 1
TASK 2                   ; expect 7023
TASK 0                   ; expect 7023

;=== a group of parameters ends with PAR[7]
; OPT-7.102 OPT-7.103 OPT-9.21 OPT-E.7206
DEFINE PAR[6] = LOGIC
ASSIGN PAR[6]=3 /2
ASSIGN PAR[6]=0 /3       ; expect 7206

;=== indices by name, at both ends
; OPT-7.59 OPT-7.60 OPT-9.21 OPT-E.7017
DECLARE FIRST = 0
DECLARE BELOW = -1
DECLARE LAST = 99
DECLARE BEYOND = 100
DECLARE LASTPAR = 7
DECLARE NOPAR = 8
VR[FIRST] = VR[LAST]
VR[1] = VR[BELOW]        ; expect 7017
VR[1] = VR[BEYOND]       ; expect 7017
VR[1] = PAR[FIRST] + PAR[LASTPAR]
VR[1] = PAR[NOPAR]       ; expect 7017

;=== a literal too long for its digits counts by its size
; OPT-7.54 OPT-7.62 OPT-B.42 OPT-E.7004
VR[0] = 100000000000000000000000000000000000000000000000000.   ; expect 7004
VR[0] = 100000000000000000000000000000000000000000000000000    ; expect 7004
VR[0] = 100000000000000000000000000000000000000000000000000E-40
VR[0] = 100000000000000000000000000000000000000000000000000E-99
VR[0] = .00000000000000000000000000000000000000000000000000001E5
VR[0] = .00000000000000000000000000000000000000000000000000001E99  ; expect 7004
