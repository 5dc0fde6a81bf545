;=== a statement goes on behind a comma, a slash, an operator and inside parentheses
; OPT-1.30 OPT-8.52
MOVE (1.,2.,3.,0.,0.)/
VIA (2.,2.,3.,0.,0.)
MOVE
(1.,2.,3.,0.,0.)
MOVE (1.,2.
,3.,0.
,0.)
/FLY
VR[1] =      ; the value comes below

; a comment line between
2. *
3.
VL[1] = VL[2] AND
VL[3]
SYSDEF
(1., 2., 3., 0., 0., 0.)

;=== a token cannot be split
; OPT-1.31
MOVE (1.,2.,3.,0.,1.570
8)                       ; expect 7003

;=== a statement that the end of the text cuts off
; OPT-E.7002
MOVE (1.,2.,3.,
                         ; expect-end 7002

;=== a comma at the end of the text
; OPT-E.7002
UPDATE IL,
                         ; expect-end 7002

;=== an operator cannot be split
; OPT-B.87
VL[0] = VR[1] > = 2.     ; expect 7003
VL[0] = VR[1] >= 2.
VL[0] = VR[1] <> 2.
VL[0] = VR[1] >< 2.
VL[0] = VR[1] =< 2.      ; expect 7003
