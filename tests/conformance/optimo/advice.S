;=== reserved variables (advice)
; OPT-7.104 OPT-7.105 OPT-E.7413
VR[50] = 1.              ; expect 7413
VR[98] = 1.              ; expect 7413
VR[42] = 1.
VR[60] = 1.
VI[75] = 1               ; expect 7413
VI[69] = 1
VL[80] = ON              ; expect 7413
VL[79] = ON
ASSIGN VL[78] = 0 /8     ; expect 7413
ASSIGN VL[72] = 0 /8

;=== what cannot be written at all is told once (advice)
; OPT-7.66 OPT-7.105 OPT-E.7016
VI[99] = 0               ; expect 7016
ASSIGN OL[8] = VI[99] /1

;=== outputs of the system (advice)
; OPT-7.106 OPT-E.7412
OL[20] = ON              ; expect 7412
OL[8] = ON
OL[11] = ON
OL[16] = ON
OL[32] = ON
ASSIGN OL[16] = 0 /2     ; expect 7412

;=== offsets and tools that mean nothing (advice)
; OPT-7.37 OPT-E.7311 OPT-E.7312 OPT-E.7313 OPT-E.7315
SYSDEF (0.0,0.0,0.0,0.0,0.0,0.0)     ; expect 7311
TCP (8.68,0,0.72/0,1.77,0)           ; expect 7313
TCP (0,0,0/0,0,0)                    ; expect 7312
TCP (0,0,0/0,0,5)                    ; expect 7315

;=== the rotary table turns in degrees (advice)
; OPT-8.78
VR[3] = 1.
FUNCTION 99 (VR[3])      ; expect 7033
FUNCTION 99 (VR[26])

;=== tools that are off the axis, and without one (advice)
; OPT-4.55 OPT-4.70 OPT-4.71 OPT-B.90
TCP (0,0,3/0,1,3)                    ; expect 7313
TCP (0,0,3/0,0,3)                    ; expect 7312
TCP (0,0,3/0,0,3.5)                  ; expect 7315
