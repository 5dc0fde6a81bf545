;=== forms of WORKDEF
; OPT-3.01 OPT-3.04 OPT-3.05 OPT-3.07
WORKDEF 0,0
WORKDEF 1,0 (6.5, 80., 1.5, 95)
WORKDEF 1,00,(6.5,80.,1.5,95.)
WORKDEF 1,01 (VR[65],VR[66],VR[67],VR[68])
WORKDEF 1,2 (8.,75.,1.,50.,12)
WORKDEF 2,5 (15)
WORKDEF 2,0 (VR[30])

;=== kinds and numbers of processes
; OPT-3.02 OPT-E.7402
WORKDEF 3,0              ; expect 7402
WORKDEF 1,10 (1.,2.,3.,4.)   ; expect 7402
WORK 0,10 /ON            ; expect 7402

;=== counts of parameters
; OPT-3.03 OPT-3.04 OPT-3.06
WORKDEF 0,0 (5.)         ; expect 7019
WORKDEF 1,0 (5.)         ; expect 7019
WORKDEF 1,0              ; expect 7019
WORKDEF 2,0 (1,2)        ; expect 7019

;=== ranges of parameters
; OPT-3.06 OPT-3.08 OPT-E.7403
WORKDEF 1,0 (0., 80., 1., 90.)       ; expect 7004
WORKDEF 1,0 (100., 100., 0., 0.)
WORKDEF 1,0 (101., 80., 1., 90.)     ; expect 7004
WORKDEF 1,0 (8., 101., 1., 90.)      ; expect 7004
WORKDEF 1,0 (8., 80., -1., 90.)      ; expect 7004
WORKDEF 1,0 (8., 80., 1., -90.)      ; expect 7004
WORKDEF 2,5 (0)                      ; expect 7403
WORKDEF 2,5 (64)                     ; expect 7403
WORKDEF 2,5 (63)
WORKDEF 1,0 (8., 80., 1., 90., 64)   ; expect 7403

;=== WORK is ON or OFF
; OPT-3.13 OPT-3.38 OPT-W.54
WORK 0,0 /ON
WORK 0,00/OFF
WORK 0,0                 ; expect 7003
WORK 0,0/ON/OFF          ; expect 7021
WORK 0,0/ON/ON           ; expect 7021
WORK 0,0/ON /START (IL[16]) /END (IL[17]) /NEXT
WORK 0,0/FLY             ; expect 7020
5 WORK 0,0/ON /TIME (1.,5)   ; expect 7023

;=== DELAY and SETERR
; OPT-3.45 OPT-3.61
DELAY .5
DELAY 0
DELAY -1                 ; expect 7004
SETERR 1234
SETERR 9999
SETERR 0                 ; expect 7004
SETERR 10000             ; expect 7004

;=== ASSIGN writes groups
; OPT-7.102 OPT-7.103 OPT-E.7206 OPT-7.108 OPT-W.02
DECLARE PRGDATA = OL[22]
ASSIGN OL[22] = 5 /8
ASSIGN PRGDATA =0 /8
ASSIGN VL[1] = VI[3] /16
ASSIGN OL[12]=16 /4      ; expect 7206
ASSIGN OL[12]=-1 /4      ; expect 7206
ASSIGN OL[95]=0 /8       ; expect 7206
ASSIGN OL[92]=0 /8
ASSIGN OL[12]=1 /17      ; expect 7004
ASSIGN VR[12]=1 /4       ; expect 7018
ASSIGN OL[12]=VL[1] /4   ; expect 7018
ASSIGN IL[12]=1 /4       ; expect 7016
ASSIGN OL[12]=1.5 /4     ; expect 7003

;=== groups of images
; OPT-7.98 OPT-7.100 OPT-B.61 OPT-W.49
UPDATE IL, OL /OFF
UPDATE IA /ON
IMAGE OL
IMAGE
REAL
REAL OL, OA
UPDATE VR /ON            ; expect 7003
UPDATE IL                ; expect 7003
UPDATE IL /ON /OFF       ; expect 7021
