// A rod of three regions, of which the top is forgotten.
tool Rod {
    units mm;
    curve side = 3 - d;
    curve end  = 10 - z;
    region side   where 0 <= side <= min(z, end) { depth: side; }
    region bottom where 0 <= z <= min(side, end) { depth: z; }
}
