tool BadLaw {
    units mm;
    curve far = d + d^2;
    profile { start (0, 0); line to (2, 0), (2, 5), (0, 5) as body cutting; }
    niceness body: far;
}
