(beside the wall: the holder meets the clamp)
G21 G90 G54 G0 X25. Y-40. Z90.
T1 M6
S6000 M3
G43 H1 Z90.
Z12.
G1 Y50. F600.
G0 Z90.
G49
M5
M30
