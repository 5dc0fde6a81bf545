;=== instructions that stand alone
; OPT-W.13 OPT-W.28 OPT-W.32 OPT-W.34 OPT-W.42
ENDTASK
NOERR
PAUSE
RETURN
STOP
ZERO

;=== instructions with one value
; OPT-W.01 OPT-W.09 OPT-W.30 OPT-W.41 OPT-W.38
ACCEL 50
DELAY .5
OVERSH 50
SPEED 30
SETERR 1234

;=== more instructions
; OPT-W.04 OPT-W.19 OPT-W.20 OPT-W.14 OPT-W.21
5 CALL 2
GOTO 5
GOSUB 5
ERR 5
IF VL[0] THEN 5 ELSE 5

;=== declarations and definitions
; OPT-W.07 OPT-W.08 OPT-W.55 OPT-W.56 OPT-W.50
DECLARE X = VR[0]
DEFINE PAR[0] = INT
WORKDEF 0,0
ZERO
WAIT IL[16]

;=== paths and offsets
; OPT-W.26 OPT-W.31 OPT-W.43 OPT-W.45 OPT-W.22
MOVE (1.,2.,3.,0.,0.)
PATH LIN
SYSDEF
TCP (0.,0.,3./0.,0.,-5.)
IMAGE OL

;=== the control's own
; OPT-W.03 OPT-W.33 OPT-W.40 OPT-W.47
BREAK 7
REAL OL
SIMUL 10, 45
9 TIMER (5., 9)

;=== words that are accepted without effect
; OPT-W.05 OPT-W.10 OPT-W.12 OPT-W.15 OPT-W.27
CONT                     ; expect 7023
DISABLE 3                ; expect 7023
ENABLE                   ; expect 7023
EXTERN FOO               ; expect 7023
NOBREAK                  ; expect 7023

;=== weaving
; OPT-W.51 OPT-W.52 OPT-W.53
WEAV (((                 ; expect 7023
WEAVDEF 1,2,             ; expect 7023
WEAVING                  ; expect 7023

;=== words that are not available
; OPT-W.17 OPT-W.23 OPT-W.25 OPT-W.29 OPT-W.35
GET                      ; expect 7022
INCLUDE 5                ; expect 7022
MACHINE                  ; expect 7022
NOTRACE                  ; expect 7022
SEND                     ; expect 7022

;=== more words that are not available
; OPT-W.36 OPT-W.37 OPT-W.39 OPT-W.48 OPT-W.64
SENSDEF                  ; expect 7022
SENSOR 5                 ; expect 7022
SIGNAL                   ; expect 7022
TRACE                    ; expect 7022
5 TIMER (1.,5) /CLOCK    ; expect 7022
TIMER (1.,5) /INTR       ; expect 7022
VR[1] = CLOCK            ; expect 7022

;=== timers repeat or are cancelled
; OPT-W.63 OPT-W.72
9 TIMER (5.,9) /AUTO
TIMER /DIS
VL[1] = VL[2] AND VL[3] OR VL[4] XOR NOT VL[5]
