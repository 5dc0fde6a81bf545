;=== a name stands for a number, a constant or a variable
; OPT-7.41 OPT-7.44 OPT-W.73 OPT-9.30
DECLARE YHOME = 45.0
DECLARE CAXIS = OL [11]
DECLARE radius = PAR[0]
DECLARE LOWER = -3
DECLARE ENABLED = ON
DECLARE P = PI
CAXIS = ON
VR[1] = radius + YHOME + P

;=== an expression or another name is refused
; OPT-7.42 OPT-E.7014
DECLARE A1 = VR[1]+1     ; expect 7014
DECLARE A2 = VR[2]
DECLARE A3 = A2          ; expect 7014
DECLARE A4 = SIN(1.)     ; expect 7014
DECLARE A5 = -VR[1]      ; expect 7014

;=== a constant cannot be assigned
; OPT-7.43 OPT-E.7015
DECLARE YHOME = 45.0
YHOME = 46.0             ; expect 7015

;=== a name begins with a letter
; OPT-7.45
DECLARE 2X = VR[1]       ; expect 7003
DECLARE X_1 = VR[1]      ; expect 7001
X_1 = 5.                 ; expect 7001
LET X_1 = 5.             ; expect 7001
SPED_1 = 5.              ; expect 7001
VR[0] = X_1              ; expect 7001

;=== eight characters count
; OPT-7.46 OPT-7.47 OPT-B.49 OPT-E.7012
DECLARE POSITION1 = VR[1]    ; expect 7012
POSITION = 5.
DECLARE POSITION2 = VR[2]    ; expect 7010

;=== a reserved word is no name
; OPT-7.48 OPT-W.74 OPT-W.75 OPT-E.7009
DECLARE C = VR[1]            ; expect 7009
DECLARE FUNCTION1 = VR[1]    ; expect 7009
DECLARE VR = 5               ; expect 7009
DECLARE PAR = 5              ; expect 7009
DECLARE A = VR[46]

;=== the uses of a refused name are no errors of their own
; OPT-1.33 OPT-7.48
DECLARE C = VR[1]            ; expect 7009
DECLARE SPEED = VR[2]        ; expect 7009
DECLARE FUNCTION1 = VR[3]    ; expect 7009
C = 5.
LET C = C + 1.
SPEED = C
SPEED 5
SPEED C
FUNCTION1 = SPEED + FUNCTION1
MOVE (C, SPEED, 1., 0., 0.)/FLY
GO 46/C
SPEED C C                    ; expect 7003

;=== of a name that nobody declared it matters little how long it is
; OPT-7.46 OPT-7.50 OPT-1.33
POSITION1 = 5                ; expect 7011
DECLARE LENGTH = VR[1]
DECLARE LENGTHOFX = VR[2]    ; expect 7012
LENGTHOFX = 5

;=== a name is declared once and before it is used
; OPT-7.49 OPT-7.50 OPT-E.7010 OPT-E.7011
X = 5.                   ; expect 7011
DECLARE X = VR[0]
DECLARE X = VR[1]        ; expect 7010
X = 5.
Z = 1.                   ; expect 7011
VR[2] = Z + X            ; expect 7011

;=== the uses of a name whose DECLARE is wrong are no errors of their own
; OPT-1.33
DECLARE XP = VR[100]     ; expect 7017
DECLARE YP = VR[1] + 1   ; expect 7014
YP = 5.

;=== an index is a number or an INTEGER constant
; OPT-7.59 OPT-7.60 OPT-E.7017
DECLARE N = 7
DECLARE R = VR[1]        ; expect 7009
DECLARE F = 7.5
DECLARE V = VI[2]
VR[N] = 1.
VR[07] = 1.
VR[100] = 1.             ; expect 7017
VR[VI[2]] = 1.           ; expect 7017
VR[1.] = 1.              ; expect 7017
VR[F] = 1.               ; expect 7017
VR[V] = 1.               ; expect 7017
VR[-1] = 1.              ; expect 7017
