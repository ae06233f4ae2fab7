tool Ball {
    units mm;
    curve c0 = d; curve c1 = max(c0 - 0.001, 0); curve c2 = max(c1 - 0.001, 0); curve c3 =
    max(c2 - 0.001, 0); curve c4 = max(c3 - 0.001, 0); curve c5 = max(c4 - 0.001, 0);
    curve c6 = max(c5 - 0.001, 0); curve c7 = max(c6 - 0.001, 0); curve c8 = max(c7 -
    0.001, 0); curve c9 = max(c8 - 0.001, 0); curve c10 = max(c9 - 0.001, 0); curve c11
    = max(c10 - 0.001, 0); curve c12 = max(c11 - 0.001, 0); curve c13 = max(c12 - 0.001,
    0); curve c14 = max(c13 - 0.001, 0); curve c15 = max(c14 - 0.001, 0); curve c16 =
    max(c15 - 0.001, 0); curve c17 = max(c16 - 0.001, 0); curve c18 = max(c17 - 0.001,
    0); curve c19 = max(c18 - 0.001, 0); curve c20 = max(c19 - 0.001, 0); curve c21 =
    max(c20 - 0.001, 0); curve c22 = max(c21 - 0.001, 0); curve c23 = max(c22 - 0.001,
    0); curve c24 = max(c23 - 0.001, 0); curve c25 = max(c24 - 0.001, 0); curve c26 =
    max(c25 - 0.001, 0); curve c27 = max(c26 - 0.001, 0); curve c28 = max(c27 - 0.001,
    0); curve c29 = max(c28 - 0.001, 0); curve c30 = max(c29 - 0.001, 0); curve c31 =
    max(c30 - 0.001, 0); curve c32 = max(c31 - 0.001, 0); curve c33 = max(c32 - 0.001,
    0); curve c34 = max(c33 - 0.001, 0); curve c35 = max(c34 - 0.001, 0); curve c36 =
    max(c35 - 0.001, 0); curve c37 = max(c36 - 0.001, 0); curve c38 = max(c37 - 0.001,
    0); curve c39 = max(c38 - 0.001, 0); curve c40 = max(c39 - 0.001, 0); curve c41 =
    max(c40 - 0.001, 0); curve c42 = max(c41 - 0.001, 0); curve c43 = max(c42 - 0.001,
    0); curve c44 = max(c43 - 0.001, 0); curve c45 = max(c44 - 0.001, 0); curve c46 =
    max(c45 - 0.001, 0); curve c47 = max(c46 - 0.001, 0); curve c48 = max(c47 - 0.001,
    0); curve c49 = max(c48 - 0.001, 0); curve c50 = max(c49 - 0.001, 0); curve c51 =
    max(c50 - 0.001, 0); curve c52 = max(c51 - 0.001, 0); curve c53 = max(c52 - 0.001,
    0); curve c54 = max(c53 - 0.001, 0); curve c55 = max(c54 - 0.001, 0); curve c56 =
    max(c55 - 0.001, 0); curve c57 = max(c56 - 0.001, 0); curve c58 = max(c57 - 0.001,
    0); curve c59 = max(c58 - 0.001, 0); curve c60 = max(c59 - 0.001, 0); curve c61 =
    max(c60 - 0.001, 0); curve c62 = max(c61 - 0.001, 0); curve c63 = max(c62 - 0.001,
    0); curve c64 = max(c63 - 0.001, 0); curve c65 = max(c64 - 0.001, 0); curve c66 =
    max(c65 - 0.001, 0); curve c67 = max(c66 - 0.001, 0); curve c68 = max(c67 - 0.001,
    0); curve c69 = max(c68 - 0.001, 0); curve c70 = max(c69 - 0.001, 0); curve c71 =
    max(c70 - 0.001, 0); curve c72 = max(c71 - 0.001, 0); curve c73 = max(c72 - 0.001,
    0); curve c74 = max(c73 - 0.001, 0); curve c75 = max(c74 - 0.001, 0); curve c76 =
    max(c75 - 0.001, 0); curve c77 = max(c76 - 0.001, 0); curve c78 = max(c77 - 0.001,
    0); curve c79 = max(c78 - 0.001, 0); curve c80 = max(c79 - 0.001, 0); curve c81 =
    max(c80 - 0.001, 0); curve c82 = max(c81 - 0.001, 0); curve c83 = max(c82 - 0.001,
    0); curve c84 = max(c83 - 0.001, 0); curve c85 = max(c84 - 0.001, 0); curve c86 =
    max(c85 - 0.001, 0); curve c87 = max(c86 - 0.001, 0); curve c88 = max(c87 - 0.001,
    0); curve c89 = max(c88 - 0.001, 0); curve c90 = max(c89 - 0.001, 0); curve c91 =
    max(c90 - 0.001, 0); curve c92 = max(c91 - 0.001, 0); curve c93 = max(c92 - 0.001,
    0); curve c94 = max(c93 - 0.001, 0); curve c95 = max(c94 - 0.001, 0); curve c96 =
    max(c95 - 0.001, 0); curve c97 = max(c96 - 0.001, 0); curve c98 = max(c97 - 0.001,
    0); curve c99 = max(c98 - 0.001, 0); curve c100 = max(c99 - 0.001, 0); curve c101 =
    max(c100 - 0.001, 0); curve c102 = max(c101 - 0.001, 0); curve c103 = max(c102 -
    0.001, 0); curve c104 = max(c103 - 0.001, 0); curve c105 = max(c104 - 0.001, 0);
    curve c106 = max(c105 - 0.001, 0); curve c107 = max(c106 - 0.001, 0); curve c108 =
    max(c107 - 0.001, 0); curve c109 = max(c108 - 0.001, 0); curve c110 = max(c109 -
    0.001, 0); curve c111 = max(c110 - 0.001, 0); curve c112 = max(c111 - 0.001, 0);
    curve c113 = max(c112 - 0.001, 0); curve c114 = max(c113 - 0.001, 0); curve c115 =
    max(c114 - 0.001, 0); curve c116 = max(c115 - 0.001, 0); curve c117 = max(c116 -
    0.001, 0); curve c118 = max(c117 - 0.001, 0); curve c119 = max(c118 - 0.001, 0);
    curve c120 = max(c119 - 0.001, 0); curve c121 = max(c120 - 0.001, 0); curve c122 =
    max(c121 - 0.001, 0); curve c123 = max(c122 - 0.001, 0); curve c124 = max(c123 -
    0.001, 0); curve c125 = max(c124 - 0.001, 0); curve c126 = max(c125 - 0.001, 0);
    curve c127 = max(c126 - 0.001, 0); curve c128 = max(c127 - 0.001, 0); curve c129 =
    max(c128 - 0.001, 0); curve c130 = max(c129 - 0.001, 0); curve c131 = max(c130 -
    0.001, 0); curve c132 = max(c131 - 0.001, 0); curve c133 = max(c132 - 0.001, 0);
    curve c134 = max(c133 - 0.001, 0); curve c135 = max(c134 - 0.001, 0); curve c136 =
    max(c135 - 0.001, 0); curve c137 = max(c136 - 0.001, 0); curve c138 = max(c137 -
    0.001, 0); curve c139 = max(c138 - 0.001, 0); curve c140 = max(c139 - 0.001, 0);
    curve c141 = max(c140 - 0.001, 0); curve c142 = max(c141 - 0.001, 0); curve c143 =
    max(c142 - 0.001, 0); curve c144 = max(c143 - 0.001, 0); curve c145 = max(c144 -
    0.001, 0); curve c146 = max(c145 - 0.001, 0); curve c147 = max(c146 - 0.001, 0);
    curve c148 = max(c147 - 0.001, 0); curve c149 = max(c148 - 0.001, 0); curve c150 =
    max(c149 - 0.001, 0); curve c151 = max(c150 - 0.001, 0); curve c152 = max(c151 -
    0.001, 0); curve c153 = max(c152 - 0.001, 0); curve c154 = max(c153 - 0.001, 0);
    curve c155 = max(c154 - 0.001, 0); curve c156 = max(c155 - 0.001, 0); curve c157 =
    max(c156 - 0.001, 0); curve c158 = max(c157 - 0.001, 0); curve c159 = max(c158 -
    0.001, 0);
    region ball where hypot(d, z - 3) <= 3, c159 <= 9 { depth: 3 - hypot(d, z - 3); }
}
