tool Pin {
    units mm;
    curve side = 3 - d;
    curve low = z;
    curve high = 40 - z;
    region low where 0 <= low <= min(side, high) { depth: low; }
    region high where 0 <= high <= min(side, low) { depth: high; }
    region side as side cutting where 0 <= side <= min(low, high) {
        depth: side;
        niceness: 1 + depth;
    }
}
