; What fails whenever it is executed, and can be seen in the text.

;=== divisions by zero, overflows and domains (advice)
; OPT-7.78 OPT-7.79 OPT-7.83 OPT-E.7203 OPT-E.7204
VR[0] = 1/0                          ; expect 7201
VI[2] = 5 MOD 0                      ; expect 7201
VR[0] = 0^-1                         ; expect 7201
VR[0] = 1E18*100.                    ; expect 7202
VR[0] = SQRT(-1)                     ; expect 7204
VR[0] = ASIN(2)                      ; expect 7204
VR[0] = LN(0)                        ; expect 7204
VR[0] = EXP(33)                      ; expect 7204
VR[0] = (-8)^(1/3)                   ; expect 7204
VI[2] = 32767+1                      ; expect 7203
VI[2] = 32768                        ; expect 7203
VI[2] = -32768
VI[2] = 32767.9
VR[0] = 32767+1
MOVE (1/0, 0, 0, 0, 0)               ; expect 7201
IF 1/0 > 0 THEN 5                    ; expect 7201
5 VL[0] = 1/0 > 0                    ; expect 7201

;=== names of constants count as their values (advice)
; OPT-7.43 OPT-7.79
DECLARE NONE = 0
DECLARE BIG = 40000
VR[0] = 1/NONE                       ; expect 7201
VI[2] = BIG                          ; expect 7203

;=== computed operands out of their range (advice)
; OPT-B.36 OPT-2.35 OPT-E.7205 OPT-E.7505
SPEED 50+51                          ; expect 7205
SPEED 50+50
ACCEL 0-1                            ; expect 7205
OVERSH 2*51                          ; expect 7205
DELAY 1-2                            ; expect 7205
DELAY 1+2
SETERR 5000*2                        ; expect 7505
WORKDEF 1,0 (1-1, 80., 1., 90.)      ; expect 7205
WORKDEF 1,0 (1+1, 50+51, 1., 90.)    ; expect 7205
WORKDEF 1,0 (1+1, 50., 1.-2., 90.)   ; expect 7205
WORKDEF 1,0 (1+1, 50., 1., 90., 8*8) ; expect 7403
WORKDEF 2,0 (32+32)                  ; expect 7403
WORKDEF 2,0 (32+31)
WORKDEF 2,0 (63+.9999)
WORKDEF 2,0 (63+1.)                  ; expect 7403
SETERR 9999+.999
SETERR 9999+1.                       ; expect 7505

;=== what depends on a variable is not known (advice)
; OPT-B.36 OPT-7.79
VR[1] = 0.
VR[0] = 1/VR[1]
VI[2] = 40000 + VR[1]
SPEED 101 + VR[1]

;=== a WAIT for what is never true (advice)
; OPT-7.27
WAIT 0                               ; expect 7033
WAIT 1 > 2                           ; expect 7033
WAIT 1
WAIT NOT IL[95]

;=== SPEED 0 and a distance to go (advice)
; OPT-B.22 OPT-E.7307
; rmlcell: allow 7033 in file
COORD ABSOL
PATH LIN
MOVE (1.,2.,3.,0.,0.)
SPEED 0
MOVE (1.,2.,3.,0.,0.)
MOVE (10.,2.,3.,0.,0.)               ; expect 7307
MOVE (20.,2.,3.,0.,0.)/TIME (1.,900)
MOVE (VR[1],2.,3.,0.,0.)
ENDTASK
900 RETURN
