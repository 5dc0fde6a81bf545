;=== logical and numeric do not mix
; OPT-7.89 OPT-7.92 OPT-7.93 OPT-B.46 OPT-E.7018
OL[5] = VR[1]            ; expect 7018
OL[5] = 2                ; expect 7018
VR[1] = IL[3]            ; expect 7018
VR[1] = ON               ; expect 7018
VR[1] = 1
VL[0] = VR[1] AND VL[2]  ; expect 7018
VR[0] = VL[1] + 1        ; expect 7018
VL[0] = PAR[0]           ; expect 7018

;=== integers become real, logical expressions stay logical
; OPT-7.94 OPT-7.88 OPT-2.03
VR[0] = VI[2]
OL [15] = IL [32] AND IL [27]
OL [16] = IL [16] or IL [23]
MOVE (VR[1], VR[2] + 10., VI[3], 0, 0)

;=== relations
; OPT-7.85 OPT-7.86 OPT-B.43 OPT-B.44 OPT-B.45
VL[1] = VR[2] >< 3.
VL[3] = VR[1] = 2.
VL[0] = IL[3] = 1
VL[0] = IL[3] <> VL[2]
VL[0] = IL[3] AND VR[1] > 5.
VL[0] = IL[3] > 1            ; expect 7018
VL[0] = IL[3] = VR[1]        ; expect 7018
VL[0] = 1 < 2 < 3            ; expect 7003
VL[0] = (1 < 2) = (2 < 3)

;=== conditions may be logical or numeric
; OPT-7.24 OPT-7.26 OPT-2.57 OPT-7.27
DECLARE DIST = VR[5]
50 IF VI[2] THEN 50
IF DIST > 100 THEN 50
IF (VR[1] > 0.) AND IL[3] THEN 50 ELSE 50
MOVE (10.0,10.0,750.0,0.0,0.0) /FLY /START (IL[16])
WAIT (IL[16])
WAIT NOT IL[95]

;=== only what can be written is assigned
; OPT-7.66 OPT-E.7016
IL[3] = ON               ; expect 7016
IA[0] = 1.               ; expect 7016
OA[0] = 1.               ; expect 7016
VI[98] = 1               ; expect 7016
VI[99] = 0               ; expect 7016
OA[1] = 1.
VI[97] = 1

;=== arguments of functions stand in parentheses
; OPT-7.84 OPT-7.82 OPT-W.69 OPT-W.70 OPT-W.71
VR[0] = SIN (VR [5]) +8
VR[0] = COS(1.) + TAN(1.) + ASIN(1.) + ACOS(1.) + ATAN(1.)
VR[0] = SQRT(2.) + EXP(1.) + LN(2.) + LOG(2.) + ABS(-1.) + INT(2.5)
VR[0] = 7 MOD 3
VR[0] = SIN 5.           ; expect 7003
VR[0] = SIN(ON)          ; expect 7018

;=== a plus sign is ignored, NOT needs a logical place
; OPT-7.72 OPT-7.87
VR[0] = +5
VR[0] = 1 + NOT VL[1]    ; expect 7003
VL[0] = NOT VR[1] = 2.
VL[0] = NOT NOT VL[1]
