;=== one instruction a line
; OPT-1.01 OPT-1.19 OPT-E.7003
SPEED 20
SPEED 20 PATH LIN        ; expect 7003
SPEED 20 slow            ; expect 7003

;=== upper and lower case mean the same
; OPT-1.02
path hole (12.7)
Coord absol
MOVE (1.e1, 2.E1, 3., 0., 0.)/fly

;=== a comment runs to the end of the line and may hold any byte
; OPT-1.18 OPT-1.32 OPT-E.7001
SPEED 20 ; #slow# {}~
  ; ° alone
SPEED 20#                ; expect 7001
SPEED ?                  ; expect 7001
DECLARE X_1 = VR[1]      ; expect 7001

;=== blanks between tokens have no meaning
; OPT-1.29
VR [12] = 1.
MOVE ( 1.,2. , 3.,0.,0. ) / FLY
WORK 0, 00 /ON
work	0	,	0	/	off

;=== every error of a file is reported once
; OPT-1.33 OPT-E.7004
SPEED 101                ; expect 7004
FOO 3                    ; expect 7011
MOVE (1.,2.,3.,0.)       ; expect 7019
SPEED 20
GOTO                     ; expect 7003

;=== two bad lines do not hide the good ones between them
; OPT-1.33
VR[1] = (2. + 3.         ; expect 7003
SPEED 101                ; expect 7004
SPEED 30
VR[2] = 4. +             ; expect 7003
SPEED 20

;=== an assignment behind an open parenthesis starts afresh
; OPT-1.33
VR[1] = (2. + 3.         ; expect 7003
VR[2] = 4.
VR[3] = ON               ; expect 7018

;=== an attribute word in the place of an instruction
; OPT-W.60 OPT-W.11 OPT-W.46
FLY                      ; expect 7003
ELSE 5                   ; expect 7003
THEN 5                   ; expect 7003
ABSOL                    ; expect 7003
