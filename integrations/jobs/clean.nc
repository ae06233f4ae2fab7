(along the wall of the bracket: the flute cuts, and the shank is above the wall)
G21 G90 G54 G0 X34.9 Y-40. Z90.
T1 M6
S6000 M3
G43 H1 Z90.
Z28.
G1 Y50. F600.
G0 Z90.
G49
M5
M30
