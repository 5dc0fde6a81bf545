;=== every form of a number
; OPT-7.54 OPT-7.55 OPT-B.41 OPT-B.42
VR[0] = 5
VR[0] = 5.
VR[0] = .5
VR[0] = 5.0
VR[0] = 1234.5
VR[0] = -2.5 E -3
VR[0] = .256 E -3
VR[0] = -.5 E +10
VR[0] = 5E3
VR[0] = 5 e 3
VR[0] = .256E-3

;=== what is no number
; OPT-B.42 OPT-E.7005 OPT-7.55
VR[0] = .                ; expect 7005
VR[0] = 5..              ; expect 7005
VR[0] = 1.2.3            ; expect 7005
VR[0] = 0x5              ; expect 7005
VR[0] = 1E100            ; expect 7005
VR[0] = 5 E              ; expect 7003
DELAY 1,5                ; expect 7003

;=== the range of REAL
; OPT-7.62
VR[0] = 1E19             ; expect 7004
VR[0] = 9.2E18
VR[0] = -9.3E18          ; expect 7004
VR[0] = 1E-99

;=== seven digits count, more are accepted
; OPT-7.56 OPT-7.53
VR[10] = 1262.139005
VR[11] = 40000
VI[2] = 32767
VI[2] = -32768

;=== logical constants
; OPT-7.58 OPT-W.67 OPT-W.68
OL[11] = 1
OL[11] = ON
OL[11] = TRUE
VL[0] = YES
VL[0] = NO
VL[0] = FALSE
VL[0] = OFF
VL[0] = 2                ; expect 7018
