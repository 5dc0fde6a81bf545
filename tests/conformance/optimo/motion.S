;=== MOVE has five coordinates
; OPT-2.01 OPT-B.50 OPT-E.7019
MOVE (1200, 170.5, -118.3, 0.5, 0.12)
MOVE (1.,2.,3.,0.)       ; expect 7019
MOVE (1.,2.,3.,0.,0.,0.) ; expect 7019
MOVE                     ; expect 7019
MOVE ()                  ; expect 7019

;=== PATH HOLE has a radius, the others have none
; OPT-2.12 OPT-2.33 OPT-W.58 OPT-W.59 OPT-E.7022
PATH PTP
PATH LIN
PATH CIR
PATH HOLE (25.1)
PATH HOLE                ; expect 7003
PATH LIN (3)             ; expect 7003
PATH FRE                 ; expect 7022
PATH                     ; expect 7003

;=== COORD
; OPT-W.57 OPT-W.06
COORD ABSOL
COORD ROBOT
COORD LIN                ; expect 7003

;=== percentages
; OPT-2.34 OPT-2.35 OPT-2.36 OPT-2.38 OPT-B.36
DECLARE RAPID = VR[64]
DECLARE TOOFAST = 120.
SPEED 33.
SPEED RAPID
SPEED VR[64]
SPEED (VR[64] + 1.)
ACCEL 50
OVERSH 100
SPEED 0
SPEED 101                ; expect 7004
ACCEL -1                 ; expect 7004
OVERSH 100.5             ; expect 7004
SPEED TOOFAST            ; expect 7004
SPEED VL[1]              ; expect 7018

;=== attributes in any order, each once
; OPT-2.43 OPT-E.7020 OPT-E.7021 OPT-W.61
MOVE (1.,2.,3.,0.,0.) /FLY /START (IL[16])
MOVE (1.,2.,3.,0.,0.) /START (IL[16]) /FLY
MOVE (1.,2.,3.,0.,0.) /NEXT /END (IL[20]) /VIA (1.,2.,3.,0.,0.)
MOVE (1.,2.,3.,0.,0.)/FLY/FLY    ; expect 7021
SPEED 5 /FLY                     ; expect 7020
DELAY 1 /NEXT                    ; expect 7020
MOVE (1.,2.,3.,0.,0.) /ON        ; expect 7020
MOVE (1.,2.,3.,0.,0.) /FLYY      ; expect 7003

;=== the via point has five coordinates
; OPT-2.31
MOVE (1.,2.,3.,0.,0.) /VIA (1.,2.,3.)    ; expect 7019
MOVE (1.,2.,3.,0.,0.) /VIA               ; expect 7019

;=== /TIME takes seconds and a sequence number, /INF has no effect
; OPT-2.54 OPT-2.61 OPT-W.62 OPT-E.7023
900 MOVE (1.,2.,3.,0.,0.) /TIME (2., 900)
MOVE (1.,2.,3.,0.,0.) /TIME (-2., 900)   ; expect 7004
MOVE (1.,2.,3.,0.,0.) /TIME (2.)         ; expect 7003
MOVE (1.,2.,3.,0.,0.)/INF                ; expect 7023

;=== SYSDEF has six values or none
; OPT-7.28 OPT-7.35 OPT-7.38
SYSDEF (50.8, 101.6, 0, 0, 0, 0)
SYSDEF
SYSDEF (1.,2.,3.)        ; expect 7019

;=== TCP has two triples
; OPT-4.64 OPT-4.72 OPT-B.85
TCP (0.0,0.0,3.0 / 0.0,0.0,-6.0)
TCP (0.0,0.0,3.0,0.0,0.0,-6.0)
TCP (0,0,(VR[1]/2)/0,0,-5)
TCP (0,0,(VR[1])/0,0,-5)
TCP (0,0,SQRT(VR[1]/2)/0,0,-5)
TCP (0,0,VR[1]/2/0,0,-5) ; expect 7019
TCP (0,0,3)              ; expect 7019
TCP                      ; expect 7019
