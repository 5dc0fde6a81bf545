;=== GO and CALL
; OPT-7.01 OPT-7.02 OPT-7.06 OPT-7.07 OPT-B.86
DECLARE NEXTPRG = 46
DECLARE TOOHIGH = 100
GO 46
GO 46/C
GO VI[1]
GO NEXTPRG
CALL 02
CALL VI[1] (1.)
CALL 0                   ; expect 7004
GO 100                   ; expect 7004
CALL TOOHIGH             ; expect 7004
CALL 2.                  ; expect 7003
CALL VL[1]               ; expect 7018

;=== GO sets one mode
; OPT-W.18 OPT-W.65 OPT-W.66
GO 46 /R
GO 46 /S
GO 46 /C /R              ; expect 7021
CALL 46 /C               ; expect 7020

;=== FUNCTION takes a constant
; OPT-9.01 OPT-E.7029 OPT-W.16
DECLARE RECT = 44
DECLARE VARIANT = VI[2]
FUNCTION 44
FUNCTION RECT (7.)
FUNCTION VI[2]           ; expect 7029
FUNCTION VARIANT         ; expect 7029
FUNCTION 100             ; expect 7004

;=== at most eight parameters, any expression
; OPT-9.20 OPT-9.29 OPT-E.7027
FUNCTION 6 (VR[40], 5, VR[1]+1., IL[4])
CALL 6 (1,2,3,4,5,6,7,8)
CALL 6 (1,2,3,4,5,6,7,8,9)   ; expect 7027
CALL 6 ()                ; expect 7003

;=== DEFINE gives PAR a type
; OPT-9.22 OPT-9.23 OPT-9.24 OPT-E.7025 OPT-E.7036
DEFINE PAR[0] = FLOAT
DEFINE PAR[1] = LOGIC
DEFINE PAR[2] = INT
VL[1] = PAR[1]
VR[1] = PAR[0] + PAR[2]
DEFINE VR[1] = PAR[0]    ; expect 7025
DEFINE PAR[3] = VR       ; expect 7025
DEFINE PAR[8] = INT      ; expect 7017

;=== DEFINE PAR without index is PAR[0], and comes once
; OPT-9.24 OPT-B.88
DEFINE PAR = INT         ; expect 7036
DEFINE PAR[0] = INT      ; expect 7025

;=== DEFINE comes before the first use, a DECLARE is a use
; OPT-9.25 OPT-E.7026
VR[1] = PAR[1]
DEFINE PAR[1] = INT      ; expect 7026
DECLARE D = PAR[2]
DEFINE PAR[2] = LOGIC    ; expect 7026

;=== PAR has eight places
; OPT-9.21
PAR[7] = 1.
LET PAR[8] = 1.          ; expect 7017

;=== computed GOTO
; OPT-7.17 OPT-7.18
10 GOTO VI[2] (10, 20)
20 GOTO VR[2] (10, 20)
GOTO VL[2] (10, 20)      ; expect 7018
GOTO VI[2] (10.)         ; expect 7003

;=== LET is optional
; OPT-7.91 OPT-W.24
LET VR [12] = -7.52
VR [12] = -7.52
LET 5 = 3                ; expect 7003
VR[12] -7.52             ; expect 7003

;=== TIMER, BREAK, SIMUL, TASK
; OPT-B.59 OPT-6.11 OPT-6.16 OPT-6.15 OPT-W.44
900 TIMER (5., 900)
TIMER (5., 900) /AUTO
TIMER /DIS
TIMER /AUTO              ; expect 7003
TIMER (5., 900) /DIS     ; expect 7020
BREAK 7
BREAK 7, 45
SIMUL 10, 45
SIMUL 0                  ; expect 7004
BREAK 10, 100            ; expect 7004
TASK 1
TASK 2                   ; expect 7023
